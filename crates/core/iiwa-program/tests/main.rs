//! Motion programs: JSON, includes, payloads and waits.

mod all_errors;
mod documents;
mod include;
mod io;
mod labels;
mod limits;
mod loads;
mod moved_cell;
mod reader;
mod repeats;
mod shapes;
mod tasks;
mod waits;
