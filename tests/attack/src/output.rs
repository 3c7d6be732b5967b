//! Output of the harness.

/// Prints a line at once.
#[expect(clippy::print_stdout, reason = "the output of the program")]
pub(super) fn print(line: &str) {
    println!("{line}");
}
