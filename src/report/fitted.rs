//! Laws beside the tests that they were fitted to: nominal stress over stretch.

use plotters::prelude::*;

use super::canvas::{self, Area, Drawn, INK, Mark, OTHERS, OURS, SMITH, Shape, linear_range};

/// One kind of test, as it was measured and as the laws have it.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedTest {
    /// Its name.
    pub name: &'static str,
    /// Stretch and nominal stress (MPa).
    pub measured: Vec<[f64; 2]>,
    /// The laws, the same in every test.
    pub curves: Vec<FittedCurve>,
}

/// A law in one test.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedCurve {
    /// Its name.
    pub name: &'static str,
    /// Whether it is the one to use.
    pub is_chosen: bool,
    /// Stretch and nominal stress (MPa).
    pub points: Vec<[f64; 2]>,
}

/// Of laws that are not chosen, the first, second and so on.
const COLORS: [RGBColor; 6] = [
    OTHERS,
    RGBColor(218, 145, 26),
    SMITH,
    RGBColor(46, 139, 87),
    RGBColor(130, 90, 160),
    RGBColor(90, 180, 190),
];
/// Width of a panel, pixels.
const PANEL: u32 = 520;

/// The figure of `tests` as SVG, a panel each.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn fitted_svg(tests: &[FittedTest]) -> String {
    let width = PANEL * tests.len().max(1) as u32;
    canvas::svg((width, 470), |area| {
        let (panels, legend) = area.split_vertically(400);
        for (panel, test) in panels.split_evenly((1, tests.len().max(1))).iter().zip(tests) {
            draw_test(panel, test)?;
        }
        let curves = tests.first().map_or(&[][..], |test| &test.curves);
        let measured = Mark { shape: Shape::Ring, color: INK, radius: 4 };
        let law = |(place, curve): (usize, &FittedCurve)| {
            let shape = if curve.is_chosen { Shape::Square } else { Shape::Disk };
            (Mark { shape, color: color(place, curve), radius: 4 }, curve.name)
        };
        let entries: Vec<(Mark, &str)> = std::iter::once((measured, "measured"))
            .chain(curves.iter().enumerate().map(law))
            .collect();
        let columns: Vec<Vec<(Mark, &str)>> = entries.chunks(3).map(<[_]>::to_vec).collect();
        canvas::draw_legend(&legend.margin(4, 0, 80, 0), &columns, 150)
    })
}

fn color(place: usize, curve: &FittedCurve) -> RGBColor {
    if curve.is_chosen { OURS } else { COLORS[place % COLORS.len()] }
}

fn draw_test(panel: &Area<'_>, test: &FittedTest) -> Drawn {
    let all = || test.measured.iter().filter(|at| at.iter().all(|value| value.is_finite()));
    let x = linear_range(all().map(|at| at[0]).chain([1.0]));
    let y = linear_range(all().map(|at| at[1]).chain([0.0]));
    let mut chart = canvas::panel(panel, test.name)?.build_cartesian_2d(x, y.clone())?;
    canvas::draw_axes(&mut chart, "stretch", "nominal stress, MPa")?;
    // The chosen law on top of the others.
    let mut curves: Vec<(usize, &FittedCurve)> = test.curves.iter().enumerate().collect();
    curves.sort_by_key(|(_, curve)| curve.is_chosen);
    for (place, curve) in curves {
        let is_shown = |at: &&[f64; 2]| y.contains(&at[1]) && at[0].is_finite();
        let points = curve.points.iter().filter(is_shown).map(|at| (at[0], at[1]));
        let width = if curve.is_chosen { 3 } else { 1 };
        chart.draw_series(LineSeries::new(points, color(place, curve).stroke_width(width)))?;
    }
    let points = all().map(|at| (at[0], at[1]));
    chart.draw_series(points.map(|at| Circle::new(at, 4, INK)))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_test_has_its_points_and_laws() {
        let curve = |name, is_chosen| FittedCurve {
            name,
            is_chosen,
            points: vec![[1.0, 0.0], [1.5, 0.4], [2.0, f64::INFINITY]],
        };
        let test = |name| FittedTest {
            name,
            measured: vec![[1.2, 0.2], [1.6, 0.5]],
            curves: vec![curve("yeoh", true), curve("neo-hookean", false)],
        };
        let svg = fitted_svg(&[test("uniaxial"), test("planar")]);
        for word in ["uniaxial", "planar", "yeoh", "neo-hookean", "measured"] {
            assert!(svg.contains(word), "{word}");
        }
        // Two points in each panel and one in the legend; a curve of each law in each panel.
        assert!(svg.matches("<circle").count() >= 5 && !svg.contains("inf"));
        assert!(svg.matches("<polyline").count() >= 4);
        assert!(!fitted_svg(&[]).contains("NaN"));
    }
}
