//! Tests of the C functions against the Rust libraries behind them.

use std::{
    ffi::{CStr, CString, c_char},
    mem::MaybeUninit,
    ptr, thread,
};

use iiwa_kin::Robot;
use iiwa_path::JointPath;
use iiwa_plan::{PlanFigures, PlanOptions};
use iiwa_program::Program;
use iiwa_traj::{Timing, Trajectory};
use iiwasim::{
    IiwasimError, IiwasimPlan, IiwasimProgram, IiwasimState, IiwasimStatus, iiwasim_last_error,
    iiwasim_plan, iiwasim_plan_at, iiwasim_plan_cycle_time_s, iiwasim_plan_figures_json,
    iiwasim_plan_free, iiwasim_plan_sample, iiwasim_program_free, iiwasim_program_from_json,
    iiwasim_string_free,
};

const PROGRAM: &str = r#"{ "version": 1, "tools": { "gripper": { "tcp": { "z_mm": 120 } } },
  "start": { "joints_deg": [0, 30, 0, -60, 0, 90, 0] },
  "motions": [
    { "type": "ptp", "joints_deg": [20, 30, 0, -60, 0, 90, 0], "blend": { "sunrise_rel": 0.5 } },
    { "type": "ptp", "joints_deg": [20, 50, 0, -60, 0, 90, 0] },
    { "type": "lin_rel", "offset": { "z_mm": -50 }, "tool": "gripper" }
  ] }"#;

fn program(text: &str) -> Result<Box<IiwasimProgram>, IiwasimStatus> {
    let text = CString::new(text).unwrap();
    let mut program = MaybeUninit::uninit();
    // SAFETY: the text ends with a NUL.
    let status = unsafe { iiwasim_program_from_json(text.as_ptr(), Some(&mut program)) };
    // SAFETY: the function always writes it.
    let program = unsafe { program.assume_init() };
    assert_eq!(program.is_null(), status != IiwasimStatus::Ok);
    // SAFETY: a pointer other than NULL is a program of this library.
    if program.is_null() { Err(status) } else { Ok(unsafe { Box::from_raw(program) }) }
}

fn plan(program: &IiwasimProgram) -> Result<Box<IiwasimPlan>, IiwasimStatus> {
    let mut plan = MaybeUninit::uninit();
    // SAFETY: the options are null.
    let status = unsafe { iiwasim_plan(Some(program), None, Some(&mut plan)) };
    // SAFETY: the function always writes it.
    let plan = unsafe { plan.assume_init() };
    // SAFETY: a pointer other than NULL is a plan of this library.
    if plan.is_null() { Err(status) } else { Ok(unsafe { Box::from_raw(plan) }) }
}

fn at(plan: &IiwasimPlan, t_s: f64) -> IiwasimState {
    let mut state = MaybeUninit::uninit();
    assert_eq!(iiwasim_plan_at(Some(plan), t_s, Some(&mut state)), IiwasimStatus::Ok);
    // SAFETY: the state was written.
    unsafe { state.assume_init() }
}

/// Returns figures and warnings.
fn figures(plan: &IiwasimPlan) -> serde_json::Value {
    let mut json = MaybeUninit::uninit();
    assert_eq!(iiwasim_plan_figures_json(Some(plan), Some(&mut json)), IiwasimStatus::Ok);
    // SAFETY: the pointer was written, and its text ends with a NUL.
    let json: *mut c_char = unsafe { json.assume_init() };
    // SAFETY: likewise.
    let text = unsafe { CStr::from_ptr(json) }.to_str().unwrap();
    let figures = serde_json::from_str(text).unwrap();
    // SAFETY: the text belongs to this library, and is freed once.
    unsafe { iiwasim_string_free(json) };
    figures
}

/// Returns the error of this thread, and its message.
fn last_error() -> (IiwasimError, String) {
    let mut error = MaybeUninit::uninit();
    assert_eq!(iiwasim_last_error(Some(&mut error)), IiwasimStatus::Ok);
    // SAFETY: the error was written, and its message ends with a NUL.
    let error: IiwasimError = unsafe { error.assume_init() };
    // SAFETY: likewise.
    (error, unsafe { CStr::from_ptr(error.message) }.to_str().unwrap().to_owned())
}

fn trajectory() -> (Trajectory, PlanOptions) {
    let program = Program::from_json(PROGRAM).unwrap();
    let path = JointPath::new(&program, &Robot::default()).unwrap();
    let trajectory = Trajectory::plan(&path, Timing::default()).unwrap();
    (trajectory, PlanOptions { samples: 100, ..PlanOptions::default() })
}

