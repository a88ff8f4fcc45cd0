//! A table of tests as a person has it (CSV).

use std::path::Path;

use super::measured::{Measured, Point};
use crate::io::{InputError, csv, input};
use crate::model::material::Loading;

/// How far a specimen was stretched.
#[derive(Clone, Copy, Debug, PartialEq)]
enum StretchColumn {
    Stretch,
    /// Engineering strain, in this unit.
    Strain(f64),
}

/// The force that it took.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StressColumn {
    is_cauchy: bool,
    /// Its unit, MPa.
    unit: f64,
}

const TEST: &str = "test";

const STRETCHES: [(&str, StretchColumn); 3] = [
    ("stretch", StretchColumn::Stretch),
    ("strain", StretchColumn::Strain(1.0)),
    ("strain_percent", StretchColumn::Strain(0.01)),
];

const STRESSES: [(&str, StressColumn); 4] = [
    ("nominal_mpa", StressColumn { is_cauchy: false, unit: 1.0 }),
    ("nominal_kpa", StressColumn { is_cauchy: false, unit: 1e-3 }),
    ("cauchy_mpa", StressColumn { is_cauchy: true, unit: 1.0 }),
    ("cauchy_kpa", StressColumn { is_cauchy: true, unit: 1e-3 }),
];

/// A stress of the wrong sign below this share of the largest of its test is noise about rest.
const NOISE: f64 = 0.02;
/// Beyond these no rubber is stretched.
const STRETCH_LIMITS: [f64; 2] = [0.02, 50.0];

/// The tests in the CSV file `path`; a file that has no column `test` is of the kind `test`.
///
/// # Errors
/// [`InputError`] with the line when the file is no such table, or a value can be none of a test.
pub fn read_tests(path: &Path, test: Option<Loading>) -> Result<Measured, InputError> {
    of_text(&input::text(path, input::DATA)?, path, test)
}

/// The kind of test of this name.
///
/// # Errors
/// The line that says which there are.
pub(crate) fn named_test(name: &str) -> Result<Loading, String> {
    let found = Loading::ALL.into_iter().find(|loading| loading.name() == name);
    found.ok_or_else(|| {
        format!("`{name}` is no kind of test; there are {}", names(Loading::ALL.map(Loading::name)))
    })
}

fn names<const N: usize>(names: [&str; N]) -> String {
    let (last, others) = names.split_last().expect("there are some");
    format!("{} and {last}", others.join(", "))
}

fn of_text(text: &str, path: &Path, test: Option<Loading>) -> Result<Measured, InputError> {
    let table = csv::raw(text, path)?;
    let at_header = |what: String| InputError::at_line(path, table.line, what);
    let known =
        || [TEST].into_iter().chain(STRETCHES.map(|it| it.0)).chain(STRESSES.map(|it| it.0));
    if let Some(column) = table.columns.iter().find(|column| !known().any(|it| it == *column)) {
        let [stretches, stresses] =
            [names(STRETCHES.map(|it| it.0)), names(STRESSES.map(|it| it.0))];
        return Err(at_header(format!(
            "the column `{column}` is none of `{TEST}`, of {stretches} (engineering strain), and of {stresses}; separated by commas"
        )));
    }
    let place = |name: &str| table.columns.iter().position(|column| column == name);
    let (stretch_at, stretch_column) = one_of(&STRETCHES, place).map_err(at_header)?;
    let (stress_at, stress_column) = one_of(&STRESSES, place).map_err(at_header)?;
    let mut points = Vec::new();
    for (line, cells) in &table.rows {
        let at_line = |what: String| InputError::at_line(path, *line, what);
        let loading = match (place(TEST), test) {
            (Some(column), _) => named_test(&cells[column]).map_err(at_line)?,
            (None, Some(test)) => test,
            (None, None) => {
                let kinds = names(Loading::ALL.map(Loading::name));
                return Err(at_header(format!(
                    "there is no column `{TEST}` that says of each row which of {kinds} it is; say it of the file with --test"
                )));
            }
        };
        let number = |place: usize| {
            let (name, cell) = (&table.columns[place], &cells[place]);
            let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| at_line(format!("{name} is `{cell}`, but it must be a number")))
        };
        let (value, stress) = (number(stretch_at)?, number(stress_at)?);
        let stretch = match stretch_column {
            StretchColumn::Stretch => value,
            StretchColumn::Strain(unit) => 1.0 + unit * value,
        };
        let [least, most] = STRETCH_LIMITS;
        if !(least..=most).contains(&stretch) {
            let name = &table.columns[stretch_at];
            return Err(at_line(format!(
                "{name} is {value:?}, a stretch of {stretch:?}; length over length at rest is positive, and of rubber between {least} and {most}"
            )));
        }
        let stress = stress_column.unit * stress;
        let nominal = if stress_column.is_cauchy { stress / stretch } else { stress };
        points.push((*line, loading, Point { stretch, nominal }));
    }
    check_signs(&points, path)?;
    let mut measured = Measured::default();
    points.into_iter().for_each(|(_, loading, point)| measured.push(loading, point));
    Ok(measured)
}

