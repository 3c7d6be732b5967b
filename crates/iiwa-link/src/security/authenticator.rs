//! The thread that libzmq asks about each client.

use std::{
    io,
    sync::{Arc, Mutex, PoisonError},
    thread::{self, JoinHandle},
};

use super::{
    AllowList, GuardedSocket, KeyPair, SecurityError, ServerSecurity, require_curve,
    zap::{self, Verdict},
};
use refusals::Refusals;

mod refusals;

/// Checks the clients of a context's guarded sockets: those with a key on the list are let in, all
/// others get nothing. It runs until it and all of its sockets are dropped.
///
/// A client that is let in is named in each of its messages: their property `User-Id` is the name of
/// its key. Those that are refused are named in warnings. Clients without any key are turned away
/// before by libzmq itself.
#[derive(Clone)]
pub struct Authenticator {
    context: zmq::Context,
    pair: Arc<KeyPair>,
    // The last one that goes ends the thread.
    _running: Arc<Running>,
}

impl Authenticator {
    /// Starts it.
    ///
    /// # Errors
    /// The libzmq of this build has no CURVE; the context has an authenticator already; libzmq or
    /// the system refuse.
    pub fn start(context: &zmq::Context, security: ServerSecurity) -> Result<Self, SecurityError> {
        require_curve()?;
        let ServerSecurity { pair, allowed } = security;
        let running = Running::start(context, allowed)?;
        Ok(Self { context: context.clone(), pair: Arc::new(pair), _running: Arc::new(running) })
    }

    /// A socket that lets in only clients that this authenticator admits.
    ///
    /// # Errors
    /// libzmq refuses to make one.
    pub fn socket(&self, kind: zmq::SocketType) -> Result<GuardedSocket, SecurityError> {
        let socket = self.context.socket(kind).map_err(SecurityError::zmq("make a socket"))?;
        socket
            .set_curve_server(true)
            .and_then(|()| socket.set_curve_secretkey(self.pair.secret()))
            // Without a domain, libzmq would not ask.
            .and_then(|()| socket.set_zap_domain(zap::DOMAIN))
            .map_err(SecurityError::zmq("give a socket its keys"))?;
        Ok(GuardedSocket::with_keys(socket, self.clone()))
    }
}

/// The thread, and what ends it.
struct Running {
    stop: Mutex<zmq::Socket>,
    // Bound as long as this lives, whatever becomes of the thread: where nobody listens, libzmq lets
    // everybody in; where nobody answers, nobody gets in.
    _requests: Arc<Mutex<zmq::Socket>>,
    thread: Option<JoinHandle<()>>,
}

impl Running {
    fn start(context: &zmq::Context, allowed: AllowList) -> Result<Self, SecurityError> {
        let refuse = || SecurityError::zmq("start the authenticator");
        let requests = context.socket(zmq::REP).map_err(refuse())?;
        requests.set_linger(0).map_err(refuse())?;
        match requests.bind(zap::ADDRESS) {
            Err(zmq::Error::EADDRINUSE) => return Err(SecurityError::SecondAuthenticator),
            bound => bound.map_err(refuse())?,
        }
        let (stop, stopped) = (
            context.socket(zmq::PAIR).map_err(refuse())?,
            context.socket(zmq::PAIR).map_err(refuse())?,
        );
        // A context has one authenticator, so the name is free.
        stopped.bind("inproc://iiwasim.authenticator.stop").map_err(refuse())?;
        stop.connect("inproc://iiwasim.authenticator.stop").map_err(refuse())?;
        stop.set_linger(0).map_err(refuse())?;
        let requests = Arc::new(Mutex::new(requests));
        let thread = {
            let requests = Arc::clone(&requests);
            thread::Builder::new().name("authenticator".to_owned()).spawn(move || {
                let requests = requests.lock().unwrap_or_else(PoisonError::into_inner);
                serve(&requests, &stopped, &allowed);
            })
        };
        let thread = thread.map_err(|source: io::Error| SecurityError::Thread { source })?;
        Ok(Self { stop: Mutex::new(stop), _requests: requests, thread: Some(thread) })
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let stop = self.stop.get_mut().unwrap_or_else(PoisonError::into_inner);
        // The thread has nothing to do but to listen, so this arrives; if the context has been
        // terminated, it has ended by that.
        let _ = stop.send("", zmq::DONTWAIT);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Answers requests until it is stopped.
fn serve(requests: &zmq::Socket, stopped: &zmq::Socket, allowed: &AllowList) {
    let mut refusals = Refusals::default();
    loop {
        let mut items = [requests.as_poll_item(zmq::POLLIN), stopped.as_poll_item(zmq::POLLIN)];
        match zmq::poll(&mut items, -1) {
            Ok(_) | Err(zmq::Error::EINTR) => {}
            Err(_) => return,
        }
        if items[1].is_readable() {
            return;
        }
        if !items[0].is_readable() {
            continue;
        }
        let Ok(request) = requests.recv_multipart(zmq::DONTWAIT) else { continue };
        let answer = zap::answer(&request, allowed);
        match answer.verdict {
            Verdict::Admitted { name, address } => {
                tracing::info!(client = name, address, "admitted");
            }
            Verdict::Refused { key, address } => {
                if refusals.is_news(&address, key) {
                    let key = key.map(|key| key.to_string()).unwrap_or_default();
                    tracing::warn!(address, key, "refused: its key is not allowed");
                }
            }
            Verdict::Malformed => tracing::warn!("a malformed request to the authenticator"),
        }
        // It came from this process; if that has gone by now, nobody waits.
        let _ = requests.send_multipart(answer.frames, zmq::DONTWAIT);
    }
}
