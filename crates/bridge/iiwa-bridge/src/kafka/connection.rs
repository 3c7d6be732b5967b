//! Connections to Kafka brokers.

use std::{error::Error as _, str::FromStr, sync::Arc, time::Duration};

use rskafka::{
    BackoffConfig,
    client::{
        Client, ClientBuilder, Credentials as KafkaCredentials, SaslConfig,
        error::{Error, ProtocolError},
    },
};
use tokio::time::{Instant, sleep, timeout};

use crate::{
    BridgeError,
    credentials::{BrokerAccess, Credentials, is_this_machine},
    tls::TlsFiles,
};

/// Connection settings.
#[derive(Clone, Debug)]
pub struct KafkaConnection {
    /// Bootstrap addresses, as `HOST:PORT`.
    pub brokers: Vec<String>,
    /// TLS, and the user.
    pub access: BrokerAccess,
    /// SASL mechanism.
    pub sasl: Sasl,
}

/// SASL mechanism.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sasl {
    /// PLAIN: the password itself is sent.
    Plain,
    /// SCRAM with SHA-256.
    ScramSha256,
    /// SCRAM with SHA-512.
    #[default]
    ScramSha512,
}

impl FromStr for Sasl {
    type Err = ();

    /// Parses the name: `plain`, `scram-sha-256` or `scram-sha-512`.
    fn from_str(name: &str) -> Result<Self, ()> {
        match name {
            "plain" => Ok(Self::Plain),
            "scram-sha-256" => Ok(Self::ScramSha256),
            "scram-sha-512" => Ok(Self::ScramSha512),
            _ => Err(()),
        }
    }
}

/// Time-out of the first connection: a refused user is an error in this phase, a missing broker is
/// not.
const PROBE_TIMEOUT: Duration = Duration::from_secs(4);

/// Pause between attempts of the first connection.
const PROBE_PAUSE: Duration = Duration::from_millis(200);

/// Time for which a request is repeated before the connection is replaced.
const RETRY_TIMEOUT: Duration = Duration::from_secs(5);

/// Time-out of connecting.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

impl KafkaConnection {
    /// Reads certificates, and checks the settings.
    pub(super) fn connector(&self) -> Result<KafkaConnector, BridgeError> {
        let far = self.brokers.iter().find(|broker| !is_this_machine(broker));
        let BrokerAccess { tls, credentials } = &self.access;
        let is_plain = self.sasl == Sasl::Plain && tls.is_none();
        if let (Some(_), Some(broker), true) = (credentials, far, is_plain) {
            let message = format!(
                "{broker} is on another machine, and the password would be sent in the clear: use \
                 TLS, or SCRAM"
            );
            return Err(BridgeError::Settings { message });
        }
        let tls = tls.as_ref().map(TlsFiles::config).transpose()?;
        let sasl = credentials.as_ref().map(|Credentials { user, password }| {
            let credentials = KafkaCredentials::new(user.clone(), password.clone());
            match self.sasl {
                Sasl::Plain => SaslConfig::Plain(credentials),
                Sasl::ScramSha256 => SaslConfig::ScramSha256(credentials),
                Sasl::ScramSha512 => SaslConfig::ScramSha512(credentials),
            }
        });
        Ok(KafkaConnector { brokers: self.brokers.clone(), tls, sasl })
    }
}

/// Connects to the brokers.
#[derive(Debug)]
pub(super) struct KafkaConnector {
    brokers: Vec<String>,
    tls: Option<Arc<rustls::ClientConfig>>,
    sasl: Option<SaslConfig>,
}

impl KafkaConnector {
    /// Returns the addresses, for messages.
    pub(super) fn address(&self) -> String {
        self.brokers.join(", ")
    }

    /// Opens a new connection.
    pub(super) async fn connect(&self) -> Result<Client, KafkaFailure> {
        self.connect_within(RETRY_TIMEOUT).await
    }

