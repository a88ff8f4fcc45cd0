//! `[material]` of a run or scene file: a preset, or a law with its numbers.

use anyhow::{Context, bail, ensure};
use serde::{Deserialize, Serialize};

use crate::model::material::{
    Compressible, Loading, Material, MooneyRivlin, NeoHookean, Ogden, OgdenTerm, Rubber,
    StVenantKirchhoff, Yeoh,
};

/// What a file says about the material: a preset alone, or a law with its own keys.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialSection {
    /// One of [`PRESETS`].
    preset: Option<String>,
    /// One of [`LAWS`].
    law: Option<String>,
    /// Shear modulus of the neo-Hookean law, MPa.
    mu: Option<f64>,
    /// Young's modulus at rest, MPa.
    young_modulus: Option<f64>,
    /// Poisson's ratio at rest.
    poisson_ratio: Option<f64>,
    /// Coefficients of the Mooney-Rivlin law, MPa.
    c1: Option<f64>,
    c2: Option<f64>,
    /// Coefficients of the Yeoh law, MPa.
    c: Option<[f64; 3]>,
    /// Terms of the Ogden law in Abaqus' convention, MPa.
    terms: Option<Vec<OgdenTerm>>,
    /// Bulk modulus of a rubber, MPa; a wall without it is incompressible.
    bulk_modulus: Option<f64>,
}

const PRESETS: &str = "ninjaflex-c2s, ninjaflex-c2s-compressible and ninjaflex-yap2016";

/// The laws, and what each wants.
const LAWS: [(&str, &str); 5] = [
    (
        "neo-hookean",
        "`mu`, with `bulk_modulus` if it is compressible, or `young_modulus` and `poisson_ratio`",
    ),
    ("mooney-rivlin", "`c1` and `c2`, with `bulk_modulus` if it is compressible"),
    ("yeoh", "`c = [c1, c2, c3]`, with `bulk_modulus` if it is compressible"),
    ("ogden", "`terms = [{ mu, alpha }]`, with `bulk_modulus` if it is compressible"),
    ("st-venant-kirchhoff", "`young_modulus` and `poisson_ratio`"),
];

impl Default for MaterialSection {
    fn default() -> Self {
        Self {
            preset: Some("ninjaflex-c2s".to_owned()),
            law: None,
            mu: None,
            young_modulus: None,
            poisson_ratio: None,
            c1: None,
            c2: None,
            c: None,
            terms: None,
            bulk_modulus: None,
        }
    }
}

impl MaterialSection {
    pub(super) fn material(&self) -> anyhow::Result<Material> {
        match (&self.preset, &self.law) {
            (Some(preset), None) => self.of_preset(preset),
            (None, Some(law)) => self.of_law(law),
            (Some(_), Some(_)) => bail!("[material] has both `preset` and `law`; give one"),
            (None, None) => bail!("[material] has neither `preset` nor `law`; give one"),
        }
    }

    /// The preset, or the law.
    pub(super) fn name(&self) -> &str {
        self.preset.as_deref().or(self.law.as_deref()).unwrap_or_default()
    }

    fn of_preset(&self, preset: &str) -> anyhow::Result<Material> {
        if let Some(key) = self.given_numbers().next() {
            bail!(
                "[material] takes no `{key}` beside `preset`; numbers of your own go with a `law`"
            );
        }
        match preset {
            "ninjaflex-c2s" => Ok(Material::Ogden(Ogden::ninjaflex_c2s())),
            "ninjaflex-c2s-compressible" => {
                Ok(Material::Compressible(Compressible::ninjaflex_c2s()))
            }
            "ninjaflex-yap2016" => Ok(Material::Ogden(Ogden::ninjaflex_yap2016())),
            _ => bail!("[material] has no preset `{preset}`; it has {PRESETS}"),
        }
    }

