//! What became of a search's candidates: how many came how far, and why the others were rejected.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use serde::{Deserialize, Serialize};

use super::canvas::{self, INK, OTHERS, OURS, bold, letters};

/// How many candidates ended in one way.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OutcomeCount {
    /// Its name: a path's ending, or the room and reason of a rejection.
    pub outcome: String,
    /// Whether candidates with it have no objectives.
    pub rejected: bool,
    /// How many.
    pub candidates: usize,
}

/// The figure of `counts`, a bar for each in their order, as SVG.
///
/// # Panics
/// Never: drawing into a string cannot fail.
#[must_use]
pub fn outcomes_svg(counts: &[OutcomeCount]) -> String {
    let whole: usize = counts.iter().map(|count| count.candidates).sum();
    let largest = counts.iter().map(|count| count.candidates).max().unwrap_or(0).max(1);
    let height = TOP + ROW * counts.len() as i32 + 20;
    canvas::svg((WIDTH as u32, height as u32), |area| {
        let title = format!("What became of {whole} candidates (grey: rejected)");
        area.draw(&Text::new(title, (20, 14), bold(14.5, INK)))?;
        let at = |h_pos| letters(12.0, INK).pos(Pos { h_pos, v_pos: VPos::Center });
        for (row, count) in counts.iter().enumerate() {
            let y = TOP + ROW * row as i32;
            let share = count.candidates as f64 / largest as f64;
            let end = LEFT + (share * f64::from(WIDTH - LEFT - 130)).round() as i32;
            let color = if count.rejected { OTHERS } else { OURS };
            area.draw(&Rectangle::new([(LEFT, y), (end, y + ROW - 8)], color.filled()))?;
            let middle = y + (ROW - 8) / 2;
            area.draw(&Text::new(count.outcome.clone(), (LEFT - 10, middle), at(HPos::Right)))?;
            let number = format!(
                "{} ({:.1} %)",
                count.candidates,
                100.0 * count.candidates as f64 / whole.max(1) as f64
            );
            area.draw(&Text::new(number, (end + 8, middle), at(HPos::Left)))?;
        }
        Ok(())
    })
}

/// Pixels: the figure's width, where bars begin, and a bar with the gap to the next.
const WIDTH: i32 = 900;
const LEFT: i32 = 300;
const TOP: i32 = 44;
const ROW: i32 = 24;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_are_as_long_as_counts_are_many() {
        let count = |outcome: &str, rejected, candidates| OutcomeCount {
            outcome: outcome.to_owned(),
            rejected,
            candidates,
        };
        let svg = outcomes_svg(&[count("reached", false, 30), count("surface/islands", true, 10)]);
        let width = |line: &str| {
            let text = line.split(" width=\"").nth(1).unwrap();
            text.split('"').next().unwrap().parse::<f64>().unwrap()
        };
        let bars: Vec<f64> = svg
            .lines()
            .filter(|line| line.starts_with("<rect") && !line.contains("FFFFFF"))
            .map(width)
            .collect();
        assert_eq!(bars.len(), 2);
        // To a pixel of rounding.
        assert!((bars[0] - 3.0 * bars[1]).abs() <= 3.0, "{bars:?}");
        assert!(svg.contains("10 (25.0 %)") && svg.contains("surface/islands"));
        assert!(!outcomes_svg(&[]).contains("NaN"));
    }
}
