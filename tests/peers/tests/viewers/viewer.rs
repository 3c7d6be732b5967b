//! A viewer: the messages of the SDK's own library over a WebSocket.

use std::{
    collections::BTreeMap,
    net::{SocketAddr, TcpStream},
    time::Duration,
};

use foxglove::ws_protocol::{
    client::{Subscribe, Subscription},
    server::{Channel, ServerInfo, ServerMessage, Status},
};
use tungstenite::{ClientRequestBuilder, Message, WebSocket};

/// Longer than anything takes that works.
const LONG: Duration = Duration::from_secs(20);

pub(super) struct Viewer {
    socket: WebSocket<TcpStream>,
    pub(super) info: ServerInfo,
    pub(super) channels: BTreeMap<String, Channel<'static>>,
    /// Topics by the numbers of their subscriptions.
    subscribed: Vec<String>,
}

/// A message that has arrived.
#[derive(Debug)]
pub(super) struct Arrived {
    pub(super) topic: String,
    pub(super) time_ns: u64,
    pub(super) data: Vec<u8>,
}

impl Viewer {
    /// Connects, and receives the server's information and `channels` channels.
    pub(super) fn connect(address: SocketAddr, channels: usize) -> Self {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        let request = ClientRequestBuilder::new(format!("ws://{address}").parse().unwrap())
            .with_sub_protocol("foxglove.sdk.v1");
        let (mut socket, response) = tungstenite::client(request, stream).unwrap();
        assert_eq!(response.headers()["sec-websocket-protocol"], "foxglove.sdk.v1");

        let message = socket.read().unwrap();
        let Ok(ServerMessage::ServerInfo(info)) = ServerMessage::try_from(&message) else {
            panic!("{message:?}");
        };
        let mut viewer = Self { socket, info, channels: BTreeMap::new(), subscribed: Vec::new() };
        while viewer.channels.len() < channels {
            let message = viewer.socket.read().unwrap();
            let Ok(ServerMessage::Advertise(advertised)) = ServerMessage::try_from(&message) else {
                panic!("{message:?}");
            };
            let channels = advertised.into_owned().channels.into_iter();
            viewer.channels.extend(channels.map(|channel| (channel.topic.to_string(), channel)));
        }
        viewer
    }

    /// Returns true if one more viewer is rejected.
    pub(super) fn is_refused(address: SocketAddr) -> bool {
        Self::is_refused_with(address, "foxglove.sdk.v1")
    }

    /// Returns true if a viewer that offers only this protocol is rejected.
    pub(super) fn is_refused_with(address: SocketAddr, protocol: &str) -> bool {
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(LONG)).unwrap();
        let request = ClientRequestBuilder::new(format!("ws://{address}").parse().unwrap())
            .with_sub_protocol(protocol);
        tungstenite::client(request, stream).is_err()
    }

    /// Subscribes to topics, and to the description after them; when that is there, so are they.
    pub(super) fn subscribe(&mut self, topics: &[&str]) {
        let all = [topics, &["/robot_description"]].concat();
        let subscriptions = all.iter().map(|topic| {
            let id = u32::try_from(self.subscribed.len()).unwrap();
            self.subscribed.push((*topic).to_owned());
            Subscription::new(id, self.channels[*topic].id)
        });
        let message = Subscribe::new(subscriptions);
        self.send(serde_json::to_string(&message).unwrap());
    }

    pub(super) fn send(&mut self, text: String) {
        self.socket.send(Message::text(text)).unwrap();
    }

    /// The next message; none when the server has disconnected.
    pub(super) fn next(&mut self) -> Option<Arrived> {
        let message = self.socket.read().ok().filter(|message| !message.is_close())?;
        let Ok(ServerMessage::MessageData(data)) = ServerMessage::try_from(&message) else {
            panic!("{message:?}");
        };
        Some(Arrived {
            topic: self.subscribed[data.subscription_id as usize].clone(),
            time_ns: data.log_time,
            data: data.data.into_owned(),
        })
    }

    /// The next message, which is to be on this topic.
    pub(super) fn next_on(&mut self, topic: &str) -> Arrived {
        let arrived = self.next().unwrap();
        assert_eq!(arrived.topic, topic);
        arrived
    }

    /// The server's answer to a request that is not allowed.
    pub(super) fn status(&mut self) -> Status {
        let message = self.socket.read().unwrap();
        let Ok(ServerMessage::Status(status)) = ServerMessage::try_from(&message) else {
            panic!("{message:?}");
        };
        status
    }
}
