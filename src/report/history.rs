//! How a search went: the quality of the front and the share of usable designs, by generation.

use std::ops::Range;

use plotters::prelude::*;
use serde::{Deserialize, Serialize};

use super::canvas::{self, Area, Drawn, OURS, SMITH, linear_range};

/// One generation of a search.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct HistoryPoint {
    /// Its number.
    pub generation: u64,
    /// Hypervolume of the front so far, in the product of the objectives' units.
    pub hypervolume: f64,
    /// Share of its candidates that broke no constraint, 0 to 1.
    pub feasible_share: f64,
}

/// The figure of a search's `history` as SVG.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn history_svg(history: &[HistoryPoint]) -> String {
    let generations = history.iter().map(|point| point.generation);
    let last = generations.max().unwrap_or(1).max(1) as f64;
    let hypervolume: Vec<_> =
        history.iter().map(|point| (point.generation as f64, point.hypervolume)).collect();
    let feasible: Vec<_> = history
        .iter()
        .map(|point| (point.generation as f64, 100.0 * point.feasible_share))
        .collect();
    let finite = hypervolume.iter().map(|at| at.1).filter(|y| y.is_finite());
    let height = 0.0..linear_range(finite).end.max(f64::MIN_POSITIVE);
    canvas::svg((1240, 430), |area| {
        let (left, right) = area.split_horizontally(620);
        draw_panel(&left, "Hypervolume of the front", OURS, (last, height), &hypervolume)?;
        draw_panel(&right, "Feasible candidates, %", SMITH, (last, 0.0..105.0), &feasible)
    })
}

fn draw_panel(
    panel: &Area<'_>,
    title: &str,
    color: RGBColor,
    (last, height): (f64, Range<f64>),
    points: &[(f64, f64)],
) -> Drawn {
    let mut chart = canvas::panel(panel, title)?.build_cartesian_2d(0.0..last, height)?;
    canvas::draw_axes(&mut chart, "generation", "")?;
    let finite = || points.iter().copied().filter(|(_, y)| y.is_finite());
    chart.draw_series(LineSeries::new(finite(), color.stroke_width(2)))?;
    chart.draw_series(finite().map(|at| Circle::new(at, 3, color.filled())))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_generation_has_a_mark_in_each_panel_and_gaps_are_left_out() {
        let point = |generation: u64, hypervolume| HistoryPoint {
            generation,
            hypervolume,
            feasible_share: 0.25 * generation as f64,
        };
        let history = [point(0, 0.0), point(1, f64::NAN), point(2, 0.3), point(3, 0.4)];
        let svg = history_svg(&history);
        assert_eq!(svg.matches("<circle").count(), 3 + 4);
        assert_eq!(svg, history_svg(&history));
        assert!(!svg.contains("NaN"));
    }
}
