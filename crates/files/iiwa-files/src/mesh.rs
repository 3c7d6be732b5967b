//! Mesh files that programs and scenes name.

use std::{io, path::Path};

use crate::input::read_up_to;

/// Maximum size of a mesh file, in bytes.
pub const MAX_MESH_BYTES: u64 = 20_000_000;

/// Reads a mesh file of at most [`MAX_MESH_BYTES`].
///
/// # Errors
///
/// The reason why the file cannot be read, with the remedy for a larger file.
pub fn read_mesh(path: &Path) -> Result<Vec<u8>, String> {
    read_up_to(path, MAX_MESH_BYTES).map_err(|error| match error.kind() {
        io::ErrorKind::FileTooLarge => format!("{error}: make the mesh coarser"),
        _ => format!("cannot read {}: {error}", path.display()),
    })
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use super::*;

    #[test]
    fn large_files_are_not_read_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.stl");
        assert!(read_mesh(&path).unwrap_err().starts_with("cannot read "));
        let file = File::create(&path).unwrap();
        file.set_len(MAX_MESH_BYTES).unwrap();
        assert_eq!(read_mesh(&path).unwrap().len() as u64, MAX_MESH_BYTES);
        // A sparse file, which needs no space.
        file.set_len(3_000_000_000).unwrap();
        let error = read_mesh(&path).unwrap_err();
        assert_eq!(error, "the file has more than 20000000 bytes: make the mesh coarser");
    }
}
