//! Loads with a potential.

mod chamber_pressure;

pub use chamber_pressure::ChamberPressure;
