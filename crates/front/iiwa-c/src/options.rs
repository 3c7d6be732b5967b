//! Planning options for C.

use std::{ffi::c_char, mem::MaybeUninit, ptr};

use iiwa_kin::Robot;

use crate::{
    border::{IiwasimStatus, call, required},
    failure::CallFailure,
    planned::{Choices, ChosenTiming},
    pointers,
};

/// Set of active limits.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IiwasimTiming {
    /// Velocity, acceleration and jerk.
    Jerk = 0,
    /// Velocity and acceleration.
    Acceleration = 1,
    /// Jerk-limited, but with PTP motions and splines from rest to rest as Sunrise was observed to
    /// plan them: splines by a model.
    Sunrise = 2,
}

/// Planning options. `iiwasim_options_default` initialises them, so that unset fields have their
/// default values.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct IiwasimOptions {
    /// Name of a built-in robot, or the JSON text of a robot's profile; NULL for the robot that the
    /// program names.
    pub robot: *const c_char,
    /// Set of active limits: an `IiwasimTiming`.
    pub timing: i32,
    /// Samples per blend under `IIWASIM_TIMING_ACCELERATION`, 2 to 100000.
    pub samples: u32,
    /// Torque limit, in per cent of the robot's; 0 for the program's own limit, if it has one.
    pub limit_torque_percent: f64,
}

/// Writes the default options.
#[unsafe(no_mangle)]
pub extern "C" fn iiwasim_options_default(
    options: Option<&mut MaybeUninit<IiwasimOptions>>,
) -> IiwasimStatus {
    call(|| {
        let choices = Choices::default();
        required(options, "options")?.write(IiwasimOptions {
            robot: ptr::null(),
            timing: match choices.timing {
                ChosenTiming::Jerk => IiwasimTiming::Jerk as i32,
                ChosenTiming::Acceleration => IiwasimTiming::Acceleration as i32,
                ChosenTiming::Sunrise => IiwasimTiming::Sunrise as i32,
            },
            samples: choices.samples,
            limit_torque_percent: choices.limit_torque_percent.unwrap_or_default(),
        });
        Ok(())
    })
}

impl IiwasimOptions {
    /// Returns the robot, if given, and the planning options.
    ///
    /// # Safety
    ///
    /// `robot` is NULL or a string that ends with a NUL.
    pub(crate) unsafe fn read(&self) -> Result<(Option<Robot>, Choices), CallFailure> {
        // SAFETY: the caller gives the same guarantee.
        let robot = unsafe { pointers::optional_text(self.robot, "options->robot") }?;
        let timing = match self.timing {
            known if known == IiwasimTiming::Jerk as i32 => ChosenTiming::Jerk,
            known if known == IiwasimTiming::Acceleration as i32 => ChosenTiming::Acceleration,
            known if known == IiwasimTiming::Sunrise as i32 => ChosenTiming::Sunrise,
            other => {
                let message = format!(
                    "options->timing is {other}; it must be 0 (jerk), 1 (acceleration) or 2 \
                     (sunrise)"
                );
                return Err(CallFailure::argument(message));
            }
        };
        let percent = self.limit_torque_percent;
        let limit_torque_percent = (percent != 0.0).then_some(percent);
        let choices = Choices { timing, samples: self.samples, limit_torque_percent };
        Ok((robot.map(robot_of).transpose()?, choices))
    }
}

/// Returns the built-in robot of this name, or the robot of this profile.
fn robot_of(name_or_profile: &str) -> Result<Robot, CallFailure> {
    if name_or_profile.trim_start().starts_with('{') {
        return Robot::from_profile(name_or_profile).map_err(|error| CallFailure::profile(&error));
    }
    Robot::built_in(name_or_profile).ok_or_else(|| {
        let built_in = Robot::BUILT_IN.join(" and ");
        let name = iiwa_json::excerpt(name_or_profile);
        CallFailure::argument(format!(
            "no robot is called `{name}`: {built_in} are built in, and a profile is given as its \
             JSON text"
        ))
    })
}
