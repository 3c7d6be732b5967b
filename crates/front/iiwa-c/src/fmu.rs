//! Library as the binary of an FMU for co-simulation (FMI 3.0).
//!
//! `model` is the behaviour of the FMU, without C; `variables` are its inputs and outputs,
//! `description` describes them in XML, `resources` contain the program. `functions` are the
//! supported functions of the standard, `unsupported` those that require capabilities this FMU
//! lacks.

mod description;
mod functions;
mod instance;
mod model;
mod resources;
mod unsupported;
mod variables;

pub(crate) use resources::fmu_files;
