//! A part given by formulas, and what stands at its sides and vertices: supports and forces.

use anyhow::{Context, bail, ensure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::formula::Formula;
use crate::math::Vec3;
use crate::mesh::Side;
use crate::model::EdgeSupport;
use crate::scene::material::within;
use crate::scene::watch::{WatchSection, Watched};

/// `[part.patch]`: the mid-surface `x(s, t), y(s, t), z(s, t)` over a rectangle of `s` and `t`, cut into cells.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PatchSection {
    /// Range of the first parameter.
    pub s: [f64; 2],
    /// Range of the second.
    pub t: [f64; 2],
    /// Cells along each; two triangles make a cell.
    pub cells: [usize; 2],
    /// A formula of `s`, `t` and `pi`, mm. It holds a few cells beyond the sides too.
    pub x: String,
    /// As `x`.
    pub y: String,
    /// As `x`.
    pub z: String,
}

/// `[[edge]]`: how a side is held, in exactly one way; a side that is not listed is free.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EdgeSection {
    /// Which side.
    pub side: Side,
    /// Neither moves nor turns.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clamped: Option<bool>,
    /// Lies in a plane of symmetry with this normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub symmetry: Option<Axis>,
    /// Does not move along these axes, and turns freely.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hold: Option<Vec<Axis>>,
}

/// `[[pin]]`: a vertex that does not move along some axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PinSection {
    /// Its `s` and `t`.
    pub at: [f64; 2],
    /// Along which axes it does not move.
    pub hold: Vec<Axis>,
}

/// `[[force]]`: a force at a vertex, along a side or over the whole surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ForceSection {
    /// `s` and `t` of a vertex, with `force`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at: Option<[f64; 2]>,
    /// At that vertex, N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force: Option<[f64; 3]>,
    /// A side, with `per_length`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// Along that side at rest, N/mm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per_length: Option<[f64; 3]>,
    /// On the whole surface, per area at rest, MPa.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub per_area: Option<[f64; 3]>,
    /// Whether it turns with the wall at its place, instead of keeping its direction; not for `per_area`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub follower: bool,
}

/// `[[moment]]`: a dead moment along a side.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct MomentSection {
    /// The side, which is free.
    pub side: Side,
    /// About the axes x, y, z, per length of the side, N mm/mm.
    pub per_length: [f64; 3],
}

/// An axis of space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// What a `[[force]]` acts on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Force {
    /// N at `s`, `t`.
    Point { at: [f64; 2], force: Vec3 },
    /// N/mm.
    Edge { side: Side, per_length: Vec3 },
    /// N at `s`, `t` at rest, turning with the wall.
    FollowerPoint { at: [f64; 2], force: Vec3 },
    /// N/mm at rest, turning with the wall.
    FollowerEdge { side: Side, per_length: Vec3 },
    /// MPa.
    Area { per_area: Vec3 },
}

impl PatchSection {
    pub(crate) fn check(&self) -> anyhow::Result<()> {
        for (name, [low, high]) in [("s", self.s), ("t", self.t)] {
            ensure!(
                low < high && low.is_finite() && high.is_finite(),
                "[part.patch] {name} is [{low:?}, {high:?}], but it must be a range, the smaller number first"
            );
        }
        let [n, m] = self.cells;
        ensure!(
            (1..=MOST_CELLS).contains(&n) && (1..=MOST_CELLS).contains(&m),
            "[part.patch] cells is [{n}, {m}], but each must lie between 1 and {MOST_CELLS}"
        );
        self.surface().map(drop)
    }

    /// The mid-surface as a function of `s` and `t`, mm.
    pub(crate) fn surface(&self) -> anyhow::Result<impl Fn(f64, f64) -> Vec3 + use<>> {
        let formula = |name: &str, text: &str| {
            Formula::parse(text, &["s", "t"]).with_context(|| format!("[part.patch] {name}"))
        };
        let x = formula("x", &self.x)?;
        let y = formula("y", &self.y)?;
        let z = formula("z", &self.z)?;
        Ok(move |s, t| Vec3::new(x.value(&[s, t]), y.value(&[s, t]), z.value(&[s, t])))
    }

