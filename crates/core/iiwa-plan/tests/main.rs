//! Sources, requests, groups and repeat blocks: robots, limits, files and the places of errors.

mod groups;
mod io;
mod repeats;
mod robots;
mod sources;
mod statements;
