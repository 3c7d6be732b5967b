//! Recordings.

#![no_main]

use iiwa_log::Recording;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = Recording::from_bytes(bytes);
});
