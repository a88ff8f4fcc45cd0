//! A compressible rubber in plane stress, its thickness found by a local solve.
//!
//! ```text
//! psi(T, J)    = min over s of psi_iso(e^(-2s/3) T, e^(-4s/3) J) + kappa/2 (V - 1)^2,    V = l1 l2 l3 = e^s
//! d psi / ds   = R + kappa V (V - 1) = 0,    R = -2/3 (T d/dT + 2 J d/dJ) psi_iso        (no stress across the wall)
//! psi_XY       = psi_XY - psi_Xs psi_Ys / psi_ss,    X, Y in {T, J}                          (the condensed tangent)
//! l3           = e^s / sqrt J
//! ```
//!
//! The stretches `V^(-1/3) l_i` leave the volume alone, so `psi_iso` is the incompressible law itself at the
//! invariants that they have. With the logarithm of the volume as the unknown no stress is a difference of large
//! numbers, however stiff the volume: `kappa / mu` from 0.3 to any size. Abaqus writes `kappa = 2 / D1`.
//!
//! Source: Flory (1961), the split; Simo & Hughes (1998), its energy of the volume.

use super::incompressible_law::IncompressibleLaw;
use super::of_invariants::OfInvariants;
use super::ogden::Ogden;
use super::rubber::Rubber;

/// An incompressible law's resistance to a change of shape, and a resistance to a change of volume.
#[derive(Clone, Debug, PartialEq)]
pub struct Compressible {
    /// The law of shape.
    pub law: Rubber,
    /// Bulk modulus at rest, MPa; at least 0.3 of the shear modulus.
    pub bulk_modulus: f64,
}

/// A Newton step below this leaves an error of its square, which is below rounding.
const LAST_STEP: f64 = 1e-8;
/// A step changes the volume by no more than this power of e, for the powers of stretches may overflow.
const LONGEST_STEP: f64 = 1.0;
/// The safeguard brackets and bisects after this many steps; the mean is 4 at strains of 0.2, the most 14 at stretches of 1/3 to 3.
/// A law that stiffens exponentially takes hundreds where its energy is beyond all use.
const NEWTON_STEPS: usize = 40;
/// Bisection takes some 60 steps from a bracket of 1 to rounding.
const MOST_STEPS: usize = 120;

impl Compressible {
    /// [`Ogden::ninjaflex_c2s`] with the decks' `D1 = 0.1`: a bulk modulus of 20 MPa, a Poisson's ratio of 0.380.
    ///
    /// # Decisions
    /// The decks also have `D2 = D3 = 0.1`; they add 1 % to the energy of the volume where it changes by a tenth,
    /// and are left out.
    #[must_use]
    pub fn ninjaflex_c2s() -> Self {
        Self { law: Rubber::Ogden(Ogden::ninjaflex_c2s()), bulk_modulus: 20.0 }
    }

    pub(super) fn density(&self, t: f64, j: f64) -> OfInvariants {
        let State { s, iso, rate, stiffness, .. } = self.without_normal_stress(t, j);
        let [r_t, r_j] = rate.first;
        let [tt, tj, jj] = iso.second;
        let condensed = OfInvariants {
            value: iso.value + 0.5 * self.bulk_modulus * s.exp_m1().powi(2),
            first: iso.first,
            second: [
                tt - r_t * r_t / stiffness,
                tj - r_t * r_j / stiffness,
                jj - r_j * r_j / stiffness,
            ],
        };
        of_stretched_invariants(condensed, s)
    }

    pub(super) fn energy(&self, t: f64, j: f64) -> f64 {
        let State { s, iso, .. } = self.without_normal_stress(t, j);
        iso.value + 0.5 * self.bulk_modulus * s.exp_m1().powi(2)
    }

    /// By the implicit function theorem for `d psi / ds (T, J, s) = 0`.
    pub(super) fn thickness_stretch(&self, t: f64, j: f64) -> OfInvariants {
        let State { s, t: iso_t, j: iso_j, stiffness, .. } = self.without_normal_stress(t, j);
        let r = self.law.dilation_rate(iso_t, iso_j);
        let dr = DilationRate::new(&r, iso_t, iso_j);
        let ddr = dilation_rate(dr.first, iso_t, iso_j);
        let volume = s.exp();
        let third = ddr + self.bulk_modulus * volume * (4.0 * volume - 1.0);
        let [s_t, s_j] = r.first.map(|r| -r / stiffness);
        let [r_st, r_sj] = dr.first;
        let log_volume = OfInvariants {
            value: s,
            first: [s_t, s_j],
            second: [
                -(r.second[0] + 2.0 * r_st * s_t + third * s_t * s_t) / stiffness,
                -(r.second[1] + r_st * s_j + r_sj * s_t + third * s_t * s_j) / stiffness,
                -(r.second[2] + 2.0 * r_sj * s_j + third * s_j * s_j) / stiffness,
            ],
        };
        let log_area = OfInvariants::of_j([-0.5 * j.ln(), -0.5 / j, 0.5 / (j * j)]);
        let log_thickness = of_stretched_invariants(log_volume, s) + log_area;
        log_thickness.chain([log_thickness.value.exp(); 3])
    }

