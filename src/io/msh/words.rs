//! Numbers of a mesh file one after another, written as text or as the machine has them.

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

    /// The rest of the line, without blanks around it; `None` at the end of the file.
    pub(super) fn line(&mut self) -> Option<&'a str> {
        let rest = self.bytes.get(self.at..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|&b| b == b'\n').map_or(rest.len(), |end| end + 1);
        self.at += length;
        std::str::from_utf8(&rest[..length]).ok().map(str::trim)
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

    /// Goes behind the next `word` at the beginning of a line; `None` when there is none.
    pub(super) fn skip_to_line(&mut self, word: &str) -> Option<()> {
        let rest = self.bytes.get(self.at..)?;
        let found = rest
            .windows(word.len())
            .enumerate()
            .find(|&(at, window)| window == word.as_bytes() && (at == 0 || rest[at - 1] == b'\n'));
        self.at += found?.0 + word.len();
        Some(())
    }

    fn raw<const N: usize>(&mut self) -> Option<[u8; N]> {
        let raw = self.bytes.get(self.at..self.at + N)?.try_into().ok();
        self.at += N;
        raw
    }
}
