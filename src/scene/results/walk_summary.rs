//! How a path went, for `summary.json` and the last line on the terminal.

use anyhow::ensure;
use serde::Serialize;

use crate::math::Vec3;
use crate::model::{Face, PartModel, UsedLimit};
use crate::scene::part::placement::Placed;
use crate::solve::{Ending, Path, PathPoint};

/// Why and where a path ended, and what it lost and found on the way.
#[derive(Debug, Serialize)]
pub(crate) struct WalkSummary {
    pub ending: Ending,
    /// Where on the part, mm: where a bound was passed, or what moved fastest at the end; none where the programme was walked
    /// to its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ended_near: Option<[f64; 3]>,
    /// The first load (MPa, or share of a patch's loads) at which stability under a given load was lost.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_load: Option<f64>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub snaps: Vec<SnapRow>,
    /// Where the scene sets limits: that of which the last state uses most.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<LimitSummary>,
}

/// How much of a limit of the material the last state uses, and where.
#[derive(Debug, Serialize)]
pub(crate) struct LimitSummary {
    /// `stretch` or `nominal_stress`.
    quantity: &'static str,
    allowed: f64,
    value: f64,
    /// `(value - 1) / (allowed - 1)` of a stretch, `value / allowed` of a stress.
    share: f64,
    /// In the order of the file: 0 is that of `[material]`.
    material: usize,
    /// Of a shell.
    #[serde(skip_serializing_if = "Option::is_none")]
    face: Option<&'static str>,
    /// The middle of the triangle or cell at rest, mm.
    at_rest: [f64; 3],
    /// Whether the limit is passed by a snap from this state alone, and not in it.
    passed_in_snap: bool,
    #[serde(skip)]
    unit: &'static str,
}

/// Refuses a path on which the method found nothing but the state at rest, or the material bears not even that.
pub(crate) fn check_left_rest(walked: &Path) -> anyhow::Result<()> {
    ensure!(
        walked.ending != Ending::Stalled || walked.points.len() > 1,
        "the path stalls at rest: no state under any load was found; look at the mesh, the clamp and the size of the load"
    );
    ensure!(
        walked.ending != Ending::LimitReached || !walked.points.is_empty(),
        "the wall is past its [limits] at rest, before any load: raise them, or take away what pushes it there"
    );
    Ok(())
}

/// One loss of stability that the path went over; its shapes are the pictures of the step and of the one before.
#[derive(Debug, Serialize)]
pub(crate) struct SnapRow {
    /// The step to which it led.
    pub step: usize,
    /// Before and after.
    pub load: [f64; 2],
    /// Before and after; of a closed part the volume, mm^3.
    pub conjugate: [f64; 2],
    /// mJ.
    pub released: f64,
    pub from_bifurcation: bool,
}

impl WalkSummary {
    pub(crate) fn new(walked: &Path, model: &PartModel) -> Self {
        let snap = |(step, pair): (usize, &[PathPoint])| {
            let (from, to) = (&pair[0], &pair[1]);
            to.snap.map(|snap| SnapRow {
                step: step + 1,
                load: [from.load, to.load],
                conjugate: [from.conjugate, to.conjugate],
                released: snap.released,
                from_bifurcation: snap.from_bifurcation,
            })
        };
        let last = walked.points.last();
        let near = |unknown| last.map(|last| model.place_of(unknown, &last.x).into());
        Self {
            ending: walked.ending,
            ended_near: walked.place.and_then(near),
            limit_load: walked.limit_load(),
            snaps: walked.points.windows(2).enumerate().filter_map(snap).collect(),
            limit: last.and_then(|last| model.used_limit(&last.x)).map(|used| {
                let passed_in_snap = walked.ending == Ending::LimitReached && walked.fell;
                LimitSummary::new(&used, passed_in_snap)
            }),
        }
    }

    /// As of a part that was put at its place in the computation.
    pub(crate) fn of_placed(mut self, placed: Placed) -> Self {
        if let Some(near) = &mut self.ended_near {
            let mut place = [Vec3::from(*near)];
            placed.put_back(&mut place);
            *near = place[0].into();
        }
        if let Some(limit) = &mut self.limit {
            let mut place = [Vec3::from(limit.at_rest)];
            placed.put_back(&mut place);
            limit.at_rest = place[0].into();
        }
        self
    }

    /// The ending as a sentence begins, with its place and the number of snaps.
    pub(crate) fn in_words(&self) -> String {
        let mut words = self.ending.name().replace('_', " ");
        if let Some([x, y, z]) = self.ended_near {
            words += &format!(" near ({x:.1}, {y:.1}, {z:.1}) mm");
        }
        match self.snaps.len() {
            0 => {}
            1 => words += " (1 snap)",
            n => words += &format!(" ({n} snaps)"),
        }
        if let Some(limit) = &self.limit {
            words += &limit.in_words();
        }
        words
    }
}

impl LimitSummary {
    fn new(used: &UsedLimit, passed_in_snap: bool) -> Self {
        let face = |face| if face == Face::Inner { "inner" } else { "outer" };
        Self {
            quantity: used.quantity.name(),
            allowed: used.allowed,
            value: used.value,
            share: used.share,
            material: used.material,
            face: used.face.map(face),
            at_rest: used.at_rest.into(),
            passed_in_snap,
            unit: used.quantity.told_unit(),
        }
    }

    /// What a sentence goes on with: the limit, and where it is used.
    fn in_words(&self) -> String {
        let Self { allowed, value, unit, .. } = self;
        let quantity = self.quantity.replace('_', " ");
        let face = self.face.map_or_else(String::new, |face| format!(" at the {face} face"));
        let [x, y, z] = self.at_rest;
        let snap = if self.passed_in_snap { ", and passes it in a snap" } else { "" };
        format!(
            " (a {quantity} of {value:.4} of the {allowed}{unit} allowed,{face} of what is at ({x:.1}, {y:.1}, {z:.1}) mm at rest{snap})"
        )
    }
}
