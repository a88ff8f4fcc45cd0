//! A look at a file of a user's, as far as commands go before they compute.

use std::path::Path;

use crate::evolve::Nsga2;
use crate::io::{ChamberChoice, calculix, toml_file};
use crate::scene::Unobserved;
use crate::scene::error::one_line;
use crate::scene::part::closed_part;
use crate::scene::part::on_disk::{OnDisk, read_network};
use crate::scene::part::placement::Placed;
use crate::scene::part::{PartFiles, PartSource};
use crate::scene::scene_file::SceneFile;
use crate::study::run_file::RunFile;
use crate::study::run_folder::RunFolder;

/// Which kind of file it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Input {
    /// A scene file, without the files that it names.
    Scene,
    /// A run file.
    Run,
    /// A network file.
    Network,
    /// A surface, with the mesh that is made of it.
    Surface,
    /// Tetrahedra.
    Tetrahedra,
    /// The folder of a run.
    RunFolder,
    /// The tip's displacements that CalculiX answered (`.dat`).
    TipAnswer,
    /// All nodes' displacements that CalculiX answered (`.frd`).
    NodalAnswer,
}

/// Reads and checks the file or folder `path` as the commands do, and computes nothing with it.
///
/// # Errors
/// One line when a command would refuse it.
pub fn inspect(input: Input, path: &Path) -> Result<(), String> {
    looked_at(input, path).map_err(|error| one_line(&error))
}

fn looked_at(input: Input, path: &Path) -> anyhow::Result<()> {
    match input {
        Input::Scene => SceneFile::read(path, None).map(|_| ()),
        Input::Run => RunFile::read(path, None).map(|_| ()),
        Input::Network => read_network(path).map(|_| ()),
        Input::Surface => {
            let mut surface = OnDisk.surface(path)?;
            let scene: SceneFile = toml_file::parse(ANY_SCENE, Path::new("scene.toml"))?;
            let placed = Placed::new(&scene.part, &mut surface.positions);
            let source = PartSource::Stl { file: path.to_owned(), surface, placed };
            source.check_size(&scene.part, scene.wall.thickness)?;
            closed_part::shell(&scene, &source, &Unobserved).map(|_| ())
        }
        Input::Tetrahedra => OnDisk.tetrahedra(path, &ChamberChoice::default()).map(|_| ()),
        Input::RunFolder => {
            let folder = RunFolder::open(path)?;
            folder.run_file()?;
            let (state, _) = folder.load()?;
            if let Some(state) = state {
                let search = Nsga2::resume(state.search)?;
                let records = folder.records(search.generation())?;
                folder.front(&search, &records)?;
            }
            folder.solid_front().map(|_| ())
        }
        Input::TipAnswer => Ok(calculix::read_tip(path).map(|_| ())?),
        Input::NodalAnswer => Ok(calculix::read_nodes(path).map(|_| ())?),
    }
}

/// Whose wall and mesh a surface is given.
const ANY_SCENE: &str = "[part]\nstl = \"part.stl\"\n[material]\npreset = \"ninjaflex-c2s\"\n";
