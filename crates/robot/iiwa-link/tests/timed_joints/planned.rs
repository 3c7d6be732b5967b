//! Planned trajectories are accepted; truncated ones or ones with a spike are refused.

use iiwa_kin::Robot;
use iiwa_link::TimedJoints;
use proptest::prelude::*;

use crate::timed_joints::sampled::{
    assert_refused, at_stamps, check, even, planned, programs, rounded,
};

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn planned_trajectories_are_accepted(
        program in programs(),
        step_s in 0.001..0.02_f64,
        whole_ms in 1..=20_u32,
        uneven in prop::collection::vec(1e-4..0.025_f64, 50),
    ) {
        let plan = planned(&program);
        let uneven = uneven.iter().cycle().scan(0.0, |t_s, step_s| {
            let stamp = *t_s;
            *t_s += step_s;
            Some(stamp)
        });
        let trajectories = [
            even(&plan, step_s),
            even(&plan, f64::from(whole_ms) * 1e-3),
            at_stamps(&plan, uneven),
        ];
        for trajectory in trajectories {
            prop_assert_eq!(check(&trajectory), Ok(()));
            prop_assert_eq!(check(&rounded(&trajectory)), Ok(()));
            // Stamps of a wall clock.
            let mut later = trajectory;
            later.t_s.iter_mut().for_each(|t_s| *t_s += 1.7e9);
            prop_assert_eq!(check(&later), Ok(()));
        }
    }

    #[test]
    fn a_trajectory_cut_off_in_motion_is_refused(
        program in programs(),
        step_ms in 1..=20_u32,
        share in 0.0..1.0_f64,
    ) {
        let plan = planned(&program);
        let whole = even(&plan, f64::from(step_ms) * 1e-3);
        let cut = (share * whole.t_s.len() as f64) as usize;
        let state = plan.at(whole.t_s[cut]);
        // Too fast to come to rest within one or two steps.
        let limits = Robot::default();
        let limits = limits.limits();
        let moves = (0..7).any(|j| {
            let gained = limits.acceleration_rad_s2[j] * f64::from(step_ms) * 1e-3;
            state.dq[j].abs() > 2.5 * gained
        });
        if moves && cut > 1 && cut + 2 < whole.t_s.len() {
            let [head, tail] = [0..=cut, cut..=whole.t_s.len() - 1].map(|part| TimedJoints {
                t_s: whole.t_s[part.clone()].to_vec(),
                joints_rad: whole.joints_rad[part].to_vec(),
            });
            let refusal = assert_refused(&head, "it does not end at rest");
            prop_assert!(refusal.message.contains("end at rest"), "{}", refusal);
            let refusal = assert_refused(&tail, "it does not start at rest");
            prop_assert!(refusal.message.contains("start at rest"), "{}", refusal);
        }
    }

    #[test]
    fn a_spike_of_a_milliradian_is_refused(
        program in programs(),
        step_ms in 1..=10_u32,
        share in 0.0..1.0_f64,
        joint in 0..7_usize,
        up in any::<bool>(),
    ) {
        let mut trajectory = even(&planned(&program), f64::from(step_ms) * 1e-3);
        if trajectory.t_s.len() > 3 {
            let index = 1 + (share * (trajectory.t_s.len() - 2) as f64) as usize;
            trajectory.joints_rad[index][joint] += if up { 1e-3 } else { -1e-3 };
            let _ = assert_refused(&trajectory, "a spike");
        }
    }
}
