//! JSON form of a single target, such as on a command line.

use iiwa_json::{JsonObject, locate, without_mark};

use super::{
    error::{ProgramError, json_error},
    frames::TargetWire,
};
use crate::{source::Sources, target::Target};

impl Target {
    /// Reads a target as in programs: an object with `x_mm` to `c_deg`, and `base`, `e1_deg`,
    /// `status` and `turn`.
    ///
    /// ```
    /// use iiwa_program::Target;
    ///
    /// let text = r#"{ "x_mm": 600, "y_mm": 0, "z_mm": 400,
    ///     "a_deg": 0, "b_deg": 180, "c_deg": 0, "e1_deg": 10 }"#;
    /// let target = Target::from_json(text)?;
    /// assert_eq!(target.frame.xyz_mm, [600.0, 0.0, 400.0]);
    /// # Ok::<(), iiwa_program::ProgramError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If the text is not a target; the error gives the place in the text.
    pub fn from_json(text: &str) -> Result<Self, ProgramError> {
        let text = without_mark(text);
        let JsonObject(wire) = serde_json::from_str::<JsonObject<TargetWire>>(text)
            .map_err(|error| json_error(text, text, None, &error))?;
        let place = || locate(text, &[]);
        wire.target().map_err(|message| ProgramError::Json {
            message,
            motion: None,
            sources: Sources::default(),
            place: place(),
        })
    }
}
