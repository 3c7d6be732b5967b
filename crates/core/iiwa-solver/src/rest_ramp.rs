//! Limits of jerk that are lower next to rest.

/// Lower limits of jerk next to one of the rests between which a path goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestRamp {
    /// Their share of the limits of jerk elsewhere.
    pub jerk_rel: f64,
    /// The way from the rest on which it holds, in rad of sigma.
    pub reach_rad: f64,
    /// The way from the rest beyond which the limits are as elsewhere; longer than the reach.
    pub end_rad: f64,
}

impl RestRamp {
    /// The share of the limits of jerk at a way from the rest, in rad.
    pub(crate) fn jerk_rel_at(&self, way_rad: f64) -> f64 {
        let Self { jerk_rel, reach_rad, end_rad } = *self;
        let weight = fade((end_rad - way_rad) / (end_rad - reach_rad));
        1.0 + weight * (jerk_rel - 1.0)
    }
}

/// The weight of a limit that fades out: from 0 and less, where it is 0, to 1 and more, where it is 1, without a jump of its slope.
#[must_use]
pub fn fade(near: f64) -> f64 {
    let near = near.clamp(0.0, 1.0);
    near * near * (3.0 - 2.0 * near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_fades_from_its_reach_to_its_end() {
        let ramp = RestRamp { jerk_rel: 0.4, reach_rad: 0.5, end_rad: 1.0 };
        let found = [0.0, 0.25, 0.5, 0.75, 1.0, 9.0].map(|way| ramp.jerk_rel_at(way));
        assert_eq!(found, [0.4, 0.4, 0.4, 0.7, 1.0, 1.0]);
    }
}
