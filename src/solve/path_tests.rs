//! Paths of systems of two unknowns, whose equilibria are known in closed form, on every solver.

use super::{
    Backend, Ending, EquilibriumSolver, NewtonReport, NewtonSettings, Path, PathPoint,
    PathSettings, Programme, SolveTimes, SolverFailure, Supply, follow,
};
use crate::model::system::{
    Inadmissible, Limit, LimitKind, LoadedSystem, SparsityPattern, System, Utilization,
};

/// Energy, gradient and the lower triangle of the Hessian (xx, yx, yy) of two unknowns.
pub(super) struct Jet {
    pub value: f64,
    pub gradient: [f64; 2],
    pub hessian: [f64; 3],
}

/// `W(x, y) - load C(x, y)`.
pub(super) struct Plain {
    stored: fn([f64; 2]) -> Jet,
    conjugate: fn([f64; 2]) -> Jet,
    load: f64,
    pub limit: Option<(f64, LimitKind)>,
    /// What `x` may be.
    pub allowed: Option<f64>,
    pattern: SparsityPattern,
}

impl Plain {
    pub(super) fn new(stored: fn([f64; 2]) -> Jet, conjugate: fn([f64; 2]) -> Jet) -> Self {
        let pattern = SparsityPattern { column_starts: vec![0, 2, 3], row_indices: vec![0, 1, 1] };
        Self { stored, conjugate, load: 0.0, limit: None, allowed: None, pattern }
    }

    /// The path on every solver there is.
    pub(super) fn paths(
        mut self,
        programme: impl Into<Programme> + Copy,
        settings: &PathSettings,
    ) -> Vec<Path> {
        let backends = [Backend::Native, Backend::Petsc];
        backends
            .iter()
            .filter(|backend| backend.is_built_in())
            .map(|backend| {
                let mut solver: Box<dyn EquilibriumSolver> = backend.solver(&self.pattern).unwrap();
                follow(&mut self, solver.as_mut(), programme, Vec::new(), settings).unwrap()
            })
            .collect()
    }
}

impl System for Plain {
    fn pattern(&self) -> &SparsityPattern {
        &self.pattern
    }

    fn energy(&mut self, x: &[f64]) -> Result<f64, Inadmissible> {
        let x = [x[0], x[1]];
        Ok((self.stored)(x).value - self.load * (self.conjugate)(x).value)
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) -> Result<f64, Inadmissible> {
        let at = [x[0], x[1]];
        let (stored, conjugate) = ((self.stored)(at), (self.conjugate)(at));
        for (axis, residual) in residual.iter_mut().enumerate() {
            *residual = stored.gradient[axis] - self.load * conjugate.gradient[axis];
        }
        self.energy(x)
    }

    fn tangent(
        &mut self,
        x: &[f64],
        residual: &mut [f64],
        tangent: &mut [f64],
    ) -> Result<f64, Inadmissible> {
        let at = [x[0], x[1]];
        let (stored, conjugate) = ((self.stored)(at), (self.conjugate)(at));
        for (entry, tangent) in tangent.iter_mut().enumerate() {
            *tangent = stored.hessian[entry] - self.load * conjugate.hessian[entry];
        }
        self.residual(x, residual)
    }

    fn force_scale(&self) -> f64 {
        1.0
    }

    fn energy_rounding(&self) -> f64 {
        1e-16
    }
}

impl LoadedSystem for Plain {
    fn set_load(&mut self, load: f64) {
        self.load = load;
    }

    fn conjugate(&self, x: &[f64]) -> f64 {
        (self.conjugate)([x[0], x[1]]).value
    }

    fn load_direction(&self, x: &[f64], direction: &mut [f64]) {
        direction.copy_from_slice(&(self.conjugate)([x[0], x[1]]).gradient);
    }

    fn passed_limit(&self, x: &[f64]) -> Option<Limit> {
        let (bound, kind) = self.limit?;
        (x[0] > bound).then_some(Limit { kind, unknown: 0 })
    }

    fn utilization(&self, x: &[f64]) -> Option<Utilization> {
        Some(Utilization { share: x[0] / self.allowed?, unknown: 0 })
    }
}

