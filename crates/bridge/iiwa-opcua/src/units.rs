//! OPC UA units, identified by their codes in UN/ECE Recommendation 20.

use opcua::types::{EUInformation, UAString};

/// A unit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EngineeringUnit {
    /// The common code of UN/ECE Recommendation 20.
    code: &'static str,
    symbol: &'static str,
    name: &'static str,
}

/// Unit of angles.
pub(crate) const RADIAN: EngineeringUnit =
    EngineeringUnit { code: "C81", symbol: "rad", name: "radian" };
/// Unit of joint speeds.
pub(crate) const RADIAN_PER_SECOND: EngineeringUnit =
    EngineeringUnit { code: "2A", symbol: "rad/s", name: "radian per second" };
/// Unit of joint accelerations.
pub(crate) const RADIAN_PER_SECOND_SQUARED: EngineeringUnit =
    EngineeringUnit { code: "2B", symbol: "rad/s²", name: "radian per second squared" };
/// Unit of masses.
pub(crate) const KILOGRAM: EngineeringUnit =
    EngineeringUnit { code: "KGM", symbol: "kg", name: "kilogram" };
/// Unit of lengths.
pub(crate) const METRE: EngineeringUnit =
    EngineeringUnit { code: "MTR", symbol: "m", name: "metre" };
/// Unit of temperatures.
pub(crate) const DEGREE_CELSIUS: EngineeringUnit =
    EngineeringUnit { code: "CEL", symbol: "°C", name: "degree Celsius" };

impl EngineeringUnit {
    /// Returns the unit in the representation of OPC UA.
    pub(crate) fn information(self) -> EUInformation {
        EUInformation {
            namespace_uri: UAString::from("http://www.opcfoundation.org/UA/units/un/cefact"),
            unit_id: self.id(),
            display_name: self.symbol.into(),
            description: self.name.into(),
        }
    }

    /// Returns the characters of the code as a number, the first one in the highest byte (OPC
    /// 10000-8, 5.6.3).
    fn id(self) -> i32 {
        self.code.bytes().fold(0, |id, byte| (id << 8) | i32::from(byte))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // Expected values are from the list that the OPC Foundation publishes with its nodes,
    // UNECE_to_OPCUA.csv.
    #[test]
    fn ids_are_those_of_the_opc_foundation() {
        let ids =
            [RADIAN, RADIAN_PER_SECOND, RADIAN_PER_SECOND_SQUARED, KILOGRAM, METRE, DEGREE_CELSIUS]
                .map(EngineeringUnit::id);
        assert_eq!(ids, [4_405_297, 12_865, 12_866, 4_933_453, 5_067_858, 4_408_652]);
    }
}
