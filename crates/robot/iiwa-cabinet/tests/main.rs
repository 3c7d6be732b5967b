//! Integration tests of the simulated cabinet: conformance, and an independent FRI client.

mod conformance;
mod independent_client;
