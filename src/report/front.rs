//! The Pareto front, twice: in the first two objectives, and on the axes on which the literature is compared.
//!
//! Left: the first objective against the second, with everything evaluated behind the front.
//! Right: Smith et al. (2022), Fig. 3, both axes logarithmic; a design whose force or angle is not
//! positive stands on the edge, as a ring. A front in the left panel need not be one in the right.

use plotters::prelude::*;
use serde::{Serialize, Serializer};

use super::canvas::{
    self, Area, Drawn, Frame, INK, Mark, OTHERS, OURS, SMITH, Shape, linear_range, log_range,
};
use super::literature::{Published, Set, Technique, published};
use crate::io::csv::{self, Cell, Cells};

/// One design of the front as the figures and tables show it.
#[derive(Clone, Debug, PartialEq)]
pub struct FrontPoint {
    /// The design's name.
    pub id: String,
    /// Its objectives, at least two: the first two are the axes of figures, and stand first in tables.
    pub objectives: Vec<Column>,
    /// Bending angle per pressure and length, deg/(kPa m).
    pub figure_of_merit: f64,
    /// Largest blocking force, N.
    pub max_force: f64,
    /// Reasons to doubt its objectives, separated by spaces; empty where there are none.
    pub flags: String,
    /// What it reached, where that is known.
    pub reached: Option<Reached>,
    /// Where it is judged at a pressure of its own: that, and what it is at a pressure that all are told at.
    pub rated: Option<RatedColumns>,
    /// Of each objective by how much it is off for the mesh, as a second mesh estimates, %, or `None` if that gives nothing to compare;
    /// empty where nothing was estimated. Of tables for people alone.
    pub mesh_errors: Vec<Option<f64>>,
}

/// How many objectives are axes of figures.
const AXES: usize = 2;

impl FrontPoint {
    /// The objectives that are axes of figures.
    #[must_use]
    pub fn leading(&self) -> &[Column] {
        &self.objectives[..AXES]
    }

    /// The other objectives.
    #[must_use]
    pub fn further(&self) -> &[Column] {
        &self.objectives[AXES..]
    }

    /// Its place in figures: the first two objectives.
    #[must_use]
    pub fn place(&self) -> [f64; 2] {
        [self.objectives[0].value, self.objectives[1].value]
    }
}

/// What a design reached at the pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// Chord angle of the tip at the end of the first scenario's path, degrees.
    pub angle_deg: f64,
    /// Of each scenario the name of its column and the pressure at the end of its path, MPa: below the run's where the part itself ended
    /// the path.
    pub pressures: Vec<(String, f64)>,
}

/// The pressure of its own at which a design is judged, and its numbers at another one.
#[derive(Clone, Debug, PartialEq)]
pub struct RatedColumns {
    /// MPa.
    pub pressure: f64,
    /// Names of columns with the numbers at the reference pressure; `None` where the design does not come to that.
    pub at_reference: Vec<(String, Option<f64>)>,
}

impl RatedColumns {
    /// The number of the column `reference_` and `name`.
    #[must_use]
    pub fn reading(&self, name: &str) -> Option<f64> {
        let is_it = |(column, _): &&(String, _)| column.strip_prefix("reference_") == Some(name);
        self.at_reference.iter().find(is_it)?.1
    }
}

/// A design's value of an objective.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// What stands above it in files.
    pub name: &'static str,
    /// Its symbol, where it has one.
    pub symbol: Option<&'static str>,
    /// Its unit.
    pub unit: &'static str,
    /// The value.
    pub value: f64,
}

impl Column {
    /// What stands above it in tables: the symbol, or the name in words.
    #[must_use]
    pub fn title(&self) -> String {
        self.symbol.map_or_else(|| self.name.replace('_', " "), str::to_owned)
    }
}

/// What stands at the axis of a figure: the name of an objective with its symbol and unit.
#[must_use]
pub fn axis_label(name: &str, symbol: Option<&str>, unit: &str) -> String {
    let words = [Some(name.replace('_', " ")), symbol.map(str::to_owned)];
    let words: Vec<String> = words.into_iter().flatten().collect();
    format!("{}, {}", words.join(" "), unit.replace(' ', "·"))
}

