//! From tables of tests to a folder with the law to use.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use serde::Serialize;

use super::fit::{Choice, fit_laws};
use super::law_fit::LawFit;
use super::material_file::{in_words, section};
use super::measured::{Measured, Point};
use super::test_table::read_tests;
use crate::io::{OutputFolder, atomic};
use crate::model::material::{KeyValue, Loading, Material};
use crate::report::{self, FittedCurve, FittedTest};

/// What is fitted, and to what.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// CSV files with tests of one rubber.
    pub files: &'a [PathBuf],
    /// The kind of test of a file that has no column for it.
    pub test: Option<Loading>,
    /// The largest stretch that counts, and by its inverse the least; all where there is none.
    pub up_to: Option<f64>,
}

/// The laws fitted to the tests of one rubber.
#[derive(Clone, Debug)]
pub struct Calibration {
    measured: Measured,
    choice: Choice,
    /// The names of the files.
    sources: String,
}

/// Fewer points than this fit no law.
const LEAST_POINTS: usize = 3;
/// Points of a drawn curve.
const DRAWN: usize = 100;

impl Calibration {
    /// Reads the tests and fits every law to them.
    ///
    /// # Errors
    /// When a file is refused, or there are too few points.
    pub fn new(request: &Request<'_>) -> anyhow::Result<Self> {
        let mut measured = Measured::default();
        for file in request.files {
            for (loading, points) in read_tests(file, request.test)?.tests() {
                points.iter().for_each(|point| measured.push(loading, *point));
            }
        }
        let names: Vec<String> =
            request.files.iter().map(|file| file.display().to_string()).collect();
        let sources = names.join(", ");
        if let Some(most) = request.up_to {
            measured = measured.up_to(most);
        }
        let points = measured.len();
        let within = request.up_to.map_or_else(String::new, |most| format!(" up to {most}"));
        ensure!(
            points >= LEAST_POINTS,
            "{sources}: {points} points{within}; even a law of one number wants {LEAST_POINTS}"
        );
        let is_loaded = |(_, points): (Loading, &[Point])| {
            points.iter().any(|at| at.nominal != 0.0 && at.stretch != 1.0)
        };
        ensure!(
            measured.tests().all(is_loaded),
            "{sources}: a test in which nothing is stretched under a stress says nothing of a law"
        );
        let choice = fit_laws(&measured)
            .with_context(|| format!("{sources}: no law could be fitted that is stable"))?;
        Ok(Self { measured, choice, sources })
    }

    /// The fits.
    #[must_use]
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// The table of the laws, what was chosen and why, and its section.
    #[must_use]
    pub fn in_words(&self) -> String {
        let [least, greatest] = self.measured.stretches();
        let kinds: Vec<String> = self
            .measured
            .tests()
            .map(|(loading, points)| format!("{} {} points", points.len(), loading.name()))
            .collect();
        let mut text = format!(
            "{}; stretches from {least:.3} to {greatest:.3}, stresses up to {:.4} MPa\n\n",
            kinds.join(", "),
            self.measured.largest_stress(),
        );
        text += "                  RMS error            of points\n";
        text += "law               MPa         %        left out, %   stable between    numbers (MPa)\n";
        for (place, fit) in self.choice.fits.iter().enumerate() {
            let mark = if place == self.choice.best { '*' } else { ' ' };
            let held = if fit.is_held { "; held by stability" } else { "" };
            let [least, greatest] = fit.stable;
            text += &format!(
                "{:<16}{mark} {:<11.4e} {:<8.2} {:<13.2} {:<17} {}{held}\n",
                fit.name,
                fit.rms,
                100.0 * fit.relative,
                100.0 * fit.left_out,
                format!("{least:.2} and {greatest:.2}"),
                in_words(&fit.law),
            );
        }
        for (name, reason) in &self.choice.dropped {
            text += &format!("{name:<16}  not fitted: {reason}\n");
        }
        text += "\n% of the largest stress of each test, the mean of the tests. * has the fewest numbers of those that predict points\nleft out of the fit, a fifth of each test in a row, at most a tenth worse than the best.\n";
        if self.choice.is_of_one_test {
            text += "Of one kind of test the choice is among laws of the first invariant (neo-hookean, yeoh), which carry over to the others.\n";
        }
        if self.choice.best().is_held {
            text += "Without the condition of stability (Drucker) it would come nearer to the data, and be unstable.\n";
        }
        text + "\n" + &section(&self.choice.best().law)
    }