/// The unknown `x` itself is what the load works on.
pub(super) fn along_x([x, _]: [f64; 2]) -> Jet {
    Jet { value: x, gradient: [1.0, 0.0], hessian: [0.0; 3] }
}

/// `(s^2 - 1)^2 / 4`, `s = x - 1`: bistable, at rest in the left well at `x = 0`; the force `s^3 - s` has its maximum
/// `2 / sqrt 27` at `s = -1 / sqrt 3`. `y` is a plain spring.
pub(super) fn bistable([x, y]: [f64; 2]) -> Jet {
    let s = x - 1.0;
    Jet {
        value: (s * s - 1.0).powi(2) / 4.0 + y * y / 2.0,
        gradient: [s.powi(3) - s, y],
        hessian: [3.0 * s * s - 1.0, 0.0, 1.0],
    }
}

pub(super) const LIMIT: f64 = 0.384_900_179_459_750_5;

/// Energy and work of the closed form on both sides of the jump; every state after it is in the right well.
#[test]
fn given_load_snaps_at_the_limit_point() {
    for path in Plain::new(bistable, along_x).paths(0.6, &PathSettings::default()) {
        assert_eq!(path.ending, Ending::SnappedAndContinued);
        let [[before, after]] = path.snaps().collect::<Vec<_>>()[..] else { panic!("one snap") };
        // A step is a 320th of 0.6.
        assert!(before.load < LIMIT && LIMIT < after.load && after.load < LIMIT + 0.6 / 160.0);
        assert!((path.limit_load().unwrap() / LIMIT - 1.0).abs() < 5e-3);
        let released = after.snap.unwrap().released;
        let energy = |x: f64| bistable([x, 0.0]).value;
        let exact = 0.5 * (before.load + after.load) * (after.x[0] - before.x[0])
            - (energy(after.x[0]) - energy(before.x[0]));
        assert!((released - exact).abs() < 1e-12 && released > 0.5, "{released} {exact}");
        for point in &path.points {
            let s = point.x[0] - 1.0;
            assert!((s.powi(3) - s - point.load).abs() < 1e-9);
            assert_eq!(s > 1.0, point.load > LIMIT);
            // What the load did is stored, or was given off; Hermite's cubics are of fourth order.
            let audit = point.work - point.stored_energy - point.dissipated;
            assert!(audit.abs() < 1e-3 * point.work.max(1e-12), "{audit}");
        }
        let samples: Vec<f64> =
            path.points.iter().filter(|p| p.is_sample).map(|p| p.load).collect();
        assert_eq!(samples.len(), 11, "{samples:?}");
    }
}

/// Where the conjugate is given, the same system goes through its limit points, and is stable all the way.
#[test]
fn given_conjugate_passes_limit_points() {
    let programme = Programme::Driven { supply: Supply::Conjugate, end: 2.4 };
    for path in Plain::new(bistable, along_x).paths(programme, &PathSettings::default()) {
        assert_eq!(path.ending, Ending::Reached);
        for point in &path.points {
            let s = point.x[0] - 1.0;
            assert!((s.powi(3) - s - point.load).abs() < 1e-9);
            assert_eq!(point.negative_pivots, usize::from(3.0 * s * s < 1.0));
            assert!(point.is_stable);
        }
        let found = path.limit_load().unwrap();
        // Steps of 0.24, the error of a cubic's top: 0.24^4 / 384 times the fourth derivative, 0 here.
        assert!((found / LIMIT - 1.0).abs() < 1e-3, "{found}");
    }
}

