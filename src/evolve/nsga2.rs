//! NSGA-II: elitist non-dominated sorting, asked for a generation and told how good it is.
//!
//! ```text
//! generation 0:  random
//! generation g:  parents by tournament -> children by crossover and mutation
//!                population = best of (population + children)
//! ```
//!
//! Source: Deb, Pratap, Agarwal, Meyarivan (2002), IEEE Trans. Evol. Comput. 6:182-197.
//! Settings make it behave as MATLAB's `gamultiobj`, which limits the share of the best front and adapts its mutation.

use rand::{Rng, RngExt};

use super::checkpoint::{Checkpoint, InvalidCheckpoint};
use super::individual::{Candidate, Evaluation, Individual, IndividualId};
use super::selection::{Ranking, controlled_survivors, survivors};
use super::settings::{Breeding, InvalidSettings, Nsga2Settings, Survival};
use super::spread::{Adaptation, spread};
use crate::genome::Representation;
use crate::math::random::{Purpose, Stream};

/// A run of NSGA-II between two generations.
#[derive(Clone, Debug, PartialEq)]
pub struct Nsga2<R: Representation> {
    settings: Nsga2Settings,
    representation: R,
    objectives: usize,
    /// Generations told so far.
    generation: usize,
    /// Empty before the first generation is told, then of the size that the settings say.
    population: Vec<Individual<R::Genome>>,
    adaptation: Adaptation,
}

impl<R: Representation> Nsga2<R> {
    /// A run before its first generation, over genomes of a `representation`, with so many
    /// `objectives`.
    ///
    /// # Errors
    /// [`InvalidSettings`] as [`Nsga2Settings::validate`] says.
    ///
    /// # Panics
    /// When `objectives` is 0.
    pub fn new(
        settings: Nsga2Settings,
        representation: R,
        objectives: usize,
    ) -> Result<Self, InvalidSettings> {
        assert!(objectives > 0, "a run has objectives");
        settings.validate()?;
        let (generation, population, adaptation) = (0, Vec::new(), Adaptation::FIRST);
        Ok(Self { settings, representation, objectives, generation, population, adaptation })
    }

    /// The run that a checkpoint was taken of.
    ///
    /// # Errors
    /// [`InvalidCheckpoint`] when its format is another or its parts contradict each other.
    pub fn resume(checkpoint: Checkpoint<R>) -> Result<Self, InvalidCheckpoint> {
        checkpoint.check()?;
        let Checkpoint { settings, representation, objectives, generation, .. } = checkpoint;
        let Checkpoint { population, adaptation, .. } = checkpoint;
        Ok(Self { settings, representation, objectives, generation, population, adaptation })
    }

    /// The next generation's candidates `[population]`, in the order of their ids.
    ///
    /// Asking changes nothing: the answer is the same until the run is told.
    #[must_use]
    pub fn ask(&self) -> Vec<Candidate<R::Genome>> {
        let ranking = Ranking::of(&self.population);
        (0..self.settings.population)
            .map(|index| Candidate {
                id: IndividualId { generation: self.generation, index },
                genome: self.genome(index, &ranking),
            })
            .collect()
    }

    /// Receives how good the candidates of [`Self::ask`] are, in their order `[population]`, and keeps the best.
    ///
    /// A candidate with a number that is not finite counts as [`Evaluation::failed`].
    ///
    /// # Panics
    /// When the number of evaluations is not that of the candidates, or when one has another number of objectives
    /// (none is allowed where a constraint is violated).
    pub fn tell(&mut self, evaluations: Vec<Evaluation>) {
        let candidates = self.ask();
        let before = self.front_objectives();
        assert_eq!(evaluations.len(), candidates.len(), "one evaluation for each candidate");
        for (Candidate { id, genome }, evaluation) in candidates.into_iter().zip(evaluations) {
            let evaluation = evaluation.made_finite();
            assert!(
                evaluation.is_of(self.objectives),
                "{id} has {} objectives, not {}",
                evaluation.objectives.len(),
                self.objectives
            );
            self.population.push(Individual { id, genome, evaluation });
        }
        let (merged, count) = (std::mem::take(&mut self.population), self.settings.population);
        self.population = match self.settings.survival {
            Survival::Elitist => survivors(merged, count),
            Survival::Controlled => {
                controlled_survivors(merged, count, self.settings.pareto_fraction)
            }
        };
        let spread = spread(&self.front_objectives(), &before);
        self.adaptation = self.adaptation.next(self.generation, spread);
        self.generation += 1;
    }

    /// The number of generations told, which is that of the next generation.
    #[must_use]
    pub fn generation(&self) -> usize {
        self.generation
    }

