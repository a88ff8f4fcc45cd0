//! Materials that a file names instead of a law: one table, from which files are read, messages and manuals are made.
//!
//! Numbers that no paper gives were fitted by `pneumorph material fit` to measurements that one publishes; the points are in
//! `data/materials`, and tests compare the two.

use serde::Serialize;

use crate::model::material::{Compressible, Loading, Material, Ogden, Rubber};

/// A material with its numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Preset {
    /// Its name in files.
    pub name: &'static str,
    /// What it is.
    pub product: &'static str,
    /// The law, made anew.
    pub material: fn() -> Material,
    /// The test behind the numbers, and the stretches that it covers; none where the source says neither.
    pub test: Option<(Loading, [f64; 2])>,
    /// Where the numbers come from.
    pub source: &'static str,
}

/// Every preset, in the order in which messages list them.
pub(crate) const PRESETS: &[Preset] = &[
    Preset {
        name: "ninjaflex-c2s",
        product: "NinjaFlex, printed",
        material: || Material::Ogden(Ogden::ninjaflex_c2s()),
        test: None,
        source: "the public Abaqus decks of Smith et al. (2022), RoboSoft, taken as incompressible",
    },
    Preset {
        name: "ninjaflex-c2s-compressible",
        product: "NinjaFlex, printed",
        material: || Material::Compressible(Compressible::ninjaflex_c2s()),
        test: None,
        source: "the same with its bulk modulus of 20 MPa",
    },
    Preset {
        name: "ninjaflex-yap2016",
        product: "NinjaFlex, printed",
        material: || Material::Ogden(Ogden::ninjaflex_yap2016()),
        test: None,
        source: "Yap et al. (2016)",
    },
];

/// The preset of this name.
pub(crate) fn named(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// The names of all, as a sentence lists them.
pub(crate) fn names() -> String {
    let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
    let (last, others) = names.split_last().expect("there are presets");
    format!("{} and {last}", others.join(", "))
}

impl Preset {
    /// Test and stretches in words.
    pub(crate) fn range(&self) -> String {
        let Some((loading, [least, most])) = self.test else {
            return "test and stretches not stated".to_owned();
        };
        format!("{}, stretches of {least} to {most}", loading.name())
    }

    /// Law and modulus at rest in words.
    fn law(&self) -> String {
        let material = (self.material)();
        let (law, bulk_modulus) = material.rubber().expect("presets are rubbers");
        let compressible = if bulk_modulus.is_some() { "compressible " } else { "" };
        format!("{compressible}{}, shear modulus {:.3} MPa", law.name(), material.shear_modulus())
    }
}

/// A line for each preset, and one for its source.
pub(crate) fn in_words() -> String {
    let line = |preset: &Preset| {
        let Preset { name, product, source, .. } = preset;
        let (law, range) = (preset.law(), preset.range());
        format!("{name:<27} {product}: {law}; {range}\n{:27} {source}\n", "")
    };
    PRESETS.iter().map(line).collect()
}

/// The presets for a program.
pub(crate) fn records() -> Vec<PresetRecord> {
    let record = |preset: &Preset| {
        let material = (preset.material)();
        let (law, bulk_modulus): (Rubber, Option<f64>) =
            material.rubber().expect("presets are rubbers");
        PresetRecord {
            name: preset.name,
            product: preset.product,
            law: law.name(),
            shear_modulus_mpa: material.shear_modulus(),
            bulk_modulus_mpa: bulk_modulus,
            test: preset.test.map(|(loading, _)| loading.name()),
            stretches: preset.test.map(|(_, stretches)| stretches),
            source: preset.source,
        }
    };
    PRESETS.iter().map(record).collect()
}

/// A preset as `--json` has it.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PresetRecord {
    name: &'static str,
    product: &'static str,
    law: &'static str,
    shear_modulus_mpa: f64,
    bulk_modulus_mpa: Option<f64>,
    test: Option<&'static str>,
    stretches: Option<[f64; 2]>,
    source: &'static str,
}