/// A soft line behind the system turns the conjugate back too: only an arc follows, through both limit points.
#[test]
fn arc_passes_snap_back() {
    // y = 1.6 load, so that the conjugate x + y turns back where the load falls steeply.
    fn stored([x, y]: [f64; 2]) -> Jet {
        let jet = bistable([x, 0.0]);
        let hessian = [jet.hessian[0], 0.0, 1.0 / 1.6];
        let gradient = [jet.gradient[0], y / 1.6];
        Jet { value: jet.value + y * y / 3.2, gradient, hessian }
    }
    fn conjugate([x, y]: [f64; 2]) -> Jet {
        Jet { value: x + y, gradient: [1.0, 1.0], hessian: [0.0; 3] }
    }
    let curve = Programme::Curve { end: 0.6 };
    for path in Plain::new(stored, conjugate).paths(curve, &PathSettings::default()) {
        assert_eq!(path.ending, Ending::Reached);
        for point in &path.points {
            let s = point.x[0] - 1.0;
            assert!((s.powi(3) - s - point.load).abs() < 1e-8);
            assert_eq!(point.is_stable, 3.0 * s * s > 1.0);
        }
        assert!(path.points.iter().any(|point| point.load < -0.9 * LIMIT));
        assert!((path.limit_load().unwrap() / LIMIT - 1.0).abs() < 1e-3);
    }
    // Given the conjugate, the same system jumps.
    let programme = Programme::Driven { supply: Supply::Conjugate, end: 3.0 };
    for path in Plain::new(stored, conjugate).paths(programme, &PathSettings::default()) {
        assert_eq!(path.ending, Ending::SnappedAndContinued);
        assert!(path.points.iter().all(|point| point.is_stable));
    }
}

/// A rigid bar on a spring of 1 at its foot, a stiff line in series: it tilts at the load 1, where `y = load sin y`.
#[test]
fn perfect_bar_buckles() {
    fn stored([x, y]: [f64; 2]) -> Jet {
        Jet {
            value: 50.0 * x * x + y * y / 2.0,
            gradient: [100.0 * x, y],
            hessian: [100.0, 0.0, 1.0],
        }
    }
    fn conjugate([x, y]: [f64; 2]) -> Jet {
        Jet { value: x + 1.0 - y.cos(), gradient: [1.0, y.sin()], hessian: [0.0, 0.0, y.cos()] }
    }
    for path in Plain::new(stored, conjugate).paths(1.5, &PathSettings::default()) {
        assert_eq!(path.ending, Ending::SnappedAndContinued);
        let [[before, after]] = path.snaps().collect::<Vec<_>>()[..] else { panic!("one snap") };
        assert!(after.snap.unwrap().from_bifurcation);
        assert!(before.load <= 1.0 && after.load > 1.0 && after.load - before.load < 1.5 / 19.0);
        let last = path.points.last().unwrap();
        assert!((last.x[1] - last.load * last.x[1].sin()).abs() < 1e-8 && last.x[1].abs() > 1.0);
    }
}

/// The force `x exp(-x^2 / 2)` is never more than at `x = 1`: beyond, the part flies until it passes its bound.
#[test]
fn flight_without_an_equilibrium_balloons() {
    fn stored([x, y]: [f64; 2]) -> Jet {
        let bell = (-x * x / 2.0).exp();
        Jet {
            value: -bell + y * y / 2.0,
            gradient: [x * bell, y],
            hessian: [(1.0 - x * x) * bell, 0.0, 1.0],
        }
    }
    let mut system = Plain::new(stored, along_x);
    system.limit = Some((20.0, LimitKind::Ballooning));
    for path in system.paths(1.0, &PathSettings::default()) {
        assert_eq!((path.ending, path.place), (Ending::Ballooning, Some(0)));
        let exact = (-0.5_f64).exp();
        let last = path.points.last().unwrap().load;
        assert!(last < exact && exact - last < 1.0 / 160.0, "{last}");
    }
}

/// A thin neo-Hookean sphere of stretch `1 + x`: `W = 2 l^2 + l^-4 - 3`, `C = l^3 - 1` and `p = 4/3 (1/l - l^-7)`, which is never more
/// than `8 7^(-7/6)` at `l = 7^(1/6)`.
pub(super) fn sphere([x, y]: [f64; 2]) -> Jet {
    let l = 1.0 + x;
    Jet {
        value: 2.0 * l * l + l.powi(-4) - 3.0 + y * y / 2.0,
        gradient: [4.0 * l - 4.0 * l.powi(-5), y],
        hessian: [4.0 + 20.0 * l.powi(-6), 0.0, 1.0],
    }
}