    /// Checks that a vertex of the lattice lies at `s`, `t`.
    fn check_vertex(&self, what: &str, at: [f64; 2]) -> anyhow::Result<()> {
        let ranges = [("s", self.s), ("t", self.t)];
        for ((at, (name, [low, high])), cells) in at.into_iter().zip(ranges).zip(self.cells) {
            let place = (at - low) / (high - low) * cells as f64;
            let is_on_lattice = (place - place.round()).abs() < 1e-6;
            ensure!(
                is_on_lattice && (0.0..=cells as f64).contains(&place.round()),
                "{what}: no vertex has {name} = {at}; {cells} cells divide {low} to {high} into steps of {:.6}",
                (high - low) / cells as f64
            );
        }
        Ok(())
    }
}

/// A million cells are some three million unknowns, more than a laptop factorises.
const MOST_CELLS: usize = 1000;

impl EdgeSection {
    pub(crate) fn support(&self) -> anyhow::Result<EdgeSupport> {
        match (self.clamped, self.symmetry, &self.hold) {
            (Some(true), None, None) => Ok(EdgeSupport::Clamped),
            (None, Some(normal), None) => Ok(EdgeSupport::Symmetry(normal as usize)),
            (None, None, Some(axes)) => held(axes, "[[edge]] hold").map(EdgeSupport::Held),
            _ => bail!(
                "[[edge]] wants exactly one of `clamped = true`, `symmetry = \"x\"` and `hold = [\"x\", \"z\"]`"
            ),
        }
    }
}

impl PinSection {
    pub(crate) fn held(&self) -> anyhow::Result<[bool; 3]> {
        held(&self.hold, "[[pin]] hold")
    }
}

fn held(axes: &[Axis], what: &str) -> anyhow::Result<[bool; 3]> {
    ensure!(!axes.is_empty(), "{what} is empty, but it must name an axis");
    Ok([Axis::X, Axis::Y, Axis::Z].map(|axis| axes.contains(&axis)))
}

impl ForceSection {
    /// Whether it is other than zero.
    pub(crate) fn acts(&self) -> bool {
        let vectors = [self.force, self.per_length, self.per_area];
        vectors.into_iter().flatten().flatten().any(|component| component != 0.0)
    }

    pub(crate) fn acting(&self) -> anyhow::Result<Force> {
        let vector = |name, f| load_vector(name, f);
        match (self.at, self.force, self.side, self.per_length, self.per_area) {
            (Some(at), Some(force), None, None, None) => {
                let force = vector("[[force]] force", force)?;
                let follows = self.follower;
                Ok(if follows {
                    Force::FollowerPoint { at, force }
                } else {
                    Force::Point { at, force }
                })
            }
            (None, None, Some(side), Some(f), None) => {
                let per_length = vector("[[force]] per_length", f)?;
                Ok(if self.follower {
                    Force::FollowerEdge { side, per_length }
                } else {
                    Force::Edge { side, per_length }
                })
            }
            (None, None, None, None, Some(_)) if self.follower => {
                bail!(
                    "[[force]] per_area keeps its direction; what follows the wall all over is [load] pressure"
                )
            }
            (None, None, None, None, Some(f)) => {
                Ok(Force::Area { per_area: vector("[[force]] per_area", f)? })
            }
            _ => bail!(
                "[[force]] wants either `at` with `force`, or `side` with `per_length`, or `per_area`"
            ),
        }
    }
}

impl MomentSection {
    pub(crate) fn per_length(&self) -> anyhow::Result<Vec3> {
        let moment = load_vector("[[moment]] per_length", self.per_length)?;
        ensure!(moment != Vec3::zeros(), "[[moment]] per_length is zero: no moment at all");
        Ok(moment)
    }
}

/// Checks the pressure on a patch, MPa, of either sign.
pub(crate) fn check_patch_pressure(pressure: f64) -> anyhow::Result<()> {
    let what = "[load] pressure of a [part.patch]";
    within(what, pressure, -LARGEST_LOAD, LARGEST_LOAD).map(drop)
}

/// Beyond, in N, mm and MPa, nothing is a load.
const LARGEST_LOAD: f64 = 1e12;

fn load_vector(what: &str, vector: [f64; 3]) -> anyhow::Result<Vec3> {
    for component in vector {
        within(what, component, -LARGEST_LOAD, LARGEST_LOAD)?;
    }
    Ok(Vec3::from(vector))
}

/// What stands at the sides and vertices of a patch.
pub(crate) struct PatchConditions<'a> {
    pub edges: &'a [EdgeSection],
    pub pins: &'a [PinSection],
    pub forces: &'a [ForceSection],
    pub moments: &'a [MomentSection],
    pub watches: &'a [WatchSection],
}

