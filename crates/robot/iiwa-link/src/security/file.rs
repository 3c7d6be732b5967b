//! Key files: `NAME.key` with a secret and a public key, `NAME.pub` with the public key only.
//!
//! The format of CZMQ and `pyzmq` certificates: `zmq.auth.load_certificate("NAME.key")` returns
//! both keys.
//!
//! ```text
//! # Public key `NAME` of iiwasim
//! curve
//!     public-key = "40 characters of Z85"
//!     secret-key = "40 characters of Z85, in NAME.key only"
//! ```

use std::{
    fs::{self, File},
    io::{self, Read as _, Write as _},
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;

use super::{
    error::{KeyTextError, SecurityError},
    key::{KeyPair, PublicKey},
    z85,
};

/// Maximum size of a key file, which is far shorter; a large file given by mistake is not read to
/// its end.
const MAX_BYTES: u64 = 1 << 16;

impl KeyPair {
    /// Writes `NAME.key`, readable by its owner only, and `NAME.pub` into a folder: both or none.
    /// Returns their paths, the secret key first.
    ///
    /// # Errors
    /// The name is invalid, one of the files exists, or they cannot be written.
    pub fn write(&self, folder: &Path, name: &str) -> Result<(PathBuf, PathBuf), SecurityError> {
        check_name(name)?;
        let paths = (folder.join(format!("{name}.key")), folder.join(format!("{name}.pub")));
        // `persist` checks this again; here, both files are checked before either is written.
        for path in [&paths.0, &paths.1] {
            // A dangling link counts as existing.
            if path.symlink_metadata().is_ok() {
                return Err(SecurityError::Exists { path: path.clone() });
            }
        }
        let (public, secret) = (self.public(), z85::encode(self.secret()));
        let secret_text = format!(
            "# SECRET key `{name}` of iiwasim: it stays on this machine; {name}.pub is for others\n\
             curve\n    public-key = \"{public}\"\n    secret-key = \"{secret}\"\n"
        );
        let public_text =
            format!("# Public key `{name}` of iiwasim\ncurve\n    public-key = \"{public}\"\n");
        let secret_file = prepare(folder, &paths.0, &secret_text, 0o600)?;
        let public_file = prepare(folder, &paths.1, &public_text, 0o644)?;
        // Both contents are on the disk before either file gets its name.
        persist(secret_file, &paths.0)?;
        if let Err(error) = persist(public_file, &paths.1) {
            let _ = fs::remove_file(&paths.0);
            return Err(error);
        }
        Ok(paths)
    }

    /// Reads a file with a secret key.
    ///
    /// # Errors
    /// The file cannot be read, is accessible to others, is not a key file, or has no secret key.
    pub fn read(path: &Path) -> Result<Self, SecurityError> {
        let keys = Keys::read(path)?;
        let (Some(public), Some(secret)) = (keys.public, keys.secret) else {
            let message = if keys.public.is_some() {
                "it contains a public key only; the .key file is required"
            } else {
                "not a key file: it has no line `public-key = \"...\"`"
            };
            return Err(SecurityError::KeyFile { path: path.to_owned(), message });
        };
        // Only for secret keys: everyone may read a public key.
        if let Some(mode) = exposed(keys.mode) {
            return Err(SecurityError::Exposed { path: path.to_owned(), mode });
        }
        Ok(Self::new(PublicKey::from(public), secret))
    }
}

impl PublicKey {
    /// Reads a public key file. A secret key file is refused: it should not be shared.
    ///
    /// # Errors
    /// The file cannot be read, is not a key file, or contains a secret key.
    pub fn read(path: &Path) -> Result<Self, SecurityError> {
        let keys = Keys::read(path)?;
        match (keys.public, keys.secret) {
            (Some(public), None) => Ok(Self::from(public)),
            (_, Some(_)) => Err(SecurityError::KeyFile {
                path: path.to_owned(),
                message: "it contains a secret key, which only its owner should have; the .pub \
                          file is required",
            }),
            (None, None) => Err(SecurityError::KeyFile {
                path: path.to_owned(),
                message: "not a key file: it has no line `public-key = \"...\"`",
            }),
        }
    }
}

/// Fails if the name is not allowed for key files.
fn check_name(name: &str) -> Result<(), SecurityError> {
    let inside = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let begins = name.starts_with(|c: char| c.is_ascii_alphanumeric());
    if begins && name.len() <= 64 && name.chars().all(inside) {
        return Ok(());
    }
    Err(SecurityError::Name { name: name.to_owned() })
}

/// The content of a key file.
struct Keys {
    public: Option<[u8; 32]>,
    secret: Option<[u8; 32]>,
    mode: u32,
}

impl Keys {
    fn read(path: &Path) -> Result<Self, SecurityError> {
        let to_error = |source| SecurityError::Read { path: path.to_owned(), source };
        let file = File::open(path).map_err(to_error)?;
        // The mode of the open file: the path may refer to another file in the meantime.
        let mode = mode(&file.metadata().map_err(to_error)?);
        let mut bytes = Vec::new();
        file.take(MAX_BYTES).read_to_end(&mut bytes).map_err(to_error)?;
        let text = String::from_utf8(bytes).map_err(|_| SecurityError::KeyFile {
            path: path.to_owned(),
            message: "not a key file: it is not text",
        })?;
        let mut keys = Self { public: None, secret: None, mode };
        keys.parse(&text).map_err(|(line, message)| SecurityError::KeyLine {
            path: path.to_owned(),
            line,
            message,
        })?;
        Ok(keys)
    }

    /// Parses a text. Errors contain a line, from 1.
    fn parse(&mut self, text: &str) -> Result<(), (usize, String)> {
        let mut in_metadata = false;
        for (i, line) in text.lines().enumerate() {
            let to_error = |message: &str| Err((i + 1, message.to_owned()));
            let indented = line.starts_with([' ', '\t']);
            let line = line.trim();
            // Metadata of CZMQ certificates may have any names.
            if line.is_empty() || line.starts_with('#') || (indented && in_metadata) {
                continue;
            }
            in_metadata = line == "metadata";
            if in_metadata || line == "curve" {
                continue;
            }
            let Some((name, value)) = line.split_once('=') else {
                return to_error("expected `public-key = \"...\"` or `secret-key = \"...\"`");
            };
            let value = value.trim();
            let bare = value.strip_prefix('"').and_then(|value| value.strip_suffix('"'));
            let key = match name.trim() {
                "public-key" => &mut self.public,
                "secret-key" => &mut self.secret,
                _ => return to_error("expected `public-key = \"...\"` or `secret-key = \"...\"`"),
            };
            if key.is_some() {
                return to_error("a second key of the same kind");
            }
            let decoded = bare.ok_or("a key has to be in double quotes".to_owned());
            let decoded = decoded.and_then(|text| z85::decode(text).map_err(|e| redacted(&e)));
            *key = Some(decoded.map_err(|message| (i + 1, message))?);
        }
        Ok(())
    }
}

/// Returns the error without the offending character, which may be part of a secret key.
fn redacted(error: &KeyTextError) -> String {
    match error {
        KeyTextError::Character { position, .. } => {
            format!("character {position} of the key is not one of Z85's")
        }
        error => error.to_string(),
    }
}

/// Creates a temporary file in the same folder with the complete content.
fn prepare(
    folder: &Path,
    path: &Path,
    text: &str,
    mode: u32,
) -> Result<NamedTempFile, SecurityError> {
    let to_error = |source| SecurityError::Write { path: path.to_owned(), source };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".iiwasim-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        // From creation on, so that others cannot read the secret at any time.
        builder.permissions(fs::Permissions::from_mode(mode));
    }
    #[cfg(not(unix))]
    let _ = mode;
    // The error is reported without the name of the temporary file.
    let file = builder.tempfile_in(folder).map_err(|error| to_error(error.kind().into()));
    let mut file = file?;
    // Synchronised first: after a crash, a key file is complete or missing.
    file.write_all(text.as_bytes()).and_then(|()| file.as_file().sync_all()).map_err(to_error)?;
    Ok(file)
}

/// Moves a file to its final path, unless this path exists.
fn persist(file: NamedTempFile, path: &Path) -> Result<(), SecurityError> {
    let path = path.to_owned();
    match file.persist_noclobber(&path) {
        Ok(_) => Ok(()),
        // Another process has created the file since the check.
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => {
            Err(SecurityError::Exists { path })
        }
        Err(error) => Err(SecurityError::Write { path, source: error.error }),
    }
}

#[cfg(unix)]
fn mode(metadata: &fs::Metadata) -> u32 {
    use std::os::unix::fs::PermissionsExt as _;
    metadata.permissions().mode() & 0o7777
}

#[cfg(not(unix))]
fn mode(_: &fs::Metadata) -> u32 {
    0
}

/// Returns the mode, if it grants access to users other than the owner.
fn exposed(mode: u32) -> Option<u32> {
    (mode & 0o077 != 0).then_some(mode)
}