pub(super) fn volume_of_sphere([x, _]: [f64; 2]) -> Jet {
    let l = 1.0 + x;
    Jet { value: l.powi(3) - 1.0, gradient: [3.0 * l * l, 0.0], hessian: [6.0 * l, 0.0, 0.0] }
}

/// It balloons at its maximum, found to a 320th of the load and never beyond it, whatever the load asked for. Past a limit point the
/// volume grows by doubling, so that from 1.6 to the 215 of the bound it takes some seven steps; a fall takes hundreds of iterations.
#[test]
fn inflated_sphere_balloons_cheaply_at_its_limit() {
    let exact = 8.0 * 7.0_f64.powf(-7.0 / 6.0);
    for load in [0.9, 1.2, 3.0] {
        let mut system = Plain::new(sphere, volume_of_sphere);
        system.limit = Some((5.0, LimitKind::Ballooning));
        for path in system.paths(load, &PathSettings::default()) {
            assert_eq!((path.ending, path.place, path.fell), (Ending::Ballooning, Some(0), true));
            let found = path.limit_load().unwrap();
            assert!(found <= exact && exact - found < load / 319.0, "{found} {exact}");
            assert!(path.points.iter().all(|point| point.is_stable && point.negative_pivots == 0));
            for PathPoint { x, load, .. } in &path.points {
                let l = 1.0 + x[0];
                assert!((4.0 / 3.0 * (1.0 / l - l.powi(-7)) - load).abs() < 1e-8);
            }
            assert!(path.counts.newton_iterations < 120, "{:?}", path.counts);
        }
    }
}

/// With a wall that stiffens, `W + 1e-3 (l^2 - 1)^3`, the load comes back to its maximum: the sphere jumps and goes on.
#[test]
fn inflated_sphere_that_stiffens_snaps() {
    fn stiffening([x, y]: [f64; 2]) -> Jet {
        let (jet, l) = (sphere([x, y]), 1.0 + x);
        let strain = l * l - 1.0;
        let second = 1e-3 * (6.0 * strain * strain + 24.0 * l * l * strain);
        Jet {
            value: jet.value + 1e-3 * strain.powi(3),
            gradient: [jet.gradient[0] + 6e-3 * l * strain * strain, y],
            hessian: [jet.hessian[0] + second, 0.0, 1.0],
        }
    }
    let mut system = Plain::new(stiffening, volume_of_sphere);
    system.limit = Some((19.0, LimitKind::Ballooning));
    for path in system.paths(1.2, &PathSettings::default()) {
        assert_eq!(path.ending, Ending::SnappedAndContinued);
        let [[before, after]] = path.snaps().collect::<Vec<_>>()[..] else { panic!("one snap") };
        let load_at = |l: f64| stiffening([l - 1.0, 0.0]).gradient[0] / (3.0 * l * l);
        let maximum = (1000..2000).map(|k| load_at(f64::from(k) * 1e-3)).fold(0.0, f64::max);
        assert!(before.load <= maximum && maximum - before.load < 1.2 / 160.0);
        assert!((load_at(1.0 + after.x[0]) - after.load).abs() < 1e-8 && after.x[0] > 1.0);
    }
}

/// Stands before a solver and counts what is asked of it.
struct Counted {
    solver: Box<dyn EquilibriumSolver>,
    iterations: usize,
    linearized: usize,
    solved: usize,
}

impl EquilibriumSolver for Counted {
    fn solve(
        &mut self,
        system: &mut dyn System,
        x: &mut [f64],
        settings: &NewtonSettings,
    ) -> Result<NewtonReport, SolverFailure> {
        let report = self.solver.solve(system, x, settings)?;
        self.iterations += report.iterations;
        Ok(report)
    }

    fn linearize(&mut self, system: &mut dyn System, x: &[f64]) -> Result<usize, SolverFailure> {
        self.linearized += 1;
        self.solver.linearize(system, x)
    }

    fn solve_linearized(&mut self, b: &mut [f64]) -> Result<(), SolverFailure> {
        self.solved += 1;
        self.solver.solve_linearized(b)
    }

    fn is_invertible(&self) -> bool {
        self.solver.is_invertible()
    }

