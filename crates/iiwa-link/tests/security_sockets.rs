//! Who gets in, over real sockets.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails, or says why it is left out"
)]

use std::{
    sync::mpsc,
    thread,
    time::{Duration, Instant},
};

use iiwa_link::security::{
    AllowList, Authenticator, ClientSecurity, Endpoint, GuardedSocket, Handshake, KeyPair,
    PublicKey, SecurityError, ServerSecurity, WatchedSocket, connect, has_curve,
};

/// Longer than anything takes on a busy machine.
const PATIENCE: Duration = Duration::from_secs(20);

/// How long it is watched that nothing arrives after a handshake has failed; what arrives takes a
/// hundredth of it.
const QUIET: Duration = Duration::from_millis(300);

/// Keys of a server and of clients, if this build can use them.
struct Keys {
    server: KeyPair,
    alice: KeyPair,
    mallory: KeyPair,
}

impl Keys {
    fn new() -> Option<Self> {
        if !has_curve() {
            let expected = std::env::var_os("IIWASIM_EXPECT_CURVE").is_some();
            assert!(!expected, "this build has no CURVE");
            println!("left out: this build has no CURVE");
            return None;
        }
        let pair = || KeyPair::generate().unwrap();
        Some(Self { server: pair(), alice: pair(), mallory: pair() })
    }

    fn security(&self) -> ServerSecurity {
        let allowed = AllowList::from_iter([("alice".to_owned(), self.alice.public())]);
        ServerSecurity { pair: self.server.clone(), allowed }
    }
}

/// A ROUTER that is to answer requests and a PUB that says something all the time.
struct Server {
    requests: GuardedSocket,
    stream: GuardedSocket,
    addresses: [Endpoint; 2],
}

impl Server {
    fn new(context: &zmq::Context, security: Option<ServerSecurity>) -> Self {
        let authenticator = security.map(|s| Authenticator::start(context, s).unwrap());
        // The sockets alone keep the authenticator from here on.
        let socket = |kind| {
            let socket = match &authenticator {
                Some(authenticator) => authenticator.socket(kind).unwrap(),
                None => GuardedSocket::open(context, kind).unwrap(),
            };
            socket.set_linger(0).unwrap();
            let at = socket.bind(&"127.0.0.1:*".parse().unwrap()).unwrap();
            (socket, at.parse().unwrap())
        };
        let ((requests, first), (stream, second)) = (socket(zmq::ROUTER), socket(zmq::PUB));
        Self { requests, stream, addresses: [first, second] }
    }

    /// Publishes and answers until something has arrived at the client, or for a while after both of
    /// its handshakes have failed; returns the user ids of requests that came, and the handshakes.
    fn serve(&self, client: &Client) -> (Vec<String>, [Option<Handshake>; 2]) {
        let mut users = Vec::new();
        let (mut replied, mut heard) = (false, false);
        let mut handshakes = [None; 2];
        let begun = Instant::now();
        let mut undecided = begun;
        while !(replied && heard && handshakes == [Some(Handshake::Done); 2]) {
            assert!(begun.elapsed() < PATIENCE, "{users:?}, heard: {heard}, {handshakes:?}");
            self.stream.send_multipart(["joints", "{}"], 0).unwrap();
            if self.requests.poll(zmq::POLLIN, 5).unwrap() > 0 {
                let id = self.requests.recv_bytes(0).unwrap();
                assert!(self.requests.recv_bytes(0).unwrap().is_empty());
                let mut body = self.requests.recv_msg(0).unwrap();
                users.push(body.gets("User-Id").unwrap_or_default().to_owned());
                self.requests.send_multipart([id, Vec::new(), b"done".to_vec()], 0).unwrap();
            }
            replied |= client.requests.recv_bytes(zmq::DONTWAIT).is_ok();
            heard |= client.stream.recv_multipart(zmq::DONTWAIT).is_ok();
            for (socket, latest) in [&client.requests, &client.stream].iter().zip(&mut handshakes) {
                // A connection that was refused is lost then.
                let next = socket.handshake().unwrap().filter(|next| *next != Handshake::Lost);
                *latest = next.or(*latest);
            }
            if !handshakes.iter().all(|h| h.is_some_and(Handshake::is_refusal)) {
                undecided = Instant::now();
            } else if undecided.elapsed() > QUIET {
                assert!(!heard, "the stream came through");
                break;
            }
        }
        (users, handshakes)
    }
}

struct Client {
    requests: WatchedSocket,
    stream: WatchedSocket,
}

