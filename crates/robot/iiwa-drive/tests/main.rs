//! Integration tests of the drive: with cabinet and clients, and its sockets.
//!
//! `restarts` is a separate program: it counts the threads and open files of its process.

mod link;
mod security_addresses;
mod security_sockets;
