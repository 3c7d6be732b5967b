//! `iiwasim twin`.

use std::{
    net::{Ipv4Addr, SocketAddr, TcpListener},
    sync::{Arc, Mutex},
    thread,
};

use crate::{
    args, connection,
    failure::{Failure, print_note},
    output,
    twin::{
        Dispatcher, LatestJoints, PageChannel, Setup, Shared, Token, Viewers, follow, serve,
        watch_health,
    },
};

/// A server for Foxglove and Lichtblick.
fn viewers_at(setup: &Setup, at: SocketAddr) -> Result<Viewers, Failure> {
    Viewers::listen(&setup.robot, &setup.names, at).map_err(|error| {
        match error.cause.downcast_ref() {
            Some(cause) => connection::not_listening(&error, cause, "--foxglove=IP:PORT"),
            None => error.into(),
        }
    })
}

/// Follows the robot and serves its page until an interrupt.
pub(crate) fn run(options: &args::Twin) -> Result<(), Failure> {
    let setup = Arc::new(Setup::new(options)?);
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, options.port)).map_err(|error| {
        let what = format!("cannot listen at port {}; --port 0 takes a free one", options.port);
        Failure::run(what, &error)
    })?;
    let address =
        listener.local_addr().map_err(|error| Failure::run("cannot serve the page", &error))?;
    let token = Token::new()?;
    let viewers = options.foxglove.map(|at| viewers_at(&setup, at)).transpose()?;
    output::catch_interrupts();
    let live = Arc::new(LatestJoints::default());
    let dispatcher = Arc::new(Dispatcher::new(setup.clone(), live.clone())?);
    let (live_words, health_words) = (PageChannel::new("{}".into()), PageChannel::new("{}".into()));
    let words = [live_words.subscribe(), health_words.subscribe()];
    let twin = Shared::new(setup.clone(), words, dispatcher.clone());
    output::print(&format!("http://{address}/?token={}\n", token.text()))?;
    print_note("The twin is at this address, for this machine only. Ctrl-C ends it.\n");
    if let Some(viewers) = &viewers {
        print_note(&format!("Foxglove and Lichtblick open ws://{}\n", viewers.address()));
    }
    let viewers = viewers.map(Mutex::new);
    thread::scope(|scope| {
        scope.spawn(|| watch_health(&setup, &health_words, viewers.as_ref()));
        let following = scope.spawn(|| {
            // Without joint positions there is nothing to show.
            follow(&setup, &live, &live_words, viewers.as_ref())
                .inspect_err(|_| output::interrupt())
        });
        let served = serve(listener, &token, twin);
        output::interrupt();
        dispatcher.end();
        following.join().unwrap_or(Ok(())).and(served)
    })
}
