//! `mesh`: the mid-surface of a network and its quality.

use std::path::Path;

use anyhow::{Context, anyhow};

use super::terminal::say;
use crate::field::{CappedField, CompiledNetwork, DesignBox};
use crate::io::vtu::Picture;
use crate::io::{OutputFolder, stl};
use crate::mesh::{MeshSettings, surface_of_field};
use crate::scene::checks::check_mesh;
use crate::scene::part::on_disk::read_network;
use crate::scene::results::design_folder::write_json;
use crate::surface::SurfaceQuality;

/// Meshes the network at `path` and writes surface and quality into the new folder `out`.
pub(super) fn run(path: &Path, out: &Path, edge: Option<f64>, json: bool) -> anyhow::Result<()> {
    OutputFolder::check_new(out)?;
    let network = read_network(path)?;
    let mut settings = MeshSettings::default();
    settings.edge = edge.unwrap_or(settings.edge);
    let design_box = DesignBox::default();
    check_mesh(design_box, &settings).context("--edge")?;
    let field = CappedField::new(CompiledNetwork::new(&network), design_box, settings.rim_radius)?;
    let surface = surface_of_field(&field, &settings)
        .map_err(|rejected| anyhow!("{}: {rejected}", path.display()))?;
    let quality = SurfaceQuality::of(&surface)?;
    let folder = OutputFolder::create_new(out)?;
    stl::write(&folder.file("surface.stl"), &surface)?;
    Picture::new(&surface).write(&folder.file("surface.vtu"))?;
    write_json(&folder.file("quality.json"), &quality)?;
    say(&if json { serde_json::to_string_pretty(&quality)? } else { in_words(&quality, out) });
    Ok(())
}

fn in_words(quality: &SurfaceQuality, out: &Path) -> String {
    format!(
        "{} vertices, {} triangles, genus {}; area {:.1} mm^2, volume {:.1} mm^3\n\
         edges {:.2} / {:.2} / {:.2} mm (min / mean / max), radius ratio {:.2} / {:.2} (min / mean)\n\
         valence {} to {}, largest dihedral angle {:.1} deg; results in {}",
        quality.vertices,
        quality.triangles,
        quality.genus,
        quality.area,
        quality.volume,
        quality.edge_min,
        quality.edge_mean,
        quality.edge_max,
        quality.radius_ratio_min,
        quality.radius_ratio_mean,
        quality.valence_min,
        quality.valence_max,
        quality.dihedral_max,
        out.display()
    )
}
