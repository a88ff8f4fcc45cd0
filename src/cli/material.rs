//! `[material]` of a run or scene file: a preset, or a law with its numbers.

use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};

use crate::model::material::{Material, NeoHookean, Ogden, OgdenTerm, StVenantKirchhoff};

/// What a file says about the material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialSection {
    /// `ninjaflex-c2s` or `ninjaflex-yap2016`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    preset: Option<String>,
    /// `neo-hookean`, `ogden` or `st-venant-kirchhoff`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    law: Option<String>,
    /// Shear modulus of the neo-Hookean law, MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    mu: Option<f64>,
    /// Terms of the Ogden law in Abaqus' convention, MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    terms: Option<Vec<OgdenTerm>>,
    /// Of the Saint-Venant-Kirchhoff law, MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    young_modulus: Option<f64>,
    /// Of the Saint-Venant-Kirchhoff law.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    poisson_ratio: Option<f64>,
}

impl Default for MaterialSection {
    fn default() -> Self {
        Self {
            preset: Some("ninjaflex-c2s".to_owned()),
            law: None,
            mu: None,
            terms: None,
            young_modulus: None,
            poisson_ratio: None,
        }
    }
}

impl MaterialSection {
    pub(super) fn material(&self) -> anyhow::Result<Material> {
        let elastic = (self.young_modulus, self.poisson_ratio);
        match (self.preset.as_deref(), self.law.as_deref(), self.mu, &self.terms, elastic) {
            (Some("ninjaflex-c2s"), None, None, None, (None, None)) => {
                Ok(Material::Ogden(Ogden::ninjaflex_c2s()))
            }
            (Some("ninjaflex-yap2016"), None, None, None, (None, None)) => {
                Ok(Material::Ogden(Ogden::ninjaflex_yap2016()))
            }
            (Some(preset), None, None, None, (None, None)) => {
                bail!(
                    "[material] has no preset `{preset}`; it has ninjaflex-c2s and ninjaflex-yap2016"
                )
            }
            (None, Some("neo-hookean"), Some(mu), None, (None, None)) => {
                positive("[material] mu", mu)?;
                Ok(Material::NeoHookean(NeoHookean { mu }))
            }
            (None, Some("ogden"), None, Some(terms), (None, None)) => {
                if terms.is_empty() {
                    bail!(
                        "[material] terms is empty; an Ogden law has at least one {{ mu, alpha }}"
                    );
                }
                let is_exponent = |alpha: f64| alpha != 0.0 && alpha.abs() <= LARGEST_EXPONENT;
                if let Some(term) = terms.iter().find(|term| !is_exponent(term.alpha)) {
                    bail!(
                        "[material] terms: alpha is {:?}, but it must be a number other than 0 and at most {LARGEST_EXPONENT} in size",
                        term.alpha
                    );
                }
                let modulus: f64 = terms.iter().map(|term| term.mu).sum();
                positive("the sum of mu over the [material] terms", modulus)?;
                Ok(Material::Ogden(Ogden::new(terms)))
            }
            (
                None,
                Some("st-venant-kirchhoff"),
                None,
                None,
                (Some(young_modulus), Some(poisson_ratio)),
            ) => {
                // Textbook cases come in newtons and metres too.
                within("[material] young_modulus", young_modulus, 1e-9, 1e15)?;
                within("[material] poisson_ratio", poisson_ratio, -0.99, 0.5)?;
                let law = StVenantKirchhoff { young_modulus, poisson_ratio };
                Ok(Material::StVenantKirchhoff(law))
            }
            (None, Some(law), ..)
                if !["neo-hookean", "ogden", "st-venant-kirchhoff"].contains(&law) =>
            {
                bail!(
                    "[material] has no law `{law}`; it has neo-hookean (with mu), ogden (with terms) and st-venant-kirchhoff (with young_modulus and poisson_ratio)"
                )
            }
            _ => bail!(
                "[material] wants either `preset`, or `law = \"neo-hookean\"` with `mu`, or `law = \"ogden\"` with `terms`, or `law = \"st-venant-kirchhoff\"` with `young_modulus` and `poisson_ratio`"
            ),
        }
    }
}

/// Measured laws have exponents up to some 25; far beyond, the powers of the stretches overflow.
const LARGEST_EXPONENT: f64 = 100.0;

/// Checks that `value` is a positive number of a size that mm, N and MPa can have.
pub(super) fn positive(what: &str, value: f64) -> anyhow::Result<f64> {
    if value > 0.0 && value.is_finite() {
        return within(what, value, 1e-9, 1e9);
    }
    bail!("{what} is {value:?}, but it must be a positive number")
}

/// Checks that `value` lies from `least` to `most`.
pub(super) fn within(what: &str, value: f64, least: f64, most: f64) -> anyhow::Result<f64> {
    (least..=most).contains(&value).then_some(value).with_context(|| {
        format!("{what} is {value:?}, but it must lie between {least:?} and {most:?}")
    })
}
