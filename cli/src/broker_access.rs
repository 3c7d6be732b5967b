//! Broker access, and broker errors.

use std::path::Path;

use iiwa_bridge::{
    BridgeError, BrokerAccess, Credentials,
    kafka::KafkaConnection,
    mqtt::{MqttConnection, MqttVersion},
    tls::TlsFiles,
};
use iiwa_report::with_causes;

use crate::{args, connection, failure::Failure};

/// Returns the connection to Kafka.
pub(crate) fn kafka_connection(
    brokers: &[String],
    access: &args::KafkaAccess,
) -> Result<KafkaConnection, Failure> {
    Ok(KafkaConnection {
        brokers: brokers.to_vec(),
        access: broker_access(&access.shared())?,
        sasl: access.sasl.parse().unwrap_or_default(),
    })
}

/// Returns the connection to the MQTT broker, if there is one.
pub(crate) fn mqtt_connection(mqtt: &args::Mqtt) -> Result<Option<MqttConnection>, Failure> {
    let Some((host, port)) = mqtt.broker.as_ref().and_then(|broker| broker.rsplit_once(':')) else {
        return Ok(None);
    };
    let version = match mqtt.version {
        3 => MqttVersion::V3,
        5 => MqttVersion::V5,
        other => return Err(Failure::input(format!("--mqtt-version {other}: it is 3 or 5"))),
    };
    Ok(Some(MqttConnection {
        host: host.trim_start_matches('[').trim_end_matches(']').to_owned(),
        port: port.parse().unwrap_or_default(),
        version,
        access: broker_access(&mqtt.access.shared())?,
        client_id: mqtt.client.clone(),
    }))
}

fn broker_access(options: &args::BrokerAccess<'_>) -> Result<BrokerAccess, Failure> {
    let client_certificate =
        options.client_certificate.map(|(certificate, key)| (certificate.clone(), key.clone()));
    let tls = (options.tls || options.authority.is_some() || client_certificate.is_some())
        .then(|| TlsFiles { authority: options.authority.cloned(), client_certificate });
    let credentials = options.user.map(|(user, file)| credentials(user, file)).transpose()?;
    Ok(BrokerAccess { tls, credentials })
}

/// Returns the user with the password from the first line of a file.
pub(crate) fn credentials(user: &str, file: &Path) -> Result<Credentials, Failure> {
    let text = iiwa_files::read_text(file).map_err(|error| {
        Failure::input(format!("cannot read the password in {}: {error}", file.display()))
    })?;
    let password = text.lines().next().unwrap_or_default().to_owned();
    if password.is_empty() {
        return Err(Failure::input(format!("the first line of {} is empty", file.display())));
    }
    Ok(Credentials { user: user.to_owned(), password })
}

/// Converts the error of a bridge that did not start: invalid input if the options are wrong.
pub(crate) fn failure(error: &BridgeError) -> Failure {
    match error {
        BridgeError::Link(error) => connection::link_failure(error),
        BridgeError::RobotName { .. }
        | BridgeError::SameName { .. }
        | BridgeError::Certificate { .. }
        | BridgeError::Settings { .. } => Failure::input(with_causes(error)),
        BridgeError::SpoolInUse { .. } => {
            Failure::Run { message: format!("{error} (--spool)"), cause: None }
        }
        error => Failure::Run { message: with_causes(error), cause: None },
    }
}