impl Cells for FrontPoint {
    fn cells(&self) -> Vec<(String, Cell<'_>)> {
        let number = |name: &str, value| (name.to_owned(), Cell::Number(value));
        let objective = |column: &Column| number(column.name, column.value);
        let mut cells = vec![("id".to_owned(), Cell::Word(&self.id))];
        cells.extend(self.leading().iter().map(objective));
        cells.push(number("figure_of_merit", self.figure_of_merit));
        cells.push(number("max_force", self.max_force));
        cells.push(("flags".to_owned(), Cell::Word(&self.flags)));
        cells.extend(self.further().iter().map(objective));
        if let Some(Reached { angle_deg, pressures }) = &self.reached {
            cells.push(number("angle_deg", *angle_deg));
            cells.extend(pressures.iter().map(|(name, pressure)| number(name, *pressure)));
        }
        if let Some(RatedColumns { pressure, at_reference }) = &self.rated {
            cells.push(number("rated_pressure", *pressure));
            let told = |(name, value): &(String, Option<f64>)| {
                (name.clone(), value.map_or(Cell::Nothing, Cell::Number))
            };
            cells.extend(at_reference.iter().map(told));
        }
        cells
    }
}

impl Serialize for FrontPoint {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        csv::as_map(self, serializer)
    }
}

/// The figure of a `front` over what stands at its `axes` ([`axis_label`]), with every evaluated pair of these objectives and the front of
/// `solids` if there is one, as SVG.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn front_svg(
    axes: &[String; 2],
    front: &[FrontPoint],
    evaluated: &[[f64; 2]],
    solids: &[FrontPoint],
) -> String {
    canvas::svg((1240, 640), |area| {
        let (panels, legend) = area.split_vertically(536);
        let (left, right) = panels.split_horizontally(620);
        draw_objectives(area, &left, axes, front, evaluated, solids)?;
        draw_comparison(area, &right, front, solids)?;
        draw_legends(&legend, !solids.is_empty())
    })
}

/// The figure of the fronts of two runs with these `names`, over what stands at its `axes`, as SVG.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn two_fronts_svg(axes: &[String; 2], names: [&str; 2], fronts: [&[FrontPoint]; 2]) -> String {
    let marks = [FRONT, Mark { shape: Shape::Square, color: SMITH, radius: 4 }];
    canvas::svg((780, 600), |area| {
        let (panel, legend) = area.split_vertically(536);
        let is_finite = |[x, y]: &[f64; 2]| x.is_finite() && y.is_finite();
        let fronts = fronts.map(|front| -> Vec<([f64; 2], &str)> {
            front.iter().map(FrontPoint::place).filter(is_finite).map(|at| (at, "")).collect()
        });
        let all = || fronts.iter().flatten();
        let x = linear_range(all().map(|(at, _)| at[0]));
        let y = linear_range(all().map(|(at, _)| at[1]));
        let mut chart = canvas::panel(&panel, "Fronts of two runs")?.build_cartesian_2d(x, y)?;
        canvas::draw_axes(&mut chart, &axes[0], &axes[1])?;
        for (front, mark) in fronts.iter().zip(marks) {
            let line = mark.color.mix(0.45).stroke_width(1);
            chart.draw_series(LineSeries::new(staircase(front), line))?;
            for ([x, y], _) in front {
                mark.draw(area, chart.backend_coord(&(*x, *y)))?;
            }
        }
        let columns = [0, 1].map(|k| vec![(marks[k], names[k])]);
        canvas::draw_legend(&legend.margin(8, 0, 90, 0), &columns, 330)
    })
}

const FRONT: Mark = Mark { shape: Shape::Disk, color: OURS, radius: 5 };
const ON_EDGE: Mark = Mark { shape: Shape::Ring, color: OURS, radius: 5 };
const SOLIDS: Mark = Mark { shape: Shape::Square, color: INK, radius: 4 };
const EVALUATED: Mark = Mark { shape: Shape::Disk, color: RGBColor(205, 210, 216), radius: 2 };
/// The band around a mark that a label may not cover, pixels.
const CLEARANCE: i32 = 5;

