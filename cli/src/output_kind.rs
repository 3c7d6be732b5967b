//! Kinds of output files: their names, and the files that they may replace.

use std::{
    fs::File,
    io::{self, Read},
    path::Path,
};

use iiwa_log::is_recording;
use iiwa_report::PictureFormat;

use crate::failure::Failure;

/// Kind of a file, or of a folder, that a command writes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum OutputKind {
    Trajectory,
    Csv,
    Parquet,
    Picture(PictureFormat),
    Page,
    #[cfg(feature = "live")]
    Recording,
    Profile,
    #[cfg_attr(
        not(any(feature = "optimise", feature = "sunrise")),
        expect(dead_code, reason = "searches and imports write programs")
    )]
    Program,
    #[cfg(feature = "sunrise")]
    Frames,
    #[cfg(feature = "sunrise")]
    DataFile,
    #[cfg(feature = "sunrise")]
    Project,
}

/// File extensions of all formats that commands write.
const EXTENSIONS: [&str; 9] =
    ["csv", "html", "json", "mcap", "parquet", "pdf", "png", "svg", "xml"];

impl OutputKind {
    /// Name of the kind in messages.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Trajectory => "trajectory",
            Self::Csv | Self::Parquet => "table",
            Self::Picture(_) => "picture",
            Self::Page => "page",
            #[cfg(feature = "live")]
            Self::Recording => "recording",
            Self::Profile => "profile",
            Self::Program => "program",
            #[cfg(feature = "sunrise")]
            Self::Frames => "file of frames",
            #[cfg(feature = "sunrise")]
            Self::DataFile => "data file",
            #[cfg(feature = "sunrise")]
            Self::Project => "project",
        }
    }

    /// Name of the format, and its file extension; `None` if any name will do.
    fn format(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Trajectory => Some(("MCAP", "mcap")),
            #[cfg(feature = "live")]
            Self::Recording => Some(("MCAP", "mcap")),
            Self::Csv => Some(("CSV", "csv")),
            Self::Parquet => Some(("Apache Parquet", "parquet")),
            // A picture has the format that its extension names.
            Self::Picture(_) => None,
            Self::Page => Some(("HTML", "html")),
            Self::Profile | Self::Program => Some(("JSON", "json")),
            #[cfg(feature = "sunrise")]
            Self::Frames => Some(("JSON", "json")),
            #[cfg(feature = "sunrise")]
            Self::DataFile => Some(("XML", "xml")),
            #[cfg(feature = "sunrise")]
            Self::Project => None,
        }
    }

    /// Rejects a name that asks for another format, or for standard output. Unknown extensions are
    /// accepted.
    pub(crate) fn check_name(self, path: &Path) -> Result<(), Failure> {
        let name = self.name();
        if path == Path::new("-") {
            return Err(Failure::input(format!(
                "the {name} cannot be written to standard output (-): name a file"
            )));
        }
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match self.format() {
            Some((format, own)) if extension != own && EXTENSIONS.contains(&&*extension) => {
                Err(Failure::input(format!(
                    "{}: the {name} is written as {format}, in a file *.{own}",
                    path.display()
                )))
            }
            _ => Ok(()),
        }
    }

    /// Rejects a path with a file of another kind. Files that are computed again from their inputs
    /// replace files of their kind without asking.
    pub(crate) fn check_existing(self, path: &Path) -> Result<(), Failure> {
        let content = head(path).map_err(|error| {
            Failure::input(format!("cannot read {}, which is kept: {error}", path.display()))
        })?;
        if content.is_empty() || self.begins(&content) {
            return Ok(());
        }
        let name = match self {
            Self::Trajectory if content.starts_with(MCAP) => "a trajectory of `iiwasim plan`",
            Self::Trajectory => "a trajectory",
            Self::Csv => "a table of `iiwasim plan`",
            Self::Parquet => "a Parquet file",
            Self::Picture(_) => "a picture of this format",
            Self::Page => "a page",
            _ => "of this kind",
        };
        Err(Failure::input(format!(
            "{} exists and is not {name}: it is kept; name another file, or remove it",
            path.display()
        )))
    }

    /// Returns true if a file with this content is of this kind.
    fn begins(self, content: &[u8]) -> bool {
        let text = || String::from_utf8_lossy(content).trim_start().to_ascii_lowercase();
        match self {
            Self::Trajectory => content.starts_with(MCAP) && !is_recording(content),
            Self::Csv => content.starts_with(b"t_s,"),
            Self::Parquet => content.starts_with(b"PAR1"),
            Self::Picture(PictureFormat::Png) => content.starts_with(b"\x89PNG"),
            Self::Picture(PictureFormat::Pdf) => content.starts_with(b"%PDF"),
            Self::Picture(_) => ["<svg", "<?xml"].iter().any(|it| text().starts_with(it)),
            Self::Page => text().starts_with("<!doctype html"),
            _ => false,
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