    /// The state in which no stress acts across the wall; NaN where there is none, which a law with terms of
    /// both signs may have at extreme stretches.
    fn without_normal_stress(&self, t: f64, j: f64) -> State {
        let (mut lower, mut upper) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut state = self.state(t, j, self.hookean_log_volume(j));
        for step in 0..MOST_STEPS {
            let State { s, force, stiffness, .. } = state;
            let newton = if stiffness > 0.0 { -force / stiffness } else { f64::NAN };
            if newton.abs() < LAST_STEP {
                return self.state(t, j, s + newton);
            }
            if force > 0.0 {
                upper = s;
            } else {
                lower = s;
            }
            let next = s + newton.clamp(-LONGEST_STEP, LONGEST_STEP);
            let is_within = lower < next && next < upper;
            let is_bracketed = upper - lower < f64::INFINITY;
            let next = if is_within && step < NEWTON_STEPS {
                next
            } else if is_bracketed {
                0.5 * (lower + upper)
            } else {
                s - LONGEST_STEP.copysign(force)
            };
            state = self.state(t, j, next);
        }
        self.state(t, j, f64::NAN)
    }

    /// The `s` of Hooke's law in logarithmic strains, `(1 - 2 nu) / (1 - nu) ln(l1 l2)`.
    fn hookean_log_volume(&self, j: f64) -> f64 {
        let mu = self.law.shear_modulus();
        3.0 * mu / (3.0 * self.bulk_modulus + 4.0 * mu) * j.ln()
    }

    fn state(&self, t: f64, j: f64, s: f64) -> State {
        let q = (-2.0 / 3.0 * s).exp();
        let (t, j) = (q * t, q * q * j);
        let iso = self.law.density(t, j);
        let rate = DilationRate::new(&iso, t, j);
        let excess = s.exp_m1();
        let volume = 1.0 + excess;
        State {
            s,
            t,
            j,
            iso,
            rate,
            force: rate.value + self.bulk_modulus * volume * excess,
            stiffness: dilation_rate(rate.first, t, j)
                + self.bulk_modulus * volume * (volume + excess),
        }
    }
}

/// The wall at given `T`, `J` and logarithm of the volume ratio.
struct State {
    s: f64,
    /// The invariants of the stretches that leave the volume alone.
    t: f64,
    j: f64,
    /// `psi_iso` at them.
    iso: OfInvariants,
    rate: DilationRate,
    /// `d psi / ds` and `d2 psi / ds2`, MPa.
    force: f64,
    stiffness: f64,
}

/// The rate of a function along `s`, and that rate's slopes by `T` and `J`.
#[derive(Clone, Copy)]
struct DilationRate {
    value: f64,
    first: [f64; 2],
}

impl DilationRate {
    #[inline]
    fn new(f: &OfInvariants, t: f64, j: f64) -> Self {
        let [f_t, f_j] = f.first;
        let [f_tt, f_tj, f_jj] = f.second;
        Self {
            value: dilation_rate(f.first, t, j),
            first: [
                -2.0 / 3.0 * (f_t + t * f_tt + 2.0 * j * f_tj),
                -2.0 / 3.0 * (t * f_tj + 2.0 * f_j + 2.0 * j * f_jj),
            ],
        }
    }
}

/// The rate along `s` of a function with the slopes `f_t` and `f_j`.
#[inline]
fn dilation_rate([f_t, f_j]: [f64; 2], t: f64, j: f64) -> f64 {
    -2.0 / 3.0 * (t * f_t + 2.0 * j * f_j)
}

/// A function of `(e^(-2s/3) T, e^(-4s/3) J)` as one of `(T, J)`, at a fixed `s`.
#[inline]
fn of_stretched_invariants(f: OfInvariants, s: f64) -> OfInvariants {
    let q = (-2.0 / 3.0 * s).exp();
    let [t, j] = f.first;
    let [tt, tj, jj] = f.second;
    let q2 = q * q;
    OfInvariants {
        value: f.value,
        first: [q * t, q2 * j],
        second: [q2 * tt, q2 * q * tj, q2 * q2 * jj],
    }
}
