//! Access control over real sockets.

#![expect(clippy::unwrap_used, reason = "a test fails by it")]

use std::time::{Duration, Instant};

use iiwa_drive::{Drive, DriveConfig};
use iiwa_link::{
    Client, ClientError, LinkError, Remote, Server, Stream,
    message::DriveStatus,
    security::{AllowList, ClientSecurity, KeyPair, PublicKey, ServerSecurity},
};

/// Keys of a server and of clients.
struct Keys {
    server: KeyPair,
    alice: KeyPair,
    mallory: KeyPair,
}

impl Keys {
    fn new() -> Self {
        let pair = || KeyPair::generate().unwrap();
        Self { server: pair(), alice: pair(), mallory: pair() }
    }

    fn server(&self) -> Server {
        let allowed = AllowList::from_iter([("alice".to_owned(), self.alice.public())]);
        Server::with_keys(ServerSecurity::new(self.server.clone(), allowed))
    }
}

fn remote(pair: &KeyPair, server: PublicKey) -> Remote {
    Remote::with_keys(ClientSecurity::new(pair.clone(), server))
}

/// Starts a drive without a robot.
pub(crate) fn drive(server: &Server) -> Drive {
    let mut config = DriveConfig::default();
    config.instructions = "tcp://127.0.0.1:*".into();
    config.stream = "tcp://127.0.0.1:*".into();
    config.fri = "127.0.0.1:0".parse().unwrap();
    config.cabinet_instructions = "tcp://127.0.0.1:9".into();
    config.cabinet_state = "tcp://127.0.0.1:9".into();
    Drive::start(config, server, &Remote::open()).unwrap()
}

fn request_status(drive: &Drive, remote: &Remote) -> Result<DriveStatus, ClientError> {
    Client::new(remote, drive.instructions()).unwrap().state()
}

/// Returns the reason of the stream's refusal.
fn refused_by_stream(drive: &Drive, remote: &Remote) -> String {
    let mut stream = Stream::new(remote, drive.stream()).unwrap();
    let since = Instant::now();
    while since.elapsed() < Duration::from_secs(20) {
        match stream.next(Duration::from_millis(100)) {
            Ok(None) => {}
            Ok(Some(published)) => return format!("{published:?}"),
            Err(LinkError::Unauthorized { reason, .. }) => return reason.to_owned(),
            Err(error) => return error.to_string(),
        }
    }
    "nothing".to_owned()
}

/// Returns the reasons of the refusals of a client and a stream.
fn refused(drive: &Drive, remote: &Remote) -> [String; 2] {
    let reply = match request_status(drive, remote) {
        Err(ClientError::Unauthorized { reason, .. }) => reason.to_owned(),
        other => format!("{other:?}"),
    };
    [reply, refused_by_stream(drive, remote)]
}

const NOT_ALLOWED: &str = "the client's key is not on the drive's list";
const ONE_SIDE: &str = "one side has keys and the other one has none: both need them, or neither";
const CLOSED: &str = "the drive closed the connection; is the drive's public key the right one?";

#[test]
fn the_right_key_works() {
    let keys = Keys::new();
    let drive = drive(&keys.server());
    request_status(&drive, &remote(&keys.alice, keys.server.public())).unwrap();
    let mut stream =
        Stream::new(&remote(&keys.alice, keys.server.public()), drive.stream()).unwrap();
    // Without a robot nothing is published.
    assert_eq!(stream.next(Duration::from_millis(300)).unwrap(), None);
}

#[test]
fn without_keys_loopback_works() {
    request_status(&drive(&Server::open()), &Remote::open()).unwrap();
}

#[test]
fn an_unlisted_key_is_refused() {
    let keys = Keys::new();
    let drive = drive(&keys.server());
    // The server's own key is not accepted either.
    for pair in [&keys.mallory, &keys.server] {
        assert_eq!(refused(&drive, &remote(pair, keys.server.public())), [NOT_ALLOWED; 2]);
    }
    let allowed = AllowList::default();
    let empty_list = Server::with_keys(ServerSecurity::new(keys.server.clone(), allowed));
    let alice = remote(&keys.alice, keys.server.public());
    assert_eq!(refused(&self::drive(&empty_list), &alice), [NOT_ALLOWED; 2]);
}

#[test]
fn keys_on_one_side_only_are_detected() {
    let keys = Keys::new();
    let reasons = refused(&drive(&keys.server()), &Remote::open());
    // Which side closes the connection first is a race.
    assert!(
        reasons.iter().all(|reasons| [ONE_SIDE, CLOSED].contains(&reasons.as_str())),
        "{reasons:?}"
    );
    let alice = remote(&keys.alice, keys.server.public());
    let reasons = refused(&drive(&Server::open()), &alice);
    assert!(
        reasons.iter().all(|reasons| [ONE_SIDE, CLOSED].contains(&reasons.as_str())),
        "{reasons:?}"
    );
}

#[test]
fn a_wrong_server_key_is_refused() {
    let keys = Keys::new();
    let drive = drive(&keys.server());
    assert_eq!(refused(&drive, &remote(&keys.alice, keys.mallory.public())), [CLOSED; 2]);
}

#[test]
fn a_borrowed_public_key_is_refused() {
    let keys = Keys::new();
    // Alice's public key, which is not secret, with another secret key.
    let folder = tempfile::tempdir().unwrap();
    let (path, _) = keys.mallory.write(folder.path(), "mallory").unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let forged = text.replace(&keys.mallory.public().to_string(), &keys.alice.public().to_string());
    std::fs::write(&path, forged).unwrap();
    let forged = KeyPair::read(&path).unwrap();
    assert_eq!(forged.public(), keys.alice.public());
    let reasons = refused(&drive(&keys.server()), &remote(&forged, keys.server.public()));
    assert!(
        reasons.iter().all(|reasons| [NOT_ALLOWED, CLOSED].contains(&reasons.as_str())),
        "{reasons:?}"
    );
}
