//! Machine without a program, for tests of the API.

use std::rc::Rc;

use crate::DataFile;
use iiwa_java::{Classes, EvaluationStop, Machine, SourceLine, Value};

use crate::application::{
    robot_value::{RobotValue, robot},
    robotics::Robotics,
    station::{Station, StationSetup},
    station_host::StationHost,
};

/// Small station: a nested frame, a gripper with two TCPs, and a workpiece.
const STATION: &str = r#"<RoboticsAPIData version="3">
  <world>
    <frame name="Table">
      <transformation x="400" y="-100" z="100" a="0" b="0" c="0"/>
      <frame name="Pick">
        <transformation x="100.1" y="50" z="200" a="2.5" b="0" c="3.1"/>
        <redundancyData>
          <redundancy transformationProviderName="LBR" type="LBRE1Redundancy">
            <info type="E1Parameter" value="0.1"/>
            <info type="StatusParameter" value="2"/>
            <info type="TurnParameter" value="10"/>
          </redundancy>
        </redundancyData>
      </frame>
    </frame>
    <frame name="Shelf"><transformation x="1500" y="0" z="300" a="0" b="0" c="3.1"/></frame>
  </world>
  <objectTemplates>
    <toolTemplate name="Gripper" defaultMotionFrameRef="/Tip">
      <frames>
        <frame name="Tip"><transformation x="0" y="0" z="150" a="0" b="0" c="0"/></frame>
        <frame name="Side"><transformation x="50" y="0" z="100" a="0" b="0.5" c="0"/></frame>
      </frames>
      <loadData cogX="0" cogY="0" cogZ="50" mass="1.5"/>
    </toolTemplate>
    <workpieceTemplate name="Box">
      <frames>
        <frame name="Edge"><transformation x="30" y="0" z="20" a="0" b="0" c="0"/></frame>
      </frames>
      <loadData cogX="0" cogY="0" cogZ="10" mass="0.5"/>
    </workpieceTemplate>
  </objectTemplates>
  <processDataContainer>
    <processData dataType="java.lang.Double" defaultValue="0.5" id="velocity" value="0.25"/>
    <processData dataType="java.lang.Integer" defaultValue="3" id="count"/>
  </processDataContainer>
</RoboticsAPIData>"#;

/// Creates a machine in the small station, with answers.
pub(crate) fn machine(answers: &str) -> Robotics<'static> {
    let answers = crate::Answers::from_toml(answers).unwrap_or_default();
    let data_file = DataFile::from_xml(STATION).unwrap_or_default();
    let setup = StationSetup { data_file, answers, ..StationSetup::default() };
    let idle = Rc::new(StationHost::new(Station::new(StationSetup::default())));
    let place = SourceLine { file: Rc::from("src/Job.java"), line: 1 };
    // Leaked, which is acceptable for the duration of the tests.
    Robotics {
        machine: Box::leak(Box::new(Machine::new(Classes::default(), idle, place))),
        station: Box::leak(Box::new(Station::new(setup))),
    }
}

/// Creates text arguments.
pub(crate) fn texts(texts: &[&str]) -> Vec<Value> {
    texts.iter().map(Value::text).collect()
}

pub(crate) fn doubles(numbers: &[f64]) -> Vec<Value> {
    numbers.iter().copied().map(Value::Double).collect()
}

impl Robotics<'_> {
    /// Calls a method of an API value on a new line.
    pub(crate) fn on(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        self.place.line += 1;
        match crate::application::arguments::robot_value(receiver) {
            Some(receiver) => self.call_robot(&receiver, name, arguments),
            None => self.reject(format!("`{name}` of {}", receiver.kind())),
        }
    }

    pub(crate) fn motion(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let motion = self.robot_static("BasicMotions", name, arguments)?;
        motion.map_or_else(|| self.reject(format!("no {name}")), Ok)
    }

    pub(crate) fn frame(&mut self, path: &str) -> Result<Value, EvaluationStop> {
        self.tree_frame(path)
    }
}

pub(crate) fn lbr() -> Value {
    robot(RobotValue::Robot)
}

pub(crate) fn flange() -> Value {
    robot(RobotValue::Spot(crate::application::spot::Spot::Flange))
}

/// Returns the reason of a refusal, or the exception.
pub(crate) fn reason<T>(result: Result<T, EvaluationStop>) -> String {
    match result {
        Ok(_) => "it was not refused".to_owned(),
        Err(EvaluationStop::Refused(refusal)) => refusal.reason,
        Err(EvaluationStop::Ended) => "it ended".to_owned(),
        Err(EvaluationStop::Thrown(thrown)) => {
            format!("{}: {}", thrown.classes.concat(), thrown.message)
        }
    }
}
