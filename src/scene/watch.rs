//! `[[watch]]`: numbers that are followed along a path.

use anyhow::{bail, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::watch_curve::{CurvePoint, WatchCurve};
use crate::fitness::Turning;
use crate::math::Vec3;
use crate::model::PartModel;
use crate::solve::PathPoint;

/// `[[watch]]`: a vertex or the tip along a direction, or something of the part as a whole.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct WatchSection {
    /// Of the number, in tables and messages.
    pub name: String,
    /// `s` and `t` of a vertex of a patch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 2]>,
    /// Instead of `at`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub measure: Option<Measure>,
    /// Along which the displacement of a vertex, or of the tip, is measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
}

/// What can be measured without naming a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Measure {
    /// Mean displacement of the tip set along `direction`, mm.
    Tip,
    /// Angle at the base between the tip at rest and the tip, degrees, up to half a turn.
    ChordAngle,
    /// Energy stored in the wall, mJ.
    StoredEnergy,
    /// Enclosed volume less that at rest, mm^3.
    VolumeGrowth,
    /// Cube root of the enclosed volume over that at rest, less 1.
    VolumeStrain,
}

/// What a `[[watch]]` follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Watched {
    /// The displacement of the vertex at `s`, `t` along a unit vector, mm.
    Vertex {
        at: [f64; 2],
        direction: Vec3,
    },
    /// The mean displacement of the tip set along a unit vector, mm.
    Tip {
        direction: Vec3,
    },
    ChordAngle,
    StoredEnergy,
    VolumeGrowth,
    VolumeStrain,
}

/// What a part has to be watched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Watchable {
    /// An open surface has vertices of known parameters, and encloses nothing.
    Patch,
    /// A closed free surface encloses a volume.
    FreeBody,
    /// A clamped actuator has a tip besides.
    Actuator,
}

impl WatchSection {
    pub(crate) fn watched(&self) -> anyhow::Result<Watched> {
        match (self.at, self.measure, self.direction) {
            (Some(at), None, Some(direction)) => {
                Ok(Watched::Vertex { at, direction: self.unit(direction)? })
            }
            (None, Some(Measure::Tip), Some(direction)) => {
                Ok(Watched::Tip { direction: self.unit(direction)? })
            }
            (None, Some(Measure::ChordAngle), None) => Ok(Watched::ChordAngle),
            (None, Some(Measure::StoredEnergy), None) => Ok(Watched::StoredEnergy),
            (None, Some(Measure::VolumeGrowth), None) => Ok(Watched::VolumeGrowth),
            (None, Some(Measure::VolumeStrain), None) => Ok(Watched::VolumeStrain),
            _ => bail!(
                "[[watch]] {}: give either `at` with `direction`, or `measure` (`tip` with `direction`)",
                self.name
            ),
        }
    }

    /// Checks that the part has what is watched.
    pub(crate) fn check(&self, part: Watchable) -> anyhow::Result<()> {
        let name = &self.name;
        ensure!(
            !name.trim().is_empty(),
            "[[watch]] name is {name:?}, but it must name what is watched"
        );
        match self.watched()? {
            Watched::Vertex { .. } if part != Watchable::Patch => {
                bail!("[[watch]] {name}: `at` wants a [part.patch], which alone has `s` and `t`")
            }
            Watched::Tip { .. } | Watched::ChordAngle if part != Watchable::Actuator => {
                bail!(
                    "[[watch]] {name}: only a network, an STL file or tetrahedra are clamped and have a tip"
                )
            }
            Watched::VolumeGrowth | Watched::VolumeStrain if part == Watchable::Patch => {
                bail!("[[watch]] {name}: a patch encloses no volume")
            }
            _ => Ok(()),
        }
    }

    fn unit(&self, direction: [f64; 3]) -> anyhow::Result<Vec3> {
        let direction = Vec3::from(direction);
        ensure!(
            direction.norm() > 1e-12 && direction.norm().is_finite(),
            "[[watch]] {}: direction must be a direction, not {:?}",
            self.name,
            direction.as_slice()
        );
        Ok(direction.normalize())
    }
}

/// A watch on the model of a part.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Watch {
    pub watched: Watched,
    /// Whose mean displacement it follows, if it follows one.
    pub vertices: Vec<u32>,
    /// Of the part along z at rest, mm; for the chord angle.
    pub length: f64,
}

impl Watch {
    /// The watched number over the share of the `largest` load.
    pub(crate) fn curve(
        &self,
        model: &PartModel,
        points: &[PathPoint],
        largest: f64,
    ) -> WatchCurve {
        let at_rest = points.first().map_or(0.0, |point| point.conjugate);
        let mut turning = Turning::default();
        let point = |point: &PathPoint| {
            let [value, rate] = self.value_and_rate(model, at_rest, &mut turning, point);
            CurvePoint { load: point.load / largest, value, rate: rate * largest / point.load_rate }
        };
        WatchCurve { points: points.iter().map(point).collect() }
    }

    /// The watched number, and its derivative with respect to the drive of the path; `turning` has followed the path up to here.
    fn value_and_rate(
        &self,
        model: &PartModel,
        at_rest: f64,
        turning: &mut Turning,
        point: &PathPoint,
    ) -> [f64; 2] {
        // The displacement of a vertex is linear in the unknowns.
        let mean = |x: &[f64]| {
            let displacements = model.vertex_displacements(x);
            let sum: Vec3 = self.vertices.iter().map(|&v| displacements[v as usize]).sum();
            sum / self.vertices.len() as f64
        };
        match self.watched {
            Watched::Vertex { direction, .. } | Watched::Tip { direction } => {
                [&point.x, &point.rate].map(|x| mean(x).dot(&direction))
            }
            Watched::ChordAngle => turning
                .chord_and_rate(self.length, mean(&point.x), mean(&point.rate))
                .map(f64::to_degrees),
            Watched::StoredEnergy => [point.stored_energy, point.load * point.conjugate_rate],
            Watched::VolumeGrowth => [point.conjugate - at_rest, point.conjugate_rate],
            Watched::VolumeStrain => {
                let stretch = (point.conjugate / at_rest).cbrt();
                [stretch - 1.0, stretch / (3.0 * point.conjugate) * point.conjugate_rate]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section(text: &str) -> WatchSection {
        toml::from_str(&format!("name = \"w\"\n{text}")).unwrap()
    }

    #[test]
    fn half_given_watches_are_refused() {
        for wrong in [
            "",
            "at = [0, 0]",
            "at = [0, 0]\ndirection = [0, 0, 0]",
            "at = [0, 0]\nmeasure = \"stored-energy\"",
            "measure = \"tip\"",
            "measure = \"chord-angle\"\ndirection = [1, 0, 0]",
        ] {
            assert!(section(wrong).watched().is_err(), "{wrong}");
        }
        let tip = section("measure = \"tip\"\ndirection = [0, 3, 4]").watched().unwrap();
        assert_eq!(tip, Watched::Tip { direction: Vec3::new(0.0, 0.6, 0.8) });
    }

    #[test]
    fn a_part_is_watched_only_where_it_has_something() {
        let place = "at = [0, 0]\ndirection = [1, 0, 0]";
        let rows = [
            (place, [true, false, false]),
            ("measure = \"stored-energy\"", [true, true, true]),
            ("measure = \"volume-growth\"", [false, true, true]),
            ("measure = \"chord-angle\"", [false, false, true]),
        ];
        for (text, wanted) in rows {
            let parts = [Watchable::Patch, Watchable::FreeBody, Watchable::Actuator];
            assert_eq!(parts.map(|part| section(text).check(part).is_ok()), wanted, "{text}");
        }
    }
}
