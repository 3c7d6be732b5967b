//! Motion programs: JSON, includes, payloads and waits.

mod documents;
mod include;
mod limits;
mod loads;
mod reader;
mod waits;
