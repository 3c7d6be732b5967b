//! Connections to an MQTT broker, with either protocol version.

use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use bytes::Bytes;
use rumqttc::{
    AsyncClient, ConnectReturnCode, ConnectionError, Event, LastWill, MqttOptions, Packet, QoS,
    TlsConfiguration, Transport, v5,
};
use tokio::{sync::mpsc, task::JoinHandle, time::timeout};

use crate::{
    BridgeError,
    credentials::{BrokerAccess, Credentials, is_this_machine},
    tls::TlsFiles,
};

/// Connection settings.
#[derive(Clone, Debug)]
pub struct MqttConnection {
    /// Host name or IP address.
    pub host: String,
    /// TCP port.
    pub port: u16,
    /// Protocol version.
    pub version: MqttVersion,
    /// TLS, and the user.
    pub access: BrokerAccess,
    /// Prefix of client ids; brokers end a connection when another one has the same id.
    pub client_id: String,
}

/// MQTT version.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MqttVersion {
    /// MQTT 3.1.1.
    V3,
    /// MQTT 5.
    #[default]
    V5,
}

/// Keep-alive interval: maximum time between messages for which a broker considers a connection
/// alive.
const KEEP_ALIVE: Duration = Duration::from_secs(10);

/// Time-out of connecting.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// Maximum packet length, in bytes. The gate refuses packets that are longer than a command, with a
/// reply; packets beyond this limit would end the connection.
const MAX_PACKET_BYTES: u32 = 64 << 20;

/// Maximum number of messages that wait to be sent.
const OUTGOING: usize = 256;

/// Maximum number of received messages that wait to be read; further ones are dropped. The task
/// that reads the connection must not wait for tasks that wait for it to write.
const INCOMING: usize = 64;

impl MqttConnection {
    /// Reads certificates, and checks the settings.
    pub(super) fn connector(&self) -> Result<MqttConnector, BridgeError> {
        let address = format!("{}:{}", self.host, self.port);
        if self.access.credentials.is_some()
            && self.access.tls.is_none()
            && !is_this_machine(&address)
        {
            let message = format!(
                "{address} is on another machine, and the password would be sent in the clear: use \
                 TLS"
            );
            return Err(BridgeError::Settings { message });
        }
        let tls = self.access.tls.as_ref().map(TlsFiles::config).transpose()?;
        Ok(MqttConnector { settings: self.clone(), tls })
    }
}

/// Connects to the broker.
#[derive(Debug)]
pub(super) struct MqttConnector {
    settings: MqttConnection,
    tls: Option<Arc<rustls::ClientConfig>>,
}

/// A last will.
pub(super) struct Will {
    pub(super) topic: String,
    pub(super) payload: Vec<u8>,
    pub(super) retain: bool,
}

impl MqttConnector {
    /// Returns the address, for messages.
    pub(super) fn address(&self) -> String {
        format!("{}:{}", self.settings.host, self.settings.port)
    }

