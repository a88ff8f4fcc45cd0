//! Which law does a measured rubber follow?
//!
//! Tables of uniaxial, planar and equibiaxial tests are read, every law is fitted to them under Drucker's stability, and the one that
//! predicts best what it was not fitted to is written as a `[material]`, with a figure.
//!
//! It is no model of what rubber does besides: no rate, no softening by the first stretch, no set.
//!
//! # Decisions
//! - Errors are those of the nominal stress over the largest of the same test, and every test counts alike, however many points it has.
//! - Stability is a condition of the fit, over the stretches of the data and those of everyday, in all three tests whatever was measured:
//!   Ogden's terms have a positive `mu`, which is enough at all stretches; of the other laws the stiffness against the softest further
//!   strain is held above a small share of the modulus at closely spaced stretches.
//! - What one kind of test says nothing of is not left to chance: then the choice is among laws of the first invariant.
//! - Laws are compared by blocks left out, not by what is left over of the fit, which more numbers always make smaller.

mod calibrate;
mod fit;
mod law_fit;
mod least_squares;
mod material_file;
mod measured;
pub(crate) mod test_table;
#[cfg(test)]
mod tests;

pub use calibrate::{Calibration, CalibrationRecord, Request};
pub use fit::{Choice, fit_laws};
pub use law_fit::LawFit;
pub use measured::{Measured, Point};
pub use test_table::read_tests;
