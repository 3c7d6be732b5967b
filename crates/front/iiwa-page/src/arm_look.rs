//! Appearance of the arm on pages: packed triangles of its links, from built-in shells or a user's
//! meshes.

mod look;
mod packed;
mod shells;
mod skin;
mod surface;
#[cfg(test)]
mod tests;
mod thinned;

pub(crate) use look::Look;
pub(crate) use packed::Packed;
