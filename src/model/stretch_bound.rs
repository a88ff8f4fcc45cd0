//! The stretch beyond which a part is said to balloon.
//!
//! ```text
//! |x_a - x_b| > bound |X_a - X_b|       along any side of a facet of the sampled surface
//! ```
//!
//! It bounds the model's validity (rubbers break) and ends the flight of a part that has no equilibrium left. It is checked on
//! accepted states only, and is no part of the energy.

use std::collections::BTreeSet;

use super::body::{Body, Configuration};
use super::part_term::{PartTerm, without_stencils};
use super::system::{Limit, LimitKind};
use crate::math::Vec3;

/// The stretch that ends a path unless another is asked for: 500 % strain, more than printed elastomers survive.
pub const DEFAULT_STRETCH_BOUND: f64 = 6.0;

/// Sides of facets that may be stretched to a bound.
#[derive(Clone, Debug)]
pub(super) struct StretchBound {
    /// The largest stretch allowed.
    bound: f64,
    /// Two samples and the square of their distance at rest, mm^2.
    sides: Vec<([u32; 2], f64)>,
}

impl StretchBound {
    /// Of the surface of `body`.
    pub(super) fn new(Body { surface, reference, .. }: &Body, bound: f64) -> Self {
        let at_rest = surface.at(reference);
        let ends = |facet: &[u32; 3]| {
            let [a, b, c] = *facet;
            [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])
        };
        let sides: BTreeSet<[u32; 2]> = surface.facets.iter().flat_map(ends).collect();
        let square = |[a, b]: [u32; 2]| (at_rest[a as usize] - at_rest[b as usize]).norm_squared();
        let sides = sides.into_iter().map(|side| (side, square(side))).collect();
        Self { bound, sides }
    }

    /// A sample at which the bound is passed most, for samples at `positions`.
    fn passed(&self, positions: &[Vec3]) -> Option<u32> {
        let square_bound = self.bound * self.bound;
        let stretch = |&([a, b], square): &([u32; 2], f64)| {
            ((positions[a as usize] - positions[b as usize]).norm_squared() / square, a)
        };
        let longest = self.sides.iter().map(stretch).max_by(|a, b| a.0.total_cmp(&b.0))?;
        (longest.0 > square_bound || longest.0.is_nan()).then_some(longest.1)
    }
}

without_stencils!(StretchBound);

impl PartTerm for StretchBound {
    fn boxed(&self) -> Box<dyn PartTerm> {
        Box::new(self.clone())
    }

    fn passed_limit(&self, at: &Configuration<'_>) -> Option<Limit> {
        let sample = self.passed(at.samples())?;
        let node = at.body.surface.samples[sample as usize].heaviest();
        Some(Limit { kind: LimitKind::Ballooning, unknown: 3 * node as usize })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::test_shells::TestShell;
    use crate::model::tie::Ties;

    /// A uniform stretch passes the bound exactly where it is larger.
    #[test]
    fn bound_is_a_stretch() {
        let shell = TestShell::new(0);
        let surface = shell.surface();
        let (reference, ties) = (shell.reference.clone(), Ties::default());
        let body = Body { reference, ties, surface };
        let bound = StretchBound::new(&body, DEFAULT_STRETCH_BOUND);
        let stretched = |by: f64| {
            let positions: Vec<Vec3> = shell.reference.iter().map(|x| x * by).collect();
            bound.passed(&body.surface.at(&positions))
        };
        assert_eq!(stretched(DEFAULT_STRETCH_BOUND * (1.0 - 1e-9)), None);
        assert!(stretched(DEFAULT_STRETCH_BOUND * (1.0 + 1e-9)).is_some());
        assert!(stretched(f64::NAN).is_some());
    }
}
