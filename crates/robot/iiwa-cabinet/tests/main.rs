//! The simulated cabinet from outside: conformance, and an independent FRI client.

mod conformance;
mod independent_client;
