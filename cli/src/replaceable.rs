//! Files that a command may overwrite.

use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

use iiwa_log::is_recording;
use iiwa_report::PictureFormat;

use crate::failure::Failure;

/// Generated file: it replaces files of the same kind, and no others.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Replaceable {
    Trajectory,
    Csv,
    Parquet,
    Picture(PictureFormat),
    Page,
}

impl Replaceable {
    /// Rejects a path with a file of another kind.
    pub(crate) fn check(self, path: &Path) -> Result<(), Failure> {
        let Ok(content) = head(path) else { return Ok(()) };
        if content.is_empty() || self.matches_start(&content) {
            return Ok(());
        }
        let name = match self {
            Self::Trajectory if content.starts_with(MCAP) => "a trajectory of `iiwasim plan`",
            Self::Trajectory => "a trajectory",
            Self::Csv => "a table of `iiwasim plan`",
            Self::Parquet => "a Parquet file",
            Self::Picture(_) => "a picture of this format",
            Self::Page => "a page",
        };
        Err(Failure::input(format!(
            "{} exists and is not {name}: it is kept; name another file, or remove it",
            path.display()
        )))
    }

    /// Returns true if a file with this content is of this kind.
    fn matches_start(self, content: &[u8]) -> bool {
        let text = || String::from_utf8_lossy(content).trim_start().to_ascii_lowercase();
        match self {
            Self::Trajectory => content.starts_with(MCAP) && !is_recording(content),
            Self::Csv => content.starts_with(b"t_s,"),
            Self::Parquet => content.starts_with(b"PAR1"),
            Self::Picture(PictureFormat::Png) => content.starts_with(b"\x89PNG"),
            Self::Picture(PictureFormat::Pdf) => content.starts_with(b"%PDF"),
            Self::Picture(_) => ["<svg", "<?xml"].iter().any(|it| text().starts_with(it)),
            Self::Page => text().starts_with("<!doctype html"),
        }
    }
}

/// First bytes of an MCAP file.
const MCAP: &[u8] = b"\x89MCAP";

/// Reads the first bytes of a file.
fn head(path: &Path) -> io::Result<Vec<u8>> {
    let mut content = Vec::new();
    if path.is_file() {
        File::open(path)?.take(512).read_to_end(&mut content)?;
    }
    Ok(content)
}