    fn of_law(&self, law: &str) -> anyhow::Result<Material> {
        match law {
            "neo-hookean" if self.mu.is_none() && self.young_modulus.is_some() => {
                self.neo_hookean_of_young_modulus()
            }
            "neo-hookean" => {
                self.check_keys(law, &["mu", "bulk_modulus"])?;
                let mu = positive("[material] mu", wanted(law, "mu", self.mu)?)?;
                self.of_rubber(Rubber::NeoHookean(NeoHookean { mu }))
            }
            "mooney-rivlin" => {
                self.check_keys(law, &["c1", "c2", "bulk_modulus"])?;
                let c1 = coefficient("[material] c1", wanted(law, "c1", self.c1)?)?;
                let c2 = coefficient("[material] c2", wanted(law, "c2", self.c2)?)?;
                positive("the shear modulus 2 (c1 + c2) of [material]", 2.0 * (c1 + c2))?;
                self.of_rubber(Rubber::MooneyRivlin(MooneyRivlin { c1, c2 }))
            }
            "yeoh" => {
                self.check_keys(law, &["c", "bulk_modulus"])?;
                let c = wanted(law, "c", self.c)?;
                positive("the first of [material] c", c[0])?;
                coefficient("the second of [material] c", c[1])?;
                coefficient("the third of [material] c", c[2])?;
                self.of_rubber(Rubber::Yeoh(Yeoh { c }))
            }
            "ogden" => {
                self.check_keys(law, &["terms", "bulk_modulus"])?;
                let terms = wanted(law, "terms", self.terms.as_deref())?;
                self.of_rubber(Rubber::Ogden(ogden(terms)?))
            }
            "st-venant-kirchhoff" => {
                let young_modulus = self.young_modulus(law)?;
                let poisson_ratio = wanted(law, "poisson_ratio", self.poisson_ratio)?;
                within("[material] poisson_ratio", poisson_ratio, -0.99, 0.5)?;
                let law = StVenantKirchhoff { young_modulus, poisson_ratio };
                Ok(Material::StVenantKirchhoff(law))
            }
            _ => {
                let names = LAWS.map(|(name, _)| name).join(", ");
                bail!("[material] has no law `{law}`; it has {names}")
            }
        }
    }

    fn neo_hookean_of_young_modulus(&self) -> anyhow::Result<Material> {
        let law = "neo-hookean";
        let young_modulus = self.young_modulus(law)?;
        let poisson_ratio = wanted(law, "poisson_ratio", self.poisson_ratio)?;
        within("[material] poisson_ratio", poisson_ratio, 0.0, 0.5)?;
        let law =
            Rubber::NeoHookean(NeoHookean { mu: 0.5 * young_modulus / (1.0 + poisson_ratio) });
        if poisson_ratio == 0.5 {
            return Ok(law.into());
        }
        let bulk_modulus = young_modulus / (3.0 * (1.0 - 2.0 * poisson_ratio));
        Ok(Material::Compressible(Compressible { law, bulk_modulus }))
    }

    fn young_modulus(&self, law: &str) -> anyhow::Result<f64> {
        self.check_keys(law, &["young_modulus", "poisson_ratio"])?;
        positive("[material] young_modulus", wanted(law, "young_modulus", self.young_modulus)?)
    }

    fn of_rubber(&self, law: Rubber) -> anyhow::Result<Material> {
        let Some(bulk_modulus) = self.bulk_modulus else {
            return Ok(law.into());
        };
        positive("[material] bulk_modulus", bulk_modulus)?;
        let mu = Material::from(law.clone()).shear_modulus();
        ensure!(
            bulk_modulus >= SOFTEST_VOLUME * mu,
            "[material] bulk_modulus is {bulk_modulus:?}, but it must be at least {:.3}, {SOFTEST_VOLUME} of the shear modulus; leave it out for an incompressible wall",
            SOFTEST_VOLUME * mu
        );
        Ok(Material::Compressible(Compressible { law, bulk_modulus }))
    }

    /// Checks that of the numbers only those named by `keys` are given.
    fn check_keys(&self, law: &str, keys: &[&str]) -> anyhow::Result<()> {
        let surplus = self.given_numbers().find(|key| !keys.contains(key));
        surplus.map_or(Ok(()), |key| {
            bail!("[material] {law} takes no `{key}` here; it wants {}", wishes(law))
        })
    }