    /// Whether all generations of the settings have been told.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.generation >= self.settings.generations
    }

    /// The settings of the run.
    #[must_use]
    pub fn settings(&self) -> &Nsga2Settings {
        &self.settings
    }

    /// What the genomes of the run are.
    #[must_use]
    pub fn representation(&self) -> &R {
        &self.representation
    }

    /// The survivors of the last generation told, the best first; none before the first.
    #[must_use]
    pub fn population(&self) -> &[Individual<R::Genome>] {
        &self.population
    }

    /// The feasible survivors that no other dominates, by rising first objective; none if all are infeasible.
    #[must_use]
    pub fn front(&self) -> Vec<&Individual<R::Genome>> {
        let ranking = Ranking::of(&self.population);
        let mut front: Vec<_> = self
            .population
            .iter()
            .zip(ranking.rank)
            .filter(|(individual, rank)| *rank == 0 && individual.evaluation.is_feasible())
            .map(|(individual, _)| individual)
            .collect();
        let first = |one: &Individual<R::Genome>| one.evaluation.objectives[0];
        front.sort_by(|a, b| first(a).total_cmp(&first(b)).then(a.id.cmp(&b.id)));
        front
    }

    /// How steady and how even the front is, as [`spread`] says.
    #[must_use]
    pub fn spread(&self) -> f64 {
        self.adaptation.spread
    }

    fn front_objectives(&self) -> Vec<Vec<f64>> {
        self.front().iter().map(|individual| individual.evaluation.objectives.clone()).collect()
    }

    /// All that the run needs to go on.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint<R> {
        Checkpoint {
            format: Checkpoint::<R>::FORMAT,
            settings: self.settings.clone(),
            key: Some(self.representation.key().to_owned()),
            representation: self.representation.clone(),
            objectives: self.objectives,
            generation: self.generation,
            population: self.population.clone(),
            adaptation: self.adaptation,
        }
    }

    /// The genome of candidate `index` of the next generation.
    fn genome(&self, index: usize, ranking: &Ranking) -> R::Genome {
        let stream = Stream::new(self.settings.seed);
        let rng = |purpose| stream.keyed(purpose, self.generation as u64, index as u64);
        if self.population.is_empty() {
            return self.representation.random(&mut rng(Purpose::Creation));
        }
        let (mut selection, mut variation) = (rng(Purpose::Selection), rng(Purpose::Variation));
        let mut child = || self.child(index, ranking, &mut selection, &mut variation);
        let is_new = |child: &R::Genome| self.population.iter().all(|one| one.genome != *child);
        // A copy would be an evaluation wasted; where all draws are copies, the last one is taken.
        (1..DRAWS).map(|_| child()).find(is_new).unwrap_or_else(&mut child)
    }

    /// One draw of candidate `index` of the next generation.
    fn child(
        &self,
        index: usize,
        ranking: &Ranking,
        selection: &mut impl Rng,
        variation: &mut impl Rng,
    ) -> R::Genome {
        let [first, second] =
            ranking.two_parents(selection).map(|parent| &self.population[parent].genome);
        let operators = self.settings.operators(self.adaptation.step);
        match self.settings.breeding {
            Breeding::CrossoverOrMutation => {
                if index < self.settings.mutants(self.generation) {
                    self.representation.mutate(first, &operators, variation)
                } else {
                    self.representation.mix([first, second], &operators, variation)
                }
            }
            Breeding::CrossoverThenMutation => {
                if variation.random_bool(self.settings.crossover_probability) {
                    let child = self.representation.mix([first, second], &operators, variation);
                    self.representation.mutate(&child, &operators, variation)
                } else {
                    self.representation.mutate(first, &operators, variation)
                }
            }
        }
    }
}

/// Draws of one child until it is no copy.
const DRAWS: usize = 20;

#[cfg(test)]
mod tests {
    use super::super::hypervolume::hypervolume;
    use super::*;
    use crate::genome::{Bounds, Crossover};

    struct Problem {
        bounds: Vec<(f64, f64)>,
        evaluate: fn(&[f64]) -> Evaluation,
    }

    /// Zitzler, Deb, Thiele (2000), with 10 genes: front `f2 = 1 - sqrt(f1)`.
    fn zdt1() -> Problem {
        Problem { bounds: vec![(0.0, 1.0); 10], evaluate: |x| zdt(x, |ratio| 1.0 - ratio.sqrt()) }
    }

    /// Zitzler, Deb, Thiele (2000), with 10 genes: front `f2 = 1 - f1^2`.
    fn zdt2() -> Problem {
        Problem { bounds: vec![(0.0, 1.0); 10], evaluate: |x| zdt(x, |ratio| 1.0 - ratio * ratio) }
    }

