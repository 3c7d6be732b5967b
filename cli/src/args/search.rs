//! Searches for faster programs (feature `optimise`).

mod advise;
mod optimise;
mod options;
mod order;
mod place;

pub(crate) use advise::{Advise, ChosenRows};
pub(crate) use optimise::Optimise;
pub(crate) use options::{SceneOptions, SearchInput, SearchOptions, SearchOutput};
pub(crate) use order::OrderTasks;
pub(crate) use place::PlaceRobot;
