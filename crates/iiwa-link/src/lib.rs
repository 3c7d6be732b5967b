//! iiwaDrive: monitor and command the KUKA LBR iiwa, or a simulated one, over the network.
//!
//! Source: C. Larsen, *Including a Collaborative Robot in Digital Twin Manufacturing Systems*,
//! Chalmers 2019, chapter 3, cited as "Larsen 2019".

pub mod security;