fn draw_objectives(
    whole: &Area<'_>,
    panel: &Area<'_>,
    axes: &[String; 2],
    front: &[FrontPoint],
    evaluated: &[[f64; 2]],
    solids: &[FrontPoint],
) -> Drawn {
    let is_finite = |[x, y]: &[f64; 2]| x.is_finite() && y.is_finite();
    let solids = solids.iter().map(FrontPoint::place);
    let solids: Vec<_> = solids.filter(is_finite).map(|at| (at, "")).collect();
    let named: Vec<_> = front
        .iter()
        .map(|point| (point.place(), point.id.as_str()))
        .filter(|(at, _)| is_finite(at))
        .collect();
    let evaluated: Vec<_> = evaluated.iter().copied().filter(is_finite).collect();
    let all = named.iter().chain(&solids).map(|(at, _)| at).chain(&evaluated);

    let x = linear_range(all.clone().map(|at| at[0]));
    let y = linear_range(all.map(|at| at[1]));
    let mut chart = canvas::panel(panel, "Objectives of this run")?.build_cartesian_2d(x, y)?;
    canvas::draw_axes(&mut chart, &axes[0], &axes[1])?;
    for at in &evaluated {
        EVALUATED.draw(whole, chart.backend_coord(&(at[0], at[1])))?;
    }
    chart.draw_series(LineSeries::new(staircase(&named), OURS.mix(0.45).stroke_width(1)))?;
    chart.draw_series(LineSeries::new(staircase(&solids), INK.mix(0.45).stroke_width(1)))?;
    for (at, _) in &solids {
        SOLIDS.draw(whole, chart.backend_coord(&(at[0], at[1])))?;
    }
    let marks: Vec<_> =
        named.iter().map(|(at, id)| (chart.backend_coord(&(at[0], at[1])), *id)).collect();
    draw_front(whole, frame_of(chart.plotting_area()), Vec::new(), marks)
}

fn draw_comparison(
    whole: &Area<'_>,
    panel: &Area<'_>,
    front: &[FrontPoint],
    solids: &[FrontPoint],
) -> Drawn {
    let others = published();
    let axis = |value: fn(&FrontPoint) -> f64, of_others: fn(&Published) -> f64| {
        let ours = front.iter().chain(solids).map(value);
        let values: Vec<f64> = ours.chain(others.iter().map(of_others)).collect();
        log_range(values.iter().copied().filter(|value| *value > 0.0 && value.is_finite()))
    };
    let x = axis(|point| point.figure_of_merit, |point| point.figure_of_merit);
    let y = axis(|point| point.max_force, |point| point.max_force);
    let least = [x.start, y.start];
    let mut chart = canvas::panel(panel, "Against the literature (Smith et al. 2022, Fig. 3)")?
        .build_cartesian_2d(x.log_scale(), y.log_scale())?;
    canvas::draw_axes(&mut chart, "figure of merit, deg/(kPa·m)", "largest force, N")?;
    let mut taken = Vec::new();
    for point in &others {
        let at = chart.backend_coord(&(point.figure_of_merit, point.max_force));
        mark_of(point).draw(whole, at)?;
        taken.push(Frame::around(at, CLEARANCE));
    }
    // Nothing, which has no logarithm, stands where the axis begins.
    let place = |point: &FrontPoint| {
        let at = [point.figure_of_merit, point.max_force];
        let is_known = at.iter().all(|value| value.is_finite());
        let is_inside = at.iter().all(|value| *value > 0.0);
        let [x, y] = [0, 1].map(|k| at[k].max(least[k]));
        is_known.then(|| (chart.backend_coord(&(x, y)), is_inside))
    };
    for (at, is_inside) in solids.iter().filter_map(place) {
        let shape = if is_inside { SOLIDS.shape } else { Shape::HollowSquare };
        Mark { shape, ..SOLIDS }.draw(whole, at)?;
    }
    let placed = front.iter().filter_map(|point| Some((place(point)?, point.id.as_str())));
    let (inside, on_edge): (Vec<_>, Vec<_>) = placed.partition(|((_, is_inside), _)| *is_inside);
    for ((at, _), _) in &on_edge {
        ON_EDGE.draw(whole, *at)?;
        taken.push(Frame::around(*at, CLEARANCE));
    }
    if !on_edge.is_empty() {
        let Frame(left, top, ..) = frame_of(chart.plotting_area());
        let words = "rings on the edge: no force, or no angle";
        let at = (left + 8, top + 4);
        whole.draw(&Text::new(words, at, canvas::letters(11.0, OURS)))?;
    }
    let marks = inside.into_iter().map(|((at, _), id)| (at, id)).collect();
    draw_front(whole, frame_of(chart.plotting_area()), taken, marks)
}

