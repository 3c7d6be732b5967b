//! Payloads of Sparkplug B, limited to the used part of its Protobuf schema.
//!
//! Source: Eclipse Sparkplug 3.0.0, section 6.4.

use std::time::{SystemTime, UNIX_EPOCH};

use prost::{Message, Oneof};

use super::metrics::SparkplugValue;

#[derive(Clone, PartialEq, Message)]
struct Payload {
    /// Time in ms since 1970.
    #[prost(uint64, optional, tag = "1")]
    timestamp: Option<u64>,
    #[prost(message, repeated, tag = "2")]
    metrics: Vec<Metric>,
    #[prost(uint64, optional, tag = "3")]
    seq: Option<u64>,
}

#[derive(Clone, PartialEq, Message)]
struct Metric {
    #[prost(string, optional, tag = "1")]
    name: Option<String>,
    #[prost(uint64, optional, tag = "3")]
    timestamp: Option<u64>,
    #[prost(uint32, optional, tag = "4")]
    datatype: Option<u32>,
    #[prost(bool, optional, tag = "7")]
    is_null: Option<bool>,
    #[prost(oneof = "MetricValue", tags = "11, 13, 14, 15")]
    value: Option<MetricValue>,
}

#[derive(Clone, PartialEq, Oneof)]
enum MetricValue {
    #[prost(uint64, tag = "11")]
    Long(u64),
    #[prost(double, tag = "13")]
    Double(f64),
    #[prost(bool, tag = "14")]
    Boolean(bool),
    #[prost(string, tag = "15")]
    Text(String),
}

/// Data types, section 6.4.16.
const INT64: u32 = 4;
const UINT64: u32 = 8;
const DOUBLE: u32 = 10;
const BOOLEAN: u32 = 11;
const STRING: u32 = 12;

/// Encodes a payload with these metrics; death messages have no `seq`.
pub(super) fn encode(seq: Option<u8>, metrics: &[(String, SparkplugValue)]) -> Vec<u8> {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    let timestamp = u64::try_from(now.as_millis()).ok();
    let metric = |(name, value): &(String, SparkplugValue)| {
        let (datatype, value) = match value {
            SparkplugValue::Double(number) => (DOUBLE, Some(MetricValue::Double(*number))),
            SparkplugValue::Boolean(flag) => (BOOLEAN, Some(MetricValue::Boolean(*flag))),
            SparkplugValue::Int64(number) => (INT64, Some(MetricValue::Long(*number))),
            SparkplugValue::UInt64(number) => (UINT64, Some(MetricValue::Long(*number))),
            SparkplugValue::Text(text) => (STRING, Some(MetricValue::Text(text.clone()))),
            SparkplugValue::NoText => (STRING, None),
            SparkplugValue::NoDouble => (DOUBLE, None),
        };
        Metric {
            name: Some(name.clone()),
            timestamp,
            datatype: Some(datatype),
            is_null: value.is_none().then_some(true),
            value,
        }
    };
    let metrics = metrics.iter().map(metric).collect();
    Payload { timestamp, metrics, seq: seq.map(u64::from) }.encode_to_vec()
}

/// Returns true if a command requests a birth message.
pub(super) fn decode_rebirth(bytes: &[u8]) -> bool {
    let rebirth = |metric: &Metric| {
        metric.name.as_deref() == Some("Node Control/Rebirth")
            && metric.value == Some(MetricValue::Boolean(true))
    };
    Payload::decode(bytes).is_ok_and(|payload| payload.metrics.iter().any(rebirth))
}
