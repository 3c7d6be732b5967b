//! Motion programs: JSON, includes, loads and waits.

mod documents;
mod include;
mod limits;
mod loads;
mod reader;
mod waits;
