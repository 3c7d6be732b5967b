//! Report on an experiment: Markdown, and its figures.

use std::fmt::{Display, Write as _};

use super::bench::Bench;

/// Part of a report.
#[derive(Clone, Debug, Default)]
pub struct Chapter {
    /// Markdown.
    pub text: String,
    /// Names and contents of SVG files.
    pub figures: Vec<(String, String)>,
}

impl Chapter {
    pub(crate) fn new(title: &str) -> Self {
        Self { text: format!("## {title}\n"), figures: Vec::new() }
    }

    /// Adds a paragraph, unless its text is empty.
    pub(crate) fn paragraph(&mut self, text: impl AsRef<str>) {
        let text = text.as_ref().trim();
        if !text.is_empty() {
            self.text.push('\n');
            self.text.push_str(&wrapped(text));
            self.text.push('\n');
        }
    }

    pub(crate) fn heading(&mut self, title: &str) {
        let _ = writeln!(self.text, "\n### {title}");
    }

    /// Adds a figure with the number from the thesis.
    pub(crate) fn figure(&mut self, bench: &Bench, number: &str, caption: &str, svg: String) {
        let name = format!("figure-{number}.svg");
        let caption = format!("{caption} ({})", bench.on);
        let _ = writeln!(self.text, "\n![{caption}]({}{name})", bench.link);
        self.paragraph(format!("*{caption}.*"));
        self.figures.push((name, svg));
    }

    /// Adds a table; all columns but the first are numbers.
    pub(crate) fn table<C: Display>(&mut self, head: &[&str], rows: &[Vec<C>]) {
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        self.text.push('\n');
        self.text.push_str(&line(head.iter().map(ToString::to_string).collect()));
        let rule: Vec<_> = (0..head.len()).map(|i| if i == 0 { "---" } else { "---:" }).collect();
        let _ = writeln!(self.text, "|{}|", rule.join("|"));
        for row in rows {
            self.text.push_str(&line(row.iter().map(ToString::to_string).collect()));
        }
    }
}

/// Wraps the paragraph into lines of up to a hundred characters.
#[must_use]
pub fn wrapped(text: &str) -> String {
    const WIDTH: usize = 100;
    let mut lines = String::new();
    let mut width = 0;
    for word in text.split_whitespace() {
        let long = word.chars().count();
        if width > 0 && width + 1 + long > WIDTH {
            lines.push('\n');
            width = 0;
        } else if width > 0 {
            lines.push(' ');
            width += 1;
        }
        lines.push_str(word);
        width += long;
    }
    lines
}
