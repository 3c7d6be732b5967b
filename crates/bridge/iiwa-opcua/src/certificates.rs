//! Server certificate, and certificates of trusted clients.
//!
//! ```text
//! own/cert.der          the server's certificate, for clients to trust
//! private/private.pem   its key
//! trusted/              certificates of clients
//! rejected/             those of clients that came without being trusted
//! ```

use std::{
    collections::HashSet,
    fs::{self, File},
    io::{self, Write as _},
    path::{Path, PathBuf},
    time::SystemTime,
};

use opcua::crypto::{CertificateStore, X509, X509Data};

use crate::OpcUaError;

/// Key length of the server, in bits.
const KEY_BITS: u32 = 2048;
/// Validity of a self-signed server certificate, in days. Clients trust it explicitly, and each new
/// certificate has to be trusted again.
const VALID_DAYS: u32 = 3650;
/// Maximum number of stored rejected certificates: anyone who can reach the port can add to them.
const MAX_REJECTED: usize = 50;

/// A certificate folder.
#[derive(Debug)]
pub(crate) struct Certificates {
    folder: PathBuf,
    /// Rejected certificates that have been logged.
    rejected: HashSet<PathBuf>,
}

impl Certificates {
    /// Opens a certificate folder, which is created if it is missing. If the server certificate is
    /// missing, it is also created, for an application and the host names that clients may use.
    pub(crate) fn open(
        folder: &Path,
        application_uri: &str,
        hosts: &[String],
    ) -> Result<Self, OpcUaError> {
        let these = Self { folder: folder.to_owned(), rejected: HashSet::new() };
        for part in ["own", "private", "trusted", "rejected"] {
            let path = folder.join(part);
            create_folder(&path, part == "private").map_err(|error| bad(&path, &error))?;
        }
        let (certificate, key) = (these.certificate(), these.key());
        match (certificate.exists(), key.exists()) {
            (true, true) => {}
            (false, false) => {
                let hosts = Some(hosts.to_vec());
                let names = X509Data::alt_host_names(application_uri, hosts, false, false, false);
                let data = X509Data {
                    key_size: KEY_BITS,
                    common_name: "iiwasim OPC UA".to_owned(),
                    organization: "iiwasim".to_owned(),
                    organizational_unit: String::new(),
                    country: String::new(),
                    state: String::new(),
                    alt_host_names: names,
                    certificate_duration_days: VALID_DAYS,
                };
                CertificateStore::create_certificate_and_key(&data, false, &certificate, &key)
                    .map_err(|error| bad(folder, &error))?;
                tracing::info!(
                    "OPC UA: {} is new; clients have to trust it",
                    certificate.display()
                );
            }
            (has_certificate, _) => {
                let (present, missing) =
                    if has_certificate { (&certificate, &key) } else { (&key, &certificate) };
                let message = format!("it is missing, but {} exists", present.display());
                return Err(bad(missing, &message));
            }
        }
        CertificateStore::read_cert(&certificate).map_err(|error| bad(&certificate, &error))?;
        CertificateStore::read_pkey(&key).map_err(|error| bad(&key, &error))?;
        Ok(these)
    }

    /// Returns the folder.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    fn certificate(&self) -> PathBuf {
        self.folder.join("own/cert.der")
    }

    fn key(&self) -> PathBuf {
        self.folder.join("private/private.pem")
    }

    /// Trusts a client certificate, a file in DER or PEM.
    pub(crate) fn trust(&self, file: &Path) -> Result<(), OpcUaError> {
        let certificate = CertificateStore::read_cert(file).map_err(|error| bad(file, &error))?;
        self.store(&certificate).map_err(|error| bad(file, &error))
    }

    fn store(&self, certificate: &X509) -> io::Result<()> {
        let name = CertificateStore::cert_file_name(certificate);
        let der = certificate.to_der().map_err(io::Error::other)?;
        let path = self.folder.join("trusted").join(&name);
        // Replaces any file with this name, such as a link, without following it.
        remove(&path)?;
        File::create_new(path)?.write_all(&der)?;
        // A copy in the folder of rejected certificates would be refused.
        remove(&self.folder.join("rejected").join(&name))
    }

    /// Logs recently rejected certificates, and deletes the oldest ones beyond the limit.
    pub(crate) fn look_at_rejected(&mut self) {
        let Ok(entries) = fs::read_dir(self.folder.join("rejected")) else { return };
        let dated = entries.filter_map(|entry| {
            let path = entry.ok()?.path();
            let time = path.metadata().ok()?.modified().unwrap_or(SystemTime::UNIX_EPOCH);
            Some((time, path))
        });
        let mut dated: Vec<_> = dated.collect();
        dated.sort();
        let kept = dated.split_off(dated.len().saturating_sub(MAX_REJECTED));
        for (_, path) in &dated {
            if let Err(error) = fs::remove_file(path) {
                tracing::debug!("{}: {error}", path.display());
            }
        }
        for (_, path) in &kept {
            if !self.rejected.contains(path) {
                let path = path.display();
                tracing::warn!(
                    "OPC UA: a client was rejected; to trust it, move {path} to trusted"
                );
            }
        }
        self.rejected = kept.into_iter().map(|(_, path)| path).collect();
    }
}

/// Removes a file or a link, if it exists.
fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

fn bad(file: &Path, message: &impl ToString) -> OpcUaError {
    OpcUaError::Certificate { file: file.to_owned(), message: message.to_string() }
}

/// Creates a folder; if `private`, accessible to its owner only.
fn create_folder(path: &Path, private: bool) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    if private {
        std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    }
    #[cfg(not(unix))]
    let _ = private;
    builder.create(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_rejected_certificates_are_kept() {
        let folder = tempfile::tempdir().unwrap();
        let rejected = folder.path().join("rejected");
        fs::create_dir(&rejected).unwrap();
        for i in 0..MAX_REJECTED + 7 {
            fs::write(rejected.join(format!("{i}.der")), "").unwrap();
        }
        let folder = folder.path().to_owned();
        let mut certificates = Certificates { folder, rejected: HashSet::new() };
        certificates.look_at_rejected();
        assert_eq!(certificates.rejected.len(), MAX_REJECTED);
        assert_eq!(fs::read_dir(&rejected).unwrap().count(), MAX_REJECTED);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_in_place_of_a_certificate_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let certificates = Certificates::open(folder.path(), "urn:x", &[]).unwrap();
        let certificate = CertificateStore::read_cert(&certificates.certificate()).unwrap();
        let victim = folder.path().join("victim");
        fs::write(&victim, "precious").unwrap();
        let name = CertificateStore::cert_file_name(&certificate);
        let trusted = folder.path().join("trusted").join(name);
        std::os::unix::fs::symlink(&victim, &trusted).unwrap();
        certificates.trust(&certificates.certificate()).unwrap();
        assert_eq!(fs::read_to_string(victim).unwrap(), "precious");
        assert_eq!(fs::read(trusted).unwrap(), certificate.to_der().unwrap());
    }

    #[test]
    fn a_key_without_its_certificate_is_not_replaced() {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("private")).unwrap();
        fs::write(folder.path().join("private/private.pem"), "").unwrap();
        let error = Certificates::open(folder.path(), "urn:x", &[]).unwrap_err().to_string();
        assert!(error.contains("cert.der: it is missing, but"), "{error}");
    }
}
