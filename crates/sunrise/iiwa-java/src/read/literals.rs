//! Literals and their values.

use super::{fault::SyntaxFault, reader::TreeReader, tree::SyntaxNode};
use crate::syntax::{ExpressionKind, Literal};

impl TreeReader<'_> {
    pub(super) fn literal(&self, node: SyntaxNode<'_>) -> Result<ExpressionKind, SyntaxFault> {
        let written = self.source(node);
        let value = match node.kind() {
            "true" => Literal::Boolean(true),
            "false" => Literal::Boolean(false),
            "null_literal" => Literal::Null,
            "character_literal" => self.character(node)?,
            "string_literal" if written.starts_with("\"\"\"") => {
                let block = unindented(written.get(3..written.len() - 3).unwrap_or(""));
                let units = units(&block, |_| node.start())?;
                Literal::String(String::from_utf16_lossy(&units))
            }
            "string_literal" => Literal::String(String::from_utf16_lossy(&self.units(node)?)),
            "decimal_floating_point_literal" => self.float(node)?,
            "hex_floating_point_literal" => {
                let reason = "a hexadecimal number with an exponent";
                return Ok(ExpressionKind::Unsupported(reason.to_owned()));
            }
            _ => self.integer(node, false)?,
        };
        Ok(ExpressionKind::Literal(value))
    }

    /// Reads an `int` or a `long`; the minimum values need the sign before them.
    pub(super) fn integer(
        &self,
        node: SyntaxNode<'_>,
        is_negative: bool,
    ) -> Result<Literal, SyntaxFault> {
        let written = self.source(node);
        let fault =
            |reason: &str| SyntaxFault::syntax(node.start(), format!("{written}: {reason}"));
        let digits = written.replace('_', "");
        let (digits, is_long) = match digits.strip_suffix(['l', 'L']) {
            Some(digits) => (digits, true),
            None => (digits.as_str(), false),
        };
        let lower = digits.to_ascii_lowercase();
        let (digits, radix) = if let Some(digits) = lower.strip_prefix("0x") {
            (digits, 16)
        } else if let Some(digits) = lower.strip_prefix("0b") {
            (digits, 2)
        } else if let Some(digits) = lower.strip_prefix('0').filter(|digits| !digits.is_empty()) {
            (digits, 8)
        } else {
            (lower.as_str(), 10)
        };
        if digits.is_empty() || !digits.chars().all(|digit| digit.is_digit(radix)) {
            return Err(fault("a whole number is expected"));
        }
        let magnitude = u64::from_str_radix(digits, radix).ok();
        // Hexadecimal, octal and binary numbers define all bits, including the sign bit.
        let is_decimal = radix == 10;
        if is_long {
            let max = i64::MAX.unsigned_abs() + u64::from(is_negative);
            let value = magnitude.filter(|value| !is_decimal || *value <= max);
            let value =
                value.ok_or_else(|| fault("this is more than a `long` holds"))?.cast_signed();
            return Ok(Literal::Long(if is_negative { value.wrapping_neg() } else { value }));
        }
        let max = i32::MAX.unsigned_abs() + u32::from(is_negative);
        let value = magnitude.and_then(|value| u32::try_from(value).ok());
        let value = value.filter(|value| !is_decimal || *value <= max);
        let value = value.ok_or_else(|| fault("this is more than an `int` holds"))?.cast_signed();
        Ok(Literal::Int(if is_negative { value.wrapping_neg() } else { value }))
    }

    /// Reads a `float` or a `double`.
    fn float(&self, node: SyntaxNode<'_>) -> Result<Literal, SyntaxFault> {
        let written = self.source(node);
        let digits = written.replace('_', "");
        let fault =
            |reason: &str| SyntaxFault::syntax(node.start(), format!("{written}: {reason}"));
        if let Some(digits) = digits.strip_suffix(['f', 'F']) {
            let value: f32 = digits.parse().map_err(|_| fault("a number is expected"))?;
            if !value.is_finite() {
                return Err(fault("this is more than a `float` holds"));
            }
            return Ok(Literal::Float(value));
        }
        let digits = digits.strip_suffix(['d', 'D']).unwrap_or(&digits);
        let value: f64 = digits.parse().map_err(|_| fault("a number is expected"))?;
        if !value.is_finite() {
            return Err(fault("this is more than a `double` holds"));
        }
        Ok(Literal::Double(value))
    }

    fn character(&self, node: SyntaxNode<'_>) -> Result<Literal, SyntaxFault> {
        match self.units(node)?[..] {
            [unit] => Ok(Literal::Char(unit)),
            _ => Err(SyntaxFault::syntax(
                node.start(),
                "one character is expected between the quotes",
            )),
        }
    }

    /// Returns the text between quotes as UTF-16 units, as in Java.
    fn units(&self, node: SyntaxNode<'_>) -> Result<Vec<u16>, SyntaxFault> {
        let written = self.source(node);
        let inner = written.get(1..written.len().saturating_sub(1)).unwrap_or("");
        units(inner, |rest| node.start() + written.len() - 2 - rest)
    }
}

