//! What was measured on one rubber.

use crate::model::material::{Loading, NeoHookean, Rubber};

/// A state of a test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// The leading stretch.
    pub stretch: f64,
    /// Nominal stress, MPa.
    pub nominal: f64,
}

/// The points of each kind of test that was made, by rising stretch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    tests: Vec<(Loading, Vec<Point>)>,
}

impl Measured {
    /// Adds a point to the test of its kind.
    pub fn push(&mut self, loading: Loading, point: Point) {
        let at = self.tests.partition_point(|(kind, _)| *kind < loading);
        if self.tests.get(at).is_none_or(|(kind, _)| *kind != loading) {
            self.tests.insert(at, (loading, Vec::new()));
        }
        let points = &mut self.tests[at].1;
        let place = points.partition_point(|other| other.stretch <= point.stretch);
        points.insert(place, point);
    }

    /// Each kind of test with its points.
    pub fn tests(&self) -> impl Iterator<Item = (Loading, &[Point])> {
        self.tests.iter().map(|(loading, points)| (*loading, &points[..]))
    }

    /// How many points there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tests.iter().map(|(_, points)| points.len()).sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The least and the greatest stretch, rest among them.
    #[must_use]
    pub fn stretches(&self) -> [f64; 2] {
        let all = || self.tests.iter().flat_map(|(_, points)| points).map(|point| point.stretch);
        [all().fold(1.0, f64::min), all().fold(1.0, f64::max)]
    }

    /// The largest stress in size, MPa.
    #[must_use]
    pub fn largest_stress(&self) -> f64 {
        self.tests.iter().map(|(_, points)| largest(points)).fold(0.0, f64::max)
    }

    /// The errors of a law in all points, each over the largest stress of its test and weighted so that the sum of their squares is the
    /// mean over the tests of the mean square of each.
    pub(super) fn errors<'a>(&'a self, law: &'a Rubber) -> impl Iterator<Item = f64> + 'a {
        self.errors_as_part(law, self)
    }

    /// The same of points that are a part of `whole`, which has the largest stresses and the weights.
    pub(super) fn errors_as_part<'a>(
        &'a self,
        law: &'a Rubber,
        whole: &'a Self,
    ) -> impl Iterator<Item = f64> + 'a {
        self.tests.iter().flat_map(move |(loading, points)| {
            let all = whole.tests().find(|(kind, _)| kind == loading).map_or(&[][..], |it| it.1);
            let count = (all.len() * whole.tests.len()) as f64;
            let scale = 1.0 / (largest(all) * count.sqrt());
            points.iter().map(move |&Point { stretch, nominal }| {
                scale * (law.nominal_stress(*loading, stretch) - nominal)
            })
        })
    }

    /// The root of the mean square of the stress that a law misses, over all points, MPa.
    #[must_use]
    pub fn rms(&self, law: &Rubber) -> f64 {
        let square = |(loading, points): &(Loading, Vec<Point>)| -> f64 {
            let miss = |point: &Point| law.nominal_stress(*loading, point.stretch) - point.nominal;
            points.iter().map(|point| miss(point).powi(2)).sum()
        };
        (self.tests.iter().map(square).sum::<f64>() / self.len() as f64).sqrt()
    }

    /// The shear modulus of the neo-Hookean law that comes nearest at the smaller half of the strains, MPa.
    pub(super) fn modulus(&self) -> f64 {
        let unit = Rubber::from(NeoHookean { mu: 1.0 });
        let (mut product, mut square) = (0.0, 0.0);
        for (loading, points) in &self.tests {
            let mut points = points.clone();
            points.sort_by(|a, b| a.stretch.ln().abs().total_cmp(&b.stretch.ln().abs()));
            for point in &points[..points.len().div_ceil(2)] {
                let of_unit = unit.nominal_stress(*loading, point.stretch) / largest(&points);
                product += of_unit * point.nominal / largest(&points);
                square += of_unit * of_unit;
            }
        }
        product / square
    }

    /// The points without the `block`-th of `blocks` parts along the stretch of each test, and that part alone.
    pub(super) fn without_block(&self, block: usize, blocks: usize) -> [Self; 2] {
        let part = |is_within: bool| {
            let of = |(loading, points): &(Loading, Vec<Point>)| {
                let is_in = |place: usize| (place * blocks / points.len() == block) == is_within;
                let kept = points.iter().enumerate().filter(|(place, _)| is_in(*place));
                (*loading, kept.map(|(_, point)| *point).collect::<Vec<_>>())
            };
            let tests = self.tests.iter().map(of).filter(|(_, points)| !points.is_empty());
            Self { tests: tests.collect() }
        };
        [part(false), part(true)]
    }

    /// The points up to a stretch of `most`, and from its inverse on.
    #[must_use]
    pub fn up_to(&self, most: f64) -> Self {
        let mut kept = Self::default();
        for (loading, points) in self.tests() {
            let within = points.iter().filter(|at| (1.0 / most..=most).contains(&at.stretch));
            within.for_each(|point| kept.push(loading, *point));
        }
        kept
    }
}

/// The largest stress of a test in size, MPa; not 0, by which errors are divided.
fn largest(points: &[Point]) -> f64 {
    points.iter().map(|point| point.nominal.abs()).fold(f64::MIN_POSITIVE, f64::max)
}