    fn zdt(x: &[f64], shape: fn(f64) -> f64) -> Evaluation {
        let g = 1.0 + 9.0 * x[1..].iter().sum::<f64>() / (x.len() - 1) as f64;
        Evaluation::feasible(vec![x[0], g * shape(x[0] / g)])
    }

    /// Deb et al. (2002), problem CONSTR; the violation is the sum of both constraints'.
    fn constr() -> Problem {
        Problem {
            bounds: vec![(0.1, 1.0), (0.0, 5.0)],
            evaluate: |x| Evaluation {
                objectives: vec![x[0], (1.0 + x[1]) / x[0]],
                constraint_violation: (6.0 - x[1] - 9.0 * x[0]).max(0.0)
                    + (1.0 + x[1] - 9.0 * x[0]).max(0.0),
            },
        }
    }

    fn settings(generations: usize) -> Nsga2Settings {
        Nsga2Settings { generations, ..Nsga2Settings::default() }
    }

    fn deb(generations: usize) -> Nsga2Settings {
        Nsga2Settings { breeding: Breeding::CrossoverThenMutation, ..settings(generations) }
    }

    fn start(problem: &Problem, settings: Nsga2Settings) -> Nsga2<Bounds> {
        Nsga2::new(settings, Bounds::new(problem.bounds.clone()).unwrap(), 2).unwrap()
    }

    fn step(problem: &Problem, run: &mut Nsga2<Bounds>) {
        let evaluations = run.ask().iter().map(|c| (problem.evaluate)(&c.genome)).collect();
        run.tell(evaluations);
    }

    fn finished(problem: &Problem, settings: Nsga2Settings) -> Nsga2<Bounds> {
        let mut run = start(problem, settings);
        while !run.is_finished() {
            step(problem, &mut run);
        }
        run
    }

    fn front_points(run: &Nsga2<Bounds>) -> Vec<[f64; 2]> {
        run.front()
            .iter()
            .map(|individual| {
                [individual.evaluation.objectives[0], individual.evaluation.objectives[1]]
            })
            .collect()
    }

    /// The mean distance from 1000 points of the true front to the nearest point found.
    fn inverted_generational_distance(front: impl Fn(f64) -> [f64; 2], found: &[[f64; 2]]) -> f64 {
        let distance = |[a, b]: [f64; 2]| {
            found.iter().map(|[c, d]| (a - c).hypot(b - d)).fold(f64::INFINITY, f64::min)
        };
        (0..1000).map(|i| distance(front(f64::from(i) / 999.0))).sum::<f64>() / 1000.0
    }

    /// How much hypervolume may be missing: three times what the best front of 60 points misses.
    ///
    /// A staircase below `f2(f1)` misses triangles of `|f2'| h^2 / 2`; the best steps `h ~ |f2'|^-1/2` leave
    /// `(integral of |f2'|^1/2)^2 / (2 * 60)`. Crowding spaces a front unevenly: 1.5 to 2.3 times were seen.
    fn tolerated_loss(integral_of_root_slope: f64) -> f64 {
        3.0 * integral_of_root_slope.powi(2) / (2.0 * 60.0)
    }

    /// The distance to the nearest of 60 even points on a front of `length` is a quarter of their distance on average;
    /// a front that is twice as coarse passes.
    fn tolerated_distance(length: f64) -> f64 {
        2.0 * length / (4.0 * 60.0)
    }

    fn assert_hypervolume(run: &Nsga2<Bounds>, reference: [f64; 2], exact: f64, loss: f64) {
        let found = hypervolume(&front_points(run), &reference);
        // No front can have more than the exact one.
        assert!(
            found < exact && found > exact - loss,
            "{found} is not below {exact} by up to {loss}"
        );
    }

    #[test]
    fn zdt1_is_solved() {
        for seed in 1..=3 {
            let run = finished(&zdt1(), Nsga2Settings { seed, ..deb(100) });
            // 1.1^2 less the integral of 1 - sqrt(f), 1/3; integral of (2 sqrt(f))^-1/2 = 4/(3 sqrt(2)).
            let loss = tolerated_loss(4.0 / (3.0 * 2_f64.sqrt()));
            assert_hypervolume(&run, [1.1, 1.1], 1.21 - 1.0 / 3.0, loss);
            let distance =
                inverted_generational_distance(|t| [t * t, 1.0 - t], &front_points(&run));
            assert!(distance < tolerated_distance(PARABOLA), "{distance}");
        }
    }

