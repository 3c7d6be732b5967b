//! `iiwasim schema`.

use iiwa_kin::Robot;
use iiwa_program::{Program, Workcell};
use iiwa_scene::Scene;

use crate::{
    args::{Format, Schema},
    failure::Failure,
    output,
};

/// Prints a JSON Schema.
pub(crate) fn run(options: &Schema) -> Result<(), Failure> {
    let schema = match options.format {
        Format::Program => Program::schema(),
        Format::Frames => Workcell::schema(),
        Format::Profile => Robot::profile_schema(),
        Format::Scene => Scene::schema(),
        #[cfg(feature = "bridge")]
        Format::Bridge => iiwa_bridge::message::schema(),
        #[cfg(not(feature = "bridge"))]
        Format::Bridge => return Err(crate::features::BRIDGE.missing("`iiwasim schema bridge`")),
    };
    output::print(&format!("{schema:#}\n"))
}
