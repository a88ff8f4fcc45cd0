//! Where air gets in: a bore through the base, bare or in a barb for a tube.
//!
//! ```text
//! barb, radius over depth below the base; R = tube / 2, u = tube / 10:
//!
//!   R      R    R+u      R    R+u      R        outside, from the base to the tip
//!   0     4u     5u    10u    11u    16u
//! ```
//! The backs of the two ridges slope by 45 degrees, so that they need no support with the tip of the actuator on the bed. A tube of
//! polyurethane of 8 x 5 mm, a metric size of pneumatics, sits on the default barb, whose ridges are 20 % wider than its bore. The
//! shape is our choice: no standard covers printed barbs.

/// How air gets into the chamber.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inlet {
    /// Not at all: the chamber is a closed void.
    None,
    /// A bore through the base.
    Hole {
        /// Diameter, mm.
        bore: f64,
    },
    /// A barb below the base, with a bore through both.
    Barb {
        /// Diameter of the bore, mm.
        bore: f64,
        /// Inner diameter of the tube that the barb is for, mm.
        tube: f64,
    },
}

impl Inlet {
    /// Radius of what stands on the base, mm; 0 without an inlet.
    #[must_use]
    pub fn foot(&self) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Hole { bore } => 0.5 * bore,
            Self::Barb { tube, .. } => 0.5 * tube,
        }
    }

    /// Diameter of the bore, mm; none without an inlet.
    #[must_use]
    pub fn bore(&self) -> Option<f64> {
        match *self {
            Self::None => None,
            Self::Hole { bore } | Self::Barb { bore, .. } => Some(bore),
        }
    }

    /// Thickness of the barb's wall where it is thinnest, mm; none without a barb.
    #[must_use]
    pub fn barb_wall(&self) -> Option<f64> {
        match *self {
            Self::Barb { bore, tube } => Some(0.5 * (tube - bore)),
            _ => None,
        }
    }

    /// Radius and depth below the base (mm) of the corners between the outer face of the base and the bore, both left out.
    pub(super) fn corners(&self) -> Vec<[f64; 2]> {
        let Self::Barb { bore, tube } = *self else { return Vec::new() };
        let (r, u) = (0.5 * tube, 0.1 * tube);
        let outside =
            [[r, 4.0], [r + u, 5.0], [r, 10.0], [r + u, 11.0], [r, 16.0], [0.5 * bore, 16.0]];
        outside.map(|[radius, depth]| [radius, depth * u]).to_vec()
    }
}

/// What a nozzle of 0.4 mm lays as two beads, mm: less is printed as one, or not at all.
pub const LEAST_WALL: f64 = 0.8;

#[cfg(test)]
mod tests {
    use super::*;

    /// The least wall is at the stem, and no slope faces away from the base by more than 45 degrees.
    #[test]
    fn a_barb_prints_with_its_tip_up() {
        let barb = Inlet::Barb { bore: 3.0, tube: 5.0 };
        assert_eq!((barb.foot(), barb.bore(), barb.barb_wall()), (2.5, Some(3.0), Some(1.0)));
        let corners = barb.corners();
        assert!(corners.iter().all(|[radius, _]| *radius >= 1.5));
        for pair in corners.windows(2) {
            let ([r, depth], [next, deeper]) = (pair[0], pair[1]);
            // 1e-12: rounding of tenths.
            assert!(next - r <= deeper - depth + 1e-12, "{pair:?} overhangs");
        }
        assert_eq!(Inlet::Hole { bore: 3.0 }.corners(), Vec::<[f64; 2]>::new());
        assert_eq!(Inlet::None.foot(), 0.0);
    }
}