/// Draws the front's marks and as many of its names as there is room for, its ends first.
fn draw_front(
    whole: &Area<'_>,
    frame: Frame,
    mut taken: Vec<Frame>,
    mut marks: Vec<((i32, i32), &str)>,
) -> Drawn {
    for (at, _) in &marks {
        Mark { color: WHITE, radius: FRONT.radius + 1, ..FRONT }.draw(whole, *at)?;
        FRONT.draw(whole, *at)?;
        taken.push(Frame::around(*at, CLEARANCE));
    }
    marks.sort_unstable();
    if marks.len() > 2 {
        let last = marks.len() - 1;
        marks.swap(1, last);
    }
    canvas::draw_labels(whole, frame, taken, &marks)
}

/// The border of what the points dominate, both objectives maximised.
fn staircase(points: &[([f64; 2], &str)]) -> Vec<(f64, f64)> {
    let mut descending: Vec<_> = points.iter().map(|(at, _)| *at).collect();
    descending.sort_by(|a, b| b[0].total_cmp(&a[0]).then(b[1].total_cmp(&a[1])));
    let mut path: Vec<(f64, f64)> = Vec::new();
    for [x, y] in descending {
        match path.last() {
            Some(&(_, highest)) if y <= highest => {}
            Some(&(_, highest)) => path.extend([(x, highest), (x, y)]),
            None => path.push((x, y)),
        }
    }
    path
}

fn mark_of(point: &Published) -> Mark {
    let (shape, color, radius) = match (point.set, point.technique) {
        (Set::SmithShellFront, _) => (Shape::HollowSquare, SMITH, 4),
        (Set::SmithSolidFront, _) => (Shape::Square, SMITH, 4),
        (Set::SmithPrinted, _) => (Shape::Triangle, SMITH, 6),
        (Set::Literature2020, _) => (Shape::Ring, OTHERS, 3),
        (Set::Literature2022, Technique::FilamentPrinted) => (Shape::Diamond, OTHERS, 6),
        (Set::Literature2022, Technique::ResinOrSiliconePrinted) => (Shape::Triangle, OTHERS, 5),
        (Set::Literature2022, _) => (Shape::Disk, OTHERS, 4),
    };
    Mark { shape, color, radius }
}

fn draw_legends(area: &Area<'_>, with_solids: bool) -> Drawn {
    let mark = |shape, color, radius| Mark { shape, color, radius };
    let mut ours = vec![(FRONT, "front of this run"), (EVALUATED, "evaluated designs")];
    if with_solids {
        ours.push((SOLIDS, "front as solids"));
    }
    let columns = [
        ours,
        vec![
            (mark(Shape::HollowSquare, SMITH, 4), "Smith 2022, shell front"),
            (mark(Shape::Square, SMITH, 4), "Smith 2022, front as solids"),
            (mark(Shape::Triangle, SMITH, 6), "Smith 2022, printed"),
        ],
        vec![
            (mark(Shape::Disk, OTHERS, 4), "literature, cast"),
            (mark(Shape::Triangle, OTHERS, 5), "literature, printed resin or silicone"),
            (mark(Shape::Diamond, OTHERS, 6), "literature, printed filament"),
        ],
        vec![(mark(Shape::Ring, OTHERS, 3), "literature, in Hainsworth 2020")],
    ];
    canvas::draw_legend(&area.margin(8, 0, 90, 0), &columns, 270)
}

fn frame_of<X: Ranged, Y: Ranged>(area: &DrawingArea<SVGBackend<'_>, Cartesian2d<X, Y>>) -> Frame {
    let (x, y) = area.get_pixel_range();
    Frame(x.start, y.start, x.end, y.end)
}

