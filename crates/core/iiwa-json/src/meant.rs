//! Suggestions for misspelled words.

use strsim::damerau_levenshtein;

use crate::excerpt::excerpt;

/// Word of `known` most similar to `found`, if a typing error, a capital letter or a missing ending
/// explains the difference. Of several words that add a unit, the one in degrees or mm is returned.
///
/// ```
/// let keys = ["velocity_rel", "acceleration_rel", "blend"];
/// assert_eq!(iiwa_json::meant("velocty_rel", keys), Some("velocity_rel"));
/// assert_eq!(iiwa_json::meant("velocity", keys), Some("velocity_rel"));
/// assert_eq!(iiwa_json::meant("colour", keys), None);
/// assert_eq!(iiwa_json::meant("joints", ["joints_rad", "joints_deg"]), Some("joints_deg"));
/// ```
#[must_use]
pub fn meant<'a>(text: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // A text longer than any word is not a word, and takes long to compare.
    if text.len() > MAX_WORD {
        return None;
    }
    let text = text.to_lowercase();
    let known: Vec<&str> = known.into_iter().collect();
    let off = |word: &&str| damerau_levenshtein(&text, &word.to_lowercase());
    let near = known.iter().map(|word| (off(word), *word));
    let nearest = near.filter(|(off, word)| 3 * off < word.len().min(text.len())).min();
    let begun = || {
        let mut begun = known.iter().filter(|word| word.starts_with(&text));
        begun.next().filter(|_| text.len() >= MIN_BEGINNING && begun.next().is_none()).copied()
    };
    let of_units = || {
        let begin = format!("{text}_");
        let longer = known.iter().filter(|word| word.starts_with(&begin)).copied();
        let in_usual_unit = |word: &&str| ["_deg", "_mm"].iter().any(|unit| word.ends_with(unit));
        match longer.collect::<Vec<_>>().as_slice() {
            [only] => Some(*only),
            several => several.iter().copied().find(in_usual_unit),
        }
    };
    nearest.map(|(_, word)| word).or_else(begun).or_else(of_units)
}

/// Longest word, in bytes.
const MAX_WORD: usize = 64;
/// Smallest number of letters for which a unique beginning of a word is sufficient.
const MIN_BEGINNING: usize = 4;

/// Error message for an unknown word, with the likely word or a list of all.
///
/// ```
/// let message = iiwa_json::unknown("type", "PTP", &["ptp", "lin", "wait"]);
/// assert_eq!(message, "unknown type `PTP`; did you mean `ptp`?");
/// let message = iiwa_json::unknown("type", "fly", &["ptp", "lin", "wait"]);
/// assert_eq!(message, "unknown type `fly`; `ptp`, `lin` and `wait` are known");
/// ```
#[must_use]
pub fn unknown(kind: &str, text: &str, known: &[&str]) -> String {
    let shown = excerpt(text);
    match meant(text, known.iter().copied()) {
        Some(word) => format!("unknown {kind} `{shown}`; did you mean `{word}`?"),
        None => format!("unknown {kind} `{shown}`; {}", are_known(known)),
    }
}

/// Lists all known words in a sentence.
#[must_use]
pub fn are_known(known: &[&str]) -> String {
    match known {
        [] => "none are known".to_owned(),
        [only] => format!("`{only}` is known"),
        [others @ .., last] => format!("`{}` and `{last}` are known", others.join("`, `")),
    }
}
