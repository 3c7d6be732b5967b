//! Joints of a message, by name.

use iiwa_kin::Joints;

/// Index of each robot joint in a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct JointOrder([usize; 7]);

impl JointOrder {
    /// Determines the order of a message with these names, which are the robot's joints in any
    /// order.
    ///
    /// # Errors
    ///
    /// The fault in the names, as text for people.
    pub(super) fn new(arm: &[String; 7], names: &[String]) -> Result<Self, String> {
        let joints = arm.join(", ");
        if let Some(unknown) = names.iter().find(|name| !arm.contains(name)) {
            return Err(format!("unknown joint `{unknown}`; the joints are {joints}"));
        }
        let mut order = [0; 7];
        for (place, name) in order.iter_mut().zip(arm) {
            let mut matches = names.iter().enumerate().filter(|(_, listed)| *listed == name);
            *place = match (matches.next(), matches.next()) {
                (Some((place, _)), None) => place,
                (Some(_), Some(_)) => return Err(format!("joint `{name}` is named twice")),
                (None, _) => {
                    return Err(format!("joint `{name}` is missing; give all of {joints}"));
                }
            };
        }
        Ok(Self(order))
    }

    /// Returns the numbers of a point, in the robot's order; `None` if the list is empty.
    ///
    /// # Errors
    ///
    /// A wrong number of values, or a value that is not finite.
    pub(super) fn pick(&self, values: &[f64]) -> Result<Option<Joints>, String> {
        if values.is_empty() {
            return Ok(None);
        }
        if values.len() != 7 {
            return Err(format!("{} values instead of 7", values.len()));
        }
        let picked = self.0.map(|place| values[place]);
        if picked.iter().all(|value| value.is_finite()) {
            Ok(Some(picked))
        } else {
            Err("a value that is not finite".to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arm() -> [String; 7] {
        iiwa_kin::RosNames::default().joints()
    }

    #[test]
    fn joints_may_be_in_any_order() {
        let mut names = arm().to_vec();
        names.reverse();
        let order = JointOrder::new(&arm(), &names).unwrap();
        let values = [7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0];
        assert_eq!(order.pick(&values), Ok(Some([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0])));
        assert_eq!(order.pick(&[]), Ok(None));
        assert!(order.pick(&[1.0; 6]).is_err());
        assert!(order.pick(&[f64::NAN; 7]).is_err());
    }

    #[test]
    fn all_joints_have_to_be_named_once() {
        let without = &arm()[..6];
        assert!(JointOrder::new(&arm(), without).unwrap_err().contains("iiwa_joint_7"));
        let mut names = arm().to_vec();
        names[3] = "iiwa_joint_3".to_owned();
        assert!(JointOrder::new(&arm(), &names).unwrap_err().contains("twice"));
        names[3] = "panda_joint_4".to_owned();
        assert!(JointOrder::new(&arm(), &names).unwrap_err().contains("panda"));
    }
}
