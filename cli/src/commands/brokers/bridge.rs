//! `iiwasim bridge`.

use std::{path::Path, sync::Arc, thread, time::Duration};

use iiwa_bridge::{
    Bridge, BridgeOptions, BridgedRobot, Sink, default_spool,
    kafka::KafkaOptions,
    mqtt::{MqttOptions, SparkplugOptions},
};
use iiwa_files::interrupt;

use crate::{
    args,
    broker_access::{failure, kafka_connection, mqtt_connection},
    connection,
    failure::{Failure, print_note},
    output, service_log,
};

/// Interval of the interrupt check.
const TURN: Duration = Duration::from_millis(50);

/// Runs the bridge until an interrupt.
pub(crate) fn run(options: &args::Bridge) -> Result<(), Failure> {
    let bridge = bridge_options(options)?;
    output::catch_interrupts();
    service_log::start();
    let bridge =
        Bridge::start(&bridge, further(options, &bridge)?).map_err(|error| failure(&error))?;
    print_note(&started(options));
    while !interrupt::has_come() {
        thread::sleep(TURN);
    }
    let commands = bridge.commands();
    drop(bridge);
    print_note(&format!(
        "Commands: {} passed on, {} refused\n",
        commands.accepted, commands.refused
    ));
    Ok(())
}

fn bridge_options(options: &args::Bridge) -> Result<BridgeOptions, Failure> {
    let brokers = !options.kafka.brokers.is_empty() || options.mqtt.broker.is_some();
    if !brokers && further_names(options).is_empty() {
        let ros2 = if cfg!(feature = "ros2") { ", --ros2" } else { "" };
        let opcua = if cfg!(feature = "opcua") { ", --opcua IP:PORT" } else { "" };
        return Err(Failure::input(format!(
            "there is nothing to bridge to: give --kafka HOST:PORT, --mqtt HOST:PORT{ros2}{opcua}, \
             or several"
        )));
    }
    let remote = connection::remote(&options.drive.keys)?;
    let robot = |name: &str, drive: String, stream: String| {
        BridgedRobot::new(name, remote.clone(), drive, stream).map_err(|error| failure(&error))
    };
    let (drive, stream) = (options.drive.drive.to_string(), options.stream.to_string());
    let mut robots = vec![robot(&options.name, drive, stream)?];
    for other in &options.others {
        robots.push(robot(&other.name, other.drive.to_string(), other.stream.to_string())?);
    }
    let spool = options.spool.clone().unwrap_or_else(default_spool);
    Ok(BridgeOptions {
        robots,
        allow_commands: options.allow_commands,
        kafka: kafka(options, &spool)?,
        mqtt: mqtt(options, &spool)?,
        sparkplug: sparkplug(&options.mqtt)?,
    })
}

/// Returns the message sinks other than brokers.
#[cfg_attr(
    not(any(feature = "ros2", feature = "opcua")),
    expect(
        unused_variables,
        unused_mut,
        clippy::unnecessary_wraps,
        reason = "nothing further is built in"
    )
)]
fn further(options: &args::Bridge, bridge: &BridgeOptions) -> Result<Vec<Arc<dyn Sink>>, Failure> {
    let mut sinks: Vec<Arc<dyn Sink>> = Vec::new();
    #[cfg(feature = "ros2")]
    if options.ros2.wanted {
        let (robots, allow_commands) = (&bridge.robots, bridge.allow_commands);
        let model = &options.robot;
        sinks.push(super::bridge_ros2::start(&options.ros2, model, robots, allow_commands)?);
    }
    #[cfg(feature = "opcua")]
    {
        let (robots, allow_commands) = (&bridge.robots, bridge.allow_commands);
        let model = &options.robot;
        sinks.extend(super::bridge_opcua::start(&options.opcua, model, robots, allow_commands)?);
    }
    Ok(sinks)
}

/// Describes the endpoints other than brokers.
#[cfg_attr(
    not(any(feature = "ros2", feature = "opcua")),
    expect(unused_variables, unused_mut, reason = "nothing further is built in")
)]
fn further_names(options: &args::Bridge) -> Vec<String> {
    let mut names = Vec::new();
    #[cfg(feature = "ros2")]
    if options.ros2.wanted {
        names.push("ROS 2 (UDP ports on all addresses)".to_owned());
    }
    #[cfg(feature = "opcua")]
    if let Some(listen) = options.opcua.listen {
        names.push(format!("OPC UA at {listen}"));
    }
    names
}

fn kafka(options: &args::Bridge, spool: &Path) -> Result<Option<KafkaOptions>, Failure> {
    let kafka = &options.kafka;
    if kafka.brokers.is_empty() {
        return Ok(None);
    }
    Ok(Some(KafkaOptions {
        connection: kafka_connection(&kafka.brokers, &kafka.access)?,
        prefix: kafka.access.prefix.clone(),
        compression: kafka.compression.parse().unwrap_or_default(),
        joints: options.joints.parse().unwrap_or_default(),
        spool: spool.join("kafka"),
        spool_bytes: options.spool_mb << 20,
    }))
}

fn mqtt(options: &args::Bridge, spool: &Path) -> Result<Option<MqttOptions>, Failure> {
    let mqtt = &options.mqtt;
    let Some(connection) = mqtt_connection(mqtt)? else { return Ok(None) };
    if mqtt.access.prefix.is_empty() || mqtt.access.prefix.contains(['+', '#']) {
        return Err(Failure::input("--mqtt-prefix is empty, or has + or #".to_owned()));
    }
    Ok(Some(MqttOptions {
        connection,
        prefix: mqtt.access.prefix.clone(),
        rate_hz: rate(mqtt),
        joints: options.joints.parse().unwrap_or_default(),
        spool: spool.join("mqtt"),
        spool_bytes: options.spool_mb << 20,
    }))
}

fn sparkplug(mqtt: &args::Mqtt) -> Result<Option<SparkplugOptions>, Failure> {
    let Some(group) = &mqtt.sparkplug else { return Ok(None) };
    let Some(mut connection) = mqtt_connection(mqtt)? else { return Ok(None) };
    connection.client_id = format!("{}-sparkplug", connection.client_id);
    let (group, node) = (group.clone(), mqtt.client.clone());
    Ok(Some(SparkplugOptions { connection, group, node, rate_hz: rate(mqtt) }))
}

fn rate(mqtt: &args::Mqtt) -> Option<f64> {
    Some(mqtt.rate).filter(|rate| *rate > 0.0)
}

/// Describes the bridged robots and their endpoints.
fn started(options: &args::Bridge) -> String {
    let names = options.others.iter().map(|other| other.name.as_str());
    let robots: Vec<_> = [options.name.as_str()].into_iter().chain(names).collect();
    let mut to = Vec::new();
    if !options.kafka.brokers.is_empty() {
        to.push(format!("Kafka at {}", options.kafka.brokers.join(", ")));
    }
    if let Some(broker) = &options.mqtt.broker {
        let sparkplug = if options.mqtt.sparkplug.is_some() { ", with Sparkplug" } else { "" };
        to.push(format!("MQTT at {broker}{sparkplug}"));
    }
    to.extend(further_names(options));
    let commands = if options.allow_commands { "are carried out" } else { "are refused" };
    format!(
        "Bridge from {} to {}. Commands {commands}. Ctrl-C ends it.\n",
        robots.join(", "),
        to.join(" and ")
    )
}
