//! What the KUKA LBR iiwa looks like: the triangles of its links, shells of our own or a user's meshes, packed as pages have
//! them.
//!
//! ```
//! let look = iiwa_look::Look::own(&iiwa_kin::Robot::default());
//! assert!(format!("{look:?}").contains("is_closed: true"));
//! ```

mod look;
mod packed;
mod shells;
mod skin;
mod surface;
#[cfg(test)]
mod tests;
mod thinned;

pub use look::Look;
pub use packed::Packed;
