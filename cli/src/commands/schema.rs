//! `iiwasim schema`.

use iiwa_kin::Robot;
use iiwa_program::{Program, Workcell};
use iiwa_scene::Scene;

use crate::{
    args::{OutputFormat, Schema},
    failure::Failure,
    output,
};

/// Prints a JSON Schema.
pub(crate) fn run(options: &Schema) -> Result<(), Failure> {
    let schema = match options.format {
        OutputFormat::Program => Program::schema(),
        OutputFormat::Frames => Workcell::schema(),
        OutputFormat::Profile => Robot::profile_schema(),
        OutputFormat::Scene => Scene::schema(),
        #[cfg(feature = "bridge")]
        OutputFormat::Bridge => iiwa_bridge::message::schema(),
        #[cfg(not(feature = "bridge"))]
        OutputFormat::Bridge => {
            return Err(crate::features::BRIDGE.missing("`iiwasim schema bridge`"));
        }
    };
    output::print(&format!("{schema:#}\n"))
}
