//! Tables: one row a line, the names of the columns on top.

use std::collections::BTreeMap;
use std::path::Path;

use serde::de::{DeserializeOwned, IgnoredAny};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

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

/// A table whose columns are only known when it is made.
#[derive(Clone, Debug, Default)]
pub struct Table<'a> {
    columns: Vec<(String, Vec<Cell<'a>>)>,
}

/// What stands in a row of a [`Table`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell<'a> {
    /// How many.
    Count(usize),
    /// A number, in the unit of its column's name.
    Number(f64),
    /// A word.
    Word(&'a str),
    /// Yes or no.
    Flag(bool),
    /// An empty cell.
    Nothing,
}

/// A row whose columns are only known when it is made.
pub trait Cells {
    /// The names of its columns with what stands there, from the left.
    fn cells(&self) -> Vec<(String, Cell<'_>)>;
}

/// Serializes a row as a map from the names of its columns.
///
/// # Errors
/// Those of `serializer`.
pub fn as_map<S: Serializer>(row: &impl Cells, serializer: S) -> Result<S::Ok, S::Error> {
    let cells = row.cells();
    let mut map = serializer.serialize_map(Some(cells.len()))?;
    for (name, cell) in &cells {
        map.serialize_entry(name, cell)?;
    }
    map.end()
}

/// The numbers of a row by the names of their columns, `None` if a cell has none; for a flattened field of a struct, of the columns that no
/// other field has taken.
///
/// # Errors
/// Those of `deserializer`.
pub fn numbers<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<BTreeMap<String, Option<f64>>, D::Error> {
    #[derive(Deserialize)]
    #[serde(untagged)]
    enum Entry {
        Number(f64),
        Other(IgnoredAny),
    }
    let entries = BTreeMap::<String, Entry>::deserialize(deserializer)?;
    let number = |(name, entry)| match entry {
        Entry::Number(number) => (name, Some(number)),
        Entry::Other(IgnoredAny) => (name, None),
    };
    Ok(entries.into_iter().map(number).collect())
}

/// Writes `rows` as the CSV file `path`, whole or not at all; no rows make an empty file.
///
/// The columns are those of the row that has the most; where a row lacks one its cell is empty.
///
/// # Errors
/// [`OutputError`] when the file system refuses.
pub fn write_cells<'a, R: Cells>(path: &Path, rows: &'a [R]) -> Result<(), OutputError> {
    let rows: Vec<Vec<(String, Cell<'a>)>> = rows.iter().map(Cells::cells).collect();
    // The first of several.
    let longest = rows.iter().rev().max_by_key(|row| row.len());
    let Some(longest) = longest else { return atomic::write(path, &[]) };
    let mut table = Table::default();
    for (name, _) in longest {
        let cell = |row: &Vec<(String, Cell<'a>)>| {
            let found = row.iter().find(|(column, _)| column == name);
            found.map_or(Cell::Nothing, |(_, cell)| *cell)
        };
        table.push(name.clone(), rows.iter().map(cell));
    }
    table.write(path)
}

impl<'a> Table<'a> {
    /// Adds a column on the right, a cell of it for each row.
    ///
    /// # Panics
    /// When the column is not as long as those before.
    pub fn push(&mut self, name: impl Into<String>, cells: impl IntoIterator<Item = Cell<'a>>) {
        let (name, cells): (String, Vec<Cell<'a>>) = (name.into(), cells.into_iter().collect());
        let rows = self.columns.first().map_or(cells.len(), |(_, cells)| cells.len());
        assert_eq!(cells.len(), rows, "{name}: a cell for each row");
        self.columns.push((name, cells));
    }

    /// Adds a column of numbers, as [`Self::push`].
    ///
    /// # Panics
    /// As [`Self::push`].
    pub fn push_numbers(
        &mut self,
        name: impl Into<String>,
        numbers: impl IntoIterator<Item = f64>,
    ) {
        self.push(name, numbers.into_iter().map(Cell::Number));
    }

    /// Writes the table as the CSV file `path`, whole or not at all.
    ///
    /// # Errors
    /// [`OutputError`] when the file system refuses.
    pub fn write(&self, path: &Path) -> Result<(), OutputError> {
        let unwritable = |error: csv::Error| OutputError::unwritable(path, &error);
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
        writer.write_record(self.columns.iter().map(|(name, _)| name)).map_err(unwritable)?;
        let rows = self.columns.first().map_or(0, |(_, cells)| cells.len());
        for row in 0..rows {
            let cells: Vec<Cell<'_>> = self.columns.iter().map(|(_, cells)| cells[row]).collect();
            writer.serialize(cells).map_err(unwritable)?;
        }
        let bytes = writer.into_inner().map_err(|error| OutputError::unwritable(path, &error))?;
        atomic::write(path, &bytes)
    }
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

/// A table whose columns are only known when it is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawTable {
    /// The line of the names of the columns, from 1.
    pub line: usize,
    /// Their names, without blanks around them.
    pub columns: Vec<String>,
    /// Each row with its line: as many cells as there are columns, without blanks around them.
    pub rows: Vec<(usize, Vec<String>)>,
}

/// The table of the CSV `text`; `path` is named in errors. Lines that begin with `#` are comments.
///
/// # Errors
/// [`InputError`] when a row has more or fewer cells than there are columns; with the line.
pub fn raw(text: &str, path: &Path) -> Result<RawTable, InputError> {
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let refused = |error: csv::Error| match error.position() {
        Some(at) => InputError::at_line(path, at.line() as usize, error.to_string()),
        None => InputError::new(path, error.to_string()),
    };
    // A record begins for the reader where the one before it ends, at comments and empty lines too.
    let lines: Vec<&str> = text.lines().collect();
    let line = |record: &csv::StringRecord| {
        let first = record.position().map_or(1, |at| at.line() as usize);
        let is_none = |line: &&&str| line.trim().is_empty() || line.starts_with('#');
        first + lines[(first - 1).min(lines.len())..].iter().take_while(is_none).count()
    };
    let cells = |record: &csv::StringRecord| record.iter().map(str::to_owned).collect();
    let header = reader.headers().map_err(refused)?;
    let (at, columns) = (line(header), cells(header));
    let row = |row: Result<csv::StringRecord, csv::Error>| {
        row.map(|row| (line(&row), cells(&row))).map_err(refused)
    };
    let rows = reader.records().map(row).collect::<Result<_, _>>()?;
    Ok(RawTable { line: at, columns, rows })
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
    fn columns_stand_beside_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        let mut table = Table::default();
        table.push("step", [Cell::Count(0), Cell::Count(1)]);
        table.push_numbers("force_N", [0.1 + 0.2, f64::INFINITY]);
        table.push("stability", [Cell::Word("stable"), Cell::Word("a, b")]);
        table.push("is_sample", [Cell::Flag(true), Cell::Nothing]);
        table.write(&path).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let rows = "0,0.30000000000000004,stable,true\n1,inf,\"a, b\",\n";
        assert_eq!(text, format!("step,force_N,stability,is_sample\n{rows}"));
    }

    impl Cells for Row {
        fn cells(&self) -> Vec<(String, Cell<'_>)> {
            let force = self.force.map_or(Cell::Nothing, Cell::Number);
            vec![("label".to_owned(), Cell::Word(&self.label)), ("force".to_owned(), force)]
        }
    }

    #[test]
    fn rows_of_cells_are_those_of_fields() {
        let folder = tempfile::tempdir().unwrap();
        let [fields, cells] = ["a.csv", "b.csv"].map(|name| folder.path().join(name));
        let rows = [Row { label: "a".to_owned(), force: Some(0.1 + 0.2) }];
        for rows in [&rows[..], &[]] {
            write(&fields, rows).unwrap();
            write_cells(&cells, rows).unwrap();
            let [fields, cells] = [&fields, &cells].map(|path| std::fs::read(path).unwrap());
            assert_eq!(fields, cells);
        }
        let mut json = Vec::new();
        as_map(&rows[0], &mut serde_json::Serializer::new(&mut json)).unwrap();
        assert_eq!(json, serde_json::to_vec(&rows[0]).unwrap());
    }

    #[test]
    fn a_bad_row_is_named_by_its_line() {
        let text = "# made by hand\nlabel,force\na,1\nb,much\n";
        let error = parse::<Row>(text, Path::new("a.csv")).unwrap_err();
        assert_eq!(error.line, Some(4));
    }

    #[test]
    fn a_raw_table_knows_its_lines() {
        let path = Path::new("a.csv");
        let table = raw("# made by hand\na, b\n1, x\n# later\n2,y\n", path).unwrap();
        assert_eq!((table.line, table.columns), (2, vec!["a".to_owned(), "b".to_owned()]));
        assert_eq!(table.rows[1], (5, vec!["2".to_owned(), "y".to_owned()]));
        assert_eq!(raw("a,b\n1,2\n3\n", path).unwrap_err().line, Some(3));
    }
}
