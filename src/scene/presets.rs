//! Materials that a file names instead of a law: one table, from which files are read, messages and manuals are made.
//!
//! Numbers that no paper gives were fitted by `pneumorph material fit` to measurements that one publishes; the points are in
//! `data/materials`, and tests compare the two. All were under tension alone: the silicones have one term of Ogden's with an exponent
//! between 2 and 3.2, stable at all stretches; the thermoplastics, which soften first, Yeoh's law. How stiff they are when stretched in two
//! directions is what these laws make of it.

use serde::Serialize;

use crate::model::material::{Compressible, Loading, Material, Ogden, OgdenTerm, Rubber, Yeoh};

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
    /// The principal stretch that a part of it is taken to bear where a file says none; none where no assumption is made.
    pub borne_stretch: Option<f64>,
    /// Where the numbers come from.
    pub source: &'static str,
}

/// An assumption: well below the strain of 65 % at which NinjaFlex yields by its maker's data sheet (NinjaTek), for what seams and
/// layers of a print cost and for many cycles. Breaking takes ten times as much.
const PRINTED_TPU_STRETCH: f64 = 1.5;

/// Every preset, in the order in which messages list them.
pub(crate) const PRESETS: &[Preset] = &[
    Preset {
        name: "ninjaflex-c2s",
        product: "NinjaFlex, printed",
        material: || Material::Ogden(Ogden::ninjaflex_c2s()),
        test: None,
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "the public Abaqus decks of Smith et al. (2022), RoboSoft, taken as incompressible",
    },
    Preset {
        name: "ninjaflex-c2s-compressible",
        product: "NinjaFlex, printed",
        material: || Material::Compressible(Compressible::ninjaflex_c2s()),
        test: None,
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "the same with its bulk modulus of 20 MPa",
    },
    Preset {
        name: "ninjaflex-yap2016",
        product: "NinjaFlex, printed",
        material: || Material::Ogden(Ogden::ninjaflex_yap2016()),
        test: None,
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "Yap et al. (2016)",
    },
    Preset {
        name: "ecoflex-00-30",
        product: "Ecoflex 00-30, cast silicone",
        material: || ogden(0.014_911_91, 2.287_305),
        test: Some((Loading::Uniaxial, [1.0, 3.0])),
        borne_stretch: None,
        source: "one-term fit to the tension test of Marechal et al. (2021), Soft Robotics 8:284; it misses 0.8 % of the largest stress",
    },
    Preset {
        name: "ecoflex-00-50",
        product: "Ecoflex 00-50, cast silicone",
        material: || ogden(0.019_971_34, 2.451_570),
        test: Some((Loading::Uniaxial, [1.0, 3.0])),
        borne_stretch: None,
        source: "one-term fit to the tension test of Marechal et al. (2021), Soft Robotics 8:284; it misses 0.3 % of the largest stress",
    },
    Preset {
        name: "dragon-skin-10",
        product: "Dragon Skin 10 Medium, cast silicone",
        material: || ogden(0.042_566_85, 3.114_355),
        test: Some((Loading::Uniaxial, [1.0, 3.0])),
        borne_stretch: None,
        source: "one-term fit to the tension test of Marechal et al. (2021), Soft Robotics 8:284; it misses 0.9 % of the largest stress",
    },
    Preset {
        name: "dragon-skin-20",
        product: "Dragon Skin 20, cast silicone",
        material: || ogden(0.123_620_1, 2.987_983),
        test: Some((Loading::Uniaxial, [1.0, 3.0])),
        borne_stretch: None,
        source: "one-term fit to the tension test of Marechal et al. (2021), Soft Robotics 8:284; it misses 0.9 % of the largest stress",
    },
    Preset {
        name: "dragon-skin-30",
        product: "Dragon Skin 30, cast silicone",
        material: || ogden(0.178_802_3, 2.877_507),
        test: Some((Loading::Uniaxial, [1.0, 3.0])),
        borne_stretch: None,
        source: "one-term fit to the tension test of Marechal et al. (2021), Soft Robotics 8:284; it misses 0.6 % of the largest stress",
    },
    Preset {
        name: "ninjaflex",
        product: "NinjaTek NinjaFlex, printed",
        material: || yeoh([2.429_797, -0.232_837_3, 0.018_371_67]),
        test: Some((Loading::Uniaxial, [1.0, 2.565])),
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "Yeoh fit to the tension tests of the MacCurdy Lab (2023), 3D Print. Addit. Manuf., doi:10.1089/3dp.2023.0010; it misses 1.5 % of the largest stress",
    },
    Preset {
        name: "cheetah",
        product: "NinjaTek Cheetah, printed",
        material: || yeoh([6.026_2, -0.696_64, 0.052_45]),
        test: Some((Loading::Uniaxial, [1.0, 2.719])),
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "Yeoh fit to the tension tests of the MacCurdy Lab (2023), 3D Print. Addit. Manuf., doi:10.1089/3dp.2023.0010; it misses 4.6 % of the largest stress",
    },
    Preset {
        name: "filaflex-60a",
        product: "Recreus FilaFlex 60A, printed",
        material: || yeoh([0.970_039, -0.067_873_05, 0.004_779_972]),
        test: Some((Loading::Uniaxial, [1.0, 2.565])),
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "Yeoh fit to the tension tests of the MacCurdy Lab (2023), 3D Print. Addit. Manuf., doi:10.1089/3dp.2023.0010; it misses 0.8 % of the largest stress",
    },
    Preset {
        name: "filaflex-70a",
        product: "Recreus FilaFlex 70A, printed",
        material: || yeoh([1.380_531, -0.105_532_2, 0.007_296_909]),
        test: Some((Loading::Uniaxial, [1.0, 2.565])),
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "Yeoh fit to the tension tests of the MacCurdy Lab (2023), 3D Print. Addit. Manuf., doi:10.1089/3dp.2023.0010; it misses 0.8 % of the largest stress",
    },
    Preset {
        name: "tpu-95a",
        product: "Overture TPU 95A, printed",
        material: || yeoh([4.481_0, -0.545_35, 0.046_692]),
        test: Some((Loading::Uniaxial, [1.0, 2.565])),
        borne_stretch: Some(PRINTED_TPU_STRETCH),
        source: "Yeoh fit to the tension tests of the MacCurdy Lab (2023), 3D Print. Addit. Manuf., doi:10.1089/3dp.2023.0010; it misses 3.2 % of the largest stress",
    },
];

