//! Any valid program.

use iiwa_program::Program;
use proptest::{
    strategy::{Strategy, ValueTree},
    test_runner::{Config, RngAlgorithm, TestRng, TestRunner},
};

use crate::random::drafts;

/// Returns draws for program `index`, of which the first valid one is used.
pub(super) fn programs(seed: u64, index: u64) -> impl Iterator<Item = Program> {
    let mut bytes = [0; 32];
    bytes[..8].copy_from_slice(&seed.to_le_bytes());
    bytes[8..16].copy_from_slice(&index.to_le_bytes());
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &bytes);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    let drafts = drafts(12);
    std::iter::from_fn(move || Some(drafts.new_tree(&mut runner).ok()?.current()))
}
