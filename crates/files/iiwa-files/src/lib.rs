//! Files of programs that may be interrupted or killed.
//!
//! An [`Output`] is written atomically: it replaces the previous file only when it is complete, and
//! so does a folder ([`write_folder`]). Leftovers of killed processes are removed, files in use are
//! not ([`leftovers`]). An interrupt of the process ends all writing ([`mod@interrupt`]). Files
//! that other files name are in the same folder or below ([`beside()`]). An [`InputFile`] is a
//! regular file or a pipe, which no missing writer makes hang.

mod beside;
mod input;
pub mod interrupt;
pub mod leftovers;
mod mesh;
mod output;
mod output_folder;
mod repetition;

pub use beside::{NotBeside, beside, folder_of};
pub use input::{InputFile, NotUtf8, read, read_stdin, read_text, text};
pub use mesh::{MAX_MESH_BYTES, read_mesh};
pub use output::{Output, OutputError, OutputStream, destination};
pub use output_folder::write_folder;
pub use repetition::Repetition;
