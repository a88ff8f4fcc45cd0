//! All benchmarks at a glance: one row each, with the error of every element on a logarithmic axis.
//!
//! A tick in the element's colour is the error that is accepted of it; a mark beyond its tick is hollow. A run that
//! failed stands at the right end.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::canvas::{self, Area, Drawn, GRID, INK, Mark, OURS, SMITH, Shape, bold, letters};

/// One benchmark's row.
#[derive(Clone, Debug, PartialEq)]
pub struct OverviewRow {
    /// The benchmark's name.
    pub case: String,
    /// One for each element that was run.
    pub errors: Vec<JudgedError>,
}

/// The error of one element on the mesh on which it is judged.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedError {
    /// The element's name.
    pub element: String,
    /// %; infinite where the run failed.
    pub error: f64,
    /// %.
    pub accepted: f64,
}

const WIDTH: i32 = 900;
const LEFT: i32 = 260;
const TOP: i32 = 64;
const ROW: i32 = 22;
/// Powers of ten at the ends of the axis, %; what lies beyond is drawn at the end.
const DECADES: [i32; 2] = [-2, 2];

/// The overview of `rows` as SVG.
#[must_use]
pub fn overview_svg(rows: &[OverviewRow]) -> String {
    let bottom = TOP + ROW * rows.len() as i32;
    let mut elements: Vec<&str> = Vec::new();
    for judged in rows.iter().flat_map(|row| &row.errors) {
        if !elements.contains(&judged.element.as_str()) {
            elements.push(&judged.element);
        }
    }
    canvas::svg((WIDTH as u32, bottom as u32 + 44), |area| {
        let title = "Error on the mesh on which it is judged, %";
        area.draw(&Text::new(title, (LEFT, 14), bold(14.5, INK)))?;
        draw_decades(area, bottom)?;
        for (row, y) in rows.iter().zip((0..).map(|i| TOP + ROW * i + ROW / 2)) {
            let right = Pos { h_pos: HPos::Right, v_pos: VPos::Center };
            let name = letters(12.0, INK).pos(right);
            area.draw(&Text::new(row.case.clone(), (LEFT - 14, y), name))?;
            for judged in &row.errors {
                let place = elements.iter().position(|name| *name == judged.element).unwrap_or(0);
                // One element above the other, so that equal errors do not hide each other.
                draw_judged(area, judged, place, y - 5 + 10 * (place as i32 % 2))?;
            }
        }
        let columns: Vec<_> =
            elements.iter().enumerate().map(|(i, name)| vec![(mark(i, false), *name)]).collect();
        let legend = area.margin(bottom + 14, 0, LEFT, 0);
        canvas::draw_legend(&legend, &columns, 120)?;
        let meaning = "tick: accepted; hollow: too far";
        legend.draw(&Text::new(meaning, (10 + 120 * elements.len() as i32, 6), letters(12.0, INK)))
    })
}

fn draw_decades(area: &Area<'_>, bottom: i32) -> Drawn {
    let centered = Pos { h_pos: HPos::Center, v_pos: VPos::Bottom };
    for power in DECADES[0]..=DECADES[1] {
        let value = 10_f64.powi(power);
        let x = x_of(value);
        area.draw(&PathElement::new([(x, TOP), (x, bottom)], GRID.stroke_width(1)))?;
        let label = letters(12.0, INK).pos(centered);
        area.draw(&Text::new(value.to_string(), (x, TOP - 6), label))?;
    }
    Ok(())
}

fn draw_judged(area: &Area<'_>, judged: &JudgedError, place: usize, y: i32) -> Drawn {
    let is_far = judged.error > judged.accepted;
    let mark = mark(place, is_far);
    let tick = x_of(judged.accepted);
    area.draw(&PathElement::new([(tick, y - 5), (tick, y + 5)], mark.color.stroke_width(2)))?;
    mark.draw(area, (x_of(judged.error), y))
}

fn x_of(error: f64) -> i32 {
    let [low, high] = DECADES.map(f64::from);
    let share = (error.log10().clamp(low, high) - low) / (high - low);
    LEFT + (share * f64::from(WIDTH - LEFT - 40)).round() as i32
}

fn mark(place: usize, is_hollow: bool) -> Mark {
    let (shape, color) = match (place % 2, is_hollow) {
        (0, false) => (Shape::Disk, OURS),
        (0, true) => (Shape::Ring, OURS),
        (_, false) => (Shape::Square, SMITH),
        (_, true) => (Shape::HollowSquare, SMITH),
    };
    Mark { shape, color, radius: 4 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_stands_beside_its_tick_where_its_error_is() {
        let judged = |element: &str, error, accepted| JudgedError {
            element: element.to_owned(),
            error,
            accepted,
        };
        let row = |case: &str, errors| OverviewRow { case: case.to_owned(), errors };
        let rows = [
            row("roof", vec![judged("loop", 0.1, 1.0), judged("mid-edge", 6.0, 5.0)]),
            row("beam", vec![judged("loop", f64::INFINITY, 1.0), judged("mid-edge", 0.0, 5.0)]),
        ];
        let svg = overview_svg(&rows);
        // Two runs and the legend's.
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(svg.contains("roof") && svg.contains("beam"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        let [a, b, c] = [0.01, 0.1, 1.0].map(x_of);
        assert_eq!((a, b - a), (LEFT, c - b));
        assert_eq!([x_of(0.0), x_of(f64::INFINITY)], [x_of(0.01), x_of(100.0)]);
    }
}
