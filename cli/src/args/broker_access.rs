//! TLS and login options of brokers, with the prefix `--kafka` or `--mqtt`.

use std::path::PathBuf;

use clap::Args;

macro_rules! broker_access {
    ($(#[$about:meta])* $name:ident, $broker:literal $(, { $($fields:tt)* })?) => {
        $(#[$about])*
        #[derive(Args, Debug)]
        pub(crate) struct $name {
            /// Prefix of topic names
            #[arg(id = concat!($broker, "_prefix"), long = concat!($broker, "-prefix"),
                value_name = "TEXT", default_value = "iiwasim")]
            pub(crate) prefix: String,

            /// Use TLS, with the authorities of the system
            #[arg(id = concat!($broker, "_tls"), long = concat!($broker, "-tls"))]
            pub(crate) tls: bool,

            /// Use TLS, with these authorities
            #[arg(id = concat!($broker, "_ca"), long = concat!($broker, "-ca"),
                value_name = "FILE.pem")]
            pub(crate) authority: Option<PathBuf>,

            /// Own certificate, for brokers that ask for one
            #[arg(id = concat!($broker, "_cert"), long = concat!($broker, "-cert"),
                value_name = "FILE.pem", requires = concat!($broker, "_cert_key"))]
            pub(crate) certificate: Option<PathBuf>,

            /// Key of the own certificate
            #[arg(id = concat!($broker, "_cert_key"), long = concat!($broker, "-cert-key"),
                value_name = "FILE.pem", requires = concat!($broker, "_cert"))]
            pub(crate) certificate_key: Option<PathBuf>,

            /// User
            #[arg(id = concat!($broker, "_user"), long = concat!($broker, "-user"),
                value_name = "NAME", requires = concat!($broker, "_password_file"))]
            pub(crate) user: Option<String>,

            /// File with the user's password
            #[arg(id = concat!($broker, "_password_file"),
                long = concat!($broker, "-password-file"), value_name = "FILE",
                requires = concat!($broker, "_user"))]
            pub(crate) password_file: Option<PathBuf>,

            $($($fields)*)?
        }

        impl $name {
            /// The options that are the same for all brokers.
            pub(crate) fn shared(&self) -> BrokerAccess<'_> {
                BrokerAccess {
                    tls: self.tls,
                    authority: self.authority.as_ref(),
                    client_certificate: self
                        .certificate
                        .as_ref()
                        .zip(self.certificate_key.as_ref()),
                    user: self.user.as_ref().zip(self.password_file.as_ref()),
                }
            }
        }
    };
}

/// TLS files and login of a broker connection.
pub(crate) struct BrokerAccess<'a> {
    pub(crate) tls: bool,
    pub(crate) authority: Option<&'a PathBuf>,
    /// The own certificate, and its key.
    pub(crate) client_certificate: Option<(&'a PathBuf, &'a PathBuf)>,
    /// The user's name, and the file with the password.
    pub(crate) user: Option<(&'a String, &'a PathBuf)>,
}

broker_access!(
    /// Kafka connection options, for all commands that use Kafka.
    KafkaAccess, "kafka", {
        /// SASL mechanism; `plain` sends the password itself, and needs TLS or a broker on this
        /// machine
        #[arg(long = "kafka-sasl", value_name = "NAME", default_value = "scram-sha-512",
            value_parser = ["plain", "scram-sha-256", "scram-sha-512"])]
        pub(crate) sasl: String,
    }
);

broker_access!(
    /// MQTT connection options.
    MqttAccess, "mqtt"
);