    /// The keys that are given, besides `preset` and `law`.
    fn given_numbers(&self) -> impl Iterator<Item = &'static str> {
        [
            ("mu", self.mu.is_some()),
            ("young_modulus", self.young_modulus.is_some()),
            ("poisson_ratio", self.poisson_ratio.is_some()),
            ("c1", self.c1.is_some()),
            ("c2", self.c2.is_some()),
            ("c", self.c.is_some()),
            ("terms", self.terms.is_some()),
            ("bulk_modulus", self.bulk_modulus.is_some()),
        ]
        .into_iter()
        .filter_map(|(key, is_given)| is_given.then_some(key))
    }
}

/// The value of `key`, which this law cannot do without.
fn wanted<T>(law: &str, key: &str, value: Option<T>) -> anyhow::Result<T> {
    value.with_context(|| format!("[material] {law} has no `{key}`; it wants {}", wishes(law)))
}

fn wishes(law: &str) -> &'static str {
    LAWS.iter().find(|(name, _)| *name == law).map_or("", |(_, wishes)| wishes)
}

fn ogden(terms: &[OgdenTerm]) -> anyhow::Result<Ogden> {
    ensure!(
        !terms.is_empty(),
        "[material] terms is empty; an Ogden law has at least one {{ mu, alpha }}"
    );
    let is_exponent = |alpha: f64| alpha != 0.0 && alpha.abs() <= LARGEST_EXPONENT;
    if let Some(term) = terms.iter().find(|term| !is_exponent(term.alpha)) {
        bail!(
            "[material] terms: alpha is {:?}, but it must be a number other than 0 and at most {LARGEST_EXPONENT} in size",
            term.alpha
        );
    }
    let modulus: f64 = terms.iter().map(|term| term.mu).sum();
    positive("the sum of mu over the [material] terms", modulus)?;
    Ok(Ogden::new(terms))
}

/// Bulk over shear modulus, a Poisson's ratio of -0.29: the softest volume for which the laws are tested.
const SOFTEST_VOLUME: f64 = 0.3;
/// Measured laws have exponents up to some 25; far beyond, the powers of the stretches overflow.
const LARGEST_EXPONENT: f64 = 100.0;

/// Where a rubber gives way within everyday stretches, a line that says so.
pub(super) fn instability(material: &Material) -> Option<String> {
    const EVERYDAY: [f64; 2] = [0.5, 2.0];
    let loadings = [Loading::Uniaxial, Loading::Equibiaxial, Loading::Planar];
    let is_rubber = !matches!(material, Material::StVenantKirchhoff(_));
    let [least, most] = loadings.iter().filter(|_| is_rubber).fold(EVERYDAY, |range, &loading| {
        let [least, most] = material.stable_stretches(loading);
        [range[0].max(least), range[1].min(most)]
    });
    // A law that is unstable at rest fails by itself, and says so.
    ([least, most] != EVERYDAY && least < most).then(|| {
        format!(
            "[material] is stable between stretches of {least:.2} and {most:.2} only (Drucker); beyond, its answers are no material's"
        )
    })
}

/// Checks that `value` is a positive number of a size that mm, N and MPa can have.
pub(super) fn positive(what: &str, value: f64) -> anyhow::Result<f64> {
    if value > 0.0 && value.is_finite() {
        return within(what, value, 1e-9, 1e12);
    }
    bail!("{what} is {value:?}, but it must be a positive number")
}

/// Checks that `value`, of either sign, has a size that MPa can have.
fn coefficient(what: &str, value: f64) -> anyhow::Result<f64> {
    within(what, value, -1e12, 1e12)
}

