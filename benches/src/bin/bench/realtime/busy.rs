//! Process that keeps a core busy.

use std::thread;

use iiwasim_benches::Result;

use super::part::serve;

/// Keeps a core busy at ordinary priority.
pub(crate) fn be_busy() -> Result<()> {
    thread::spawn(|| {
        loop {
            std::hint::spin_loop();
        }
    });
    serve(|| ())
}
