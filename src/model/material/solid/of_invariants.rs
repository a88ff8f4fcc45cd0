//! Laws in the invariants of the stretches that leave the volume alone.
//!
//! ```text
//! psi_iso = psi(x) + d y,    x = J^(-2/3) I1 - 3,    y = J^(-4/3) I2 - 3
//! I1 = F : F,                    dI1 = 2 F,              d2I1 = 2 d_ik d_JL
//! I2 = (I1^2 - C : C) / 2,       dI2 = 2 (I1 F - F C),
//!      d2I2 = 2 (2 F_iJ F_kL - F_iL F_kJ + (I1 d_JL - C_JL) d_ik - B_ik d_JL)
//! q  = J^m I:   dq = J^m (dI + m I G),
//!      d2q = J^m (d2I + m (dI (x) G + G (x) dI) + m^2 I G (x) G - m I G_iL G_kJ)
//! ```
//!
//! with `C = F^T F`, `B = F F^T`, `G = F^-T` and `m = -2/3` for `I1`, `-4/3` for `I2`.

use nalgebra::Matrix3;

use super::response::{LOWER, SolidResponse, mirror};
use crate::math::cofactor;

/// `psi_iso` at `f`, MPa, of `psi(x)` and `d`, MPa.
pub(in crate::model::material) fn energy(
    f: &Matrix3<f64>,
    psi: impl Fn(f64) -> f64,
    d: f64,
) -> f64 {
    let q = f.determinant().cbrt().powi(-2);
    let i1 = f.norm_squared();
    let psi = psi(q * i1 - 3.0);
    if d == 0.0 {
        return psi;
    }
    let i2 = second_invariant(i1, &f.tr_mul(f));
    psi + d * (q * q * i2 - 3.0)
}

/// The same with its derivatives by `f`, of `psi` with its first and second derivative by `x`.
pub(in crate::model::material) fn response(
    f: &Matrix3<f64>,
    with_moduli: bool,
    psi: impl Fn(f64) -> [f64; 3],
    d: f64,
) -> SolidResponse {
    let cofactor = cofactor(f);
    let j = f.column(0).dot(&cofactor.column(0));
    let g = cofactor / j;
    let q = j.cbrt().powi(-2);
    let i1 = f.norm_squared();
    let [energy, d1, d11] = psi(q * i1 - 3.0);
    let first = (f - i1 / 3.0 * g) * (2.0 * q);
    let mut response = SolidResponse { energy, stress: d1 * first, moduli: Default::default() };
    let mut sum = Moduli {
        identity: 2.0 * d1 * q,
        crossed: 2.0 / 3.0 * d1 * q * i1,
        mixed: (f - i1 / 6.0 * g) * (-4.0 / 3.0 * d1 * q),
    };
    let mut second = None;
    if d != 0.0 {
        let c = f.tr_mul(f);
        let (i2, q2) = (second_invariant(i1, &c), q * q);
        let slope = i1 * f - f * c;
        response.energy += d * (q2 * i2 - 3.0);
        response.stress += (slope - 2.0 / 3.0 * i2 * g) * (2.0 * q2 * d);
        sum.crossed += 4.0 / 3.0 * d * q2 * i2;
        sum.mixed += (slope - i2 / 3.0 * g) * (-8.0 / 3.0 * d * q2);
        second = Some((2.0 * d * q2, i1 * Matrix3::identity() - c, f * f.transpose()));
    }
    if with_moduli {
        let moduli = &mut response.moduli;
        sum.write(&g, moduli);
        if d11 != 0.0 {
            add(moduli, |j, l| d11 * first.column(j) * first.column(l).transpose());
        }
        if let Some((factor, metric, b)) = second {
            add(moduli, |j, l| {
                let mut block = 2.0 * f.column(j) * f.column(l).transpose()
                    - f.column(l) * f.column(j).transpose();
                block += Matrix3::from_diagonal_element(metric[(j, l)]);
                if j == l {
                    block -= b;
                }
                factor * block
            });
        }
        mirror(moduli);
    }
    response
}

/// `identity d_ik d_JL + crossed G_iL G_kJ + mixed (x) G + G (x) mixed`: what all second derivatives have.
struct Moduli {
    identity: f64,
    crossed: f64,
    mixed: Matrix3<f64>,
}

impl Moduli {
    /// Writes the blocks on and below the diagonal.
    #[inline]
    fn write(&self, g: &Matrix3<f64>, moduli: &mut [[Matrix3<f64>; 3]; 3]) {
        for [j, l] in LOWER {
            let (gj, gl) = (g.column(j), g.column(l));
            let (mj, ml) = (self.mixed.column(j), self.mixed.column(l));
            moduli[j][l] = Matrix3::from_fn(|i, k| {
                mj[i] * gl[k] + gj[i] * ml[k] + self.crossed * (gl[i] * gj[k])
            });
            if j == l {
                moduli[j][l] += Matrix3::from_diagonal_element(self.identity);
            }
        }
    }
}

/// Adds to the blocks on and below the diagonal.
#[inline]
fn add(moduli: &mut [[Matrix3<f64>; 3]; 3], block: impl Fn(usize, usize) -> Matrix3<f64>) {
    for [j, l] in LOWER {
        moduli[j][l] += block(j, l);
    }
}

/// `I2` of the metric `c`, whose trace is `i1`.
#[inline]
fn second_invariant(i1: f64, c: &Matrix3<f64>) -> f64 {
    0.5 * (i1 * i1 - c.norm_squared())
}
