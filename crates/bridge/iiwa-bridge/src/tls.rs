//! TLS for broker connections.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use rustls::{
    ClientConfig, RootCertStore,
    pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject},
};

use crate::BridgeError;

/// Certificate files, in PEM format.
#[derive(Clone, Debug, Default)]
pub struct TlsFiles {
    /// Certificates of the authorities that may have signed the broker certificate; the system's by
    /// default.
    pub authority: Option<PathBuf>,
    /// Client certificate and key, for brokers that require them.
    pub client_certificate: Option<(PathBuf, PathBuf)>,
}

impl TlsFiles {
    /// Reads the files.
    ///
    /// # Errors
    ///
    /// [`BridgeError::Certificate`] with the file that cannot be used.
    pub fn config(&self) -> Result<Arc<ClientConfig>, BridgeError> {
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let versions = ClientConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .map_err(|error| BridgeError::Settings { message: format!("TLS: {error}") })?;
        let builder = versions.with_root_certificates(self.roots()?);
        let config = match &self.client_certificate {
            None => builder.with_no_client_auth(),
            Some((certificate, key)) => {
                let parsed = PrivateKeyDer::from_pem_file(key);
                let parsed = parsed.map_err(|error| unusable(key, &error))?;
                builder
                    .with_client_auth_cert(certificates(certificate)?, parsed)
                    .map_err(|error| unusable(certificate, &error))?
            }
        };
        Ok(Arc::new(config))
    }

    fn roots(&self) -> Result<RootCertStore, BridgeError> {
        let mut roots = RootCertStore::empty();
        let Some(file) = &self.authority else {
            // Systems usually contain some invalid certificates.
            roots.add_parsable_certificates(rustls_native_certs::load_native_certs().certs);
            return Ok(roots);
        };
        for certificate in certificates(file)? {
            roots.add(certificate).map_err(|error| unusable(file, &error))?;
        }
        Ok(roots)
    }
}

fn certificates(file: &Path) -> Result<Vec<CertificateDer<'static>>, BridgeError> {
    let all = CertificateDer::pem_file_iter(file).and_then(Iterator::collect::<Result<Vec<_>, _>>);
    let all = all.map_err(|error| unusable(file, &error))?;
    if all.is_empty() {
        let message = "it contains no certificate in PEM".to_owned();
        return Err(BridgeError::Certificate { file: file.to_owned(), message });
    }
    Ok(all)
}

fn unusable(file: &Path, error: &dyn std::fmt::Display) -> BridgeError {
    BridgeError::Certificate { file: file.to_owned(), message: error.to_string() }
}
