//! The front as plain text for a terminal: one design a line, numbers right-aligned.

use super::FrontPoint;

/// The table of a `front`, in its order, ending with a line break.
#[must_use]
pub fn front_table(front: &[FrontPoint]) -> String {
    let head = ["design", "F_c", "F_bf", "figure of merit", "largest force", "flags"];
    let units = ["", "rad/(m J)^1/p", "N/kPa", "deg/(kPa m)", "N", ""];
    let rows = front.iter().map(|point| {
        let numbers = [point.bending, point.blocking, point.figure_of_merit, point.max_force];
        let [a, b, c, d] = numbers.map(significant);
        [point.id.clone(), a, b, c, d, point.flags.clone()]
    });
    let rows: Vec<_> =
        [head, units].into_iter().map(|row| row.map(str::to_owned)).chain(rows).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<_> = (0..head.len()).filter_map(width).collect();
    let mut text = String::new();
    for row in &rows {
        text += &format!("{:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            text += &format!("  {cell:>width$}");
        }
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    text
}

/// Four significant digits, without an exponent where that is short.
fn significant(x: f64) -> String {
    let magnitude = x.abs();
    if x == 0.0 || !x.is_finite() {
        format!("{x}")
    } else if (1e-3..1e6).contains(&magnitude) {
        let decimals = (3 - magnitude.log10().floor() as i32).max(0) as usize;
        format!("{x:.decimals$}")
    } else {
        format!("{x:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_digits_significant() {
        let point = |id: &str, bending, max_force| FrontPoint {
            id: id.to_owned(),
            bending,
            blocking: 12.0,
            figure_of_merit: 1234567.0,
            max_force,
            flags: if max_force == 0.0 { "tiny_energy".to_owned() } else { String::new() },
        };
        let table = front_table(&[point("7", 0.171_23, 0.0), point("g12-03", 54.2, 2e-4)]);
        let expected = "\
design            F_c   F_bf  figure of merit  largest force        flags
        rad/(m J)^1/p  N/kPa      deg/(kPa m)              N
7              0.1712  12.00          1.235e6              0  tiny_energy
g12-03          54.20  12.00          1.235e6       2.000e-4
";
        assert_eq!(table, expected);
    }
}
