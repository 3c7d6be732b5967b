//! The thread that runs the dispatcher and connects it with sockets, FRI and the other threads.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender},
    },
    time::{Duration, Instant},
};

use bytes::Bytes;
use iiwa_link::{
    Published,
    robot_program::{Acknowledgement, StateChange},
    transport::{Dialer, Event, Frames, Listener, PeerId, ReceivedMessage},
};

use super::{
    checks::{CheckJob, CheckResult},
    dispatcher::{Dispatcher, DispatcherOutput, IncomingRequest},
    events::{FriCommand, FriEvent},
    run_replies::RunReply,
};

/// Return address of a reply.
pub(super) struct ReplyRoute {
    pub(super) peer: PeerId,
    /// The frames before the body of the request.
    envelope: Frames,
}

impl ReplyRoute {
    /// Returns a reply with this body.
    pub(super) fn with(self, body: impl Into<Bytes>) -> Frames {
        let mut frames = self.envelope;
        frames.push(body.into());
        frames
    }
}

/// Input of the dispatcher thread, except FRI events.
pub(super) enum DispatcherInput {
    Request(ReplyRoute, IncomingRequest),
    Disconnected(PeerId),
    StateChange(StateChange),
    Acknowledged(Acknowledgement),
    Checked(CheckResult<ReplyRoute>),
}

impl DispatcherInput {
    /// Converts an event of the request socket to an input.
    pub(super) fn of(event: Event) -> Self {
        let (peer, ReceivedMessage { mut frames, permit, began }) = match event {
            Event::Disconnected(peer) => return Self::Disconnected(peer),
            Event::Message(peer, received) => (peer, received),
        };
        // Envelope, empty frame, body, as sent by REQ. DEALER may omit the empty frame.
        let envelope = frames.iter().position(Bytes::is_empty).map_or(0, |empty| empty + 1);
        let bodies = frames.split_off(envelope.min(frames.len()));
        let body = match <[Bytes; 1]>::try_from(bodies) {
            Ok([body]) => body,
            // Not a valid request, but a reply is required.
            Err(_) => Bytes::new(),
        };
        let route = ReplyRoute { peer, envelope: frames };
        Self::Request(route, IncomingRequest { body, permit, began })
    }
}

/// The thread that runs the dispatcher.
pub(super) struct DispatcherThread {
    pub(super) dispatcher: Dispatcher<ReplyRoute>,
    pub(super) requests: Arc<Listener>,
    pub(super) program: Dialer,
    /// Kept alive; its messages arrive as inputs.
    pub(super) _state: Dialer,
    pub(super) inputs: Receiver<DispatcherInput>,
    pub(super) events: Receiver<FriEvent>,
    pub(super) commands: Sender<FriCommand>,
    pub(super) stream: SyncSender<Published>,
    pub(super) jobs: Sender<CheckJob<ReplyRoute>>,
    pub(super) replies: Sender<RunReply<ReplyRoute>>,
}

/// Time-out of waiting for inputs, after which FRI events and deadlines are checked.
const POLL_INTERVAL: Duration = Duration::from_millis(5);

impl DispatcherThread {
    /// Runs until `shutdown`.
    pub(super) fn run(mut self, shutdown: &AtomicBool) {
        while !shutdown.load(Ordering::Relaxed) {
            let first = match self.inputs.recv_timeout(POLL_INTERVAL) {
                Ok(input) => Some(input),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return,
            };
            let now = Instant::now();
            // FRI events precede requests, so that requests see the latest state.
            for event in self.events.try_iter() {
                self.dispatcher.fri_event(event, now);
            }
            for input in first.into_iter().chain(self.inputs.try_iter()) {
                match input {
                    DispatcherInput::Request(route, incoming) => {
                        self.dispatcher.request(route, incoming, now);
                    }
                    DispatcherInput::Disconnected(peer) => {
                        self.dispatcher.disconnected(|route| route.peer == peer, now);
                    }
                    DispatcherInput::StateChange(change) => {
                        self.dispatcher.state_changed(change, now);
                    }
                    DispatcherInput::Acknowledged(acknowledgement) => {
                        self.dispatcher.acknowledged(acknowledgement, now);
                    }
                    DispatcherInput::Checked(CheckResult::Checked(checked)) => {
                        self.dispatcher.checked(checked, now);
                    }
                    DispatcherInput::Checked(CheckResult::Refused(route, reply)) => {
                        self.reply(route, reply);
                    }
                }
            }
            self.dispatcher.tick(now);
            self.send_outputs();
        }
    }

    fn reply(&self, route: ReplyRoute, reply: String) {
        self.requests.send(route.peer, route.with(reply), None);
    }

    fn send_outputs(&mut self) {
        for output in self.dispatcher.take_outputs() {
            match output {
                DispatcherOutput::Reply(route, reply) => self.reply(route, reply),
                DispatcherOutput::Instruct(instruction) => {
                    self.program.send(vec![Bytes::new(), instruction.into()]);
                }
                DispatcherOutput::Reconnect => self.program.reconnect(),
                // These threads outlive this one.
                DispatcherOutput::RunReply(reply) => drop(self.replies.send(reply)),
                DispatcherOutput::Check(job) => drop(self.jobs.send(job)),
                DispatcherOutput::Fri(command) => drop(self.commands.send(command)),
                // The channel is full only if the publishing thread has stopped.
                DispatcherOutput::Publish(published) => drop(self.stream.try_send(published)),
            }
        }
    }
}