impl PatchConditions<'_> {
    /// Checks them one by one, and that every `at` is a vertex of `patch`.
    pub(crate) fn check(&self, patch: &PatchSection) -> anyhow::Result<()> {
        for (i, edge) in self.edges.iter().enumerate() {
            edge.support()?;
            ensure!(
                self.edges[..i].iter().all(|before| before.side != edge.side),
                "[[edge]] lists the side {:?} twice",
                edge.side
            );
        }
        for pin in self.pins {
            pin.held()?;
            patch.check_vertex("[[pin]] at", pin.at)?;
        }
        for force in self.forces {
            if let Force::Point { at, .. } | Force::FollowerPoint { at, .. } = force.acting()? {
                patch.check_vertex("[[force]] at", at)?;
            }
        }
        for moment in self.moments {
            moment.per_length()?;
        }
        for watch in self.watches {
            if let Watched::Vertex { at, .. } = watch.watched()? {
                patch.check_vertex(&format!("[[watch]] {}: at", watch.name), at)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch() -> PatchSection {
        PatchSection {
            s: [0.0, 40.0],
            t: [0.0, 25.0],
            cells: [4, 5],
            x: "25*sin(s*pi/180)".to_owned(),
            y: "t".to_owned(),
            z: "25*cos(s*pi/180)".to_owned(),
        }
    }

    #[test]
    fn surface_is_what_the_formulas_say() {
        let surface = patch().surface().unwrap();
        let exact = Vec3::new(12.5, 7.0, 25.0 * 30.0_f64.to_radians().cos());
        // Rounding of a few operations on numbers of size 25.
        assert!((surface(30.0, 7.0) - exact).norm() < 1e-13);
    }

    #[test]
    fn wrong_patches_are_refused_in_one_line() {
        let error = |change: &dyn Fn(&mut PatchSection)| {
            let mut patch = patch();
            change(&mut patch);
            format!("{:#}", patch.check().unwrap_err())
        };
        assert_eq!(
            error(&|p| p.x = "2*s)".to_owned()),
            "[part.patch] x: `2*s)` has `)` at place 4, where an operator is wanted"
        );
        assert_eq!(
            error(&|p| p.s = [1.0, 1.0]),
            "[part.patch] s is [1.0, 1.0], but it must be a range, the smaller number first"
        );
        assert!(error(&|p| p.cells = [0, 4]).contains("cells is [0, 4]"));
    }

    #[test]
    fn places_between_vertices_are_refused() {
        let patch = patch();
        assert!(patch.check_vertex("at", [30.0, 25.0]).is_ok());
        let error = |at| patch.check_vertex("[[force]] at", at).unwrap_err().to_string();
        assert_eq!(
            error([35.0, 0.0]),
            "[[force]] at: no vertex has s = 35; 4 cells divide 0 to 40 into steps of 10.000000"
        );
        assert!(error([40.0, 30.0]).contains("no vertex has t = 30"));
    }

    #[test]
    fn half_given_conditions_are_refused() {
        let edge = |text: &str| toml::from_str::<EdgeSection>(text).unwrap().support();
        assert_eq!(edge("side = \"s0\"\nsymmetry = \"y\"").unwrap(), EdgeSupport::Symmetry(1));
        let held = EdgeSupport::Held([true, false, true]);
        assert_eq!(edge("side = \"t1\"\nhold = [\"x\", \"z\"]").unwrap(), held);
        assert!(edge("side = \"s0\"").is_err());
        assert!(edge("side = \"s0\"\nclamped = true\nsymmetry = \"y\"").is_err());
        assert!(edge("side = \"s0\"\nhold = []").is_err());
        let force = |text: &str| toml::from_str::<ForceSection>(text).unwrap().acting();
        assert_eq!(
            force("per_area = [0, 0, -90]").unwrap(),
            Force::Area { per_area: Vec3::new(0.0, 0.0, -90.0) }
        );
        let per_length = Vec3::new(0.0, 0.0, 3.0);
        assert_eq!(
            force("side = \"s1\"\nper_length = [0, 0, 3]\nfollower = true").unwrap(),
            Force::FollowerEdge { side: Side::S1, per_length }
        );
        assert!(force("per_area = [0, 0, -90]\nfollower = true").is_err());
        assert!(force("at = [0, 0]").is_err());
        assert!(force("at = [0, 0]\nper_area = [0, 0, -90]").is_err());
    }
}