/// Returns the content of a text block without incidental white space (JLS 3.10.6).
fn unindented(block: &str) -> String {
    let block = block.replace("\r\n", "\n").replace('\r', "\n");
    let content = block.split_once('\n').map_or("", |(_, content)| content);
    let lines: Vec<&str> = content.split('\n').collect();
    let is_blank = |line: &str| line.trim().is_empty();
    let indents = lines.iter().enumerate().filter(|(place, line)| {
        // The indentation of the closing delimiter counts as well.
        !is_blank(line) || place + 1 == lines.len()
    });
    let indent = |line: &str| line.chars().take_while(|letter| letter.is_whitespace()).count();
    let indent = indents.map(|(_, line)| indent(line)).min().unwrap_or(0);
    let stripped = lines.iter().map(|line| {
        let behind: String = line.chars().skip(indent).collect();
        behind.trim_end().to_owned()
    });
    stripped.collect::<Vec<_>>().join("\n")
}

/// Converts a text to UTF-16 with its escape sequences replaced; `place` returns the file offset
/// for the length of the remaining text.
fn units(inner: &str, place: impl Fn(usize) -> usize) -> Result<Vec<u16>, SyntaxFault> {
    let mut units = Vec::with_capacity(inner.len());
    let mut rest = inner.chars();
    let mut buffer = [0; 2];
    while let Some(character) = rest.next() {
        if character != '\\' {
            units.extend_from_slice(character.encode_utf16(&mut buffer));
            continue;
        }
        let offset = place(rest.as_str().len());
        let unknown = || SyntaxFault::syntax(offset, "the character after `\\` cannot be escaped");
        let escaped = rest.next().ok_or_else(unknown)?;
        if escaped == '\n' {
            // The line of a text block is continued.
            continue;
        }
        units.push(match escaped {
            'b' => 8,
            't' => 9,
            'n' => 10,
            'f' => 12,
            'r' => 13,
            's' => 32,
            '"' => 34,
            '\'' => 39,
            '\\' => 92,
            'u' => {
                let digits = rest.as_str().trim_start_matches('u');
                let code =
                    digits.get(..4).filter(|code| code.chars().all(|c| c.is_ascii_hexdigit()));
                let code = code.ok_or_else(unknown)?;
                rest = digits[4..].chars();
                u16::from_str_radix(code, 16).map_err(|_| unknown())?
            }
            '0'..='7' => {
                // Three digits if the first is at most 3, otherwise two.
                let max_digits = if escaped <= '3' { 2 } else { 1 };
                let digits: String =
                    rest.as_str().chars().take(max_digits).take_while(|c| c.is_digit(8)).collect();
                rest = rest.as_str()[digits.len()..].chars();
                u16::from_str_radix(&format!("{escaped}{digits}"), 8).map_err(|_| unknown())?
            }
            _ => return Err(unknown()),
        });
    }
    Ok(units)
}
