//! A connection to one other socket that comes back whenever it was lost.

use std::{
    pin::pin,
    thread::{self, JoinHandle},
    time::Duration,
};

use tokio::{
    sync::mpsc::{self, UnboundedReceiver, UnboundedSender},
    time::{sleep, timeout},
};

use super::wire::{Frames, Incoming, Wire, WireConfig, WireError};
use crate::{error::LinkError, security::Endpoint};

/// How long after a connection was lost another one is tried.
const AGAIN: Duration = Duration::from_millis(50);

/// How long a connection may take to come about, and a message to be taken.
const WITHIN: Duration = Duration::from_secs(2);

/// Keeps up a connection, in a thread of its own. It ends when it is dropped.
#[derive(Debug)]
pub struct Dialer {
    commands: Option<UnboundedSender<Command>>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
enum Command {
    Send(Frames),
    Reconnect,
}

impl Dialer {
    /// Starts to connect. `take` gets what comes in, and says what is answered.
    ///
    /// # Errors
    ///
    /// The system starts no thread.
    pub(crate) fn start(
        name: &'static str,
        config: WireConfig,
        to: Endpoint,
        take: impl FnMut(Frames) -> Option<Frames> + Send + 'static,
    ) -> Result<Self, LinkError> {
        let refuse = |source| LinkError::Thread { source };
        let runtime = super::runtime().map_err(refuse)?;
        let (commands, orders) = mpsc::unbounded_channel();
        let run = move || runtime.block_on(keep(&config, &to, orders, take));
        let thread = thread::Builder::new().name(name.to_owned()).spawn(run).map_err(refuse)?;
        Ok(Self { commands: Some(commands), thread: Some(thread) })
    }

    /// Sends a message, once there is a connection. The newest one counts.
    pub fn send(&self, frames: Frames) {
        self.command(Command::Send(frames));
    }

    /// Takes another connection. What was not sent so far is dropped.
    pub fn reconnect(&self) {
        self.command(Command::Reconnect);
    }

    fn command(&self, command: Command) {
        if let Some(commands) = &self.commands {
            // Its thread ends last.
            let _ = commands.send(command);
        }
    }
}

impl Drop for Dialer {
    fn drop(&mut self) {
        self.commands = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Connects, and connects again, until there is nobody left who commands.
async fn keep(
    config: &WireConfig,
    to: &Endpoint,
    mut orders: UnboundedReceiver<Command>,
    mut take: impl FnMut(Frames) -> Option<Frames>,
) {
    let mut waiting = None;
    loop {
        let wire = {
            let mut connection = pin!(connect(config, to));
            loop {
                tokio::select! {
                    wire = &mut connection => break wire,
                    order = orders.recv() => match order {
                        Some(Command::Send(frames)) => waiting = Some(frames),
                        Some(Command::Reconnect) => waiting = None,
                        None => return,
                    },
                }
            }
        };
        match exchange(wire, waiting.take(), &mut orders, &mut take).await {
            Ok(Next::Reconnect) => {}
            Ok(Next::End) => return,
            Err(error) => tracing::debug!("{to}: {error}"),
        }
    }
}

enum Next {
    Reconnect,
    End,
}

/// Sends and receives as long as the connection lasts.
async fn exchange(
    mut wire: Wire,
    first: Option<Frames>,
    orders: &mut UnboundedReceiver<Command>,
    take: &mut impl FnMut(Frames) -> Option<Frames>,
) -> Result<Next, WireError> {
    if let Some(frames) = first {
        wire.queue(&frames)?;
    }
    loop {
        timeout(WITHIN, wire.flush()).await.map_err(|_| WireError::Stalled(WITHIN))??;
        tokio::select! {
            order = orders.recv() => match order {
                Some(Command::Send(frames)) => wire.queue(&frames)?,
                Some(Command::Reconnect) => return Ok(Next::Reconnect),
                None => return Ok(Next::End),
            },
            incoming = wire.receive() => {
                if let Incoming::Message(received) = incoming?
                    && let Some(answer) = take(received.frames)
                {
                    wire.queue(&answer)?;
                }
            }
        }
    }
}

/// Tries until there is a connection.
async fn connect(config: &WireConfig, to: &Endpoint) -> Wire {
    let mut told = None;
    loop {
        match timeout(WITHIN, Wire::connect(to, config)).await {
            Ok(Ok(wire)) => return wire,
            Ok(Err(WireError::Refused(why))) if told != Some(why) => {
                tracing::warn!("{to} does not let this drive in: {}", why.what());
                told = Some(why);
            }
            Ok(Err(error)) => tracing::trace!("{to}: {error}"),
            Err(_) => tracing::trace!("{to}: no answer"),
        }
        sleep(AGAIN).await;
    }
}