    /// The fits for a program.
    #[must_use]
    pub fn in_json(&self) -> CalibrationRecord<'_> {
        let best = self.choice.best();
        CalibrationRecord {
            points: self.measured.len(),
            stretches: self.measured.stretches(),
            largest_stress_mpa: self.measured.largest_stress(),
            best: best.name,
            laws: self.choice.fits.iter().map(record).collect(),
        }
    }

    /// Writes `material.toml` with the law to use, `laws.json` with all of them, and `fit.svg`, `.png` and `.pdf` into the new folder
    /// `out`, whose files it returns.
    ///
    /// # Errors
    /// When the folder exists or cannot be written.
    pub fn write(&self, out: &Path) -> anyhow::Result<Vec<PathBuf>> {
        let folder = OutputFolder::create_new(out)?;
        let best = self.choice.best();
        let [least, greatest] = self.measured.stretches();
        let material = format!(
            "# {} fitted to {}: stretches from {least:.3} to {greatest:.3}, error {:.2} % of the largest stress,\n# {:.2} % in points left out; stable between stretches of {:.2} and {:.2}.\n{}",
            best.name,
            self.sources.replace(char::is_control, " "),
            100.0 * best.relative,
            100.0 * best.left_out,
            best.stable[0],
            best.stable[1],
            section(&best.law),
        );
        let svg = report::fitted_svg(&self.curves());
        let files = [
            ("material.toml", material.into_bytes()),
            ("laws.json", serde_json::to_vec_pretty(&self.in_json())?),
            ("fit.png", report::png(&svg, 2.0)),
            ("fit.pdf", report::pdf(&svg)),
            ("fit.svg", svg.into_bytes()),
        ];
        files
            .into_iter()
            .map(|(name, bytes)| {
                let path = folder.file(name);
                atomic::write(&path, &bytes)?;
                Ok(path)
            })
            .collect()
    }

    /// Points and curves of each test.
    fn curves(&self) -> Vec<FittedTest> {
        let of = |(loading, points): (Loading, &[Point])| {
            let stretches = points.iter().map(|at| at.stretch);
            let (least, greatest) =
                (stretches.clone().fold(1.0, f64::min), stretches.fold(1.0, f64::max));
            let at = |k: usize| least + (greatest - least) * k as f64 / DRAWN as f64;
            let curve = |(place, fit): (usize, &LawFit)| FittedCurve {
                name: fit.name,
                is_chosen: place == self.choice.best,
                points: (0..=DRAWN)
                    .map(|k| [at(k), fit.law.nominal_stress(loading, at(k))])
                    .collect(),
            };
            FittedTest {
                name: loading.name(),
                measured: points.iter().map(|at| [at.stretch, at.nominal]).collect(),
                curves: self.choice.fits.iter().enumerate().map(curve).collect(),
            }
        };
        self.measured.tests().map(of).collect()
    }
}

fn record(fit: &LawFit) -> LawRecord {
    LawRecord {
        form: fit.name,
        law: fit.law.name(),
        numbers: fit.law.values().into_iter().collect(),
        shear_modulus_mpa: Material::from(fit.law.clone()).shear_modulus(),
        rms_mpa: fit.rms,
        relative: fit.relative,
        left_out: fit.left_out.is_finite().then_some(fit.left_out),
        stable: fit.stable,
        held_by_stability: fit.is_held,
    }
}

/// The fits as `laws.json` has them.
#[derive(Clone, Debug, Serialize)]
pub struct CalibrationRecord<'a> {
    /// How many points there are.
    points: usize,
    /// The least and the greatest stretch.
    stretches: [f64; 2],
    largest_stress_mpa: f64,
    /// The form to use.
    best: &'a str,
    laws: Vec<LawRecord>,
}

/// One fit.
#[derive(Clone, Debug, Serialize)]
struct LawRecord {
    form: &'static str,
    law: &'static str,
    numbers: std::collections::BTreeMap<&'static str, KeyValue>,
    shear_modulus_mpa: f64,
    rms_mpa: f64,
    /// Of the largest stress of each test.
    relative: f64,
    /// The same of blocks that were left out; none where some law of those has no answer.
    left_out: Option<f64>,
    stable: [f64; 2],
    held_by_stability: bool,
}