    /// Opens a connection; [`BrokerConnection::next`] reports when it is established.
    pub(super) fn open(&self, name: &str, will: Option<Will>) -> BrokerConnection {
        let MqttConnection { host, port, access, client_id, version } = &self.settings;
        let id = format!("{client_id}-{name}");
        let tls = || self.tls.clone().map(|tls| Transport::Tls(TlsConfiguration::Rustls(tls)));
        let (arrived, incoming) = Arrivals::new();
        let (client, task) = match version {
            MqttVersion::V3 => {
                let mut options = MqttOptions::new(id, host, *port);
                options.set_keep_alive(KEEP_ALIVE).set_clean_session(true);
                let max_bytes = MAX_PACKET_BYTES as usize;
                options.set_max_packet_size(max_bytes, max_bytes);
                tls().map(|transport| options.set_transport(transport));
                if let Some(Credentials { user, password }) = &access.credentials {
                    options.set_credentials(user, password);
                }
                if let Some(Will { topic, payload, retain }) = will {
                    options.set_last_will(LastWill::new(topic, payload, QoS::AtLeastOnce, retain));
                }
                let (client, mut events) = AsyncClient::new(options, OUTGOING);
                let task = tokio::spawn(async move {
                    loop {
                        let event =
                            events.poll().await.map(of_v3).map_err(|e| MqttFailure::of_v3(&e));
                        if !arrived.pass(event) {
                            return;
                        }
                    }
                });
                (MqttClient::V3(client), task)
            }
            MqttVersion::V5 => {
                let mut options = v5::MqttOptions::new(id, host, *port);
                options.set_keep_alive(KEEP_ALIVE).set_clean_start(true);
                options.set_max_packet_size(Some(MAX_PACKET_BYTES));
                tls().map(|transport| options.set_transport(transport));
                if let Some(Credentials { user, password }) = &access.credentials {
                    options.set_credentials(user, password);
                }
                if let Some(Will { topic, payload, retain }) = will {
                    let qos = v5::mqttbytes::QoS::AtLeastOnce;
                    let will = v5::mqttbytes::v5::LastWill::new(topic, payload, qos, retain, None);
                    options.set_last_will(will);
                }
                let (client, mut events) = v5::AsyncClient::new(options, OUTGOING);
                let task = tokio::spawn(async move {
                    loop {
                        let event =
                            events.poll().await.map(of_v5).map_err(|e| MqttFailure::of_v5(&e));
                        if !arrived.pass(event) {
                            return;
                        }
                    }
                });
                (MqttClient::V5(client), task)
            }
        };
        BrokerConnection { client, incoming, task }
    }

    /// Determines whether the broker refuses the connection. An unreachable broker may become
    /// available later.
    pub(super) async fn probe(&self) -> Result<(), BridgeError> {
        let mut connection = self.open("probe", None);
        match connection.connected().await {
            Ok(()) => {
                tracing::info!("MQTT at {}: connected", self.address());
                connection.end().await;
                Ok(())
            }
            Err(MqttFailure { message, is_refusal: true }) => {
                Err(BridgeError::Broker { broker: "MQTT", address: self.address(), message })
            }
            Err(MqttFailure { message, .. }) => {
                tracing::warn!(
                    "MQTT at {}: {message}; events are kept until it is back",
                    self.address()
                );
                Ok(())
            }
        }
    }
}

/// Input of a connection.
#[derive(Debug)]
pub(super) enum MqttInput {
    /// The connection is established.
    Connected,
    /// The broker has acknowledged the oldest pending message.
    Acknowledged,
    /// The broker has refused the oldest pending message (MQTT 5).
    Refused {
        why: String,
        /// `true` if the refusal is permanent.
        lasts: bool,
    },
    /// A message of a subscription.
    Message(SubscribedMessage),
    /// Any other input.
    Other,
}

/// Received input, on its way to its reader.
struct Arrivals {
    to: mpsc::UnboundedSender<Result<MqttInput, MqttFailure>>,
    /// Number of unread messages.
    waiting: Arc<AtomicUsize>,
}

impl Arrivals {
    fn new() -> (Self, Arriving) {
        let (to, from) = mpsc::unbounded_channel();
        let waiting = Arc::new(AtomicUsize::new(0));
        (Self { to, waiting: Arc::clone(&waiting) }, Arriving { from, waiting })
    }

    /// Forwards input without blocking; `false` after an error, or once the reader is gone.
    fn pass(&self, event: Result<MqttInput, MqttFailure>) -> bool {
        match &event {
            Ok(MqttInput::Other) => return !self.to.is_closed(),
            Ok(MqttInput::Message(_)) if self.waiting.load(Ordering::Relaxed) >= INCOMING => {
                tracing::warn!("a command was dropped: too many arrive at once");
                return true;
            }
            Ok(MqttInput::Message(_)) => {
                self.waiting.fetch_add(1, Ordering::Relaxed);
            }
            _ => {}
        }
        let is_over = event.is_err();
        self.to.send(event).is_ok() && !is_over
    }
}

/// The reader's side.
struct Arriving {
    from: mpsc::UnboundedReceiver<Result<MqttInput, MqttFailure>>,
    waiting: Arc<AtomicUsize>,
}

