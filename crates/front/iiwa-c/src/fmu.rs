//! The library as the binary of an FMU for co-simulation (FMI 3.0).
//!
//! `model` is what the FMU does, without C; `variables` are its inputs and outputs, `description` says so in XML, `resources`
//! hold the program. `functions` are those of the standard, `refused` those of it that need what this FMU has not.

mod description;
mod functions;
mod instance;
mod model;
mod refused;
mod resources;
mod variables;

pub(crate) use resources::fmu_files;