#[test]
fn states_are_those_of_the_trajectory() {
    let (trajectory, _) = trajectory();
    let path = trajectory.path();
    let plan = plan(&program(PROGRAM).unwrap()).unwrap();
    let mut cycle_time_s = MaybeUninit::uninit();
    let status = iiwasim_plan_cycle_time_s(Some(&plan), Some(&mut cycle_time_s));
    assert_eq!(status, IiwasimStatus::Ok);
    // SAFETY: the time was written.
    assert_eq!(unsafe { cycle_time_s.assume_init() }, trajectory.cycle_time_s());
    for expected in trajectory.samples(1000.0) {
        let actual = at(&plan, expected.t_s);
        // The cycle time is a sum of durations, and may differ from the end in its last bit.
        assert!((actual.t_s - expected.t_s).abs() < 1e-12);
        assert_eq!((actual.q, actual.dq), (expected.q, expected.dq));
        assert_eq!(actual.ddq, expected.ddq);
        assert_eq!(actual.motion as usize, expected.motion.number());
        let flange = path.robot().flange_pose(&expected.q);
        // Only the last motion uses the gripper.
        let reach_m = if actual.motion == 3 { 0.12 } else { 0.0 };
        let tcp: [f64; 3] =
            std::array::from_fn(|i| flange.position_m[i] + reach_m * flange.rotation[i][2]);
        assert!((0..3).all(|i| (actual.tcp_m[i] - tcp[i]).abs() < 1e-12));
        assert_eq!(actual.tcp_xyzw, flange.quaternion_xyzw());
    }
}

#[test]
fn samples_are_as_many_as_they_are_counted() {
    let plan = plan(&program(PROGRAM).unwrap()).unwrap();
    let sample = |states: &mut [MaybeUninit<IiwasimState>]| {
        let mut count = MaybeUninit::new(0);
        let place = if states.is_empty() { ptr::null_mut() } else { states.as_mut_ptr().cast() };
        // SAFETY: the array has this capacity.
        let status = unsafe {
            iiwasim_plan_sample(Some(&plan), 250.0, place, states.len(), Some(&mut count))
        };
        // SAFETY: the count was initialised above.
        (status, unsafe { count.assume_init() })
    };
    let (status, count) = sample(&mut []);
    assert_eq!((status, count), (IiwasimStatus::Ok, trajectory().0.samples(250.0).count()));
    let mut states = vec![MaybeUninit::uninit(); count];
    assert_eq!(sample(&mut states), (IiwasimStatus::Ok, count));
    for (i, state) in states.iter().enumerate().take(count - 1) {
        // SAFETY: all states were written.
        assert_eq!(unsafe { state.assume_init() }, at(&plan, i as f64 / 250.0));
    }
    assert_eq!(sample(&mut states[1..]), (IiwasimStatus::Argument, count));
    assert_eq!(
        last_error().1,
        format!("there are {count} samples; the array has a capacity of {}", count - 1)
    );
}

#[test]
fn figures_are_those_of_the_trajectory() {
    let mut actual = figures(&plan(&program(PROGRAM).unwrap()).unwrap());
    let warnings = actual.as_object_mut().unwrap().remove("warnings").unwrap();
    assert_eq!(warnings, serde_json::json!([]));
    let (trajectory, options) = trajectory();
    let figures: PlanFigures = serde_json::from_value(actual).unwrap();
    assert_eq!(figures, PlanFigures::of(&trajectory, &options));
}

#[test]
fn a_program_is_planned_for_the_robot_that_it_names() {
    let robot_and_time = |text: &str| {
        let plan = plan(&program(text).unwrap()).unwrap();
        let mut time_s = MaybeUninit::uninit();
        assert_eq!(iiwasim_plan_cycle_time_s(Some(&plan), Some(&mut time_s)), IiwasimStatus::Ok);
        // SAFETY: the time was written.
        (figures(&plan)["robot"].clone(), unsafe { time_s.assume_init() })
    };
    let heavy = PROGRAM.replacen('{', r#"{ "robot": "lbr_iiwa_14_r820", "#, 1);
    let [(named, named_s), (usual, usual_s)] = [&*heavy, PROGRAM].map(robot_and_time);
    assert_eq!((named, usual), ("lbr_iiwa_14_r820".into(), "lbr_iiwa_7_r800".into()));
    assert!(named_s > usual_s, "{named_s} {usual_s}");
}

#[test]
fn errors_state_their_place_and_belong_to_their_thread() {
    let text = PROGRAM.replace("[20, 50,", "[20, 150,");
    let bad = program(&text).unwrap();
    assert!(plan(&bad).is_err());
    let (error, message) = last_error();
    assert_eq!((error.status, error.line, error.motion), (IiwasimStatus::Plan, 5, 2));
    let column = text.lines().nth(4).unwrap().find("150").unwrap() + 1;
    assert_eq!(error.column as usize, column);
    assert!(message.starts_with("motion 2: joint A2 is at 150 deg"), "{message}");
    thread::spawn(|| assert_eq!(last_error().1, "")).join().unwrap();
    assert_eq!(last_error().1, message);
    // A successful call has no error.
    let good = program(PROGRAM).unwrap();
    assert_eq!(last_error().0.status, IiwasimStatus::Ok);
    assert_eq!(iiwasim_last_error(None), IiwasimStatus::Argument);
    iiwasim_program_free(Some(bad));
    iiwasim_program_free(Some(good));
    iiwasim_program_free(None);
    iiwasim_plan_free(None);
    // SAFETY: NULL is ignored.
    unsafe { iiwasim_string_free(ptr::null_mut()) };
}

#[test]
fn plans_and_programs_may_be_used_by_many_threads() {
    fn is_shared<T: Send + Sync>() {}
    is_shared::<IiwasimProgram>();
    is_shared::<IiwasimPlan>();
}