    #[test]
    fn zdt2_is_solved() {
        for seed in 1..=3 {
            // As many as Deb et al. (2002), section V, let it take: of 31 seeds with 30 genes half hold the end of the front alone after 100.
            let run = finished(&zdt2(), Nsga2Settings { seed, ..deb(250) });
            // 1.1^2 less the integral of 1 - f^2, 2/3; integral of (2 f)^1/2 = 2 sqrt(2)/3.
            let loss = tolerated_loss(2.0 * 2_f64.sqrt() / 3.0);
            assert_hypervolume(&run, [1.1, 1.1], 1.21 - 2.0 / 3.0, loss);
            let distance =
                inverted_generational_distance(|t| [t, 1.0 - t * t], &front_points(&run));
            assert!(distance < tolerated_distance(PARABOLA), "{distance}");
        }
    }

    /// Length of `y = x^2` over `[0, 1]`: `sqrt(5)/2 + asinh(2)/4`.
    const PARABOLA: f64 = 1.478_942_857_544_597;

    #[test]
    fn a_front_on_a_constraint_is_found_by_either_breeding() {
        // f2 = 7/f1 - 9 on the first constraint for f1 in [7/18, 2/3], then 1/f1 up to 1; reference (1, 9).
        let exact = 8.0 - 7.0 * (12_f64 / 7.0).ln() - 1.5_f64.ln();
        let loss = tolerated_loss(7_f64.sqrt() * (12_f64 / 7.0).ln() + 1.5_f64.ln());
        for settings in [settings(100), deb(100)] {
            let run = finished(&constr(), settings);
            assert_hypervolume(&run, [1.0, 9.0], exact, loss);
        }
    }

    #[test]
    fn the_front_is_feasible_undominated_and_sorted() {
        let problem = constr();
        let mut run = start(&problem, settings(10));
        assert!(run.front().is_empty() && run.population().is_empty());
        while !run.is_finished() {
            step(&problem, &mut run);
            let points = front_points(&run);
            assert!(points.windows(2).all(|p| p[0][0] <= p[1][0] && p[0][1] >= p[1][1]));
            assert!(run.front().iter().all(|individual| individual.evaluation.is_feasible()));
            assert_eq!(run.population().len(), 60);
        }
        assert_eq!(run.generation(), 10);
    }

    #[test]
    fn the_hypervolume_of_a_front_that_fits_never_falls() {
        // As long as the first front is smaller than the population none of its members is dropped.
        let problem = zdt1();
        let mut run = start(&problem, deb(20));
        let mut last = 0.0;
        while !run.is_finished() {
            step(&problem, &mut run);
            if run.front().len() == run.population().len() {
                break;
            }
            let found = hypervolume(&front_points(&run), &[1.1, 11.0]);
            assert!(found >= last);
            last = found;
        }
        assert!(run.generation() > 5 && last > 0.0);
    }

    #[test]
    fn a_run_is_its_seed() {
        let run = |seed| finished(&zdt1(), Nsga2Settings { seed, ..settings(5) });
        assert_eq!(run(1), run(1));
        assert_ne!(run(1).population(), run(2).population());
    }

    #[test]
    fn asking_changes_nothing_and_names_the_candidates() {
        let problem = zdt1();
        let mut run = start(&problem, settings(5));
        for generation in 0..5 {
            let candidates = run.ask();
            assert_eq!(candidates, run.ask());
            assert!(candidates.iter().all(|c| run.representation.contains(&c.genome)));
            assert_eq!(candidates[17].id.to_string(), format!("g00{generation}-017"));
            step(&problem, &mut run);
        }
    }

    #[test]
    fn a_run_resumed_from_json_goes_on_with_the_same_bits() {
        for (problem, settings) in
            [(zdt1(), settings(30)), (zdt2(), deb(30)), (constr(), settings(30))]
        {
            let uninterrupted = finished(&problem, settings.clone());
            let mut run = start(&problem, settings);
            while !run.is_finished() {
                step(&problem, &mut run);
                if run.generation().is_multiple_of(7) {
                    let json = serde_json::to_string(&run.checkpoint()).unwrap();
                    run = Nsga2::resume(serde_json::from_str(&json).unwrap()).unwrap();
                }
            }
            // JSON keeps every bit: it writes the shortest decimal that reads as the same number, and -0.0.
            let json = |run: &Nsga2<Bounds>| serde_json::to_string(&run.checkpoint()).unwrap();
            assert!(json(&run) == json(&uninterrupted), "the resumed run went another way");
        }
    }