    fn times(&self) -> SolveTimes {
        self.solver.times()
    }

    fn factorizations(&self) -> usize {
        self.solver.factorizations()
    }
}

/// Each point linearises once and solves once for its rates, each iteration of state and load together once and twice: so the solver
/// knows how many there were. A path counts them all, and says of each whether it led to a point.
#[test]
fn every_iteration_is_counted() {
    for limit in [None, Some((5.0, LimitKind::Ballooning))] {
        let mut system = Plain::new(sphere, volume_of_sphere);
        system.limit = limit;
        let solver = Backend::Native.solver(&system.pattern).unwrap();
        let mut solver = Counted { solver, iterations: 0, linearized: 0, solved: 0 };
        let settings = PathSettings::default();
        let path = follow(&mut system, &mut solver, 1.2, Vec::new(), &settings).unwrap();
        let together = solver.solved - solver.linearized;
        let counts = path.counts;
        assert_eq!(counts.newton_iterations, solver.iterations + together);
        assert_eq!(counts.factorizations, solver.factorizations());
        assert!(counts.factorizations >= counts.newton_iterations);
        // Points know what was spent since the one before: theirs, and what failed before them.
        let until_last: usize = path.points.iter().map(|point| point.newton_iterations).sum();
        let useful = counts.newton_iterations - counts.failed_iterations;
        assert!(useful <= until_last && until_last < counts.newton_iterations, "{counts:?}");
        assert!(counts.failed_iterations > 0);
    }
}

/// A budget ends a path by its name, with what was reached; no attempt goes on for long after it.
#[test]
fn spent_budget_ends_a_path_with_what_was_reached() {
    let settings = PathSettings { iteration_budget: 20, ..PathSettings::default() };
    for path in Plain::new(sphere, volume_of_sphere).paths(1.2, &settings) {
        assert_eq!(path.ending, Ending::BudgetSpent);
        assert!(path.ending.leaves_an_answer());
        let samples = path.points.iter().filter(|point| point.is_sample && point.load > 0.0);
        assert!(samples.count() > 0);
        let most = settings.iteration_budget + settings.newton.max_iterations;
        assert!(path.counts.newton_iterations <= most, "{:?}", path.counts);
    }
}

/// A bound met on a stable path ends it within the smallest step.
#[test]
fn bounds_end_a_path() {
    let mut system = Plain::new(bistable, along_x);
    system.limit = Some((0.2, LimitKind::SelfTouch));
    for path in system.paths(0.3, &PathSettings::default()) {
        assert_eq!((path.ending, path.place), (Ending::SelfTouch, Some(0)));
        let at_bound = (-0.8_f64).powi(3) + 0.8;
        let last = path.points.last().unwrap().load;
        assert!(last <= at_bound && at_bound - last < 0.3 / 160.0, "{last} {at_bound}");
    }
}

/// Gas of a closed chamber against a linear spring: `(1 + p / a) V = m` and `p = V - 1` with `V0 = 1, a = 0.5`.
#[test]
fn gas_expands_against_a_spring() {
    fn stored([x, y]: [f64; 2]) -> Jet {
        Jet { value: (x * x + y * y) / 2.0, gradient: [x, y], hessian: [1.0, 0.0, 1.0] }
    }
    fn volume([x, _]: [f64; 2]) -> Jet {
        Jet { value: 1.0 + x, gradient: [1.0, 0.0], hessian: [0.0; 3] }
    }
    let supply = Supply::Gas { atmosphere: 0.5, dead_volume: 0.0, volume_at_rest: 1.0 };
    let programme = Programme::Driven { supply, end: 4.0 };
    for path in Plain::new(stored, volume).paths(programme, &PathSettings::default()) {
        assert_eq!(path.ending, Ending::Reached);
        for point in &path.points {
            // V (1 + 2 (V - 1)) = m.
            let exact = 0.25 * (1.0 + (1.0 + 8.0 * point.drive).sqrt());
            assert!((point.conjugate - exact).abs() < 1e-8, "{} {exact}", point.conjugate);
        }
        assert_eq!(path.points.len(), path.points.iter().filter(|p| p.is_sample).count());
    }
}
