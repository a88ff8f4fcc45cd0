//! Who is better than whom: constraint domination, and the fronts that it makes.
//!
//! ```text
//! a dominates b  when  a is feasible and b is not,
//!                or    both are infeasible and a violates less,
//!                or    both are feasible, no objective of a is larger and one is smaller
//! ```
//!
//! Source: Deb, Pratap, Agarwal, Meyarivan (2002), IEEE Trans. Evol. Comput. 6:182-197, sections III.A and VI.A.

use super::individual::Evaluation;

/// Whether `a` dominates `b`.
///
/// # Panics
/// When both are feasible and their numbers of objectives differ.
#[must_use]
pub fn dominates(a: &Evaluation, b: &Evaluation) -> bool {
    match (a.is_feasible(), b.is_feasible()) {
        (true, true) => pareto_dominates(&a.objectives, &b.objectives),
        (false, false) => a.constraint_violation < b.constraint_violation,
        (a_is_feasible, _) => a_is_feasible,
    }
}

/// Whether no entry of `a [objective]` is larger than that of `b [objective]`, and one is smaller.
///
/// # Panics
/// When their numbers of objectives differ.
#[must_use]
pub fn pareto_dominates(a: &[f64], b: &[f64]) -> bool {
    weakly_dominates(a, b) && a.iter().zip(b).any(|(a, b)| a < b)
}

/// Whether no entry of `a [objective]` is larger than that of `b [objective]`.
///
/// # Panics
/// When their numbers of objectives differ.
#[must_use]
pub fn weakly_dominates(a: &[f64], b: &[f64]) -> bool {
    assert_eq!(a.len(), b.len(), "individuals are compared in the same objectives");
    a.iter().zip(b).all(|(a, b)| a <= b)
}

/// The indices of `evaluations [n]` in fronts, the best front first, each in ascending order.
///
/// No member of a front dominates another; each member of a later front is dominated by one of the front before.
/// The fast non-dominated sort: `O(objectives n^2)` comparisons.
///
/// # Panics
/// When two feasible evaluations differ in their number of objectives.
#[must_use]
pub fn fronts(evaluations: &[&Evaluation]) -> Vec<Vec<usize>> {
    let n = evaluations.len();
    let mut dominated: Vec<Vec<usize>> = vec![vec![]; n];
    let mut dominators = vec![0_usize; n];
    for a in 0..n {
        for b in 0..n {
            if dominates(evaluations[a], evaluations[b]) {
                dominated[a].push(b);
                dominators[b] += 1;
            }
        }
    }
    let mut fronts = vec![];
    let mut front: Vec<usize> = (0..n).filter(|i| dominators[*i] == 0).collect();
    while !front.is_empty() {
        let mut next = vec![];
        for a in &front {
            for b in &dominated[*a] {
                dominators[*b] -= 1;
                if dominators[*b] == 0 {
                    next.push(*b);
                }
            }
        }
        next.sort_unstable();
        fronts.push(std::mem::replace(&mut front, next));
    }
    fronts
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn feasible(objectives: &[f64]) -> Evaluation {
        Evaluation::feasible(objectives.to_vec())
    }

    fn fronts_of(evaluations: &[Evaluation]) -> Vec<Vec<usize>> {
        fronts(&evaluations.iter().collect::<Vec<_>>())
    }

    #[test]
    fn domination_needs_one_smaller_and_none_larger() {
        assert!(dominates(&feasible(&[1.0, 1.0]), &feasible(&[1.0, 2.0])));
        assert!(!dominates(&feasible(&[1.0, 2.0]), &feasible(&[1.0, 1.0])));
        assert!(!dominates(&feasible(&[1.0, 1.0]), &feasible(&[1.0, 1.0])));
        assert!(!dominates(&feasible(&[0.0, 2.0]), &feasible(&[1.0, 1.0])));
    }

    #[test]
    fn feasible_comes_first_then_the_smaller_violation() {
        let poor_but_feasible = feasible(&[9.0, 9.0]);
        let good_but_infeasible =
            Evaluation { objectives: vec![0.0, 0.0], constraint_violation: 0.1 };
        let worse = Evaluation::infeasible(0.2);
        assert!(dominates(&poor_but_feasible, &good_but_infeasible));
        assert!(!dominates(&good_but_infeasible, &poor_but_feasible));
        assert!(dominates(&good_but_infeasible, &worse));
        assert!(!dominates(&worse, &worse));
    }

    #[test]
    fn fronts_of_a_hand_made_set() {
        // Three staircases on a 4 x 4 grid, then two grades of infeasible; 1 and 6 are twins.
        let set = [
            feasible(&[2.0, 2.0]),
            feasible(&[1.0, 2.0]),
            feasible(&[3.0, 3.0]),
            feasible(&[2.0, 1.0]),
            Evaluation::infeasible(5.0),
            feasible(&[3.0, 1.0]),
            feasible(&[1.0, 2.0]),
            Evaluation::infeasible(1.0),
            feasible(&[0.0, 4.0]),
        ];
        assert_eq!(fronts_of(&set), [vec![1, 3, 6, 8], vec![0, 5], vec![2], vec![7], vec![4]]);
        assert!(fronts_of(&[]).is_empty());
    }

    proptest! {
        #[test]
        fn fronts_are_what_repeated_peeling_gives(
            // Small integers, so that ties are frequent.
            numbers in prop::collection::vec((0_u8..6, 0_u8..6, 0_u8..3), 0..40)
        ) {
            let set: Vec<Evaluation> = numbers
                .iter()
                .map(|(a, b, violation)| Evaluation {
                    objectives: vec![f64::from(*a), f64::from(*b)],
                    constraint_violation: f64::from(*violation),
                })
                .collect();
            let mut rest: Vec<usize> = (0..set.len()).collect();
            let mut peeled = vec![];
            while !rest.is_empty() {
                let (inner, front): (Vec<usize>, Vec<usize>) = rest
                    .iter()
                    .partition(|b| rest.iter().any(|a| dominates(&set[*a], &set[**b])));
                peeled.push(front);
                rest = inner;
            }
            prop_assert_eq!(fronts_of(&set), peeled);
        }
    }
}
