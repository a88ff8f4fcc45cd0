//! Quasi-Newton corrections: the BFGS update of a factorised tangent (Matthies & Strang 1979; Nocedal & Wright 2006, algorithm 7.4).
//!
//! ```text
//! H R,   H = (I - s y^T / s.y) H' (I - y s^T / s.y) + s s^T / s.y      s = change of x,  y = change of R;   H = K0^-1 before all updates
//! ```

use super::vectors::dot;

/// Changes of the state with those of the residual that belong to them.
#[derive(Debug, Default)]
pub(super) struct Secants {
    pairs: Vec<Pair>,
}

#[derive(Debug)]
struct Pair {
    s: Vec<f64>,
    y: Vec<f64>,
    /// `s . y`, mJ.
    curvature: f64,
}

impl Secants {
    pub(super) fn clear(&mut self) {
        self.pairs.clear();
    }

    /// Learns from a step `s` from the residual `before` to the one `after`; nothing from one along which the energy is not convex.
    pub(super) fn learn(&mut self, s: &[f64], before: &[f64], after: &[f64]) {
        let y: Vec<f64> = after.iter().zip(before).map(|(after, before)| after - before).collect();
        let curvature = dot(s, &y);
        if curvature > 0.0 {
            self.pairs.push(Pair { s: s.to_vec(), y, curvature });
        }
    }

    /// Overwrites `b [n]` by `H b`, where `solve` overwrites a vector by `K0^-1` times it.
    pub(super) fn solve(&self, b: &mut [f64], solve: impl FnOnce(&mut [f64])) {
        let mut shares = Vec::with_capacity(self.pairs.len());
        for Pair { s, y, curvature } in self.pairs.iter().rev() {
            let share = dot(s, b) / curvature;
            add(b, -share, y);
            shares.push(share);
        }
        solve(b);
        for (Pair { s, y, curvature }, share) in self.pairs.iter().zip(shares.iter().rev()) {
            let rest = share - dot(y, b) / curvature;
            add(b, rest, s);
        }
    }
}

fn add(b: &mut [f64], factor: f64, a: &[f64]) {
    b.iter_mut().zip(a).for_each(|(b, a)| *b += factor * a);
}

#[cfg(test)]
mod tests {
    use super::*;

    const S: [[f64; 3]; 2] = [[0.4, -0.1, 0.3], [-0.2, 0.5, 0.1]];
    const AFTER: [[f64; 3]; 2] = [[1.0, 0.5, 2.0], [0.1, 1.5, -0.2]];
    const BEFORE: [[f64; 3]; 2] = [[0.3, 0.7, 0.9], [0.6, 0.2, -0.5]];

    fn updated(b: [f64; 3]) -> [f64; 3] {
        let mut secants = Secants::default();
        for ((s, before), after) in S.iter().zip(&BEFORE).zip(&AFTER) {
            secants.learn(s, before, after);
        }
        let mut b = b;
        secants.solve(&mut b, |b| b.iter_mut().zip([4.0, 2.0, 1.0]).for_each(|(b, k)| *b /= k));
        b
    }

    /// The secant equation `H y = s` of the pair learnt last, and the symmetry of `H`: closed forms, up to rounding.
    #[test]
    fn update_maps_the_last_change_of_the_residual_to_its_step() {
        let y: [f64; 3] = std::array::from_fn(|k| AFTER[1][k] - BEFORE[1][k]);
        for (found, exact) in updated(y).iter().zip(S[1]) {
            assert!((found - exact).abs() < 1e-14, "{found} {exact}");
        }
        let (u, v) = ([1.0, -2.0, 0.5], [0.3, 0.8, -1.0]);
        assert!((dot(&updated(u), &v) - dot(&u, &updated(v))).abs() < 1e-14);
    }

    /// Along a step on which the forces fall the energy is not convex: `H` stays as it is, and positive definite.
    #[test]
    fn nothing_is_learnt_from_a_step_without_convexity() {
        let mut secants = Secants::default();
        secants.learn(&[1.0, 0.0], &[2.0, 0.0], &[1.0, 0.0]);
        let mut b = [3.0, 5.0];
        secants.solve(&mut b, |b| b.iter_mut().for_each(|b| *b *= 0.5));
        assert_eq!(b, [1.5, 2.5]);
    }
}
