//! Shares of limits in programs.

use std::fmt;

use iiwa_json::Numbers;
use iiwa_kin::Joints;
use schemars::JsonSchema;
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{SeqAccess, Visitor},
};

/// One share for all joints, or one per joint.
#[derive(Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub(super) enum Share {
    All(#[schemars(extend("minimum" = 1e-6, "maximum" = 1))] f64),
    Each(
        #[schemars(extend(
            "items" = { "type": "number", "minimum": 1e-6, "maximum": 1 }
        ))]
        Joints,
    ),
}

impl Default for Share {
    fn default() -> Self {
        Self::All(1.0)
    }
}

impl Share {
    pub(super) fn is_full(&self) -> bool {
        *self == Self::default()
    }

    pub(super) fn each(self) -> Joints {
        match self {
            Self::All(share) => [share; 7],
            Self::Each(shares) => shares,
        }
    }
}

impl From<Joints> for Share {
    fn from(shares: Joints) -> Self {
        if shares.iter().all(|share| *share == shares[0]) {
            Self::All(shares[0])
        } else {
            Self::Each(shares)
        }
    }
}

impl<'de> Deserialize<'de> for Share {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ShareVisitor;
        impl<'de> Visitor<'de> for ShareVisitor {
            type Value = Share;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number above 0 and at most 1, or seven of them")
            }
            fn visit_f64<E>(self, value: f64) -> Result<Share, E> {
                Ok(Share::All(value))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Share, E> {
                Ok(Share::All(value as f64))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Share, E> {
                Ok(Share::All(value as f64))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Share, A::Error> {
                Numbers("seven shares, for joints A1 to A7").visit_seq(seq).map(Share::Each)
            }
        }
        deserializer.deserialize_any(ShareVisitor)
    }
}
