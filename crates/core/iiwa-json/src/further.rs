//! Number of errors after the first one.

/// Suffix of a message that names the first of several errors: the number of the others.
///
/// ```
/// assert_eq!(iiwa_json::further_errors(0), "");
/// assert_eq!(iiwa_json::further_errors(1), "; and one more error");
/// assert_eq!(iiwa_json::further_errors(2), "; and 2 more errors");
/// ```
#[must_use]
pub fn further_errors(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => "; and one more error".to_owned(),
        count => format!("; and {count} more errors"),
    }
}
