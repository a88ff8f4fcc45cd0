//! STL as text: words between blanks, whatever their case and wherever lines break.
//!
//! ```text
//! solid NAME
//!   facet normal n n n   outer loop   vertex x y z   vertex x y z   vertex x y z   endloop   endfacet
//! endsolid NAME
//! ```
//!
//! Names go to the end of their line, in any encoding. Normals are not looked at: the corners' order says which way a triangle faces.
//! Several solids are one list of triangles, and the last `endsolid` may be missing.
//! Source: 3D Systems, "SLC and STL file specification" (1989), as Burns, "Automated Fabrication" (1993), appendix, has it.

use crate::math::Vec3;

/// Whether `bytes` begin as such a text does; a byte order mark and blanks may stand before.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let mut words = Words::new(bytes);
    words.next().is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
}

/// The corners of each triangle, mm.
///
/// # Errors
/// The line at fault, and what is wrong there.
pub(super) fn triangles(bytes: &[u8]) -> Result<Vec<[Vec3; 3]>, (usize, String)> {
    let mut words = Words::new(bytes);
    let mut triangles = Vec::new();
    while let Some(word) = words.next() {
        if word.eq_ignore_ascii_case(b"solid") || word.eq_ignore_ascii_case(b"endsolid") {
            words.skip_line();
        } else if word.eq_ignore_ascii_case(b"facet") {
            let triangle = triangle(&mut words);
            triangles.push(triangle.map_err(|what| (words.line, what))?);
        } else {
            let what = format!("`{}` where `facet` or `endsolid` belongs", shown(word));
            return Err((words.line, what));
        }
    }
    Ok(triangles)
}

/// The rest of a triangle behind its `facet`.
fn triangle(words: &mut Words<'_>) -> Result<[Vec3; 3], String> {
    words.demand("normal")?;
    for _ in 0..3 {
        words.next().ok_or_else(cut)?;
    }
    words.demand("outer")?;
    words.demand("loop")?;
    let mut corners = [Vec3::zeros(); 3];
    for corner in &mut corners {
        words.demand("vertex")?;
        for axis in 0..3 {
            corner[axis] = words.number()?;
        }
    }
    words.demand("endloop")?;
    words.demand("endfacet")?;
    Ok(corners)
}

fn cut() -> String {
    "the text ends within a facet".to_owned()
}

/// A word of a file as a message shows it.
fn shown(word: &[u8]) -> String {
    String::from_utf8_lossy(word).chars().take(40).collect()
}

/// The words of a text, and the line of the last one, from 1.
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
    /// Lines may end in LF, CR LF or CR; the LF behind a CR ends none.
    behind_return: bool,
}

impl<'a> Words<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let rest = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        Self { rest, line: 1, behind_return: false }
    }

    fn next(&mut self) -> Option<&'a [u8]> {
        while let Some((&byte, rest)) = self.rest.split_first()
            && is_blank(byte)
        {
            self.pass(byte);
            self.rest = rest;
        }
        let length = self.rest.iter().position(|&byte| is_blank(byte)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    fn skip_line(&mut self) {
        let end = self.rest.iter().position(|byte| b"\r\n".contains(byte));
        self.rest = &self.rest[end.unwrap_or(self.rest.len())..];
    }

    fn pass(&mut self, byte: u8) {
        self.line += usize::from(byte == b'\r' || byte == b'\n' && !self.behind_return);
        self.behind_return = byte == b'\r';
    }

    fn demand(&mut self, wanted: &str) -> Result<(), String> {
        let word = self.next().ok_or_else(cut)?;
        if word.eq_ignore_ascii_case(wanted.as_bytes()) {
            return Ok(());
        }
        Err(format!("`{}` where `{wanted}` belongs", shown(word)))
    }

    fn number(&mut self) -> Result<f64, String> {
        let word = self.next().ok_or_else(cut)?;
        let number = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok());
        number.ok_or_else(|| {
            let comma = if word.contains(&b',') { "; its decimals want a point" } else { "" };
            format!("`{}` is not a number{comma}", shown(word))
        })
    }
}

/// A NUL pads some files.
fn is_blank(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0 || byte == 0x0b
}

#[cfg(test)]
mod tests {
    use super::*;

    const ONE: &str = "solid a part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   \
                       vertex 1.5e0 0 0\n   vertex 0 +1 -2.5E-1\n  endloop\n endfacet\nendsolid a part\n";

    fn corners() -> [Vec3; 3] {
        [Vec3::zeros(), Vec3::new(1.5, 0.0, 0.0), Vec3::new(0.0, 1.0, -0.25)]
    }

    /// Whatever a program of the field wrote around the numbers, the triangle is the same.
    #[test]
    fn manners_of_writing_do_not_matter() {
        let latin: Vec<u8> = ONE.replace("a part", "K@rper").bytes().collect();
        let latin = latin.iter().map(|&b| if b == b'@' { 0xf6 } else { b }).collect();
        let manners: [(&str, Vec<u8>); 10] = [
            ("plain", ONE.into()),
            ("blanks before", format!(" \t\n{ONE}").into()),
            ("mark", format!("\u{feff}{ONE}").into()),
            ("upper case", ONE.to_uppercase().into()),
            ("no normal", ONE.replace("0 0 1\n  o", "nan -nan(ind) 1.#QNAN\n  o").into()),
            ("Latin-1", latin),
            ("CR LF", ONE.replace('\n', "\r\n").into()),
            ("CR", ONE.replace('\n', "\r").into()),
            ("tabs", ONE.replace("  ", "\t").into()),
            ("no end", ONE.replace("endsolid a part\n", "").into()),
        ];
        for (manner, bytes) in manners {
            assert!(is_text(&bytes), "{manner}");
            assert_eq!(triangles(&bytes), Ok(vec![corners()]), "{manner}");
        }
        let several = format!("{ONE}\n{ONE}solid nothing\nendsolid");
        assert_eq!(triangles(several.as_bytes()), Ok(vec![corners(); 2]));
    }

    #[test]
    fn what_is_wrong_has_its_line() {
        let wrong = |from: &str, to: &str| triangles(ONE.replace(from, to).as_bytes()).unwrap_err();
        let told = |line: usize, what: &str| (line, what.to_owned());
        assert_eq!(
            wrong("1.5e0", "1,5"),
            told(5, "`1,5` is not a number; its decimals want a point")
        );
        assert_eq!(wrong("1.5e0", ""), told(6, "`vertex` is not a number"));
        assert_eq!(
            wrong("  endloop", "vertex 0 0 0\rendloop"),
            told(7, "`vertex` where `endloop` belongs")
        );
        assert_eq!(wrong("  outer loop\n", "\r"), told(4, "`vertex` where `outer` belongs"));
        assert_eq!(
            wrong("endsolid", "color"),
            told(9, "`color` where `facet` or `endsolid` belongs")
        );
        let cut = triangles(&ONE.as_bytes()[..80]).unwrap_err();
        assert_eq!(cut.1, "the text ends within a facet");
        assert!(!is_text(b"solidly built") && !is_text(b"") && !is_text(b"facet"));
    }
}
