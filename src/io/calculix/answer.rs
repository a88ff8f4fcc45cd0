//! What `ccx` wrote: the tip's displacements in `.dat`, those of all nodes in `.frd`.
//!
//! ```text
//! .dat   " displacements (vx,vy,vz) for set TIP and time  0.1000000E+00", then lines of node, x, y, z
//! .frd   "  100CL" with the time, " -4  DISP", then " -1", node (10 characters), x, y, z (12 each), until " -3"
//! ```
//!
//! Source: Dhondt, CalculiX CrunchiX user's manual 2.20, "*NODE PRINT"; Wittig, CalculiX GraphiX user's manual, "Result Format".

use std::path::Path;

use crate::io::{InputError, input};
use crate::math::Vec3;

/// The tip at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipAnswer {
    /// Share of the whole pressure.
    pub time: f64,
    /// Mean displacement of the set TIP, mm.
    pub tip: Vec3,
}

/// All nodes at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalAnswer {
    /// Share of the whole pressure.
    pub time: f64,
    /// Nodes, from 1, and their displacements, mm.
    pub displacements: Vec<(u32, Vec3)>,
}

/// The tip at each time that the `.dat` file `path` has.
///
/// # Errors
/// [`InputError`] when the file cannot be read or a line is not as above.
pub fn read_tip(path: &Path) -> Result<Vec<TipAnswer>, InputError> {
    let text = input::text(path, input::DATA)?;
    let mut answers: Vec<TipAnswer> = Vec::new();
    let mut nodes = 0.0;
    let mut is_tip = false;
    for (line, number) in text.lines().zip(1..) {
        let wrong = || InputError::at_line(path, number, "is no line of displacements");
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            None => {}
            Some("displacements") => {
                is_tip = line.contains(" set TIP ");
                if is_tip {
                    let time = words.next_back().and_then(|word| word.parse().ok());
                    answers.push(TipAnswer { time: time.ok_or_else(wrong)?, tip: Vec3::zeros() });
                    nodes = 0.0;
                }
            }
            Some(node) if is_tip && node.parse::<u32>().is_ok() => {
                let values: Option<Vec<f64>> = words.map(|word| word.parse().ok()).collect();
                let [x, y, z] = values.ok_or_else(wrong)?.try_into().map_err(|_| wrong())?;
                let answer = answers.last_mut().ok_or_else(wrong)?;
                nodes += 1.0;
                answer.tip += (Vec3::new(x, y, z) - answer.tip) / nodes;
            }
            Some(_) => is_tip = false,
        }
    }
    Ok(answers)
}

/// The last displacements that the `.frd` file `path` has; none where it has none.
///
/// # Errors
/// [`InputError`] when the file cannot be read or a line is not as above.
pub fn read_nodes(path: &Path) -> Result<Option<NodalAnswer>, InputError> {
    let text = input::text(path, input::DATA)?;
    let mut time = 0.0;
    let mut answer: Option<NodalAnswer> = None;
    let mut is_displacement = false;
    for (line, number) in text.lines().zip(1..) {
        let wrong = || InputError::at_line(path, number, "is no line of results");
        let kind = line.trim_start();
        if kind.starts_with("100C") {
            time = columns(line, 12, 12).ok_or_else(wrong)?;
        } else if kind.starts_with("-4") {
            is_displacement = line.contains("DISP");
            if is_displacement {
                answer = Some(NodalAnswer { time, displacements: Vec::new() });
            }
        } else if kind.starts_with("-3") {
            is_displacement = false;
        } else if is_displacement && line.starts_with(" -1") {
            let node = line.get(3..13).and_then(|word| word.trim().parse().ok());
            let axis = |k: usize| columns(line, 13 + 12 * k, 12).ok_or_else(wrong);
            let displacement = Vec3::new(axis(0)?, axis(1)?, axis(2)?);
            let answer = answer.as_mut().ok_or_else(wrong)?;
            answer.displacements.push((node.ok_or_else(wrong)?, displacement));
        }
    }
    Ok(answer)
}

/// Whether the program closed the `.frd` file `path`, as it does when it ends by itself.
///
/// # Errors
/// [`InputError`] when the file cannot be read.
pub fn is_closed(path: &Path) -> Result<bool, InputError> {
    Ok(input::text(path, input::DATA)?
        .lines()
        .next_back()
        .is_some_and(|line| line.trim() == "9999"))
}

fn columns(line: &str, from: usize, width: usize) -> Option<f64> {
    line.get(from..from + width)?.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn file(text: &str) -> (tempfile::TempDir, std::path::PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("solid");
        fs::write(&path, text).unwrap();
        (folder, path)
    }

    /// Lines as the program writes them; the mean is that of the set TIP alone.
    #[test]
    fn tips_are_means_over_their_set() {
        let text = "
 displacements (vx,vy,vz) for set TIP and time  0.5000000E+00

       820 -1.143620E+01 -8.000000E-03  2.000000E+00
        21 -1.243620E+01  0.000000E+00  4.000000E+00

 displacements (vx,vy,vz) for set OTHER and time  0.5000000E+00

       820  9.000000E+00  9.000000E+00  9.000000E+00

 displacements (vx,vy,vz) for set TIP and time  0.1000000E+01

       820  1.000000E+00  2.000000E+00  3.000000E+00
";
        let (_folder, path) = file(text);
        let answers = read_tip(&path).unwrap();
        assert_eq!(answers.iter().map(|answer| answer.time).collect::<Vec<_>>(), [0.5, 1.0]);
        assert!((answers[0].tip - Vec3::new(-11.9362, -0.004, 3.0)).norm() < 1e-12);
        assert_eq!(answers[1].tip, Vec3::new(1.0, 2.0, 3.0));
        let (_folder, path) = file(&text.replace("1.000000E+00", "*************"));
        assert_eq!(read_tip(&path).unwrap_err().line, Some(13));
    }

    /// Numbers that fill their columns touch each other; of two results the later one counts.
    #[test]
    fn nodes_are_read_by_columns() {
        let text = "    1C
  100CL  101 5.00000E-01           2                     0    1           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -1         1 0.00000E+00 0.00000E+00 0.00000E+00
 -3
  100CL  101 1.00000E+00           2                     0    2           1
 -4  DISP        4    1
 -5  D1          1    2    1    0
 -1         1-1.50000E+00-2.50000E-01 3.00000E+00
 -1        12 0.00000E+00 0.00000E+00-1.00000E+01
 -3
 -4  FORC        4    1
 -1         1 7.00000E+00 7.00000E+00 7.00000E+00
 -3
 9999
";
        let (_folder, path) = file(text);
        let answer = read_nodes(&path).unwrap().unwrap();
        assert_eq!(answer.time, 1.0);
        let expected = [(1, Vec3::new(-1.5, -0.25, 3.0)), (12, Vec3::new(0.0, 0.0, -10.0))];
        assert_eq!(answer.displacements, expected);
        let (_folder, path) = file("    1C\n 9999\n");
        assert_eq!(read_nodes(&path), Ok(None));
        let (_folder, path) = file(&text.replace("-2.50000E-01", "-2.50000E---"));
        assert_eq!(read_nodes(&path).unwrap_err().line, Some(10));
    }
}
