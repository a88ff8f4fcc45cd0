//! Numbers of a mesh file one after another, written as text or as the machine has them.

use std::borrow::Cow;

/// A place in the bytes of a file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at: usize,
    /// How numbers are written.
    pub(super) form: Form,
}

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// As decimals between blanks.
    Text,
    /// As little-endian bytes.
    Binary,
}

impl<'a> Words<'a> {
    /// The beginning of `bytes`, with numbers as text.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, form: Form::Text }
    }

    /// The rest of the line, without blanks around it, whatever its letters; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Option<Cow<'a, str>> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&b| b == b'\n').map_or(rest.len(), |end| end + 1);
        self.at += length;
        Some(String::from_utf8_lossy(rest[..length].trim_ascii()))
    }

    /// A count that stands alone in its line, of things of which each takes `bytes` at least; `None` when the file cannot hold them.
    pub(super) fn count_line(&mut self, bytes: usize) -> Option<usize> {
        let count = self.line()?.parse().ok()?;
        self.fits(count, bytes)
    }

    /// The next count of 64 bits, of things of which each takes `numbers` of them at least; `None` when the file cannot hold them.
    pub(super) fn count(&mut self, numbers: usize) -> Option<usize> {
        let count = usize::try_from(self.size()?).ok()?;
        self.fits(count, numbers * self.least_bytes())
    }

    /// The next count of 32 bits, likewise.
    pub(super) fn small_count(&mut self, numbers: usize) -> Option<usize> {
        let count = usize::try_from(self.int()?).ok()?;
        self.fits(count, numbers * self.least_bytes())
    }

    /// What the shortest number takes: a digit and a blank, or 32 bits.
    fn least_bytes(&self) -> usize {
        match self.form {
            Form::Text => 2,
            Form::Binary => 4,
        }
    }

    /// `count` when so many things of `bytes` each may be left; the last of a text needs no blank.
    fn fits(&self, count: usize, bytes: usize) -> Option<usize> {
        let left = self.bytes.len().saturating_sub(self.at) + 1;
        (count <= left / bytes.max(1)).then_some(count)
    }

    /// The next word of a text, whatever the form of numbers.
    pub(super) fn word(&mut self) -> Option<&'a str> {
        let rest = self.bytes.get(self.at..)?;
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let length = rest[start..].iter().position(u8::is_ascii_whitespace);
        let end = length.map_or(rest.len(), |length| start + length);
        self.at += end;
        std::str::from_utf8(&rest[start..end]).ok()
    }

    /// The next 32-bit integer.
    pub(super) fn int(&mut self) -> Option<i64> {
        match self.form {
            Form::Text => self.word()?.parse().ok(),
            Form::Binary => self.raw().map(|raw| i64::from(i32::from_le_bytes(raw))),
        }
    }

    /// The next count or number of a thing, of 64 bits.
    pub(super) fn size(&mut self) -> Option<u64> {
        match self.form {
            Form::Text => self.word()?.parse().ok(),
            Form::Binary => self.raw().map(u64::from_le_bytes),
        }
    }

    /// The next double.
    pub(super) fn double(&mut self) -> Option<f64> {
        match self.form {
            Form::Text => self.word()?.parse().ok(),
            Form::Binary => self.raw().map(f64::from_le_bytes),
        }
    }

    /// Goes behind the next `word`, which need not begin a line: some programs write binary numbers right up to it. `None` when there is none.
    pub(super) fn skip_to(&mut self, word: &str) -> Option<()> {
        let rest = self.bytes.get(self.at..)?;
        let found = rest.windows(word.len()).position(|window| window == word.as_bytes());
        self.at += found? + word.len();
        Some(())
    }

    fn raw<const N: usize>(&mut self) -> Option<[u8; N]> {
        let raw = self.bytes.get(self.at..self.at + N)?.try_into().ok();
        self.at += N;
        raw
    }
}
