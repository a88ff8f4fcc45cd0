//! The front as plain text for a terminal: one design a line, numbers right-aligned.

use super::{Column, FrontPoint};

/// The table of a `front`, in its order, ending with a line break.
#[must_use]
pub fn front_table(front: &[FrontPoint]) -> String {
    let has_reached = front.iter().any(|point| point.reached.is_some());
    let has_rated = front.iter().any(|point| point.rated.is_some());
    let at = front.iter().find_map(|point| point.rated.as_ref()?.reading("pressure"));
    let at = at.map_or_else(|| "reference".to_owned(), |pressure| format!("{pressure} MPa"));
    let has_errors = front.iter().any(|point| !point.mesh_errors.is_empty());
    let objectives = front.first().map_or(&[][..], |point| &point.objectives);
    let (leading, further) =
        front.first().map_or((&[][..], &[][..]), |point| (point.leading(), point.further()));
    let titles = |columns: &[Column]| columns.iter().map(Column::title).collect::<Vec<_>>();
    let units =
        |columns: &[Column]| columns.iter().map(|column| plain(column.unit)).collect::<Vec<_>>();
    let cells = |cells: &[&str]| cells.iter().map(|&cell| cell.to_owned()).collect::<Vec<_>>();
    let row = |parts: [Vec<String>; 8]| {
        let [id, leading, figures, reached, rated, errors, further, flags] = parts;
        let reached = if has_reached { reached } else { Vec::new() };
        let rated = if has_rated { rated } else { Vec::new() };
        let errors = if has_errors { errors } else { Vec::new() };
        [id, leading, figures, reached, rated, errors, further, flags].concat()
    };
    let mut by_mesh = titles(objectives);
    by_mesh.iter_mut().take(1).for_each(|title| title.push_str(" by mesh"));
    let head = [
        row([
            cells(&["design"]),
            titles(leading),
            cells(&["figure of merit", "largest force"]),
            cells(&["angle", if has_rated { "rated pressure" } else { "at pressure" }]),
            ["merit at ", "force at ", "angle at "].map(|what| format!("{what}{at}")).to_vec(),
            by_mesh,
            titles(further),
            cells(&["flags"]),
        ]),
        row([
            cells(&[""]),
            units(leading),
            cells(&["deg/(kPa m)", "N"]),
            cells(&["deg", "MPa"]),
            cells(&["deg/(kPa m)", "N", "deg"]),
            vec!["+- %".to_owned(); objectives.len()],
            units(further),
            cells(&[""]),
        ]),
    ];
    let rows = front.iter().map(|point| {
        let values = |columns: &[Column]| columns.iter().map(|c| significant(c.value)).collect();
        let reached = point.reached.as_ref().map_or([f64::NAN; 2], |reached| {
            let pressure = reached.pressures.first().map_or(f64::NAN, |(_, last)| *last);
            // A design with a rated pressure is read there.
            [reached.angle_deg, point.rated.as_ref().map_or(pressure, |own| own.pressure)]
        });
        let reached = reached.map(|x| if x.is_nan() { String::new() } else { significant(x) });
        let told = |k: usize| {
            let percent = point.mesh_errors.get(k)?;
            Some(percent.map_or_else(|| "?".to_owned(), |percent| format!("{percent:.1}")))
        };
        row([
            cells(&[&point.id]),
            values(point.leading()),
            [point.figure_of_merit, point.max_force].map(significant).to_vec(),
            reached.to_vec(),
            ["figure_of_merit", "max_force", "angle_deg"]
                .map(|name| at_reference(point, name))
                .to_vec(),
            (0..objectives.len()).map(|k| told(k).unwrap_or_default()).collect(),
            values(point.further()),
            cells(&[&point.flags]),
        ])
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

/// A number of a design at the reference pressure; nothing where it does not come to that.
fn at_reference(point: &FrontPoint, name: &str) -> String {
    let value = point.rated.as_ref().and_then(|rated| rated.reading(name));
    value.map_or_else(String::new, significant)
}

/// A `unit` in few letters: an exponent stands without its parentheses.
fn plain(unit: &str) -> String {
    let Some((base, exponent)) = unit.split_once("^(") else { return unit.to_owned() };
    format!("{base}^{}", exponent.replacen(')', "", 1))
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
    use crate::report::{RatedColumns, Reached};

    #[test]
    fn columns_are_aligned_and_digits_significant() {
        let point = |id: &str, bending, max_force| FrontPoint {
            id: id.to_owned(),
            figure_of_merit: 1234567.0,
            max_force,
            flags: if max_force == 0.0 { "tiny_energy".to_owned() } else { String::new() },
            ..FrontPoint::of([bending, 12.0])
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

    fn design() -> FrontPoint {
        FrontPoint {
            id: "7".to_owned(),
            figure_of_merit: 3.0,
            max_force: 4.0,
            ..FrontPoint::of([1.0, 2.0])
        }
    }

    /// Angles stand with the pressure that they were reached at.
    #[test]
    fn what_was_reached_is_in_degrees() {
        let point = FrontPoint {
            reached: Some(Reached {
                angle_deg: 43.21,
                pressures: vec![("a".to_owned(), 0.15), ("b".to_owned(), 0.2)],
            }),
            ..design()
        };
        let table = front_table(&[point]);
        let ends = ["angle  at pressure  flags", "deg          MPa", "43.21       0.1500"];
        for (line, end) in table.lines().zip(ends) {
            assert!(line.ends_with(end), "{table}");
        }
    }

    /// A design that is judged at a pressure of its own is told at that of all too, where it comes to it.
    #[test]
    fn rated_designs_are_told_at_the_reference_too() {
        let rated = |pressure, told: Option<f64>| RatedColumns {
            pressure,
            at_reference: ["pressure", "figure_of_merit", "max_force", "angle_deg"]
                .map(|name| (format!("reference_{name}"), told))
                .to_vec(),
        };
        let reached = Reached { angle_deg: 43.21, pressures: vec![("a".to_owned(), 0.4)] };
        let point = |pressure, told| FrontPoint {
            reached: Some(reached.clone()),
            rated: Some(rated(pressure, told)),
            ..design()
        };
        let table = front_table(&[point(0.15, None), point(0.31, Some(0.2))]);
        let ends = [
            "angle  rated pressure  merit at 0.2 MPa  force at 0.2 MPa  angle at 0.2 MPa  flags",
            "deg             MPa       deg/(kPa m)                 N               deg",
            "43.21          0.1500",
            "43.21          0.3100            0.2000            0.2000            0.2000",
        ];
        for (line, end) in table.lines().zip(ends) {
            assert!(line.ends_with(end), "{table}");
        }
    }

    /// A question mark where the second mesh gave nothing.
    #[test]
    fn errors_of_the_mesh_stand_beside_the_objectives() {
        let point = FrontPoint { mesh_errors: vec![Some(1.26), None], ..design() };
        let table = front_table(&[point]);
        let ends = ["force  F_c by mesh  F_bf  flags", "N         +- %  +- %", "1.3     ?"];
        for (line, end) in table.lines().zip(ends) {
            assert!(line.ends_with(end), "{table}");
        }
    }

    #[test]
    fn further_objectives_are_columns() {
        let mut point = design();
        let (name, unit) = ("wall_volume", "cm^3");
        point.objectives.push(Column { name, symbol: None, unit, value: 12.5 });
        let table = front_table(&[point]);
        let ends = ["largest force  wall volume  flags", "N         cm^3", "4.000        12.50"];
        for (line, end) in table.lines().zip(ends) {
            assert!(line.ends_with(end), "{table}");
        }
    }
}
