//! What drives a system: the equation that its load and the conjugate of the load obey.
//!
//! ```text
//! h(load, C; drive) = 0         dh/dload >= 0,  dh/dC >= 0
//! pressure given   load - drive
//! volume given     C - drive
//! closed gas       (1 + load / atmosphere) (C + dead) / (C0 + dead) - drive       isothermal, load is the excess pressure
//! ```
//!
//! An equilibrium with tangent `K` is stable under a supply when `K + k a a^T` has no negative pivot, `a = dC/dx`,
//! `k = (dh/dC) / (dh/dload)`. One added square cures at most one negative pivot, and cures it where
//! `dh/dload + dh/dC a^T K^-1 a < 0` (Sylvester; Haynsworth 1968).

use serde::{Deserialize, Serialize};

/// Which equation binds load and conjugate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Supply {
    /// The load is given.
    Load,
    /// The conjugate is given: a chamber filled with liquid. The load is the result.
    Conjugate,
    /// An amount of gas is given, as a multiple of what the part holds at rest; both load and conjugate result.
    Gas {
        /// Absolute pressure outside, and inside at rest (MPa).
        atmosphere: f64,
        /// Volume of the line that shares the gas (mm^3).
        dead_volume: f64,
        /// The conjugate at rest (mm^3).
        volume_at_rest: f64,
    },
}

/// The value of the equation and its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Equation {
    pub value: f64,
    pub by_load: f64,
    pub by_conjugate: f64,
    pub by_drive: f64,
}

impl Supply {
    /// The equation at a state.
    pub(super) fn equation(&self, load: f64, conjugate: f64, drive: f64) -> Equation {
        match *self {
            Self::Load => {
                Equation { value: load - drive, by_load: 1.0, by_conjugate: 0.0, by_drive: -1.0 }
            }
            Self::Conjugate => Equation {
                value: conjugate - drive,
                by_load: 0.0,
                by_conjugate: 1.0,
                by_drive: -1.0,
            },
            Self::Gas { atmosphere, dead_volume, volume_at_rest } => {
                let pressure = 1.0 + load / atmosphere;
                let volume = (conjugate + dead_volume) / (volume_at_rest + dead_volume);
                Equation {
                    value: pressure * volume - drive,
                    by_load: volume / atmosphere,
                    by_conjugate: pressure / (volume_at_rest + dead_volume),
                    by_drive: -1.0,
                }
            }
        }
    }

    /// The drive at which nothing is loaded yet, where the conjugate is `conjugate`.
    pub(super) fn at_rest(&self, conjugate: f64) -> f64 {
        match self {
            Self::Load => 0.0,
            Self::Conjugate => conjugate,
            Self::Gas { .. } => 1.0,
        }
    }
}

impl Equation {
    /// How many of a tangent's negative pivots the supply cures, `conjugate_rate = a^T K^-1 a`: 0 or 1.
    pub(super) fn cures(&self, conjugate_rate: f64) -> usize {
        usize::from(self.by_load + self.by_conjugate * conjugate_rate < 0.0)
    }

    /// The load's derivative with respect to the drive.
    pub(super) fn load_rate(&self, conjugate_rate: f64) -> f64 {
        -self.by_drive / (self.by_load + self.by_conjugate * conjugate_rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUPPLIES: [Supply; 3] = [
        Supply::Load,
        Supply::Conjugate,
        Supply::Gas { atmosphere: 0.1, dead_volume: 3.0, volume_at_rest: 10.0 },
    ];

    /// Central differences of equations that are at most bilinear are exact but for rounding.
    #[test]
    fn derivatives_are_differences() {
        for supply in SUPPLIES {
            let exact = supply.equation(0.2, 14.0, 2.5);
            let value = |load, conjugate, drive| supply.equation(load, conjugate, drive).value;
            let h = 1e-3;
            let by_load = (value(0.2 + h, 14.0, 2.5) - value(0.2 - h, 14.0, 2.5)) / (2.0 * h);
            let by_conjugate = (value(0.2, 14.0 + h, 2.5) - value(0.2, 14.0 - h, 2.5)) / (2.0 * h);
            let by_drive = (value(0.2, 14.0, 2.5 + h) - value(0.2, 14.0, 2.5 - h)) / (2.0 * h);
            assert!((by_load - exact.by_load).abs() < 1e-9 * exact.by_load.max(1.0));
            assert!((by_conjugate - exact.by_conjugate).abs() < 1e-9);
            assert!((by_drive - exact.by_drive).abs() < 1e-9);
        }
    }

    /// Boyle: twice the gas in an unchanged volume is twice the absolute pressure.
    #[test]
    fn nothing_is_loaded_at_rest() {
        for supply in SUPPLIES {
            assert!(supply.equation(0.0, 10.0, supply.at_rest(10.0)).value.abs() < 1e-15);
        }
        assert!(SUPPLIES[2].equation(0.1, 10.0, 2.0).value.abs() < 1e-15);
    }

    /// Beyond a pressure limit point (`dC/dload < 0`) a part is stable at given volume and not at given pressure; gas
    /// holds it as long as its own pressure falls faster with the volume than the part's.
    #[test]
    fn supplies_cure_one_pivot() {
        let cures = |supply: Supply, rate| supply.equation(0.1, 10.0, 2.0).cures(rate);
        assert_eq!(SUPPLIES.map(|supply| cures(supply, -500.0)), [0, 1, 1]);
        assert_eq!(SUPPLIES.map(|supply| cures(supply, -5.0)), [0, 1, 0]);
        assert_eq!(SUPPLIES.map(|supply| cures(supply, 5.0)), [0, 0, 0]);
    }
}
