//! Files of programs that may be interrupted or killed.
//!
//! An [`Output`] appears whole or not at all, and replaces what was there before only when it is complete; so does a
//! folder ([`write_folder`]). What a killed process leaves behind is removed, and what others use is not
//! ([`leftovers`]). An interrupt of the process ends what writes ([`mod@interrupt`]). Files that other files name are beside them
//! ([`beside()`]).

mod beside;
pub mod interrupt;
pub mod leftovers;
mod output;
mod output_folder;
mod repetition;

pub use beside::{NotBeside, beside, folder_of};
pub use output::{Output, OutputError, Stream};
pub use output_folder::write_folder;
pub use repetition::Repetition;
