//! Tables for the terminal.

use std::iter::zip;

use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, LineStyle, Table, Width, presets,
};

/// Number of rows shown at the start and at the end of a long table.
const SHOWN: usize = 100;

/// Titles of text columns; all others are columns of numbers.
const TEXT: [&str; 36] = [
    "name",
    "round",
    "block",
    "I/O",
    "direction",
    "value",
    "type",
    "group",
    "limited by",
    "source",
    "question",
    "answer",
    "option",
    "application",
    "line",
    "limited by, % of its time",
    "robot",
    "quantity",
    "unit",
    "program",
    "result",
    "tool",
    "TCP",
    "tips",
    "frame",
    "used as",
    "taught with",
    "check",
    "not taken",
    "renamed",
    "to",
    "why",
    "trend",
    "assumed",
    "change",
    "rests on",
];

/// Creates a table with a header; columns of numbers are right-aligned.
#[must_use]
pub fn table(head: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING.header_separator(LineStyle::none().fill('─').junction('─')));
    table.set_header(head.iter().copied());
    for (index, title) in head.iter().enumerate() {
        if let Some(column) = table.column_mut(index) {
            column.set_padding((0, u16::from(index + 1 < head.len())));
            if !TEXT.contains(title) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
    }
    table
}

/// Formats a table of [`table`] in lines of at most `width` characters: cells of text columns are
/// wrapped. Numbers are never wrapped, and text columns keep a few characters; a table with many
/// columns can therefore be wider than a narrow terminal. Without `width`, no cell is wrapped.
#[must_use]
pub fn fitted(mut table: Table, width: Option<u16>) -> String {
    if let Some(width) = width {
        fit(&mut table, usize::from(width));
    }
    table.trim_fmt()
}

/// Sets the widths of the columns.
fn fit(table: &mut Table, width: usize) {
    /// Smallest width of a text column with longer cells.
    const MIN_TEXT: usize = 8;
    let longest: Vec<_> = table.column_max_content_widths().into_iter().map(usize::from).collect();
    let between: usize = 2 * longest.len().saturating_sub(1);
    let excess = (longest.iter().sum::<usize>() + between).saturating_sub(width);
    if excess == 0 {
        return;
    }
    let titles = table.header().into_iter().flat_map(|header| header.cell_iter());
    let is_text = titles.map(|title| TEXT.contains(&title.content().as_str()));
    let mut text: Vec<_> =
        zip(0.., is_text).filter(|(_, is_text)| *is_text).map(|(column, _)| column).collect();
    // Columns with short cells keep their width; the others share the rest equally.
    text.sort_by_key(|column: &usize| longest[*column]);
    let mut free = text.iter().map(|column| longest[*column]).sum::<usize>().saturating_sub(excess);
    let mut widths = longest.clone();
    for (number, column) in text.iter().enumerate() {
        let share = free / (text.len() - number);
        widths[*column] = longest[*column].min(share.max(MIN_TEXT));
        free = free.saturating_sub(widths[*column]);
    }
    for (column, width) in zip(table.column_iter_mut(), widths) {
        let width = u16::try_from(width).unwrap_or(u16::MAX).saturating_add(column.padding_width());
        column.set_constraint(ColumnConstraint::Absolute(Width::Fixed(width)));
    }
    table.set_content_arrangement(ContentArrangement::Dynamic);
    table.set_width(u16::try_from(width).unwrap_or(u16::MAX));
}

/// Adds a row per entry; for a long list, only for the first and the last ones. The JSON output has
/// all.
pub(crate) fn shortened<T>(table: &mut Table, rows: &[T], mut add: impl FnMut(&mut Table, &T)) {
    let hidden = rows.len().saturating_sub(2 * SHOWN);
    for (index, row) in rows.iter().enumerate() {
        if hidden == 0 || index < SHOWN || index >= rows.len() - SHOWN {
            add(table, row);
        } else if index == SHOWN {
            table.add_row(["...".to_owned(), format!("{hidden} more")]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Table {
        let mut table = table(&["motion", "type", "name", "start s", "limited by"]);
        let name = "approach above the left pallet, behind the fence";
        table.add_row(["1", "ptp", name, "1234.567", "A1 velocity 80, A2 jerk 15"]);
        table.add_row(["2", "spline", "b", "5.000", "A7 acceleration 100"]);
        table
    }

    /// Widest line of the example, in characters.
    const NATURAL: usize = 102;

    #[test]
    fn text_is_wrapped_and_numbers_are_whole() {
        for width in 1..150_u16 {
            let text = fitted(example(), Some(width));
            let widest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
            // Numbers and short words have this width.
            assert!(widest <= usize::from(width.max(47)), "{width}: {widest}\n{text}");
            if usize::from(width) < NATURAL {
                assert!(text.contains(" 1234.567 ") && text.contains("     1 "), "{text}");
            } else {
                assert_eq!(text, fitted(example(), None), "{width}");
            }
            let line = |text: &str| text.lines().any(|line| line.ends_with(text));
            assert!(width < 70 || line("A7 acceleration 100"), "{text}");
            assert!(text.lines().all(|line| line == line.trim_end()), "{text}");
        }
    }

    #[test]
    fn a_table_without_width_has_a_line_per_row() {
        let text = fitted(example(), None);
        assert_eq!(text.lines().count(), 4, "{text}");
        assert_eq!(text.lines().map(|line| line.chars().count()).max(), Some(NATURAL), "{text}");
    }
}
