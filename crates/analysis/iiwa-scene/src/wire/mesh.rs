//! Mesh files that a scene names.

use std::fmt::Display;

use iiwa_json::excerpt;

/// Reader of the files that a scene refers to, by their names in the scene.
pub(super) type ReadFile<'a> = &'a mut dyn FnMut(&str) -> Result<Vec<u8>, String>;

/// Range of the scale, from nm to km.
pub(super) const MIN_SCALE: f64 = 1e-6;
pub(super) const MAX_SCALE: f64 = 1e6;

/// Default of the scale.
pub(super) fn one() -> f64 {
    1.0
}

/// Name of a mesh file, and the length of its unit in mm.
pub(super) struct NamedMesh<'a> {
    pub(super) file: &'a str,
    pub(super) scale: f64,
}

impl NamedMesh<'_> {
    /// Reads the file, and `parse`s its bytes; the error contains the key that it belongs to.
    pub(super) fn read<T, E: Display>(
        &self,
        read: ReadFile<'_>,
        parse: impl FnOnce(&str, &[u8], f64) -> Result<T, E>,
    ) -> Result<T, (&'static str, String)> {
        let Self { file, scale } = *self;
        if !(MIN_SCALE..=MAX_SCALE).contains(&scale) {
            return Err((
                "scale",
                format!("scale is {scale}; it must be from {MIN_SCALE} to {MAX_SCALE}"),
            ));
        }
        let named = |message: String| ("file", format!("`{}`: {message}", excerpt(file)));
        let bytes = read(file).map_err(named)?;
        parse(file, &bytes, scale).map_err(|error| named(error.to_string()))
    }
}
