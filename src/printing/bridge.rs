//! The longest bridge: how far material must hang between two supported ends, layer by layer.
//!
//! ```text
//! a cube is held where the layer below has a cube within one step of it (45 degrees), or it lies on the bed
//! span of a row of cubes that are not held, both ends of which are held = (cubes + 2) edges
//! bridge of a cube = the shortest span through it, of rows in four directions of the layer
//! ```
//! The two are the cubes at the ends that 45 degrees hold. Rows with a free end hang in the air and bridge nothing: these are
//! overhangs. It is the largest unsupported span as a slicer would choose it: along the shorter way.

use super::{BuildDirection, Voxels};

/// The longest bridge when `voxels` are built `up`, mm; 0 where all is held or hangs free.
#[must_use]
pub fn longest_bridge(voxels: &Voxels, up: BuildDirection) -> f64 {
    let layers = voxels.counts[up.axis];
    let across = [(up.axis + 1) % 3, (up.axis + 2) % 3];
    let strides = voxels.strides();
    let [rows, columns] = across.map(|axis| voxels.counts[axis]);
    let layer = |level: usize| {
        let level = if up.forward { level } else { layers - 1 - level };
        let solid = (0..rows * columns).map(|k| {
            let (i, j) = (k / columns, k % columns);
            voxels.solid[level * strides[up.axis] + i * strides[across[0]] + j * strides[across[1]]]
        });
        Layer { solid: solid.collect(), rows, columns }
    };
    let mut longest = 0.0_f64;
    let mut below: Option<Layer> = None;
    for level in 0..layers {
        let here = layer(level);
        if let Some(below) = &below {
            longest = longest.max(here.bridge(&here.hanging(below)));
        }
        // Layers below the part are empty, and what comes first lies on the bed.
        if below.is_some() || here.solid.iter().any(|solid| *solid) {
            below = Some(here);
        }
    }
    longest * voxels.size
}

/// The cubes of one layer.
struct Layer {
    solid: Vec<bool>,
    rows: usize,
    columns: usize,
}

impl Layer {
    fn at(&self, i: isize, j: isize) -> Option<usize> {
        let (i, j) = (usize::try_from(i).ok()?, usize::try_from(j).ok()?);
        (i < self.rows && j < self.columns).then_some(i * self.columns + j)
    }

    /// Whether each cube is solid and not held by the layer `below`.
    fn hanging(&self, below: &Self) -> Vec<bool> {
        let is_held = |k: usize| {
            let (i, j) = ((k / self.columns) as isize, (k % self.columns) as isize);
            let mut near = (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (i + di, j + dj)));
            near.any(|(i, j)| self.at(i, j).is_some_and(|k| below.solid[k]))
        };
        (0..self.solid.len()).map(|k| self.solid[k] && !is_held(k)).collect()
    }

    /// The longest bridge of `hanging` cubes, in edges of a cube.
    fn bridge(&self, hanging: &[bool]) -> f64 {
        let mut shortest = vec![f64::INFINITY; self.solid.len()];
        for (k, _) in hanging.iter().enumerate().filter(|(_, hangs)| **hangs) {
            let (i, j) = ((k / self.columns) as isize, (k % self.columns) as isize);
            for (di, dj) in [(0, 1), (1, 0), (1, 1), (1, -1)] {
                let hangs = |n: isize| self.at(i + n * di, j + n * dj).filter(|&k| hanging[k]);
                // Each row is walked once, from its first cube.
                if hangs(-1).is_some() {
                    continue;
                }
                let row: Vec<usize> = (0..).map_while(hangs).collect();
                let end = row.len() as isize;
                let is_solid =
                    |n: isize| self.at(i + n * di, j + n * dj).is_some_and(|k| self.solid[k]);
                if is_solid(-1) && is_solid(end) {
                    let span = (end + 2) as f64 * ((di * di + dj * dj) as f64).sqrt();
                    row.iter().for_each(|&k| shortest[k] = shortest[k].min(span));
                }
            }
        }
        shortest.into_iter().filter(|span| span.is_finite()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::printing::test_shapes::{brick, hollow};

    /// A room of 12 x 20 x 8 mm in a box: its roof spans the shorter side, whichever face is the roof; the floor lies on the bed.
    #[test]
    fn a_roof_spans_its_shorter_side() {
        let outer = brick([-2.0, -2.0, -2.0], [14.0, 22.0, 10.0]);
        let solid = hollow(&outer, &[brick([0.0; 3], [12.0, 20.0, 8.0])]);
        let voxels = Voxels::of(&solid, 0.5);
        for up in BuildDirection::ALL {
            let sides: Vec<f64> = (0..3)
                .filter(|&axis| axis != up.axis)
                .map(|axis| [12.0, 20.0, 8.0][axis])
                .collect();
            let span = sides[0].min(sides[1]);
            // Whole cubes, exactly.
            assert_eq!(longest_bridge(&voxels, up), span, "{}", up.name());
        }
    }

    /// Without two of its walls the room is a tunnel: built along its length nothing hangs, and a shelf with one end free bridges nothing.
    #[test]
    fn what_is_held_or_free_is_no_bridge() {
        let along = |axis: usize, forward: bool| BuildDirection { axis, forward };
        let walls =
            [brick([0.0; 3], [2.0, 20.0, 10.0]), brick([10.0, 0.0, 0.0], [12.0, 20.0, 10.0])];
        let lintel = brick([2.0, 0.0, 8.0], [10.0, 20.0, 10.0]);
        // Faces that touch are one wall to cubes.
        let gate = Voxels::of(&walls[0].joined(&walls[1]).joined(&lintel), 0.5);
        assert_eq!(longest_bridge(&gate, along(2, true)), 8.0);
        assert_eq!(longest_bridge(&gate, along(2, false)), 0.0);
        assert_eq!(longest_bridge(&gate, along(1, true)), 0.0);
        let shelf = Voxels::of(&walls[0].joined(&lintel), 0.5);
        assert_eq!(longest_bridge(&shelf, along(2, true)), 0.0);
    }

    /// A disc spans its diameter, along the axes as along the diagonals, to a cube at either end and what diagonals round.
    #[test]
    fn a_round_roof_spans_its_diameter() {
        let disc = crate::surface::test_fields::Analytic(|p: crate::math::Vec3| {
            let room = (p.x.hypot(p.y) - 6.0).max((p.z - 5.0).abs() - 3.0);
            (p.x.hypot(p.y) - 8.0).max((p.z - 5.0).abs() - 5.0).max(-room)
        });
        let half = crate::math::Vec3::new(9.0, 9.0, 11.0);
        let mesh = crate::surface::isosurface(&disc, -half, half, 0.5);
        let span = longest_bridge(&Voxels::of(&mesh, 0.25), BuildDirection::ALL[0]);
        assert!((span - 12.0).abs() < 0.8, "{span}");
    }
}