    async fn connect_within(&self, limit: Duration) -> Result<Client, KafkaFailure> {
        let mut builder = ClientBuilder::new(self.brokers.clone())
            .client_id("iiwasim")
            .backoff_config(BackoffConfig {
                init_backoff: Duration::from_millis(50),
                max_backoff: Duration::from_secs(1),
                base: 2.0,
                deadline: Some(limit),
            });
        if let Some(tls) = &self.tls {
            builder = builder.tls_config(Arc::clone(tls));
        }
        if let Some(sasl) = &self.sasl {
            builder = builder.sasl_config(sasl.clone());
        }
        match timeout(CONNECT_TIMEOUT.max(limit), builder.build()).await {
            Ok(Ok(client)) => Ok(client),
            Ok(Err(error)) => Err(KafkaFailure::of(&error)),
            Err(_) => Err(KafkaFailure::timeout()),
        }
    }

    /// Determines whether the brokers refuse the connection. Unreachable brokers may become
    /// available later.
    pub(super) async fn probe(&self) -> Result<(), BridgeError> {
        let since = Instant::now();
        // One attempt at a time, because the library also repeats refused ones.
        let result = loop {
            match self.connect_within(Duration::ZERO).await {
                Err(failure) if !failure.is_refusal && since.elapsed() < PROBE_TIMEOUT => {
                    sleep(PROBE_PAUSE).await;
                }
                result => break result,
            }
        };
        match result {
            Ok(_) => {
                tracing::info!("Kafka at {}: connected", self.address());
                Ok(())
            }
            Err(failure) if failure.is_refusal => Err(self.broken(failure)),
            Err(failure) => {
                tracing::warn!(
                    "Kafka at {}: {}; messages are kept until it is back",
                    self.address(),
                    failure.message
                );
                Ok(())
            }
        }
    }

    /// Converts a failure to an error that ends a command.
    pub(super) fn broken(&self, failure: KafkaFailure) -> BridgeError {
        BridgeError::Broker { broker: "Kafka", address: self.address(), message: failure.message }
    }
}

/// Failure of a request to Kafka.
#[derive(Debug)]
pub(super) struct KafkaFailure {
    pub(super) message: String,
    /// `true` if either side refuses the other: repetition does not help.
    pub(super) is_refusal: bool,
    /// `true` if the broker accepts smaller batches only.
    pub(super) is_too_large: bool,
}

impl KafkaFailure {
    /// Creates a temporary failure.
    pub(super) fn passing(message: String) -> Self {
        Self { message, is_refusal: false, is_too_large: false }
    }

    pub(super) fn timeout() -> Self {
        Self::passing("no answer in time".to_owned())
    }

    pub(super) fn of(error: &Error) -> Self {
        // The library reports the cause of repeated failures as text only.
        let mut message = error.to_string();
        let mut cause = error.source();
        while let Some(inner) = cause {
            let text = inner.to_string();
            if !message.contains(&text) {
                message = format!("{message}: {text}");
            }
            cause = inner.source();
        }
        let has = |words: &[&str]| words.iter().any(|word| message.contains(word));
        if has(&["Sasl", "SaslAuthenticationFailed"]) {
            let message =
                "the broker does not accept the user, the password or the mechanism (SASL)"
                    .to_owned();
            return Self { message, is_refusal: true, is_too_large: false };
        }
        if has(&["certificate", "Certificate", "UnknownIssuer", "HandshakeFailure"]) {
            return Self {
                message: format!("TLS: {message}"),
                is_refusal: true,
                is_too_large: false,
            };
        }
        if has(&["early eof", "handshake eof", "InvalidContentType"]) {
            message.push_str("; does one side use TLS, and the other one not?");
        }
        let is_too_large = has_too_large(error);
        Self { is_too_large, ..Self::passing(message) }
    }
}

fn has_too_large(error: &Error) -> bool {
    matches!(
        error,
        Error::ServerError {
            protocol_error: ProtocolError::MessageTooLarge | ProtocolError::RecordListTooLarge,
            ..
        }
    )
}
