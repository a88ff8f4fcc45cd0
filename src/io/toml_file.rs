//! Run and scene files: TOML into a `serde` struct, every fault told in one line.
//!
//! ```text
//! run.toml:3: unknown key `popsize`; did you mean `population_size`?
//! ```
//!
//! The struct must say `#[serde(deny_unknown_fields)]` for unknown keys to be faults.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::{InputError, input};

/// The contents of the TOML file `path`.
///
/// # Errors
/// [`InputError`] when the file cannot be read, is not TOML, or does not fit `T`; with the line.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, InputError> {
    let text = input::text(path, input::SETTINGS)?;
    parse(&text, path)
}

/// The contents of a TOML `text`; `path` is named in errors.
///
/// # Errors
/// [`InputError`] when the text is not TOML or does not fit `T`; with the line.
pub fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, InputError> {
    toml::from_str(text).map_err(|error| {
        let what = explanation(error.message());
        match error.span() {
            Some(span) => InputError::at_line(path, line_of(text, span.start), what),
            None => InputError::new(path, what),
        }
    })
}

fn line_of(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// `serde`'s message; for an unknown name, with the nearest known one.
fn explanation(message: &str) -> String {
    let noun = if message.starts_with("unknown field") {
        "key"
    } else if message.starts_with("unknown variant") {
        "value"
    } else {
        return in_plain_words(message);
    };
    // "unknown field `x`, expected one of `a`, `b`": names are every second piece between backticks.
    let mut names = message.split('`').skip(1).step_by(2);
    let unknown = names.next().unwrap_or_default();
    let known: Vec<_> = names.collect();
    match nearest(unknown, &known) {
        Some(name) => format!("unknown {noun} `{unknown}`; did you mean `{name}`?"),
        None if known.is_empty() => format!("unknown {noun} `{unknown}`; none is known here"),
        None => format!("unknown {noun} `{unknown}`; known: `{}`", known.join("`, `")),
    }
}

/// `serde`'s message with a user's words for Rust's types.
fn in_plain_words(message: &str) -> String {
    let Some((found, expected)) = message.rsplit_once("expected ") else {
        return message.to_owned();
    };
    let words = match expected {
        "f64" => "a number",
        "usize" | "u64" | "u32" => "a whole number, 0 or more",
        "a sequence" if found.contains("map") => "a list, written [[name]] with two brackets",
        "a sequence" => "a list, written [ .. ]",
        "path string" => "the name of a file, in quotes",
        "a string" => "a word, in quotes",
        "a boolean" => "true or false",
        _ if expected.starts_with("struct ") => "a section, [name] with its keys below",
        _ if expected.starts_with("enum ") || expected == "string or table" => {
            "one of its words, in quotes"
        }
        other => other,
    };
    format!("{found}expected {words}")
}

/// Names that share a smaller part of their letter pairs are not offered.
///
/// Wanted: `popsize`, `population_size` 0.50; `gens`, `generations` 0.46; `tol`, `tolerance` 0.40.
/// Unwanted: `file`, `field` 0.29; `mesh`, `method` 0.25 (edit distances rank these above the wanted ones).
const LIKENESS: f64 = 0.4;

fn nearest<'a>(unknown: &str, known: &[&'a str]) -> Option<&'a str> {
    let likeness = |name: &str| strsim::sorensen_dice(&unknown.to_lowercase(), name);
    let alike = known.iter().map(|&name| (likeness(name), name)).filter(|(l, _)| *l >= LIKENESS);
    alike.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Run {
        population_size: usize,
        #[serde(default)]
        #[expect(dead_code, reason = "only its key matters")]
        seed: u64,
        #[serde(default)]
        #[expect(dead_code, reason = "only its keys matter")]
        wall: Wall,
    }

    #[derive(Debug, Default, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[expect(dead_code, reason = "only its keys matter")]
    struct Wall {
        thickness: f64,
        #[serde(default)]
        law: Law,
    }

    #[derive(Debug, Default, Deserialize)]
    #[serde(rename_all = "snake_case")]
    enum Law {
        #[default]
        NeoHookean,
        Ogden,
    }

    fn error(text: &str) -> String {
        parse::<Run>(text, Path::new("run.toml")).unwrap_err().to_string()
    }

    #[test]
    fn each_fault_is_one_exact_line() {
        assert_eq!(
            error("seed = 1\n\npopsize = 60\n"),
            "run.toml:3: unknown key `popsize`; did you mean `population_size`?"
        );
        assert_eq!(
            error("population_size = 60\n[wall]\nthicknes = 1.0\n"),
            "run.toml:3: unknown key `thicknes`; did you mean `thickness`?"
        );
        assert_eq!(
            error("population_size = 60\nxyz = 60\n"),
            "run.toml:2: unknown key `xyz`; known: `population_size`, `seed`, `wall`"
        );
        assert_eq!(
            error("population_size = 60\n[wall]\nthickness = 1.0\nlaw = \"ogdn\"\n"),
            "run.toml:4: unknown value `ogdn`; did you mean `ogden`?"
        );
        assert_eq!(
            error("seed = 1\npopulation_size = \"many\"\n"),
            "run.toml:2: invalid type: string \"many\", expected a whole number, 0 or more"
        );
        assert_eq!(error("seed = 1\n"), "run.toml:1: missing field `population_size`");
    }

    #[test]
    fn broken_toml_names_its_line() {
        let error = error("seed = 1\npopulation_size = = 3\n");
        assert!(error.starts_with("run.toml:2: "), "{error}");
        assert_eq!(error.lines().count(), 1);
    }

    #[test]
    fn a_missing_file_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.toml");
        let missing = read::<Run>(&path).unwrap_err().to_string();
        assert_eq!(missing, format!("{}: no such file or folder", path.display()));
        fs::write(&path, "population_size = 60").unwrap();
        assert_eq!(read::<Run>(&path).unwrap().population_size, 60);
    }
}
