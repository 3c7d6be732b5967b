//! TCP paths and their images in joint space.

mod channel;
mod chord_curve;
pub(crate) mod corner;
pub(crate) mod joint_curve;
mod knot_rates;
pub(crate) mod leg;
mod link;
pub(crate) mod quintic;
mod reversal;
mod site;
mod spline;
mod spline_leg;
#[cfg(test)]
mod spline_tests;
pub(crate) mod tcp_course;
pub(crate) mod tcp_path;
