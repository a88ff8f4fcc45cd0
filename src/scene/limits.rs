//! `[limits]`: what a material may bear.

use anyhow::ensure;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::material::{MaterialSection, positive, within};
use crate::model::MaterialLimits;

/// What the material may bear, at the faces of the wall (of a solid: anywhere in it); a path that reaches it ends there. Without a key it is what a preset of printed thermoplastic polyurethane is taken to bear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct LimitsSection {
    /// Largest principal stretch, more than 1; presets of printed thermoplastic polyurethane are taken to bear 1.5, an assumption: their data sheet lets NinjaFlex yield at 1.65, in threads without seams.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<f64>,
    /// Largest principal nominal (first Piola) stress, MPa: force over area at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nominal_stress: Option<f64>,
}

impl LimitsSection {
    /// What it means for the `material` of a wall that is said to balloon at `stretch_bound`; messages begin with `section`.
    ///
    /// # Errors
    /// When it says nothing, or its numbers are no limits.
    pub(crate) fn limits(
        &self,
        section: &str,
        material: &MaterialSection,
        stretch_bound: f64,
    ) -> anyhow::Result<MaterialLimits> {
        let &Self { stretch, nominal_stress } = self;
        let is_empty = stretch.is_none() && nominal_stress.is_none();
        let stretch = stretch.or_else(|| material.assumed_stretch().filter(|_| is_empty));
        ensure!(
            stretch.is_some() || nominal_stress.is_some(),
            "{section} wants a `stretch` or a `nominal_stress`; only presets of printed thermoplastic polyurethane have a limit of their own"
        );
        if let Some(stretch) = stretch {
            within(&format!("{section} stretch"), stretch, LEAST_STRETCH, MOST_STRETCH)?;
            ensure!(
                stretch <= stretch_bound,
                "{section} stretch is {stretch:?}, but a path ends as ballooning at [load] stretch_bound = {stretch_bound:?}; raise that, or lower the limit"
            );
        }
        if let Some(stress) = nominal_stress {
            positive(&format!("{section} nominal_stress"), stress)?;
        }
        Ok(MaterialLimits { stretch, nominal_stress })
    }
}

/// A stretch of less is one of rounding and meshes.
const LEAST_STRETCH: f64 = 1.001;
const MOST_STRETCH: f64 = 1e3;

/// What a file says of one material of a wall.
pub(crate) struct OfMaterial<'a> {
    /// As messages name the section that limits it.
    pub section: &'static str,
    /// None where no further material is there.
    pub material: Option<&'a MaterialSection>,
    pub limits: Option<&'a LimitsSection>,
}

impl<'a> OfMaterial<'a> {
    /// The wall's own.
    pub(crate) fn first(material: &'a MaterialSection, limits: Option<&'a LimitsSection>) -> Self {
        Self { section: "[limits]", material: Some(material), limits }
    }
}

/// What each material of a wall may bear, the `first` and those of the `others`, in their order; none where nothing is said of any. An
/// other without a limit of its own has that of the first.
///
/// # Errors
/// As [`LimitsSection::limits`], and where there are limits of no material.
pub(crate) fn material_limits<'a>(
    first: OfMaterial<'a>,
    others: impl Iterator<Item = OfMaterial<'a>>,
    stretch_bound: f64,
) -> anyhow::Result<Vec<MaterialLimits>> {
    let of_first = first.limits;
    let mut all = Vec::new();
    for OfMaterial { section, material, limits } in std::iter::once(first).chain(others) {
        let Some(material) = material else {
            ensure!(
                limits.is_none(),
                "{section} wants a `material` beside it, which it limits; [limits] is for the wall's"
            );
            continue;
        };
        let limits = limits.or(of_first);
        let limits = limits.map(|limits| limits.limits(section, material, stretch_bound));
        all.push(limits.transpose()?);
    }
    let is_any = all.iter().any(Option::is_some);
    Ok(all.into_iter().filter(|_| is_any).map(Option::unwrap_or_default).collect())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::io::toml_file;

    fn limits(text: &str, material: &MaterialSection) -> anyhow::Result<MaterialLimits> {
        let section: LimitsSection = toml_file::parse(text, Path::new("run.toml"))?;
        section.limits("[limits]", material, 6.0)
    }

    fn refused(text: &str, material: &MaterialSection, said: &str) {
        let told = limits(text, material).unwrap_err().to_string();
        assert!(told.contains(said), "{told}");
    }

    #[test]
    fn a_preset_has_a_limit_of_its_own() {
        let preset = MaterialSection::default();
        let law = toml_file::parse("law = 'neo-hookean'\nmu = 1\n", Path::new("run.toml")).unwrap();
        let stretch = |stretch| MaterialLimits { stretch, nominal_stress: None };
        assert_eq!(limits("", &preset).unwrap(), stretch(Some(1.5)));
        assert_eq!(limits("stretch = 1.3", &law).unwrap(), stretch(Some(1.3)));
        let stress = MaterialLimits { stretch: None, nominal_stress: Some(4.0) };
        assert_eq!(limits("nominal_stress = 4", &preset).unwrap(), stress);
        refused("", &law, "[limits] wants a `stretch` or a `nominal_stress`");
        refused("stretch = 0.9", &law, "[limits] stretch");
        refused("stretch = 7", &law, "stretch_bound = 6.0");
        refused("nominal_stress = -1", &law, "[limits] nominal_stress");
    }

    #[test]
    fn a_second_material_has_its_own_limit_or_that_of_the_first() {
        let preset = MaterialSection::default();
        let of_stretch =
            |stretch| LimitsSection { stretch: Some(stretch), ..LimitsSection::default() };
        let [low, high] = [1.2, 1.6].map(of_stretch);
        let stretches = |first: Option<&LimitsSection>, second: Option<&LimitsSection>| {
            let first = OfMaterial::first(&preset, first);
            let (section, material) = ("[pattern] limits", Some(&preset));
            let second = OfMaterial { section, material, limits: second };
            let all = material_limits(first, std::iter::once(second), 6.0).unwrap();
            all.iter().map(|limits| limits.stretch).collect::<Vec<_>>()
        };
        assert_eq!(stretches(None, None), []);
        assert_eq!(stretches(Some(&low), None), [Some(1.2), Some(1.2)]);
        assert_eq!(stretches(Some(&low), Some(&high)), [Some(1.2), Some(1.6)]);
        assert_eq!(stretches(None, Some(&high)), [None, Some(1.6)]);
        let section = "[[region]] limits";
        let alone = OfMaterial { section, material: None, limits: Some(&high) };
        let first = OfMaterial::first(&preset, None);
        let told = material_limits(first, std::iter::once(alone), 6.0).unwrap_err().to_string();
        assert!(told.contains("wants a `material` beside it"), "{told}");
    }
}
