//! Tables: one `serde` row a line, the field names on top.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{InputError, OutputError, atomic};

/// Writes `rows` as the CSV file `path`, whole or not at all.
///
/// No rows make an empty file: the column names come from the first row.
///
/// # Errors
/// [`OutputError`] when a row is not flat or the file system refuses.
pub fn write<T: Serialize>(path: &Path, rows: &[T]) -> Result<(), OutputError> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        writer.serialize(row).map_err(|error| OutputError::unwritable(path, &error))?;
    }
    let bytes = writer.into_inner().map_err(|error| OutputError::unwritable(path, &error))?;
    atomic::write(path, &bytes)
}

/// The rows of the CSV `text`; `path` is named in errors. Lines that begin with `#` are comments.
///
/// # Errors
/// [`InputError`] when a row does not fit `T`; with the line.
pub fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<Vec<T>, InputError> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let row = |row: Result<T, csv::Error>| {
        row.map_err(|error| match error.position() {
            Some(at) => InputError::at_line(path, at.line() as usize, error.to_string()),
            None => InputError::new(path, error.to_string()),
        })
    };
    reader.deserialize().map(row).collect()
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Row {
        label: String,
        force: Option<f64>,
    }

    #[test]
    fn rows_come_back_with_the_same_bits() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let rows = [
            Row { label: "a, \"b\"".to_owned(), force: Some(0.1 + 0.2) },
            Row { label: "c".to_owned(), force: None },
        ];
        write(&path, &rows).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text, "label,force\n\"a, \"\"b\"\"\",0.30000000000000004\nc,\n");
        assert_eq!(parse::<Row>(&text, &path).unwrap(), rows);
    }

    #[test]
    fn a_bad_row_is_named_by_its_line() {
        let text = "# made by hand\nlabel,force\na,1\nb,much\n";
        let error = parse::<Row>(text, Path::new("a.csv")).unwrap_err();
        assert_eq!(error.line, Some(4));
    }
}
