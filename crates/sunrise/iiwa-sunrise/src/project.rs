//! Sources of a Sunrise project.

use std::{
    fs,
    io::{self, Read},
    path::{Path, PathBuf},
};

use iiwa_java::{Classes, CompilationUnit, SourceError, SourceFault, decode};
use iiwa_program::MotionLabel;
use rayon::iter::{IntoParallelIterator, ParallelIterator};

use crate::{
    label_comment::stated_labels,
    project_folder::{self, DATA_FILE, FolderFault, MAX_FILES, MAX_FOLDERS, STATION_FILE},
    robot_statement::{RobotStatement, in_java, in_station},
};

/// Maximum size of a file.
const MAX_BYTES: u64 = 10_000_000;
/// Maximum size of all files.
const MAX_BYTES_IN_TOTAL: u64 = 100_000_000;

/// Java files of a Sunrise project, its data file, and its statements about its robot.
///
/// An unusable file is kept with its error, which matters only if the file is needed.
#[derive(Debug)]
pub struct Project {
    files: Vec<SourceFile>,
    data: ProjectData,
    station: Result<Vec<RobotStatement>, StationFault>,
}

/// Error of an unusable `StationSetup.cat`.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{path} cannot be used: {reason}")]
pub struct StationFault {
    /// Path of the file, relative to the project folder.
    pub path: String,
    /// Reason.
    pub reason: String,
}

/// Java file of a project.
#[derive(Debug)]
pub struct SourceFile {
    path: String,
    unit: Result<CompilationUnit, SourceError>,
    robots: Vec<RobotStatement>,
    /// Stated durations in s, by line.
    times: Vec<(usize, f64)>,
    /// Stated labels, by line.
    labels: Vec<(u32, MotionLabel)>,
}

/// Returns the durations that the comments `// iiwasim: SECONDS s` at the ends of lines state.
fn stated_times(text: &str) -> Vec<(usize, f64)> {
    let time = |line: &str| {
        let (_, comment) = line.rsplit_once("// iiwasim: ")?;
        comment.trim_end().strip_suffix(" s")?.parse().ok()
    };
    let lines = text.lines().enumerate();
    lines.filter_map(|(index, line)| Some((index + 1, time(line)?))).collect()
}

/// File `RoboticsAPI.data.xml` of a project, from which [`DataFile`](crate::DataFile) reads frames
/// and tools.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ProjectData {
    /// No data file exists in the project folder, one level below, or one level above.
    Absent,
    /// One data file was found.
    Found {
        /// Path relative to the project folder, with `/`.
        path: String,
        /// Content of the file.
        text: String,
    },
    /// Paths of several data files in subfolders: each belongs to a separate project.
    Several(Vec<String>),
    /// The data file cannot be read.
    Unreadable {
        /// Path relative to the project folder, with `/`.
        path: String,
        /// Reason.
        reason: String,
    },
}

/// Error of opening a project.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProjectError {
    /// The folder cannot be read.
    #[error("{path} cannot be read: {source}")]
    Folder {
        /// Path of the folder.
        path: PathBuf,
        /// Cause.
        source: io::Error,
    },
    /// The folder has too many Java files.
    #[error("the folder has more than {max_files} Java files: a project's own folder is expected")]
    TooManyFiles {
        /// Maximum number of files.
        max_files: usize,
    },
    /// The folder has too many subfolders.
    #[error("the folder has more than {max_folders} folders: a project's own folder is expected")]
    TooManyFolders {
        /// Maximum number of folders.
        max_folders: usize,
    },
    /// The Java files are too large in total.
    #[error(
        "the Java files have more than {max_bytes} bytes in all: a project's own folder is expected"
    )]
    TooLarge {
        /// Maximum number of bytes.
        max_bytes: u64,
    },
}

impl Project {
    /// Returns true if the folder has Java files that [`open`](Self::open) would read.
    #[must_use]
    pub fn has_sources(folder: &Path) -> bool {
        match project_folder::sources(folder) {
            Ok(sources) => !sources.is_empty(),
            Err(FolderFault::Files | FolderFault::Folders) => true,
            Err(FolderFault::Unreadable(..)) => false,
        }
    }

