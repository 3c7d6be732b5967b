//! Robot state as text.

use std::fmt::{self, Write as _};

use iiwa_kin::Joints;

use crate::{
    message::{
        conditions::Conditions,
        reply::{DriveStatus, FriStatus, Presence},
        text::shortened,
    },
    robot_program::PROTOCOL,
};

/// Joint positions in degrees.
pub struct Degrees<'a>(pub &'a Joints);

impl fmt::Display for Degrees<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for q in self.0 {
            // Negative zero is avoided.
            write!(f, "{:8.3} ", (q.to_degrees() * 1e3).round() / 1e3 + 0.0)?;
        }
        f.write_str("deg")
    }
}

impl DriveStatus {
    /// Returns true if the robot program or the controller reports an active safety stop.
    #[must_use]
    pub fn safety_stop(&self) -> bool {
        let safety_stop = self.conditions.as_ref().and_then(|it| it.safety_stop);
        self.fri.safety_stop || safety_stop == Some(true)
    }

    /// Returns the state as text, in lines.
    #[must_use]
    pub fn text(&self) -> String {
        let simulated = if self.simulated { " (a simulated robot)" } else { "" };
        let stopped = if self.safety_stop() { ", a safety stop is active" } else { "" };
        let mut text = format!("state          {}{stopped}{simulated}\n", self.state);
        if let Some(robot) = &self.robot {
            let _ = writeln!(text, "robot          {robot}");
        }
        match (self.joints_rad, self.t_s) {
            (Some(joints), Some(t_s)) => {
                let last = if self.fri.session == FriStatus::SILENT { "last " } else { "" };
                let _ = writeln!(text, "joints        {}, {last}at {t_s:.3} s", Degrees(&joints));
            }
            _ => {
                text.push_str("joints         unknown: nothing was received from the controller\n");
            }
        }
        let fri = &self.fri;
        let _ = writeln!(
            text,
            "FRI            {}, quality {}; {} messages lost, {} late",
            shortened(&fri.session),
            shortened(&fri.quality),
            fri.lost,
            fri.late
        );
        if let Some(source) = fri.unexpected_source {
            let _ = writeln!(
                text,
                "               messages come from {source}, another address than expected \
                 (setting fri-cabinet of the drive)"
            );
        }
        self.write_program(&mut text);
        text
    }

    fn write_program(&self, text: &mut String) {
        text.push_str(match self.robot_program {
            Presence::Connected => "robot program  connected",
            Presence::Silent => "robot program  silent",
        });
        if let Some(hello) = &self.hello {
            let _ = write!(text, ": {}", shortened(&hello.program));
            if let Some(sunrise) = &hello.sunrise {
                let _ = write!(text, ", Sunrise {}", shortened(sunrise));
            }
            if hello.protocol != PROTOCOL {
                let theirs = hello.protocol;
                let _ =
                    write!(text, ", protocol {theirs}; this is iiwasim with protocol {PROTOCOL}");
            }
        }
        text.push('\n');
        let at_cabinet = self.hello.as_ref().and_then(|hello| hello.robot.as_ref());
        if let (Some(robot), Some(other)) = (&self.robot, at_cabinet)
            && !robot.is_same_arm(other)
        {
            let _ = writeln!(text, "               the cabinet has another robot: {other}");
        }
        let conditions = self.conditions.as_ref().map(Conditions::text).unwrap_or_default();
        if !conditions.is_empty() {
            let _ = writeln!(text, "conditions     {conditions}");
        }
    }
}
