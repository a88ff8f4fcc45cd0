//! What an error costs: one benchmark's error against CPU time and against unknowns, one curve for each element.
//!
//! All axes are logarithmic; a run without an error to show (it failed, or its error is zero) has no mark.
//! A dashed line, in the element's colour, is the error that is accepted of it.

use std::ops::Range;

use plotters::prelude::*;

use super::canvas::{self, Area, Drawn, INK, Mark, OTHERS, OURS, SMITH, Shape, bold};

/// The runs of one element on finer and finer meshes.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorCurve {
    /// The element's name.
    pub element: String,
    /// Its runs, the coarsest mesh first.
    pub runs: Vec<ErrorPoint>,
    /// The error that is accepted, %.
    pub accepted: Option<f64>,
}

/// One run of a benchmark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorPoint {
    /// CPU time of the whole run, s.
    pub cpu_seconds: f64,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Its error, %.
    pub error: f64,
}

/// The figure of the benchmark `title` as SVG.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn error_svg(title: &str, curves: &[ErrorCurve]) -> String {
    canvas::svg((1240, 520), |area| {
        let (head, rest) = area.split_vertically(40);
        let (panels, legend) = rest.split_vertically(426);
        let (left, right) = panels.split_horizontally(620);
        head.draw(&Text::new(title.to_owned(), (76, 18), bold(16.0, INK)))?;
        draw_panel(area, &left, "Error against time", "CPU time, s", curves, |p| p.cpu_seconds)?;
        draw_panel(area, &right, "Error against size", "unknowns", curves, |p| p.unknowns as f64)?;
        draw_legend(&legend, curves)
    })
}

fn draw_panel(
    whole: &Area<'_>,
    panel: &Area<'_>,
    title: &str,
    x_name: &str,
    curves: &[ErrorCurve],
    x_of: impl Fn(&ErrorPoint) -> f64,
) -> Drawn {
    let has_place = |(x, y): &(f64, f64)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite();
    let series: Vec<Vec<(f64, f64)>> = curves
        .iter()
        .map(|curve| {
            curve.runs.iter().map(|run| (x_of(run), run.error)).filter(has_place).collect()
        })
        .collect();
    let accepted = || curves.iter().filter_map(|curve| curve.accepted);
    let x = decades(series.iter().flatten().map(|at| at.0));
    let y = decades(series.iter().flatten().map(|at| at.1).chain(accepted()));
    let mut chart =
        canvas::panel(panel, title)?.build_cartesian_2d(x.clone().log_scale(), y.log_scale())?;
    canvas::draw_axes(&mut chart, x_name, "error, %")?;
    for (i, (curve, points)) in curves.iter().zip(&series).enumerate() {
        let mark = mark_of(i);
        if let Some(error) = curve.accepted {
            let ends = [(x.start, error), (x.end, error)];
            let dashes = DashedLineSeries::new(ends, 6, 5, mark.color.stroke_width(1));
            chart.draw_series(dashes)?;
        }
        chart.draw_series(LineSeries::new(points.iter().copied(), mark.color.stroke_width(2)))?;
        for at in points {
            mark.draw(whole, chart.backend_coord(at))?;
        }
    }
    Ok(())
}

fn draw_legend(legend: &Area<'_>, curves: &[ErrorCurve]) -> Drawn {
    let texts: Vec<String> = curves
        .iter()
        .map(|curve| match curve.accepted {
            Some(error) => format!("{} (dashed: {error} % accepted)", curve.element),
            None => curve.element.clone(),
        })
        .collect();
    let columns: Vec<_> =
        texts.iter().enumerate().map(|(i, text)| vec![(mark_of(i), text.as_str())]).collect();
    canvas::draw_legend(&legend.margin(8, 0, 70, 0), &columns, 300)
}

fn mark_of(i: usize) -> Mark {
    let looks = [(Shape::Disk, OURS), (Shape::Square, SMITH), (Shape::Triangle, OTHERS)];
    let (shape, color) = looks[i % looks.len()];
    Mark { shape, color, radius: 4 }
}

/// The range from the power of ten below `values` (positive) to the one above; a decade where there are none.
fn decades(values: impl Iterator<Item = f64> + Clone) -> Range<f64> {
    let low = values.clone().fold(f64::INFINITY, f64::min);
    let high = values.fold(0.0, f64::max);
    if low > high {
        return 1.0..10.0;
    }
    let below = low.log10().floor();
    let above = high.log10().ceil().max(below + 1.0);
    // A hair more, so that rounding does not lose the ticks at the ends.
    10_f64.powf(below) * (1.0 - 1e-9)..10_f64.powf(above) * (1.0 + 1e-9)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(element: &str, factor: f64, accepted: Option<f64>) -> ErrorCurve {
        let run = |n: usize| ErrorPoint {
            cpu_seconds: 1e-4 * (n * n) as f64,
            unknowns: 3 * n * n,
            error: factor / (n * n) as f64,
        };
        ErrorCurve { element: element.to_owned(), runs: [4, 8, 16].map(run).to_vec(), accepted }
    }

    #[test]
    fn every_run_has_its_mark_in_both_panels_and_a_failed_one_none() {
        let mut curves = [curve("loop", 100.0, Some(1.0)), curve("mid-edge", 400.0, None)];
        curves[0].runs[1].error = f64::NAN;
        curves[1].runs[2].error = 0.0;
        let svg = error_svg("Scordelis-Lo roof", &curves);
        // Two runs in each panel and one in the legend.
        assert_eq!(svg.matches("<circle").count(), 2 * 2 + 1);
        assert!(svg.contains("Scordelis-Lo roof") && svg.contains("loop (dashed: 1 % accepted)"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        assert!(error_svg("nothing ran", &[]).contains("nothing ran"));
    }

    #[test]
    fn a_second_order_is_a_straight_line() {
        let svg = error_svg("x", &[curve("loop", 100.0, None)]);
        let number = |line: &str, key: &str| -> i32 {
            line.split(key).nth(1).unwrap().split('"').next().unwrap().parse().unwrap()
        };
        let marks: Vec<(i32, i32)> = svg
            .lines()
            .filter(|line| line.starts_with("<circle"))
            .map(|line| (number(line, "cx=\""), number(line, "cy=\"")))
            .collect();
        // Each panel's three marks are equally spaced, to a pixel of rounding; y points down.
        for panel in marks[..6].chunks(3) {
            let [a, b, c] = [panel[0], panel[1], panel[2]];
            assert!((c.0 - b.0 - (b.0 - a.0)).abs() <= 1 && (c.1 - b.1 - (b.1 - a.1)).abs() <= 1);
            assert!(b.0 > a.0 && b.1 > a.1);
        }
    }

    #[test]
    fn axes_begin_and_end_at_powers_of_ten() {
        let ends = |values: &[f64]| {
            let range = decades(values.iter().copied());
            [range.start, range.end].map(|end| end.log10())
        };
        for (values, exact) in
            [(&[0.3, 42.0][..], [-1.0, 2.0]), (&[1.0], [0.0, 1.0]), (&[], [0.0, 1.0])]
        {
            let ends = ends(values);
            assert!((0..2).all(|i| (ends[i] - exact[i]).abs() < 1e-8), "{values:?}: {ends:?}");
        }
    }
}