    /// Reads the project in a folder: all `*.java` files in the folder and its subfolders, except
    /// hidden folders, `bin` and `target`; and `RoboticsAPI.data.xml` and `StationSetup.cat`, in
    /// the folder, one level below or one level above.
    ///
    /// # Errors
    ///
    /// If the folder cannot be read, or if it exceeds the limits of a project.
    pub fn open(folder: &Path) -> Result<Self, ProjectError> {
        let sources = project_folder::sources(folder).map_err(|fault| match fault {
            FolderFault::Files => ProjectError::TooManyFiles { max_files: MAX_FILES },
            FolderFault::Folders => ProjectError::TooManyFolders { max_folders: MAX_FOLDERS },
            FolderFault::Unreadable(path, source) => ProjectError::Folder { path, source },
        })?;
        let data = match &project_folder::nearest(folder, DATA_FILE)[..] {
            [] => ProjectData::Absent,
            [(name, path)] => match contents(path) {
                Ok(bytes) => ProjectData::Found { path: name.clone(), text: decode(&bytes) },
                Err(fault) => {
                    ProjectData::Unreadable { path: name.clone(), reason: fault.to_string() }
                }
            },
            several => ProjectData::Several(several.iter().map(|(name, _)| name.clone()).collect()),
        };
        let mut reading = ProjectReading::default();
        match &project_folder::nearest(folder, STATION_FILE)[..] {
            [] => {}
            [(name, path)] => reading.add_station(name, contents(path)),
            [(first, _), (second, _), ..] => {
                let reason = format!("there is {second} as well");
                reading.station = Err(StationFault { path: first.clone(), reason });
            }
        }
        for (name, path) in sources {
            match contents(&path) {
                Ok(bytes) => reading.add(name, &bytes)?,
                Err(fault) => reading.texts.push((name, Err(fault))),
            }
        }
        Ok(reading.project(data))
    }

    /// Creates a project from files that are given by their paths relative to its folder, with `/`,
    /// and their contents. Files called `RoboticsAPI.data.xml` and `StationSetup.cat` are its data
    /// file and its station; all others are Java.
    ///
    /// # Errors
    ///
    /// If the files exceed the limits of a project.
    pub fn from_texts<P, T>(files: impl IntoIterator<Item = (P, T)>) -> Result<Self, ProjectError>
    where
        P: Into<String>,
        T: AsRef<[u8]>,
    {
        let mut data = ProjectData::Absent;
        let mut reading = ProjectReading::default();
        for (path, bytes) in files {
            let path = path.into();
            match path.rsplit('/').next() {
                Some(DATA_FILE) => {
                    data = ProjectData::Found { path, text: decode(bytes.as_ref()) };
                }
                Some(STATION_FILE) => reading.add_station(&path, Ok(bytes.as_ref().to_vec())),
                _ => reading.add(path, bytes.as_ref())?,
            }
        }
        Ok(reading.project(data))
    }

    /// Returns the Java files.
    #[must_use]
    pub fn files(&self) -> &[SourceFile] {
        &self.files
    }

    /// Returns the classes; an unusable file is an error only if its class is needed.
    #[must_use]
    pub fn classes(&self) -> Classes {
        let mut classes = Classes::default();
        for file in &self.files {
            match file.unit() {
                Ok(unit) => classes.add(file.path(), unit),
                Err(error) => classes.add_faulty(file.path(), error),
            }
        }
        classes
    }

    /// Returns the statements about robots in the project's `StationSetup.cat`; empty without that
    /// file.
    ///
    /// # Errors
    ///
    /// If the `StationSetup.cat` cannot be used.
    pub fn station(&self) -> Result<&[RobotStatement], &StationFault> {
        self.station.as_deref()
    }

    /// Returns the data file.
    #[must_use]
    pub fn data(&self) -> &ProjectData {
        &self.data
    }
}

