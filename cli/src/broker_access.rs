//! How brokers are reached, and what they refuse.

use std::{fs, path::PathBuf};

use iiwa_bridge::{
    BridgeError, Credentials,
    kafka::KafkaConnection,
    mqtt::{MqttConnection, MqttVersion},
    tls::TlsFiles,
};
use iiwa_report::with_causes;

use crate::{args, connection, failure::Failure};

/// How Kafka is reached.
pub(crate) fn kafka_connection(
    brokers: &[String],
    access: &args::KafkaAccess,
) -> Result<KafkaConnection, Failure> {
    let own = (&access.certificate, &access.certificate_key);
    let sasl = access.sasl.parse().unwrap_or_default();
    let credentials = credentials(access.user.as_ref(), access.password_file.as_ref())?;
    Ok(KafkaConnection {
        brokers: brokers.to_vec(),
        tls: tls(access.tls, access.authority.as_ref(), own),
        sasl: credentials.map(|credentials| (sasl, credentials)),
    })
}

/// How the MQTT broker is reached, if there is to be one.
pub(crate) fn mqtt_connection(mqtt: &args::Mqtt) -> Result<Option<MqttConnection>, Failure> {
    let Some((host, port)) = mqtt.broker.as_ref().and_then(|broker| broker.rsplit_once(':')) else {
        return Ok(None);
    };
    let version = match mqtt.version {
        3 => MqttVersion::V3,
        5 => MqttVersion::V5,
        other => return Err(Failure::input(format!("--mqtt-version {other}: it is 3 or 5"))),
    };
    let own = (&mqtt.certificate, &mqtt.certificate_key);
    Ok(Some(MqttConnection {
        host: host.trim_start_matches('[').trim_end_matches(']').to_owned(),
        port: port.parse().unwrap_or_default(),
        version,
        tls: tls(mqtt.tls, mqtt.authority.as_ref(), own),
        credentials: credentials(mqtt.user.as_ref(), mqtt.password_file.as_ref())?,
        client_id: mqtt.client.clone(),
    }))
}

fn tls(
    wanted: bool,
    authority: Option<&PathBuf>,
    own: (&Option<PathBuf>, &Option<PathBuf>),
) -> Option<TlsFiles> {
    let own = match own {
        (Some(certificate), Some(key)) => Some((certificate.clone(), key.clone())),
        _ => None,
    };
    let wanted = wanted || authority.is_some() || own.is_some();
    wanted.then(|| TlsFiles { authority: authority.cloned(), own })
}

/// The user, with the password in the first line of a file.
pub(crate) fn credentials(
    user: Option<&String>,
    file: Option<&PathBuf>,
) -> Result<Option<Credentials>, Failure> {
    let (Some(user), Some(file)) = (user, file) else { return Ok(None) };
    let text = fs::read_to_string(file).map_err(|error| {
        Failure::input(format!("cannot read the password in {}: {error}", file.display()))
    })?;
    let password = text.lines().next().unwrap_or_default().to_owned();
    if password.is_empty() {
        return Err(Failure::input(format!("the first line of {} is empty", file.display())));
    }
    Ok(Some(Credentials { user: user.clone(), password }))
}

/// A bridge that did not start: invalid input if the options are wrong.
pub(crate) fn failure(error: &BridgeError) -> Failure {
    match error {
        BridgeError::Link(error) => connection::refused(error),
        BridgeError::RobotName { .. }
        | BridgeError::SameName { .. }
        | BridgeError::Certificate { .. }
        | BridgeError::Settings { .. } => Failure::input(with_causes(error)),
        BridgeError::SpoolInUse { .. } => {
            Failure::Run { what: format!("{error} (--spool)"), cause: None }
        }
        error => Failure::Run { what: with_causes(error), cause: None },
    }
}