#[cfg(test)]
impl FrontPoint {
    /// A design with these objectives, of which nothing else is known.
    pub(super) fn of([bending, blocking]: [f64; 2]) -> Self {
        let column = |name, symbol, unit, value| Column { name, symbol: Some(symbol), unit, value };
        Self {
            id: String::new(),
            objectives: vec![
                column("bending", "F_c", "rad/(m J)^(1/p)", bending),
                column("blocking", "F_bf", "N/kPa", blocking),
            ],
            figure_of_merit: 0.0,
            max_force: 0.0,
            flags: String::new(),
            reached: None,
            rated: None,
            mesh_errors: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(i: u32, max_force: f64) -> FrontPoint {
        let t = f64::from(i);
        FrontPoint {
            id: format!("design-{i}"),
            figure_of_merit: 3.0 * t,
            max_force,
            ..FrontPoint::of([0.1 * t, 0.5 - 0.1 * t])
        }
    }

    fn front_svg(front: &[FrontPoint], evaluated: &[[f64; 2]], solids: &[FrontPoint]) -> String {
        let axes = ["bending", "blocking"].map(|name| axis_label(name, None, "a b"));
        super::front_svg(&axes, front, evaluated, solids)
    }

    /// The centres of the front's marks, in the order drawn.
    fn marks(svg: &str) -> Vec<(i32, i32)> {
        let number = |line: &str, key: &str| {
            let value = line.split(key).nth(1).unwrap().split('"').next().unwrap();
            value.parse::<i32>().unwrap()
        };
        svg.lines()
            .filter(|line| line.starts_with("<circle") && line.contains("fill=\"#C8202F\""))
            .map(|line| (number(line, "cx=\""), number(line, "cy=\"")))
            .collect()
    }

    #[test]
    fn every_design_has_its_mark_and_name_in_both_panels() {
        let front = [point(1, 9.0), point(2, 3.0), point(4, 1.0)];
        let svg = front_svg(&front, &[[0.0, 0.0], [0.2, 0.1]], &[]);
        let marks = marks(&svg);
        // Three in each panel and one in the legend.
        assert_eq!(marks.len(), 7);
        for point in &front {
            assert_eq!(svg.matches(point.id.as_str()).count(), 2);
        }
        // Linear in the left panel, logarithmic in the right, each to a pixel of rounding; y points down.
        let [a, b, c] = [marks[0], marks[1], marks[2]];
        assert!(
            (c.0 - b.0 - 2 * (b.0 - a.0)).abs() <= 2 && (c.1 - b.1 - 2 * (b.1 - a.1)).abs() <= 2
        );
        assert!(b.0 > a.0 && b.1 > a.1);
        let [a, b, c] = [marks[3], marks[4], marks[5]];
        assert!((c.0 - b.0 - (b.0 - a.0)).abs() <= 1 && (c.1 - b.1 - (b.1 - a.1)).abs() <= 1);
        assert!(b.0 > a.0 && b.1 > a.1);
    }

    #[test]
    fn the_same_numbers_make_the_same_bytes() {
        let front = [point(1, 9.0), point(2, 3.0)];
        let svg = |front: &[FrontPoint]| front_svg(front, &[[0.1, 0.1]], &[]);
        assert_eq!(svg(&front), svg(&front));
        assert_ne!(svg(&front), svg(&front[..1]));
    }

    /// A design without force or angle is a ring on the edge of the right panel; what is no number has no place.
    #[test]
    fn what_has_no_logarithm_stands_on_the_edge() {
        let svg =
            front_svg(&[point(1, 0.0), point(2, f64::NAN), point(3, 1.0)], &[[f64::NAN, 0.0]], &[]);
        assert_eq!(marks(&svg).len(), 3 + 1 + 1);
        let rings = svg
            .lines()
            .filter(|line| line.starts_with("<circle") && line.contains("stroke=\"#C8202F\""));
        assert_eq!(rings.count(), 1);
        assert!(svg.contains("rings on the edge"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert_eq!(marks(&front_svg(&[], &[], &[])).len(), 1);
    }

    #[test]
    fn two_fronts_have_a_mark_each() {
        let svg = two_fronts_svg(
            &["x", "y"].map(str::to_owned),
            ["runs/a", "runs/b"],
            [&[point(1, 9.0)], &[point(2, 3.0), point(3, 1.0)]],
        );
        assert!(svg.contains("runs/a") && svg.contains("runs/b"));
        // One and two in the panel, one each in the legend.
        assert_eq!(marks(&svg).len(), 2);
        assert_eq!(svg.matches("fill=\"#3E6A9E\"").count(), 3);
    }

    #[test]
    fn axes_have_names_symbols_and_units() {
        let bending = axis_label("bending", Some("F_c"), "rad/(m J)^(1/p)");
        assert_eq!(bending, "bending F_c, rad/(m·J)^(1/p)");
        assert_eq!(axis_label("wall_volume", None, "cm^3"), "wall volume, cm^3");
    }

    #[test]
    fn the_staircase_bounds_what_is_dominated() {
        let at = |x: f64, y: f64| ([x, y], "");
        let path = staircase(&[at(1.0, 3.0), at(2.0, 2.0), at(1.5, 1.0), at(3.0, 1.0)]);
        assert_eq!(path, [(3.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0), (1.0, 3.0)]);
    }
}
