//! The look of the arm on pages: the triangles of its links, our own shells or a user's meshes, packed.

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