/// The one column among `known` that the table has, with its place.
fn one_of<T: Copy, const N: usize>(
    known: &[(&str, T); N],
    place: impl Fn(&str) -> Option<usize>,
) -> Result<(usize, T), String> {
    let found = known.iter().filter_map(|(name, column)| Some((*name, place(name)?, *column)));
    let found: Vec<(&str, usize, T)> = found.collect();
    match found[..] {
        [(_, place, column)] => Ok((place, column)),
        [] => Err(format!("there is no column of {}", names(known.each_ref().map(|it| it.0)))),
        [(a, ..), (b, ..), ..] => Err(format!("there are both `{a}` and `{b}`; leave one")),
    }
}

/// A pulled specimen pulls back, a pressed one presses.
fn check_signs(points: &[(usize, Loading, Point)], path: &Path) -> Result<(), InputError> {
    for (line, loading, Point { stretch, nominal }) in points {
        let same = points.iter().filter(|other| other.1 == *loading);
        let largest = same.map(|other| other.2.nominal.abs()).fold(0.0, f64::max);
        if (stretch - 1.0) * nominal < 0.0 && nominal.abs() > NOISE * largest {
            return Err(InputError::at_line(
                path,
                *line,
                format!(
                    "a stretch of {stretch:?} with a stress of {nominal:?} MPa: above 1 a stress is positive, below 1 negative"
                ),
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    fn read(text: &str) -> Result<Measured, InputError> {
        of_text(text, Path::new("a.csv"), None)
    }

    /// One state, a stretch of 1.5 under a nominal stress of 0.2 MPa, in every pair of columns.
    #[test]
    fn every_column_means_the_same_state() {
        for (length, value) in [("stretch", 1.5), ("strain", 0.5), ("strain_percent", 50.0)] {
            for (force, stress) in [
                ("nominal_mpa", 0.2),
                ("nominal_kpa", 200.0),
                ("cauchy_mpa", 0.3),
                ("cauchy_kpa", 300.0),
            ] {
                let text = format!("{force}, test, {length}\n{stress}, planar, {value}\n");
                let measured = read(&text).unwrap();
                let (loading, points) = measured.tests().next().unwrap();
                assert_eq!((loading, points.len()), (Loading::Planar, 1));
                assert_relative_eq!(points[0].stretch, 1.5, max_relative = 1e-15);
                assert_relative_eq!(points[0].nominal, 0.2, max_relative = 1e-15);
            }
        }
    }

    #[test]
    fn a_file_without_kinds_is_of_the_kind_that_is_said() {
        let text = "stretch,nominal_mpa\n1.5,0.2\n1.2,0.1\n";
        let measured = of_text(text, Path::new("a.csv"), Some(Loading::Equibiaxial)).unwrap();
        let (loading, points) = measured.tests().next().unwrap();
        assert_eq!(loading, Loading::Equibiaxial);
        // By rising stretch.
        assert_eq!(points.iter().map(|at| at.stretch).collect::<Vec<_>>(), [1.2, 1.5]);
        let refused = read(text).unwrap_err().to_string();
        assert!(refused.contains("--test") && refused.contains("uniaxial"), "{refused}");
    }

    #[test]
    fn what_is_no_test_is_refused_with_its_line() {
        for (text, line, words) in [
            ("time,stretch,nominal_mpa\n", 1, "`time` is none of `test`"),
            ("test;stretch;nominal_mpa\n", 1, "separated by commas"),
            ("test,nominal_mpa\n", 1, "no column of stretch, strain and strain_percent"),
            ("test,stretch\n", 1, "no column of nominal_mpa"),
            ("test,stretch,strain,nominal_mpa\n", 1, "both `stretch` and `strain`"),
            ("test,stretch,nominal_mpa\nbiaxial,1,0\n", 2, "`biaxial` is no kind of test"),
            ("test,stretch,nominal_mpa\nplanar,1,0\nplanar,nan,1\n", 3, "stretch is `nan`"),
            ("test,stretch,nominal_mpa\nplanar,1.2,a lot\n", 2, "nominal_mpa is `a lot`"),
            ("test,stretch,nominal_mpa\nplanar,0,-1\n", 2, "a stretch of 0.0"),
            ("test,strain,nominal_mpa\nplanar,-1.5,-1\n", 2, "a stretch of -0.5"),
            (
                "test,strain_percent,nominal_mpa\nplanar,20,-1\n",
                2,
                "a stretch of 1.2 with a stress",
            ),
            ("test,stretch,nominal_mpa\nplanar,1.2\n", 2, "fields"),
        ] {
            let refused = read(text).unwrap_err();
            assert_eq!(refused.line, Some(line), "{refused}");
            assert!(refused.what.contains(words), "{refused}");
        }
        // Noise about rest is none.
        assert!(read("test,stretch,nominal_mpa\nplanar,1.01,-0.01\nplanar,2,1\n").is_ok());
    }
}
