//! Paths of the TCP, and the curves that they are in joint space.

pub(crate) mod corner;
pub(crate) mod joint_curve;
pub(crate) mod leg;
mod site;
mod spline;
mod spline_leg;
pub(crate) mod tcp_course;
pub(crate) mod tcp_path;
