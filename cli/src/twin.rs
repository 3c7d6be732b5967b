//! The twin: a page that shows the robot live, and runs programs on it.
//!
//! One thread follows the drive's stream of joint positions ([`mod@follow`]), one polls the state of the drive
//! and the robot ([`health`]). The dispatcher ([`dispatcher`]) carries out the requests of pages, and holds
//! saved positions ([`positions`]), the plan and the run. Each of them publishes its state as JSON ([`message`]); only the
//! latest message of a kind is kept, so that a slow page skips messages and no queue grows.
//!
//! The server ([`mod@server`]) bounds the number of connections ([`mod@connections`]), admits those that have
//! the token ([`mod@guard`]), and exchanges messages and requests with pages ([`page_socket`]). A stop has a
//! connection to the drive of its own ([`mod@stop`]). The same data is published to Foxglove on request
//! ([`iiwa_viewers`]).

mod connections;
mod dispatcher;
mod follow;
mod guard;
mod health;
mod jog;
mod message;
mod page_socket;
mod planned;
mod positions;
mod request;
mod run;
mod server;
mod setup;
mod shared;
mod stop;

pub(crate) use dispatcher::Dispatcher;
pub(crate) use follow::{LatestJoints, follow};
pub(crate) use guard::Token;
pub(crate) use health::watch_health;
pub(crate) use message::PageChannel;
pub(crate) use server::serve;
pub(crate) use setup::Setup;
pub(crate) use shared::Shared;

pub(crate) use iiwa_viewers::{Viewers, ViewersError};

use crate::failure::Failure;

impl From<ViewersError> for Failure {
    fn from(error: ViewersError) -> Self {
        Self::run(error.what, &*error.cause)
    }
}
