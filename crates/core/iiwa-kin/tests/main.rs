//! Kinematics, dynamics, profiles and URDF, through the public interface.

mod cartesian;
mod dynamics;
mod forward;
mod inverse;
mod profile;
mod urdf;
mod urdf_examples;
