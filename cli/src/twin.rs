//! The twin: a page that follows the robot, and has it run programs.
//!
//! Two threads ask the drive, one for where the arm is ([`mod@follow`]), one for how it is ([`health`]); a
//! desk keeps what people do: positions, a plan, a run ([`desk`]). Each of them hands out its newest word
//! as JSON, and forgets the one before: a page that is slow misses words, and nothing piles up. The
//! server ([`mod@server`]) lets in so many connections ([`mod@connections`]) and the pages that have the token
//! ([`mod@guard`]), passes the words on to them and takes their orders to the desk ([`mod@talk`]), but for a
//! stop, which has a way of its own ([`mod@stop`]). Viewers hear of the robot, too, if they are asked for ([`foxglove`]).

mod connections;
mod desk;
mod follow;
mod foxglove;
mod guard;
mod health;
mod order;
mod planned;
mod run;
mod server;
mod setup;
mod shared;
mod stop;
mod talk;

pub(crate) use desk::Desk;
pub(crate) use follow::{Live, follow};
pub(crate) use foxglove::Viewers;
pub(crate) use guard::Token;
pub(crate) use health::watch_health;
pub(crate) use server::serve;
pub(crate) use setup::Setup;
pub(crate) use shared::Shared;

use std::sync::Arc;

use tokio::sync::watch;

/// What is passed on to pages: a JSON object.
pub(crate) type Word = Arc<str>;

/// Where the newest word is put.
pub(crate) type Words = watch::Sender<Word>;

/// A word of one kind, as `{"live": ...}`.
fn word(kind: &str, value: &impl serde::Serialize) -> Word {
    // Numbers, texts and lists have no way to fail.
    let value = serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned());
    format!("{{\"{kind}\":{value}}}").into()
}
