//! How often, how well and how fast the walls of random valid genomes become tetrahedra.
//!
//! `cargo run --release --example wall_tetrahedra -- GENOMES EDGE [tetgen | gmsh]`

#![allow(clippy::print_stdout, clippy::unwrap_used, reason = "it is a program that prints a table")]

use std::collections::BTreeMap;
use std::time::Instant;

use pneumorph::field::{CappedField, CompiledNetwork, DesignBox};
use pneumorph::genome::{Paper, Representation};
use pneumorph::io::gmsh::{Algorithm, Gmsh};
use pneumorph::io::tetgen::TetGen;
use pneumorph::math::random::{Purpose, Stream};
use pneumorph::mesh::tetrahedra::{TetMesher, TetSettings, Unfilled, filled_wall};
use pneumorph::mesh::{MeshSettings, WallSettings, surface_of_field, wall_surfaces};
use pneumorph::surface::MidSurface;

/// Of the walls, mm.
const THICKNESS: f64 = 1.6;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (genomes, edge): (u64, f64) =
        (arguments[0].parse().unwrap(), arguments[1].parse().unwrap());
    let (tetgen, hxt, delaunay) =
        (TetGen::default(), Gmsh::new(Algorithm::Hxt), Gmsh::new(Algorithm::Delaunay));
    let meshers: &[&dyn TetMesher] = match arguments.get(2).map(String::as_str) {
        None => &[&tetgen, &hxt, &delaunay],
        Some("tetgen") => &[&tetgen],
        Some(_) => &[&hxt, &delaunay],
    };
    let (stream, paper) = (Stream::new(1), Paper::default());
    let mut endings: BTreeMap<String, usize> = BTreeMap::new();
    let mut seconds = Vec::new();
    for i in 0.. {
        if seconds.len() as u64 == genomes {
            break;
        }
        let genome = paper.random(&mut stream.keyed(Purpose::Creation, 0, i));
        let settings = MeshSettings::default();
        let network = CompiledNetwork::new(&paper.express(&genome));
        let field = CappedField::new(network, DesignBox::default(), settings.rim_radius).unwrap();
        let Ok(middle) = surface_of_field(&field, &settings) else { continue };
        let middle = MidSurface::uniform(middle, THICKNESS).unwrap();
        let start = Instant::now();
        let surfaces =
            |edge| wall_surfaces(&middle, &WallSettings { edge, ..WallSettings::default() });
        let filled = filled_wall(&surfaces, meshers, &TetSettings::for_wall(THICKNESS, edge));
        seconds.push(start.elapsed().as_secs_f64());
        let (ending, attempts, words) = match filled {
            Ok(filled) => {
                let q = filled.quality;
                let words = format!(
                    "{} tets, dihedral {:.1} / {:.1}, {:.2} through",
                    q.tetrahedra, q.dihedral_min, q.dihedral_1_percent, q.layers_mean
                );
                (format!("{} at {:.2}", filled.mesher, filled.edge), filled.attempts, words)
            }
            Err(Unfilled::Rejected { rejected, attempts }) => {
                (rejected.reason.to_string(), attempts, rejected.detail)
            }
            Err(Unfilled::Machine(what)) => panic!("{what}"),
        };
        println!("{i}: {:.2} s, {ending}: {words}", seconds[seconds.len() - 1]);
        for attempt in attempts {
            if let Some(failure) = attempt.failure {
                println!(
                    "    {:.2} mm, {} in {:.2} s: {failure}",
                    attempt.edge, attempt.mesher, attempt.seconds
                );
            }
        }
        *endings.entry(ending).or_default() += 1;
    }
    seconds.sort_by(f64::total_cmp);
    let [median, worst] = [seconds[seconds.len() / 2], seconds[seconds.len() - 1]];
    println!("{endings:?}; median {median:.2} s, worst {worst:.2} s");
}