impl Arriving {
    async fn next(&mut self) -> Result<MqttInput, MqttFailure> {
        let event = self.from.recv().await.unwrap_or_else(|| Err(MqttFailure::lost()));
        if matches!(event, Ok(MqttInput::Message(_))) {
            self.waiting.fetch_sub(1, Ordering::Relaxed);
        }
        event
    }
}

/// A message of a subscription.
#[derive(Debug)]
pub(super) struct SubscribedMessage {
    pub(super) payload: Bytes,
    /// The retain flag. With MQTT 3.1.1, brokers set it only for messages that were retained before
    /// the subscription.
    pub(super) is_retained: bool,
    /// Response topic (MQTT 5).
    pub(super) response_topic: Option<String>,
    /// Correlation data, which the reply repeats (MQTT 5).
    pub(super) correlation: Option<Bytes>,
    pub(super) topic: String,
}

fn of_v3(event: Event) -> MqttInput {
    match event {
        Event::Incoming(Packet::ConnAck(_)) => MqttInput::Connected,
        Event::Incoming(Packet::PubAck(_)) => MqttInput::Acknowledged,
        Event::Incoming(Packet::Publish(publish)) => MqttInput::Message(SubscribedMessage {
            payload: publish.payload,
            is_retained: publish.retain,
            response_topic: None,
            correlation: None,
            topic: publish.topic,
        }),
        _ => MqttInput::Other,
    }
}

fn of_v5(event: v5::Event) -> MqttInput {
    use v5::mqttbytes::v5::{Packet, PubAckReason};
    match event {
        v5::Event::Incoming(Packet::ConnAck(_)) => MqttInput::Connected,
        v5::Event::Incoming(Packet::PubAck(answer)) => {
            let reason = format!("{:?}", answer.reason);
            match answer.reason {
                PubAckReason::Success | PubAckReason::NoMatchingSubscribers => {
                    MqttInput::Acknowledged
                }
                PubAckReason::NotAuthorized
                | PubAckReason::TopicNameInvalid
                | PubAckReason::PayloadFormatInvalid => {
                    MqttInput::Refused { why: reason, lasts: true }
                }
                _ => MqttInput::Refused { why: reason, lasts: false },
            }
        }
        v5::Event::Incoming(Packet::Publish(publish)) => {
            let properties = publish.properties.unwrap_or_default();
            MqttInput::Message(SubscribedMessage {
                payload: publish.payload,
                is_retained: publish.retain,
                response_topic: properties.response_topic,
                correlation: properties.correlation_data,
                topic: String::from_utf8_lossy(&publish.topic).into_owned(),
            })
        }
        _ => MqttInput::Other,
    }
}

/// Failure of a connection.
#[derive(Debug)]
pub(super) struct MqttFailure {
    pub(super) message: String,
    /// `true` if either side refuses the other: repetition does not help.
    pub(super) is_refusal: bool,
}

impl MqttFailure {
    fn of_v3(error: &ConnectionError) -> Self {
        match error {
            ConnectionError::ConnectionRefused(code) => Self::refused(
                matches!(
                    code,
                    ConnectReturnCode::BadUserNamePassword | ConnectReturnCode::NotAuthorized
                ),
                &format!("{code:?}"),
            ),
            ConnectionError::Tls(error) => Self::tls(error),
            other => Self { message: other.to_string(), is_refusal: false },
        }
    }

    fn of_v5(error: &v5::ConnectionError) -> Self {
        use v5::mqttbytes::v5::ConnectReturnCode;
        match error {
            v5::ConnectionError::ConnectionRefused(code) => Self::refused(
                matches!(
                    code,
                    ConnectReturnCode::BadUserNamePassword | ConnectReturnCode::NotAuthorized
                ),
                &format!("{code:?}"),
            ),
            v5::ConnectionError::Tls(error) => Self::tls(error),
            other => Self { message: other.to_string(), is_refusal: false },
        }
    }

    fn refused(is_user: bool, code: &str) -> Self {
        if is_user {
            let message = "the broker does not accept the user or the password".to_owned();
            Self { message, is_refusal: true }
        } else {
            Self {
                message: format!("the broker refuses the connection: {code}"),
                is_refusal: false,
            }
        }
    }

