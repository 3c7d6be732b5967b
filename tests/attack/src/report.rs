//! Table of requirements and measurements.

/// Row of the table.
pub(super) struct Row {
    pub(super) quantity: String,
    pub(super) required: String,
    pub(super) measured: String,
    pub(super) met: bool,
}

/// Formats the table as Markdown.
pub(super) fn table(rows: &[Row]) -> String {
    let head = "| what | required | measured | |\n|---|---|---|---|\n".to_owned();
    rows.iter().fold(head, |table, Row { quantity, required, measured, met }| {
        let verdict = if *met { "met" } else { "**not met**" };
        table + &format!("| {quantity} | {required} | {measured} | {verdict} |\n")
    })
}
