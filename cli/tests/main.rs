//! Tests of the command as a process: its options, output, files and exit codes.

#[cfg(feature = "optimise")]
mod advise;
mod carried_shapes;
mod compare;
mod diff;
#[cfg(feature = "live")]
mod experiment;
#[cfg(feature = "sunrise")]
mod export;
mod features;
mod helpers;
mod identify;
#[cfg(feature = "sunrise")]
mod import;
#[cfg(feature = "sunrise")]
mod import_application;
mod include;
#[cfg(feature = "live")]
mod keygen;
mod kinematics;
#[cfg(feature = "live")]
mod link;
mod log_reading;
mod many;
#[cfg(feature = "optimise")]
mod optimise;
#[cfg(feature = "optimise")]
mod order;
mod outputs;
mod overlap;
mod pipes;
#[cfg(feature = "optimise")]
mod place;
mod plan;
mod plan_statements;
mod plan_torques;
mod profile;
mod report;
mod run;
mod scene;
mod settings;
mod tables;
mod timing;
mod validate;
