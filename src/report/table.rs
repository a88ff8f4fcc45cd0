//! The front as plain text for a terminal: one design a line, numbers right-aligned.

use super::{FrontPoint, Reached};

/// The table of a `front`, in its order, ending with a line break.
#[must_use]
pub fn front_table(front: &[FrontPoint]) -> String {
    let further = front.first().map_or(&[][..], |point| &point.further);
    let has_reached = front.iter().any(|point| point.reached.is_some());
    let has_errors = front.iter().any(|point| point.mesh_error.is_some());
    let row = |id: &str,
               numbers: [&str; 4],
               [reached, errors]: [[&str; 2]; 2],
               further: Vec<String>,
               flags: &str| {
        let begin = [id].into_iter().chain(numbers).map(str::to_owned);
        let reached = reached.into_iter().filter(|_| has_reached).map(str::to_owned);
        let errors = errors.into_iter().filter(|_| has_errors).map(str::to_owned);
        begin.chain(reached).chain(errors).chain(further).chain([flags.to_owned()]).collect()
    };
    let names = ["F_c", "F_bf", "figure of merit", "largest force"];
    let units = ["rad/(m J)^1/p", "N/kPa", "deg/(kPa m)", "N"];
    let further_names = further.iter().map(|c| c.name.replace('_', " ")).collect();
    let further_units = further.iter().map(|column| column.unit.to_owned()).collect();
    let head: [Vec<String>; 2] = [
        row(
            "design",
            names,
            [["angle", "at pressure"], ["F_c by mesh", "F_bf"]],
            further_names,
            "flags",
        ),
        row("", units, [["deg", "MPa"], ["+- %", "+- %"]], further_units, ""),
    ];
    let rows = front.iter().map(|point| {
        let numbers = [point.bending, point.blocking, point.figure_of_merit, point.max_force];
        let numbers = numbers.map(significant);
        let reached = point.reached.map_or([const { String::new() }; 2], |reached| {
            let Reached { angle_deg, bending_pressure, .. } = reached;
            [angle_deg, bending_pressure].map(significant)
        });
        let errors = point.mesh_error.map_or([const { String::new() }; 2], |error| {
            let told = |percent: Option<f64>| {
                percent.map_or_else(|| "?".to_owned(), |percent| format!("{percent:.1}"))
            };
            [error.bending_percent, error.blocking_percent].map(told)
        });
        let further = point.further.iter().map(|column| significant(column.value)).collect();
        let numbers = numbers.each_ref().map(String::as_str);
        let pairs = [&reached, &errors].map(|pair| pair.each_ref().map(String::as_str));
        row(&point.id, numbers, pairs, further, &point.flags)
    });
    let rows: Vec<Vec<String>> = head.into_iter().chain(rows).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
    let widths: Vec<_> = (0..rows[0].len()).filter_map(width).collect();
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
    use crate::report::{Column, MeshError};

    #[test]
    fn columns_are_aligned_and_digits_significant() {
        let point = |id: &str, bending, max_force| FrontPoint {
            id: id.to_owned(),
            bending,
            blocking: 12.0,
            figure_of_merit: 1234567.0,
            max_force,
            flags: if max_force == 0.0 { "tiny_energy".to_owned() } else { String::new() },
            further: Vec::new(),
            reached: None,
            mesh_error: None,
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

    /// Angles stand with the pressure that they were reached at.
    #[test]
    fn what_was_reached_is_in_degrees() {
        let point = FrontPoint {
            id: "7".to_owned(),
            bending: 1.0,
            blocking: 2.0,
            figure_of_merit: 3.0,
            max_force: 4.0,
            flags: String::new(),
            further: Vec::new(),
            reached: Some(Reached {
                angle_deg: 43.21,
                bending_pressure: 0.15,
                blocking_pressure: 0.2,
            }),
            mesh_error: None,
        };
        let table = front_table(&[point]);
        let ends = ["angle  at pressure  flags", "deg          MPa", "43.21       0.1500"];
        for (line, end) in table.lines().zip(ends) {
            assert!(line.ends_with(end), "{table}");
        }
    }

    /// A question mark where the second mesh gave nothing.
    #[test]
    fn errors_of_the_mesh_stand_beside_the_objectives() {
        let point = FrontPoint {
            id: "7".to_owned(),
            bending: 1.0,
            blocking: 2.0,
            figure_of_merit: 3.0,
            max_force: 4.0,
            flags: String::new(),
            further: Vec::new(),
            reached: None,
            mesh_error: Some(MeshError { bending_percent: Some(1.26), blocking_percent: None }),
        };
        let table = front_table(&[point]);
        let ends = ["force  F_c by mesh  F_bf  flags", "N         +- %  +- %", "1.3     ?"];
        for (line, end) in table.lines().zip(ends) {
            assert!(line.ends_with(end), "{table}");
        }
    }

    #[test]
    fn further_objectives_are_columns() {
        let column = Column { name: "wall_volume", unit: "cm^3", value: 12.5 };
        let point = FrontPoint {
            id: "7".to_owned(),
            bending: 1.0,
            blocking: 2.0,
            figure_of_merit: 3.0,
            max_force: 4.0,
            flags: String::new(),
            further: vec![column],
            reached: None,
            mesh_error: None,
        };
        let table = front_table(&[point]);
        let ends = ["largest force  wall volume  flags", "N         cm^3", "4.000        12.50"];
        for (line, end) in table.lines().zip(ends) {
            assert!(line.ends_with(end), "{table}");
        }
    }
}
