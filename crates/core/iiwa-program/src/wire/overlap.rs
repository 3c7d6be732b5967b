//! Keys `overlap` and `overlap_motions` of waits, inputs and outputs.

/// Returns the number of overlapped motions, or the key at fault and the reason.
pub(super) fn of_keys(
    overlap: Option<bool>,
    overlap_motions: Option<usize>,
) -> Result<usize, (&'static str, String)> {
    let wrong = |message: &str| Err(("overlap_motions", message.to_owned()));
    match (overlap, overlap_motions) {
        (Some(_), Some(_)) => wrong("give either `overlap` or `overlap_motions`"),
        (_, Some(0)) => wrong("overlap_motions must be at least 1"),
        (_, Some(motions)) => Ok(motions),
        (Some(true), None) => Ok(1),
        (Some(false) | None, None) => Ok(0),
    }
}

/// Values of the two keys for a number of overlapped motions.
pub(super) fn in_keys(overlap: usize) -> (Option<bool>, Option<usize>) {
    ((overlap == 1).then_some(true), (overlap > 1).then_some(overlap))
}