impl Client {
    fn new(context: &zmq::Context, server: &Server, security: Option<&ClientSecurity>) -> Self {
        let socket = |kind, at: &Endpoint| {
            let socket = WatchedSocket::new(context, kind).unwrap();
            socket.set_linger(0).unwrap();
            connect(&socket, at, security).unwrap();
            socket
        };
        let requests = socket(zmq::REQ, &server.addresses[0]);
        let stream = socket(zmq::SUB, &server.addresses[1]);
        stream.set_subscribe(b"").unwrap();
        requests.send("move", 0).unwrap();
        Self { requests, stream }
    }
}

/// What comes of a client with these keys: the user ids of its requests, and its handshakes.
fn attempt(
    server: Option<ServerSecurity>,
    client: Option<(&KeyPair, PublicKey)>,
) -> (Vec<String>, [Option<Handshake>; 2]) {
    let (far, near) = (zmq::Context::new(), zmq::Context::new());
    let server = Server::new(&far, server);
    let security = client.map(|(pair, server)| ClientSecurity { pair: pair.clone(), server });
    server.serve(&Client::new(&near, &server, security.as_ref()))
}

#[test]
fn the_right_key_works_and_is_named() {
    let Some(keys) = Keys::new() else { return };
    let client = Some((&keys.alice, keys.server.public()));
    let (users, handshakes) = attempt(Some(keys.security()), client);
    assert_eq!((users, handshakes), (vec!["alice".to_owned()], [Some(Handshake::Done); 2]));
}

#[test]
fn without_keys_loopback_works() {
    let (users, handshakes) = attempt(None, None);
    assert_eq!((users, handshakes), (vec![String::new()], [Some(Handshake::Done); 2]));
}

/// Asserts that a client gets nothing on either socket, and returns its handshakes.
fn nothing_arrives(
    server: Option<ServerSecurity>,
    client: Option<(&KeyPair, PublicKey)>,
) -> [Option<Handshake>; 2] {
    let (users, handshakes) = attempt(server, client);
    assert!(users.is_empty(), "a request came through: {users:?}");
    handshakes
}

#[test]
fn a_key_that_is_not_on_the_list_gets_nothing() {
    let Some(keys) = Keys::new() else { return };
    let client = Some((&keys.mallory, keys.server.public()));
    assert_eq!(nothing_arrives(Some(keys.security()), client), [Some(Handshake::NotAllowed); 2]);
    // The server's own key does not help either.
    let client = Some((&keys.server, keys.server.public()));
    assert_eq!(nothing_arrives(Some(keys.security()), client), [Some(Handshake::NotAllowed); 2]);
    let mut nobody = keys.security();
    nobody.allowed = AllowList::default();
    let client = Some((&keys.alice, keys.server.public()));
    assert_eq!(nothing_arrives(Some(nobody), client), [Some(Handshake::NotAllowed); 2]);
}

#[test]
fn a_client_without_a_key_gets_nothing() {
    let Some(keys) = Keys::new() else { return };
    // Which side hangs up first is a race, so it is told as one of two refusals.
    nothing_arrives(Some(keys.security()), None);
}

#[test]
fn a_wrong_server_key_gets_nothing() {
    let Some(keys) = Keys::new() else { return };
    let client = Some((&keys.alice, keys.mallory.public()));
    assert_eq!(nothing_arrives(Some(keys.security()), client), [Some(Handshake::HungUp); 2]);
}

#[test]
fn a_client_with_keys_trusts_no_server_without() {
    let Some(keys) = Keys::new() else { return };
    // The same race.
    nothing_arrives(None, Some((&keys.alice, keys.server.public())));
}

#[test]
fn a_borrowed_public_key_gets_nothing() {
    let Some(keys) = Keys::new() else { return };
    // Alice's public key, which is no secret, with another secret key.
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = keys.mallory.write(folder.path(), "mallory").unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let forged = text.replace(&keys.mallory.public().to_string(), &keys.alice.public().to_string());
    std::fs::write(&path, forged).unwrap();
    let forged = KeyPair::read(&path).unwrap();
    assert_eq!(forged.public(), keys.alice.public());
    let client = Some((&forged, keys.server.public()));
    assert_eq!(nothing_arrives(Some(keys.security()), client), [Some(Handshake::HungUp); 2]);
}

/// Runs something that must end; fails if it does not.
fn bounded(work: impl FnOnce() + Send + 'static) {
    let (done, ended) = mpsc::channel();
    thread::spawn(move || {
        work();
        done.send(()).unwrap();
    });
    ended.recv_timeout(2 * PATIENCE).unwrap();
}

