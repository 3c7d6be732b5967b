//! What the program prints while it runs.

/// Shows a line at once.
#[expect(clippy::print_stdout, reason = "it is what the program is for")]
pub(super) fn tell(line: &str) {
    println!("{line}");
}