impl SourceFile {
    fn read(path: String, text: Result<String, SourceFault>) -> Self {
        match text {
            Ok(text) => Self {
                unit: iiwa_java::read(&path, &text),
                robots: in_java(&path, &text),
                times: stated_times(&text),
                labels: stated_labels(&text),
                path,
            },
            Err(fault) => {
                let error = SourceError { file: path.clone(), line: 1, column: 1, fault };
                let (robots, times, labels) = (Vec::new(), Vec::new(), Vec::new());
                Self { path, unit: Err(error), robots, times, labels }
            }
        }
    }

    /// Returns the path relative to the project folder, with `/`.
    #[must_use]
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Returns the robots that the file names.
    #[must_use]
    pub fn robots(&self) -> &[RobotStatement] {
        &self.robots
    }

    /// Returns the durations in s that comments of the file state, with their line numbers: `//
    /// iiwasim: 0.5 s` at the end of a line.
    #[must_use]
    pub fn times(&self) -> &[(usize, f64)] {
        &self.times
    }

    /// Returns the names, comments and groups that comment lines of the file state, with the
    /// numbers of the lines that follow them: `// iiwasim name: approach` names the motion of the
    /// next line, and `comment:` and `group:` are the other keys.
    #[must_use]
    pub fn labels(&self) -> &[(u32, MotionLabel)] {
        &self.labels
    }

    /// Returns the error if the file cannot be used.
    #[must_use]
    pub fn error(&self) -> Option<&SourceError> {
        self.unit.as_ref().err()
    }

    /// Returns the syntax of the file.
    ///
    /// # Errors
    ///
    /// If the file cannot be used.
    pub fn unit(&self) -> Result<&CompilationUnit, &SourceError> {
        self.unit.as_ref()
    }
}

/// State while a project is read.
struct ProjectReading {
    /// Java files by path, with their texts.
    texts: Vec<(String, Result<String, SourceFault>)>,
    station: Result<Vec<RobotStatement>, StationFault>,
    bytes: u64,
}

impl Default for ProjectReading {
    fn default() -> Self {
        Self { texts: Vec::new(), station: Ok(Vec::new()), bytes: 0 }
    }
}

impl ProjectReading {
    fn add(&mut self, path: String, bytes: &[u8]) -> Result<(), ProjectError> {
        if self.texts.len() >= MAX_FILES {
            return Err(ProjectError::TooManyFiles { max_files: MAX_FILES });
        }
        let length = u64::try_from(bytes.len()).unwrap_or(u64::MAX);
        if length > MAX_BYTES {
            self.texts
                .push((path, Err(SourceFault::TooLarge { bytes: length, max_bytes: MAX_BYTES })));
            return Ok(());
        }
        self.bytes += length;
        if self.bytes > MAX_BYTES_IN_TOTAL {
            return Err(ProjectError::TooLarge { max_bytes: MAX_BYTES_IN_TOTAL });
        }
        self.texts.push((path, Ok(decode(bytes))));
        Ok(())
    }

    fn add_station(&mut self, path: &str, bytes: Result<Vec<u8>, SourceFault>) {
        let read = bytes.map_err(|fault| fault.to_string());
        let read = read.and_then(|bytes| in_station(path, &decode(&bytes)));
        self.station = read.map_err(|reason| StationFault { path: path.to_owned(), reason });
    }

    /// Builds the project; its Java files are parsed on all cores.
    fn project(self, data: ProjectData) -> Project {
        let files = self.texts.into_par_iter().map(|(path, text)| SourceFile::read(path, text));
        Project { files: files.collect(), data, station: self.station }
    }
}

/// Reads a file, up to the maximum size.
fn contents(path: &Path) -> Result<Vec<u8>, SourceFault> {
    let unreadable = |error: io::Error| SourceFault::Unreadable(error.to_string());
    // Opening or reading a pipe, for example, could block forever.
    if !path.metadata().map_err(unreadable)?.is_file() {
        return Err(SourceFault::Unreadable("it is not an ordinary file".to_owned()));
    }
    let file = fs::File::open(path).map_err(unreadable)?;
    let metadata = file.metadata().map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if u64::try_from(bytes.len()).is_ok_and(|length| length <= MAX_BYTES) {
        return Ok(bytes);
    }
    Err(SourceFault::TooLarge { bytes: metadata.len(), max_bytes: MAX_BYTES })
}
