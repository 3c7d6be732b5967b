//! Answers to the questions of a Sunrise application.

use std::path::PathBuf;

use clap::Args;

use super::values::{length_mm, seven};

const SUNRISE: &str = "Applications of Sunrise projects (only with a project folder)";

/// Application of a Sunrise project, and the answers to its questions.
#[derive(Args, Debug, Default)]
pub(crate) struct Answering {
    /// Class of the application, or its file if several files have this class. If the project has
    /// several applications, and none is named, they are listed
    #[arg(long, value_name = "CLASS", help_heading = SUNRISE)]
    pub(crate) application: Option<String>,

    /// Answer to a dialog: its text, or a unique part of its text, and the button number from 0;
    /// several numbers answer repeated dialogs in turn [default: 0]
    #[arg(long, value_name = "TEXT=N[,N]...", help_heading = SUNRISE)]
    pub(crate) answer: Vec<String>,

    /// Value of an input, such as Gripper.Closed=true
    #[arg(long, value_name = "GROUP.NAME=VALUE", help_heading = SUNRISE)]
    pub(crate) input: Vec<String>,

    /// Value of process data, instead of the value in the project's data file
    #[arg(long, value_name = "ID=VALUE", help_heading = SUNRISE)]
    pub(crate) data: Vec<String>,

    /// Result of a break condition, by file and line of `hasFired`, such as Search.java:29=true;
    /// several values answer repeated calls in turn
    #[arg(long, value_name = "FILE:LINE=BOOL[,BOOL]...", help_heading = SUNRISE)]
    pub(crate) fired: Vec<String>,

    /// Duration in s of an endless hold, a gripper action or a platform motion, by file and line of
    /// its call, such as Fetch.java:26=2.5 [default: 0]
    #[arg(long, value_name = "FILE:LINE=SECONDS", help_heading = SUNRISE)]
    pub(crate) time: Vec<String>,

    /// Tool frame that is missing in the project's data file, relative to the flange, in mm and
    /// degrees: the TCP as Pen=0,0,120, another frame as Pen/Tip=0,0,120,0,90,0
    #[arg(long, value_name = "TOOL=X,Y,Z[,A,B,C]", help_heading = SUNRISE)]
    pub(crate) tool: Vec<String>,

    /// Distance from the wrist to the flange face in mm (152 with a media flange Touch, 126 with
    /// others), if the project does not state it or states it wrongly
    #[arg(long, value_name = "MM", value_parser = length_mm, help_heading = SUNRISE)]
    pub(crate) flange_mm: Option<f64>,

    /// File of answers: TOML with `robot`, `flange_mm`, `[answers]`, `[inputs]`, `[data]`,
    /// `[fired]`, `[times]` and `[tools]`; the options above take precedence [default:
    /// iiwasim-answers.toml in the project, if there is one]
    #[arg(long, value_name = "FILE.toml", help_heading = SUNRISE)]
    pub(crate) answers: Option<PathBuf>,

    /// Joints A1 to A7 in degrees at the start of the application [default: all 0]
    #[arg(long, value_name = "A1,...,A7", value_parser = seven, allow_hyphen_values = true,
        help_heading = SUNRISE)]
    pub(crate) start_deg: Option<[f64; 7]>,
}

impl Answering {
    /// True if an option for applications is given.
    pub(crate) fn is_given(&self) -> bool {
        let Self { application, answer, input, data, fired, time, tool, .. } = self;
        let Self { flange_mm, answers, start_deg, .. } = self;
        application.is_some()
            || answers.is_some()
            || start_deg.is_some()
            || flange_mm.is_some()
            || ![answer, input, data, fired, time, tool].into_iter().all(Vec::is_empty)
    }
}
