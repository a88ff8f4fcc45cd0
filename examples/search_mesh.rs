//! The mesh of a search: what its error and its time are, over many designs.
//!
//! ```text
//! cargo run --release --example search_mesh -- FOLDER (COUNT | NETWORK.toml ...)
//! ```
//!
//! The designs are those of network files, such as `front/*/genome.toml` of a run, or the first COUNT of a random generation that can be
//! evaluated; their settings are those of `examples/paper.toml`. Each is evaluated, both scenarios, with edges of 6 to 2 mm and of
//! 1.5 mm, with which the others are compared. FOLDER receives a table of all evaluations and a figure of the errors of both
//! objectives against the mean CPU time of a candidate.

#![allow(clippy::print_stdout, reason = "it is a program that prints a table")]

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use pneumorph::fitness::{CandidateSettings, Evaluation, Outcome, evaluate_network};
use pneumorph::genome::{Network, NetworkDraft, Paper, Representation};
use pneumorph::io::toml_file;
use pneumorph::math::random::{Purpose, Stream};
use pneumorph::model::material::{Material, Ogden};
use pneumorph::report::{ErrorCurve, ErrorPoint, error_svg, png};
use pneumorph::solve::Backend;

const EDGES: [f64; 7] = [6.0, 5.0, 4.0, 3.5, 3.0, 2.5, 2.0];
const FINEST_EDGE: f64 = 1.5;

fn main() -> anyhow::Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [folder, wanted @ ..] = words.as_slice() else { bail!("name a folder for the results") };
    let folder = PathBuf::from(folder);
    fs::create_dir(&folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| study(&designs(wanted)?, &folder))
}

/// The designs with their names.
fn designs(wanted: &[String]) -> anyhow::Result<Vec<(String, Network)>> {
    let [count] = wanted else { return wanted.iter().map(|path| named(path)).collect() };
    let Ok(count) = count.parse::<usize>() else { return Ok(vec![named(count)?]) };
    let stream = Stream::new(1);
    let paper = Paper::default();
    let mut found = Vec::new();
    for tried in 0.. {
        let genome = paper.random(&mut stream.keyed(Purpose::Creation, 0, tried));
        let network = paper.express(&genome);
        if evaluated(&network, EDGES[0])?.is_some() {
            found.push((format!("random-{tried}"), network));
        }
        if found.len() == count {
            break;
        }
    }
    Ok(found)
}

fn named(path: &str) -> anyhow::Result<(String, Network)> {
    let draft: NetworkDraft = toml_file::read(Path::new(path))?;
    Ok((path.to_owned(), Network::try_from(draft)?))
}

/// The evaluation with this edge, and its CPU seconds; none where the design is rejected.
fn evaluated(network: &Network, edge: f64) -> anyhow::Result<Option<(Evaluation, f64)>> {
    let ninjaflex = Material::Ogden(Ogden::ninjaflex_c2s());
    let mut settings = CandidateSettings::new(ninjaflex, Backend::Native);
    settings.mesh.edge = edge;
    let candidate = evaluate_network(network, &settings)?;
    Ok(match candidate.outcome {
        Outcome::Evaluated(evaluation) => Some((evaluation, candidate.seconds.total())),
        Outcome::Rejected(_) => None,
    })
}

fn study(designs: &[(String, Network)], folder: &Path) -> anyhow::Result<()> {
    let mut table = csv::Writer::from_path(folder.join("evaluations.csv"))?;
    table.write_record(["design", "edge", "unknowns", "cpu_seconds", "F_c", "F_bf", "ending"])?;
    let mut all = Vec::new();
    for edge in [FINEST_EDGE].into_iter().chain(EDGES) {
        let mut row = Vec::new();
        for (name, network) in designs {
            let found = evaluated(network, edge)?;
            if let Some((evaluation, seconds)) = &found {
                let Evaluation { objectives, unknowns, endings, .. } = evaluation;
                let [bending, blocking] = ["bending", "blocking"].map(|name| objectives[name]);
                let numbers = [edge, *unknowns as f64, *seconds, bending, blocking];
                let mut record = vec![name.clone()];
                record.extend(numbers.map(|number| number.to_string()));
                record.push(endings["bending"].ending.name().to_owned());
                table.write_record(record)?;
            }
            row.push(found);
        }
        table.flush()?;
        all.push(row);
    }
    println!(
        "  edge  evaluated  unknowns  CPU s   error of F_c: median, 9 of 10   of F_bf: median, 9 of 10"
    );
    let names = ["F_c, median design", "F_bf, median design", "the worse of both, 9 of 10 designs"];
    let mut curves =
        names.map(|name| ErrorCurve { element: name.to_owned(), runs: Vec::new(), accepted: None });
    for (edge, row) in EDGES.iter().zip(&all[1..]) {
        let pairs: Vec<_> = row
            .iter()
            .zip(&all[0])
            .filter_map(|(one, finest)| Some((one.as_ref()?, &finest.as_ref()?.0)))
            .collect();
        let count = pairs.len() as f64;
        let cpu_seconds = pairs.iter().map(|((_, seconds), _)| seconds).sum::<f64>() / count;
        let unknowns = pairs.iter().map(|((one, _), _)| one.unknowns as f64).sum::<f64>() / count;
        let error = |name: &str| -> Vec<f64> {
            let of = |evaluation: &Evaluation| evaluation.objectives[name];
            pairs.iter().map(|((one, _), finest)| deviation(of(one), of(finest))).collect()
        };
        let (bending, blocking) = (error("bending"), error("blocking"));
        let worse = bending.iter().zip(&blocking).map(|(a, b)| a.max(*b)).collect();
        let [bending, blocking, worse] = [bending, blocking, worse].map(sorted);
        println!(
            "{edge:6} {:10} {unknowns:9.0} {cpu_seconds:6.2} {:22.2} {:9.2} {:15.2} {:9.2}",
            pairs.len(),
            share(&bending, 0.5),
            share(&bending, 0.9),
            share(&blocking, 0.5),
            share(&blocking, 0.9)
        );
        let errors = [share(&bending, 0.5), share(&blocking, 0.5), share(&worse, 0.9)];
        for (curve, error) in curves.iter_mut().zip(errors) {
            let unknowns = unknowns as usize;
            curve.runs.push(ErrorPoint { cpu_seconds, unknowns, error });
        }
    }
    let title =
        format!("{} designs, both scenarios: against edges of {FINEST_EDGE} mm", designs.len());
    let svg = error_svg(&title, &curves);
    fs::write(folder.join("search_mesh.svg"), &svg)?;
    fs::write(folder.join("search_mesh.png"), png(&svg, 2.0))?;
    Ok(())
}

/// How far `value` is from `exact`, %; none where there is nothing to compare, as the force of a part that never touches.
fn deviation(value: f64, exact: f64) -> f64 {
    if value == exact {
        0.0
    } else {
        100.0 * (value - exact).abs() / exact.abs().max(f64::MIN_POSITIVE)
    }
}

fn sorted(mut errors: Vec<f64>) -> Vec<f64> {
    errors.sort_by(f64::total_cmp);
    errors
}

/// The error that this share of the sorted `errors` does not exceed.
fn share(errors: &[f64], share: f64) -> f64 {
    let at = (share * errors.len() as f64).ceil() as usize;
    errors.get(at.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}
