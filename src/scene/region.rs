//! `[[region]]`: where the wall is thicker, thinner or of another material than `[wall]` and `[material]` say.

use std::fmt;

use anyhow::{Context, ensure};
use schemars::JsonSchema;
use serde::de::{Error, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::limits::{LimitsSection, OfMaterial};
use super::material::MaterialSection;
use super::part::formula::Formula;
use crate::math::Vec3;
use crate::mesh::{Patch, Section, ShellMesh};
use crate::model::material::Material;

/// A part of the wall with a thickness or a material of its own; where regions overlap, the last one counts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RegionSection {
    /// A formula that is positive in the region: of `x`, `y`, `z` at rest (mm), of a patch of `s`, `t`; left out, it is the whole wall.
    #[serde(default, rename = "where", skip_serializing_if = "Option::is_none")]
    pub place: Option<String>,
    /// Thickness there, mm: a number, or a formula as `where` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<Expression>,
    /// What it is made of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<MaterialSection>,
    /// What this material may bear, as `[limits]` says of the wall's: `limits = { stretch = 1.2 }`; as `[limits]` where it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<LimitsSection>,
}

impl RegionSection {
    /// What it says of its material.
    pub(crate) fn limited(&self) -> OfMaterial<'_> {
        let (material, limits) = (self.material.as_ref(), self.limits.as_ref());
        OfMaterial { section: "[[region]] limits", material, limits }
    }
}

/// A number or a formula, as it stands in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) struct Expression(String);

impl<'de> Deserialize<'de> for Expression {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrText)
    }
}

struct NumberOrText;

impl Visitor<'_> for NumberOrText {
    type Value = Expression;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a number or a formula in quotes")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Expression, E> {
        Ok(Expression(format!("{number:?}")))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Expression, E> {
        Ok(Expression(number.to_string()))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Expression, E> {
        Ok(Expression(text.to_owned()))
    }
}

/// The regions of a scene, whose formulas know the variables of its part.
pub(crate) struct Regions<'a> {
    sections: &'a [RegionSection],
    formulas: Vec<RegionFormulas>,
    /// Materials before those of the regions.
    first: u16,
}

struct RegionFormulas {
    place: Option<Formula>,
    thickness: Option<Formula>,
}

/// The coordinates of a closed part and the parameters of a patch, as formulas name them.
pub(crate) const COORDINATES: &[&str] = &["x", "y", "z"];
pub(crate) const PARAMETERS: &[&str] = &["s", "t"];

impl<'a> Regions<'a> {
    /// Those of `sections`, with formulas of these `variables`; their materials come behind the `first` ones.
    ///
    /// # Errors
    /// When a region says nothing, a formula cannot be read, or there are more materials than a wall can have.
    pub(crate) fn new(
        sections: &'a [RegionSection],
        variables: &[&str],
        first: u16,
    ) -> anyhow::Result<Self> {
        let formulas = sections.iter().map(|section| {
            ensure!(
                section.thickness.is_some() || section.material.is_some(),
                "a [[region]] wants a `thickness` or a `material`"
            );
            let parsed = |key: &str, text: &str| {
                Formula::parse(text, variables).with_context(|| format!("[[region]] {key}"))
            };
            let place = section.place.as_ref().map(|text| parsed("where", text)).transpose()?;
            let of_thickness = |Expression(text): &Expression| parsed("thickness", text);
            let thickness = section.thickness.as_ref().map(of_thickness).transpose()?;
            Ok(RegionFormulas { place, thickness })
        });
        let formulas = formulas.collect::<anyhow::Result<_>>()?;
        ensure!(sections.len() < MOST_REGIONS, "more than {MOST_REGIONS} [[region]]s");
        Ok(Self { sections, formulas, first })
    }

    /// Appends the material of each region that has one to the wall's `materials`.
    ///
    /// # Errors
    /// When a region's material is none.
    pub(crate) fn append_materials(
        sections: &[RegionSection],
        materials: &mut Vec<Material>,
    ) -> anyhow::Result<()> {
        for section in sections.iter().filter_map(|section| section.material.as_ref()) {
            materials.push(section.material().context("[region.material]")?);
        }
        Ok(())
    }

    /// The section of a closed shell, whose positions the file has moved by `moved` (mm).
    ///
    /// # Errors
    /// When a thickness is no length somewhere.
    pub(crate) fn of_shell(&self, mesh: &ShellMesh, moved: Vec3) -> anyhow::Result<Section> {
        let positions = mesh.surface.positions.iter();
        let variables: Vec<Vec3> = positions.map(|x| x + moved).collect();
        self.section(&mesh.section, &variables, &mesh.surface.triangles)
    }

    /// The section of a patch.
    ///
    /// # Errors
    /// As [`Self::of_shell`].
    pub(crate) fn of_patch(&self, patch: &Patch) -> anyhow::Result<Section> {
        let parameters = |[s, t]: [f64; 2]| Vec3::new(s, t, 0.0);
        let variables: Vec<Vec3> =
            (0..patch.vertices() as u32).map(|v| parameters(patch.parameters(v))).collect();
        self.section(&patch.section, &variables, &patch.surface.triangles)
    }

    /// `plain`, and what the regions say of vertices where formulas have these `variables`, and of the triangles between them.
    fn section(
        &self,
        plain: &Section,
        variables: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> anyhow::Result<Section> {
        let mut section = plain.clone();
        if self.sections.iter().any(|region| region.thickness.is_some()) {
            let mut thickness: Vec<f64> =
                (0..variables.len() as u32).map(|v| plain.thickness(v)).collect();
            for region in &self.formulas {
                let Some(formula) = &region.thickness else { continue };
                for (own, at) in thickness.iter_mut().zip(variables) {
                    if region.contains(at) {
                        *own = formula.value(at.as_slice());
                        ensure!(
                            *own > 0.0 && own.is_finite(),
                            "[[region]] thickness is {own} at {}, where a length in mm is wanted",
                            place_in_words(at)
                        );
                    }
                }
            }
            section = section.with_thickness(thickness);
        }
        if self.sections.iter().any(|region| region.material.is_some()) {
            let of_triangle = |corners: &[u32; 3]| {
                let middle = corners.iter().map(|&v| variables[v as usize]).sum::<Vec3>() / 3.0;
                self.material_at(&middle)
            };
            let own = triangles.iter().map(of_triangle).enumerate();
            let materials = own.map(|(t, own)| own.unwrap_or_else(|| plain.material(t))).collect();
            section = section.with_materials(materials);
        }
        Ok(section)
    }

    /// The place in the list of materials of that at a point; `None` where no region says one.
    fn material_at(&self, at: &Vec3) -> Option<u16> {
        let with_material = self.sections.iter().zip(&self.formulas);
        let with_material = with_material.filter(|(section, _)| section.material.is_some());
        let numbered = (self.first..).zip(with_material);
        let within = numbered.filter(|(_, (_, region))| region.contains(at));
        within.last().map(|(material, _)| material)
    }
}

impl RegionFormulas {
    fn contains(&self, at: &Vec3) -> bool {
        self.place.as_ref().is_none_or(|place| place.value(at.as_slice()) > 0.0)
    }
}

fn place_in_words(at: &Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3})", at.x, at.y, at.z)
}

const MOST_REGIONS: usize = 1000;