fn ogden(mu: f64, alpha: f64) -> Material {
    Material::Ogden(Ogden::new(&[OgdenTerm { mu, alpha }]))
}

fn yeoh(c: [f64; 3]) -> Material {
    Material::Yeoh(Yeoh { c })
}

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

    /// A line that says how far a stretch is beyond the tests behind the numbers, where it is; `largest` is asked only where they are known.
    pub(crate) fn passed_by(&self, largest: impl FnOnce() -> f64) -> Option<String> {
        let (loading, [_, most]) = self.test?;
        let stretch = largest();
        (stretch > most).then(|| {
            format!(
                "[material] {} is stretched to {stretch:.2}, but its numbers come from {} tests up to {most}; what it does beyond them is a guess",
                self.name,
                loading.name()
            )
        })
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
            borne_stretch: preset.borne_stretch,
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
    borne_stretch: Option<f64>,
    source: &'static str,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within the stretches of its test each is stable, in the other tests too.
    #[test]
    fn presets_are_stable_where_they_were_measured() {
        for preset in PRESETS {
            let (law, _) = (preset.material)().rubber().unwrap();
            let [least, most] =
                preset.test.map_or([0.5, 2.0], |(_, [least, most])| [least.min(0.5), most]);
            assert_eq!(law.stable_stretches([least, most]), [least, most], "{}", preset.name);
        }
    }

    #[test]
    fn a_stretch_beyond_the_tests_is_told() {
        let cheetah = named("cheetah").unwrap();
        assert_eq!(cheetah.passed_by(|| 2.7), None);
        assert!(cheetah.passed_by(|| 3.25).is_some_and(|line| line.contains("stretched to 3.25")));
        assert_eq!(named("ninjaflex-c2s").unwrap().passed_by(|| 9.0), None);
    }

    #[test]
    fn names_are_words_of_their_own() {
        for (place, preset) in PRESETS.iter().enumerate() {
            assert!(PRESETS[..place].iter().all(|other| other.name != preset.name));
            assert_eq!(named(preset.name).map(|found| found.source), Some(preset.source));
            assert!(names().contains(preset.name) && in_words().contains(preset.product));
        }
    }
}