    fn tls(error: &rumqttc::TlsError) -> Self {
        let text = error.to_string();
        // A broker that has just aborted a handshake may be restarting.
        let is_refusal = text.contains("certificate") || text.contains("Certificate");
        Self { message: format!("TLS: {text}"), is_refusal }
    }

    fn lost() -> Self {
        Self { message: "the connection has ended".to_owned(), is_refusal: false }
    }
}

/// A connection.
pub(super) struct BrokerConnection {
    client: MqttClient,
    incoming: Arriving,
    task: JoinHandle<()>,
}

enum MqttClient {
    V3(AsyncClient),
    V5(v5::AsyncClient),
}

/// Delivery of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delivery {
    /// Delivery with `QoS` 0.
    AtMostOnce,
    /// Delivery with `QoS` 1.
    AtLeastOnce,
    /// Delivery with `QoS` 1, retained for later subscribers.
    Retained,
}

impl BrokerConnection {
    /// Waits for the broker's acceptance.
    pub(super) async fn connected(&mut self) -> Result<(), MqttFailure> {
        match timeout(CONNECT_TIMEOUT, self.next()).await {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(failure)) => Err(failure),
            Err(_) => {
                Err(MqttFailure { message: "no answer in time".to_owned(), is_refusal: false })
            }
        }
    }

    /// Waits for the next input. Cancellation-safe.
    pub(super) async fn next(&mut self) -> Result<MqttInput, MqttFailure> {
        self.incoming.next().await
    }

    /// Sends a message, with the correlation data of a request.
    pub(super) async fn publish(
        &self,
        topic: &str,
        payload: Vec<u8>,
        delivery: Delivery,
        correlation: Option<Bytes>,
    ) -> Result<(), MqttFailure> {
        let retain = delivery == Delivery::Retained;
        let is_sent = match &self.client {
            MqttClient::V3(client) => {
                let qos = match delivery {
                    Delivery::AtMostOnce => QoS::AtMostOnce,
                    _ => QoS::AtLeastOnce,
                };
                client.publish(topic, qos, retain, payload).await.is_ok()
            }
            MqttClient::V5(client) => {
                let qos = match delivery {
                    Delivery::AtMostOnce => v5::mqttbytes::QoS::AtMostOnce,
                    _ => v5::mqttbytes::QoS::AtLeastOnce,
                };
                let properties = v5::mqttbytes::v5::PublishProperties {
                    correlation_data: correlation,
                    ..Default::default()
                };
                let sent = client.publish_with_properties(topic, qos, retain, payload, properties);
                sent.await.is_ok()
            }
        };
        if is_sent { Ok(()) } else { Err(MqttFailure::lost()) }
    }

    /// Subscribes with `QoS` 1. With MQTT 5, messages keep the retain flag of their sender,
    /// including messages that arrive later.
    pub(super) async fn subscribe(&self, topic: &str) -> Result<(), MqttFailure> {
        let is_sent = match &self.client {
            MqttClient::V3(client) => client.subscribe(topic, QoS::AtLeastOnce).await.is_ok(),
            MqttClient::V5(client) => {
                let mut filter =
                    v5::mqttbytes::v5::Filter::new(topic, v5::mqttbytes::QoS::AtLeastOnce);
                filter.preserve_retain = true;
                // Existing retained messages are also delivered, so that each retained command is
                // refused with a reply.
                filter.retain_forward_rule = v5::mqttbytes::v5::RetainForwardRule::OnEverySubscribe;
                client.subscribe_many([filter]).await.is_ok()
            }
        };
        if is_sent { Ok(()) } else { Err(MqttFailure::lost()) }
    }

    /// Ends the connection in an orderly way: the broker does not publish the last will.
    pub(super) async fn end(mut self) {
        let _ = match &self.client {
            MqttClient::V3(client) => client.disconnect().await.is_ok(),
            MqttClient::V5(client) => client.disconnect().await.is_ok(),
        };
        // The task ends with an error once the broker has closed the connection.
        let all_read = async { while self.next().await.is_ok() {} };
        let _ = timeout(Duration::from_millis(500), all_read).await;
    }
}

impl Drop for BrokerConnection {
    fn drop(&mut self) {
        self.task.abort();
    }
}
