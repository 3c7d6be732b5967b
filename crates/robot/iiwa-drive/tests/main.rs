//! The drive from outside: with cabinet and clients, and its sockets.
//!
//! `restarts` is a program of its own: it counts the threads and open files of its process.

mod link;
mod security_addresses;
mod security_sockets;