    #[test]
    fn a_checkpoint_that_contradicts_itself_is_refused() {
        let mut run = start(&zdt1(), settings(5));
        step(&zdt1(), &mut run);
        type Damage = fn(&mut Checkpoint<Bounds>);
        let damages: [(Damage, &str); 12] = [
            (|c| c.format = 1, "format is 1"),
            (|c| c.key = Some("paper-22".to_owned()), "`paper-22`, not `real-vector`"),
            (|c| c.adaptation.step = 2.0, "its step is 2"),
            (|c| c.adaptation.spread = f64::NAN, "its spread NaN"),
            (|c| c.settings.population = 2, "`population` is 2"),
            (|c| c.settings.population = 50, "60 individuals after 1 generations, not 50"),
            (|c| c.generation = 0, "60 individuals after 0 generations, not 0"),
            (|c| c.objectives = 0, "no objectives"),
            (|c| c.objectives = 3, "not one of 3 objectives"),
            (|c| c.population[0].genome[0] = 1.5, "not in the bounds"),
            (|c| c.population[0].genome.clear(), "not in the bounds"),
            (|c| c.population[0].evaluation.constraint_violation = -1.0, "not one of 2 objectives"),
        ];
        for (damage, sentence) in damages {
            let mut checkpoint = run.checkpoint();
            damage(&mut checkpoint);
            let error = Nsga2::resume(checkpoint).unwrap_err().to_string();
            assert!(error.contains(sentence), "{error}");
        }
        // Earlier versions wrote no key.
        let without_key = Checkpoint { key: None, ..run.checkpoint() };
        assert_eq!(Nsga2::resume(without_key), Ok(run.clone()));
        assert_eq!(Nsga2::resume(run.checkpoint()), Ok(run));
    }

    #[test]
    fn a_population_of_failures_searches_on_by_violation() {
        // Nothing is feasible and no objective is ever given; the violation falls towards x = 0.
        let problem = Problem {
            bounds: vec![(0.0, 1.0); 3],
            evaluate: |x| Evaluation::infeasible(1.0 + x.iter().sum::<f64>()),
        };
        let run = finished(&problem, settings(30));
        assert!(run.front().is_empty());
        assert!(run.population()[0].evaluation.constraint_violation < 1.01);
    }

    #[test]
    fn a_plateau_of_equal_violation_does_not_stop_the_drift() {
        let problem = Problem { bounds: vec![(0.0, 1.0); 3], evaluate: |_| Evaluation::failed() };
        let run = finished(&problem, settings(10));
        assert!(run.population().iter().all(|individual| individual.id.generation == 9));
    }

    #[test]
    fn a_number_that_is_not_finite_costs_the_candidate_not_the_run() {
        let problem = Problem {
            bounds: vec![(-1.0, 1.0); 2],
            evaluate: |x| Evaluation::feasible(vec![x[0].sqrt(), 1.0 - x[0] + x[1] * x[1]]),
        };
        let run = finished(&problem, settings(20));
        assert_eq!(run.front().len(), 60);
        assert!(run.front().iter().all(|individual| individual.genome[0] >= 0.0));
    }

    #[test]
    fn mutants_and_mixtures_come_in_the_shares_asked_for() {
        // The first parents share no gene. So a mixture differs from each in all genes, and a mutant from one in one.
        for (switch_generation, mutants) in [(2, 48), (1, 12)] {
            let settings = Nsga2Settings {
                crossover: Crossover::Intermediate,
                mutation_probability: Some(0.0),
                switch_generation,
                ..settings(4)
            };
            let mut run = start(&zdt1(), settings);
            step(&zdt1(), &mut run);
            let differing = |child: &Candidate<Vec<f64>>, parent: &Individual<Vec<f64>>| {
                child.genome.iter().zip(&parent.genome).filter(|(c, p)| c != p).count()
            };
            let least: Vec<usize> = run
                .ask()
                .iter()
                .map(|child| run.population().iter().map(|p| differing(child, p)).min().unwrap())
                .collect();
            let expected: Vec<usize> = (0..60).map(|i| if i < mutants { 1 } else { 10 }).collect();
            assert_eq!(least, expected);
        }
    }

    #[test]
    #[should_panic(expected = "one evaluation for each candidate")]
    fn too_few_evaluations_are_a_mistake() {
        start(&zdt1(), settings(5)).tell(vec![Evaluation::failed(); 59]);
    }

    #[test]
    #[should_panic(expected = "g000-000 has 1 objectives, not 2")]
    fn another_number_of_objectives_is_a_mistake() {
        start(&zdt1(), settings(5)).tell(vec![Evaluation::feasible(vec![1.0]); 60]);
    }
}