/// Checks that `value` lies from `least` to `most`.
pub(super) fn within(what: &str, value: f64, least: f64, most: f64) -> anyhow::Result<f64> {
    (least..=most).contains(&value).then_some(value).with_context(|| {
        format!("{what} is {value:?}, but it must lie between {least:?} and {most:?}")
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::io::toml_file;

    fn section(text: &str) -> MaterialSection {
        toml_file::parse(text, Path::new("run.toml")).unwrap()
    }

    #[test]
    fn every_law_is_read() {
        let neo_hookean = Rubber::NeoHookean(NeoHookean { mu: 1.5 });
        let mooney_rivlin = Rubber::MooneyRivlin(MooneyRivlin { c1: 0.5, c2: 0.25 });
        let yeoh = Rubber::Yeoh(Yeoh { c: [1.0, -0.5, 0.25] });
        let ogden = Rubber::Ogden(Ogden::new(&[OgdenTerm { mu: 2.0, alpha: -3.0 }]));
        for (text, law) in [
            ("law = 'neo-hookean'\nmu = 1.5\n", neo_hookean),
            ("law = 'mooney-rivlin'\nc1 = 0.5\nc2 = 0.25\n", mooney_rivlin),
            ("law = 'yeoh'\nc = [1, -0.5, 0.25]\n", yeoh),
            ("law = 'ogden'\nterms = [{ mu = 2, alpha = -3 }]\n", ogden),
        ] {
            assert_eq!(section(text).material().unwrap(), law.clone().into());
            let text = format!("{text}bulk_modulus = 20\n");
            let compressible = Compressible { law, bulk_modulus: 20.0 };
            assert_eq!(section(&text).material().unwrap(), Material::Compressible(compressible));
        }
        let plate = StVenantKirchhoff { young_modulus: 3.0, poisson_ratio: -0.25 };
        let text = "law = 'st-venant-kirchhoff'\nyoung_modulus = 3\npoisson_ratio = -0.25\n";
        assert_eq!(section(text).material().unwrap(), Material::StVenantKirchhoff(plate));
    }

    /// `mu = E / 2.5` and `kappa = E / 1.5` at a Poisson's ratio of a quarter; `mu = E / 3` at a half.
    #[test]
    fn neo_hookean_is_read_by_its_moduli_at_rest() {
        let of_ratio = |poisson_ratio: f64| {
            let text = format!(
                "law = 'neo-hookean'\nyoung_modulus = 3\npoisson_ratio = {poisson_ratio:?}\n"
            );
            section(&text).material().unwrap()
        };
        let law = Rubber::NeoHookean(NeoHookean { mu: 1.2 });
        assert_eq!(of_ratio(0.25), Material::Compressible(Compressible { law, bulk_modulus: 2.0 }));
        assert_eq!(of_ratio(0.5), Material::NeoHookean(NeoHookean { mu: 1.0 }));
        let nearly = of_ratio(0.499_999);
        assert!((nearly.young_modulus() - 3.0).abs() < 1e-12, "{nearly:?}");
        assert!((nearly.poisson_ratio() - 0.499_999).abs() < 1e-12, "{nearly:?}");
    }

    #[test]
    fn every_preset_is_read_and_written() {
        for (preset, shear, ratio) in [
            ("ninjaflex-c2s", 5.211_656, 0.5),
            ("ninjaflex-c2s-compressible", 5.211_656, 0.380_121),
            ("ninjaflex-yap2016", 6.212, 0.5),
        ] {
            let section = section(&format!("preset = '{preset}'\n"));
            let material = section.material().unwrap();
            assert!((material.shear_modulus() - shear).abs() < 1e-6, "{preset}");
            assert!((material.poisson_ratio() - ratio).abs() < 1e-6, "{preset}");
            assert_eq!(toml::to_string(&section).unwrap(), format!("preset = \"{preset}\"\n"));
        }
    }

    /// A second term of the other sign and a larger exponent wins at a stretch that tension alone reaches.
    #[test]
    fn laws_that_give_way_are_told() {
        let unstable =
            Ogden::new(&[OgdenTerm { mu: 2.0, alpha: 2.0 }, OgdenTerm { mu: -0.2, alpha: 6.0 }]);
        assert!(
            instability(&Material::Ogden(unstable)).is_some_and(|line| line.contains("stretches"))
        );
        assert_eq!(instability(&Material::Ogden(Ogden::ninjaflex_c2s())), None);
        assert_eq!(instability(&Material::Ogden(Ogden::ninjaflex_yap2016())), None);
    }
}
