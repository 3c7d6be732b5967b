//! A persistent connection to another socket, with reconnection.

use std::{
    pin::pin,
    thread::{self, JoinHandle},
    time::Duration,
};

use tokio::{
    sync::mpsc::{self, UnboundedReceiver, UnboundedSender},
    time::{sleep, timeout},
};

use super::{
    runtime::runtime,
    wire::{ConnectionEnd, Frames, WireConfig, WireConnection, WireInput},
};
use crate::{error::LinkError, security::Endpoint};

/// Interval between connection attempts.
const RETRY_INTERVAL: Duration = Duration::from_millis(50);

/// Maximum interval between attempts at a peer that accepts connections but not their handshakes,
/// because this peer may log each attempt.
const REFUSED_INTERVAL: Duration = Duration::from_secs(1);

/// Time-out of connecting and of sending.
const TIMEOUT: Duration = Duration::from_secs(2);

/// A connection that a separate thread maintains until the dialer is dropped.
#[derive(Debug)]
pub struct Dialer {
    commands: Option<UnboundedSender<DialerCommand>>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
enum DialerCommand {
    Send(Frames),
    Reconnect,
}

impl Dialer {
    /// Starts connecting. `take` receives messages and returns replies.
    ///
    /// # Errors
    ///
    /// No thread can be started.
    pub(crate) fn start(
        name: &'static str,
        config: WireConfig,
        to: Endpoint,
        take: impl FnMut(Frames) -> Option<Frames> + Send + 'static,
    ) -> Result<Self, LinkError> {
        let to_error = |source| LinkError::Thread { source };
        let runtime = runtime().map_err(to_error)?;
        let (commands, command_queue) = mpsc::unbounded_channel();
        let run = move || runtime.block_on(maintain(&config, &to, command_queue, take));
        let thread = thread::Builder::new().name(name.to_owned()).spawn(run).map_err(to_error)?;
        Ok(Self { commands: Some(commands), thread: Some(thread) })
    }

    /// Sends a message, once connected. While disconnected, only the latest message is kept.
    pub fn send(&self, frames: Frames) {
        self.command(DialerCommand::Send(frames));
    }

    /// Replaces the connection. Unsent messages are dropped.
    pub fn reconnect(&self) {
        self.command(DialerCommand::Reconnect);
    }

    fn command(&self, command: DialerCommand) {
        if let Some(commands) = &self.commands {
            // The thread outlives the sender.
            let _ = commands.send(command);
        }
    }
}

impl Drop for Dialer {
    fn drop(&mut self) {
        // First, because the thread ends when the channel is closed.
        self.commands = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Connects and reconnects until the commands end.
async fn maintain(
    config: &WireConfig,
    to: &Endpoint,
    mut command_queue: UnboundedReceiver<DialerCommand>,
    mut take: impl FnMut(Frames) -> Option<Frames>,
) {
    let mut pending = None;
    loop {
        let wire = {
            let mut connection = pin!(connect(config, to));
            loop {
                tokio::select! {
                    wire = &mut connection => break wire,
                    command = command_queue.recv() => match command {
                        Some(DialerCommand::Send(frames)) => pending = Some(frames),
                        Some(DialerCommand::Reconnect) => pending = None,
                        None => return,
                    },
                }
            }
        };
        match exchange(wire, pending.take(), &mut command_queue, &mut take).await {
            Ok(ExchangeEnd::Reconnect) => {}
            Ok(ExchangeEnd::End) => return,
            Err(error) => tracing::debug!("{to}: {error}"),
        }
    }
}

enum ExchangeEnd {
    Reconnect,
    End,
}

/// Sends and receives until the connection is lost or replaced.
async fn exchange(
    mut wire: WireConnection,
    first: Option<Frames>,
    command_queue: &mut UnboundedReceiver<DialerCommand>,
    take: &mut impl FnMut(Frames) -> Option<Frames>,
) -> Result<ExchangeEnd, ConnectionEnd> {
    if let Some(frames) = first {
        wire.queue(&frames)?;
    }
    loop {
        timeout(TIMEOUT, wire.flush()).await.map_err(|_| ConnectionEnd::Stalled(TIMEOUT))??;
        // Both branches are cancellation-safe: the one that is dropped loses no input.
        tokio::select! {
            command = command_queue.recv() => match command {
                Some(DialerCommand::Send(frames)) => wire.queue(&frames)?,
                Some(DialerCommand::Reconnect) => return Ok(ExchangeEnd::Reconnect),
                None => return Ok(ExchangeEnd::End),
            },
            incoming = wire.receive() => {
                if let WireInput::Message(received) = incoming?
                    && let Some(reply) = take(received.frames)
                {
                    wire.queue(&reply)?;
                }
            }
        }
    }
}

/// Connects, with retries.
async fn connect(config: &WireConfig, to: &Endpoint) -> WireConnection {
    let mut logged = None;
    let mut pause = RETRY_INTERVAL;
    loop {
        let refused_pause = REFUSED_INTERVAL.min(2 * pause);
        pause = match timeout(TIMEOUT, WireConnection::connect(to, config)).await {
            Ok(Ok(wire)) => return wire,
            // Logged once: the attempts continue for as long as the peer refuses them.
            Ok(Err(ConnectionEnd::Refused(reason))) if logged != Some(reason) => {
                tracing::warn!("{to} refused the connection: {}", reason.reason());
                logged = Some(reason);
                refused_pause
            }
            Ok(Err(error)) => {
                tracing::trace!("{to}: {error}");
                // An I/O error is usually a missing peer, which cannot log the attempts.
                if matches!(error, ConnectionEnd::Io(_)) { RETRY_INTERVAL } else { refused_pause }
            }
            Err(_) => {
                tracing::trace!("{to}: no answer");
                RETRY_INTERVAL
            }
        };
        sleep(pause).await;
    }
}
