//! Lower jerk limits next to rest.

/// Lower jerk limits next to a rest at one end of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestRamp {
    /// Share of the jerk limits elsewhere.
    pub jerk_rel: f64,
    /// Distance from the rest up to which the share applies in full, in rad of sigma.
    pub reach_rad: f64,
    /// Distance from the rest beyond which the full limits apply, in rad of sigma; larger than the
    /// reach.
    pub end_rad: f64,
}

impl RestRamp {
    /// Share of the jerk limits at a distance from the rest, in rad.
    pub(crate) fn jerk_rel_at(&self, way_rad: f64) -> f64 {
        let Self { jerk_rel, reach_rad, end_rad } = *self;
        let weight = fade((end_rad - way_rad) / (end_rad - reach_rad));
        1.0 + weight * (jerk_rel - 1.0)
    }
}

/// Weight of a limit that fades out, with a continuous slope: 0 for `near` up to 0, and 1 from 1
/// on.
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
        let actual = [0.0, 0.25, 0.5, 0.75, 1.0, 9.0].map(|way| ramp.jerk_rel_at(way));
        assert_eq!(actual, [0.4, 0.4, 0.4, 0.7, 1.0, 1.0]);
    }
}