#[test]
fn the_authenticator_ends_with_the_last_of_its_sockets() {
    let Some(keys) = Keys::new() else { return };
    bounded(move || {
        let context = zmq::Context::new();
        let authenticator = Authenticator::start(&context, keys.security()).unwrap();
        let second = Authenticator::start(&context, keys.security());
        assert!(matches!(second, Err(SecurityError::SecondAuthenticator)));
        let socket = authenticator.socket(zmq::ROUTER).unwrap();
        drop(authenticator);
        // The socket still has it.
        let second = Authenticator::start(&context, keys.security());
        assert!(matches!(second, Err(SecurityError::SecondAuthenticator)));
        drop(socket);
        // Its sockets are gone once libzmq has closed them.
        let deadline = Instant::now() + Duration::from_secs(10);
        while Authenticator::start(&context, keys.security()).is_err() {
            assert!(Instant::now() < deadline, "it is still running");
            thread::sleep(Duration::from_millis(5));
        }
        // Waits for all sockets of the context, the thread's too.
        drop(context);
    });
}

#[test]
fn requests_that_are_none_are_refused() {
    let Some(keys) = Keys::new() else { return };
    let context = zmq::Context::new();
    let _authenticator = Authenticator::start(&context, keys.security()).unwrap();
    let ask = |frames: &[&[u8]]| {
        let socket = context.socket(zmq::REQ).unwrap();
        socket.set_linger(0).unwrap();
        socket.set_rcvtimeo(20_000).unwrap();
        socket.connect("inproc://zeromq.zap.01").unwrap();
        socket.send_multipart(frames.iter().map(|frame| frame.to_vec()), 0).unwrap();
        let reply = socket.recv_multipart(0).unwrap();
        assert_eq!((reply.len(), &*reply[0]), (6, &b"1.0"[..]));
        let text = |frame: &[u8]| String::from_utf8(frame.to_vec()).unwrap();
        (reply[1].clone(), text(&reply[2]), text(&reply[4]))
    };
    let alice = keys.alice.public();
    let good: [&[u8]; 7] = [b"1.0", b"7", b"iiwasim", b"10.0.0.1", b"", b"CURVE", alice.bytes()];
    assert_eq!(ask(&good), (b"7".to_vec(), "200".to_owned(), "alice".to_owned()));

    let with = |i: usize, frame: &'static [u8]| {
        let mut frames = good;
        frames[i] = frame;
        let (id, status, user) = ask(&frames);
        assert_eq!((&*id, user.as_str()), (frames[1], ""));
        status
    };
    assert_eq!(with(0, b"2.0"), "500");
    assert_eq!(with(6, b"short"), "500");
    assert_eq!(with(2, b"other domain"), "400");
    assert_eq!(with(5, b"NULL"), "400");
    assert_eq!(with(5, b"PLAIN"), "400");
    // An address is for logs only.
    let mut odd = good;
    odd[3] = b"\xff\n";
    assert_eq!(ask(&odd).1, "200");
}

#[test]
fn short_and_long_requests_are_refused() {
    let Some(keys) = Keys::new() else { return };
    let context = zmq::Context::new();
    let _authenticator = Authenticator::start(&context, keys.security()).unwrap();
    let alice = keys.alice.public();
    let good: [&[u8]; 8] =
        [b"1.0", b"7", b"iiwasim", b"10.0.0.1", b"", b"CURVE", alice.bytes(), b"more"];
    for count in [1, 2, 3, 4, 5, 6, 8] {
        let socket = context.socket(zmq::REQ).unwrap();
        socket.set_rcvtimeo(20_000).unwrap();
        socket.connect("inproc://zeromq.zap.01").unwrap();
        socket.send_multipart(good[..count].iter().map(|frame| frame.to_vec()), 0).unwrap();
        assert_eq!(socket.recv_multipart(0).unwrap()[2], b"500", "{count} frames");
    }
}

#[test]
fn a_client_that_was_refused_can_go() {
    let Some(keys) = Keys::new() else { return };
    bounded(move || {
        let (far, near) = (zmq::Context::new(), zmq::Context::new());
        let server = Server::new(&far, Some(keys.security()));
        let security = ClientSecurity { pair: keys.alice.clone(), server: keys.mallory.public() };
        for _ in 0..5 {
            let client = Client::new(&near, &server, Some(&security));
            thread::sleep(Duration::from_millis(100));
            // In the middle of libzmq's attempts to connect, which are told to nobody from now on.
            drop(client);
        }
        let right = ClientSecurity { server: keys.server.public(), ..security };
        let client = Client::new(&near, &server, Some(&right));
        assert_eq!(server.serve(&client).0, ["alice"]);
        drop((client, server));
        drop((near, far));
    });
}

#[test]
fn without_curve_there_is_no_silent_fall_back() {
    if has_curve() {
        println!("left out: this build has CURVE");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (key, public) = (folder.path().join("a.key"), folder.path().join("a.pub"));
    let server = ServerSecurity::read(&key, &public).unwrap_err();
    let client = ClientSecurity::read(&key, &public).unwrap_err();
    for error in [server, client] {
        assert!(matches!(error, SecurityError::NoCurve { .. }), "{error}");
    }
}
