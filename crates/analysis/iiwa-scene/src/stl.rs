//! Reader of STL files, binary and ASCII.
//!
//! A binary file has a header of 80 bytes, the number of triangles, and 50 bytes for each triangle.
//! The header may begin with `solid`, as that of ASCII files, and bytes may follow the last
//! triangle: programs write both. A file is therefore binary if it is long enough for the number
//! of triangles at byte 80. An ASCII file never is: four characters make a number of at least
//! 0x09090909, which needs 7 GB.

use iiwa_json::{bytes_without_mark, excerpt};

use crate::{mesh_error::TriangleMeshError, patch::MAX_TRIANGLES, patch::Patch};

/// Length of the header and the number of triangles, in bytes.
const HEADER: usize = 84;

/// Length of a triangle: normal, three corners, attribute.
const TRIANGLE: usize = 50;

/// Reads the contents of a file, in its unit.
pub(crate) fn read(bytes: &[u8]) -> Result<Vec<Patch>, TriangleMeshError> {
    if bytes.is_empty() {
        return Err(invalid("it is empty"));
    }
    let is_text = StlWords::new(bytes).next().is_some_and(|word| word.is("solid"));
    let header = bytes.get(80..HEADER).and_then(|count| count.try_into().ok());
    let Some(count) = header.map(u32::from_le_bytes) else {
        return if is_text {
            ascii(bytes)
        } else {
            Err(invalid("it is not text that begins with `solid`, and too short for a binary file"))
        };
    };
    let room = bytes.len() - HEADER;
    let needed = u64::from(count) * TRIANGLE as u64;
    if needed <= room as u64 {
        if count == 0 && room > 0 {
            let message = format!("its header states 0 triangles, and {room} bytes follow");
            return Err(invalid(message));
        }
        return binary(&bytes[HEADER..], count as usize);
    }
    // Without zero bytes, which only a binary file has.
    if is_text && !bytes.contains(&0) {
        return ascii(bytes);
    }
    Err(invalid(format!(
        "it is not text that begins with `solid`, and a binary file of {count} triangles has at \
         least {} bytes, not {}",
        needed + HEADER as u64,
        bytes.len()
    )))
}

fn invalid(message: impl Into<String>) -> TriangleMeshError {
    TriangleMeshError::unread("STL", message)
}

fn binary(triangles: &[u8], count: usize) -> Result<Vec<Patch>, TriangleMeshError> {
    TriangleMeshError::check_count(count)?;
    let mut corners = Vec::with_capacity(3 * count);
    for triangle in triangles.chunks_exact(TRIANGLE).take(count) {
        // The normal is redundant.
        corners.extend(triangle[12..48].chunks_exact(12).map(|corner| {
            std::array::from_fn(|axis| {
                let value = &corner[4 * axis..][..4];
                f64::from(f32::from_le_bytes([value[0], value[1], value[2], value[3]]))
            })
        }));
    }
    Ok(vec![patch(corners)])
}

/// Creates triangles of three points each.
fn patch(points: Vec<[f64; 3]>) -> Patch {
    // At most three for each of `MAX_TRIANGLES`.
    let count = u32::try_from(points.len() / 3).unwrap_or(u32::MAX);
    let triangles = (0..count).map(|number| [3 * number, 3 * number + 1, 3 * number + 2]).collect();
    Patch { points, triangles, rgb: None }
}

/// Reads text: any number of solids, each with a name of any characters in its first line.
fn ascii(bytes: &[u8]) -> Result<Vec<Patch>, TriangleMeshError> {
    let mut words = StlWords::new(bytes);
    let mut corners = Vec::new();
    let mut found = 0;
    loop {
        match words.next() {
            None => break,
            Some(word) if word.is("solid") => words.skip_line(),
            Some(word) => return Err(word.unexpected("`solid`")),
        }
        loop {
            let word = words.expect_any("`facet` or `endsolid`")?;
            if word.is("endsolid") {
                words.skip_line();
                break;
            }
            if !word.is("facet") {
                return Err(word.unexpected("`facet` or `endsolid`"));
            }
            words.expect("normal")?;
            for _ in 0..3 {
                // Redundant; some programs write words for the normal of a degenerate triangle.
                words.expect_any("a number")?;
            }
            words.expect("outer")?;
            words.expect("loop")?;
            found += 1;
            for _ in 0..3 {
                words.expect("vertex")?;
                let corner = [words.number()?, words.number()?, words.number()?];
                if found <= MAX_TRIANGLES {
                    corners.push(corner);
                }
            }
            words.expect("endloop")?;
            words.expect("endfacet")?;
        }
    }
    TriangleMeshError::check_count(found)?;
    Ok(vec![patch(corners)])
}

/// Words of an ASCII file.
struct StlWords<'a> {
    rest: &'a [u8],
    /// Line of the next byte, from 1. Lines end with LF, CR or both.
    line: u64,
    after_cr: bool,
}

/// Word with its line.
struct StlWord<'a> {
    text: &'a [u8],
    line: u64,
}

impl StlWord<'_> {
    /// Compares with a keyword; some programs write capitals.
    fn is(&self, keyword: &str) -> bool {
        self.text.eq_ignore_ascii_case(keyword.as_bytes())
    }

    fn unexpected(&self, expected: &str) -> TriangleMeshError {
        let start = &self.text[..self.text.len().min(1024)];
        let found = excerpt(&String::from_utf8_lossy(start));
        invalid(format!("line {}: expected {expected}, found `{found}`", self.line))
    }
}

impl<'a> StlWords<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes_without_mark(bytes), line: 1, after_cr: false }
    }

    fn next(&mut self) -> Option<StlWord<'a>> {
        while self.rest.first()?.is_ascii_whitespace() {
            self.skip_byte();
        }
        let end = self.rest.iter().position(u8::is_ascii_whitespace).unwrap_or(self.rest.len());
        let (text, rest) = self.rest.split_at(end);
        (self.rest, self.after_cr) = (rest, false);
        Some(StlWord { text, line: self.line })
    }

    fn skip_byte(&mut self) {
        let Some((byte, rest)) = self.rest.split_first() else { return };
        self.line += u64::from(*byte == b'\r' || (*byte == b'\n' && !self.after_cr));
        self.after_cr = *byte == b'\r';
        self.rest = rest;
    }

    /// Skips the rest of the line: the name of a solid.
    fn skip_line(&mut self) {
        let end = self.rest.iter().position(|byte| matches!(byte, b'\r' | b'\n'));
        self.rest = &self.rest[end.unwrap_or(self.rest.len())..];
    }

    fn expect_any(&mut self, expected: &str) -> Result<StlWord<'a>, TriangleMeshError> {
        let line = self.line;
        self.next().ok_or_else(|| {
            invalid(format!("line {line}: expected {expected}, found the end of the file"))
        })
    }

    fn expect(&mut self, keyword: &str) -> Result<(), TriangleMeshError> {
        let expected = format!("`{keyword}`");
        let word = self.expect_any(&expected)?;
        if word.is(keyword) { Ok(()) } else { Err(word.unexpected(&expected)) }
    }

    fn number(&mut self) -> Result<f64, TriangleMeshError> {
        let word = self.expect_any("a number")?;
        let number = str::from_utf8(word.text).ok().and_then(|text| text.parse().ok());
        number.filter(|number: &f64| number.is_finite()).ok_or_else(|| word.unexpected("a number"))
    }
}
