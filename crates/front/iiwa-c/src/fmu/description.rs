//! Model description in XML.

use std::{fmt::Write as _, iter};

use quick_xml::escape::escape;

use super::variables::{Declaration, Variable};

/// Constant part around the variables.
const UNITS: &str = r#"  <UnitDefinitions>
    <Unit name="s"><BaseUnit s="1"/></Unit>
    <Unit name="m"><BaseUnit m="1"/></Unit>
    <Unit name="rad"><BaseUnit rad="1"/></Unit>
    <Unit name="rad/s"><BaseUnit s="-1" rad="1"/></Unit>
  </UnitDefinitions>
  <LogCategories>
    <Category name="logStatusError" description="Why a call failed"/>
  </LogCategories>
"#;

/// Returns the description of a model called `name`, whose program takes `cycle_time_s`.
///
/// Outputs refer to the last communication point: they do not depend on inputs at the same instant.
pub(super) fn description(name: &str, token: &str, cycle_time_s: f64) -> String {
    let (name, version) = (escape(name), env!("CARGO_PKG_VERSION"));
    let mut xml = format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="{name}" instantiationToken="{token}"
    description="A motion program of a KUKA LBR iiwa" generationTool="iiwasim {version}"
    variableNamingConvention="structured">
  <CoSimulation modelIdentifier="iiwasim" canHandleVariableCommunicationStepSize="true"
      canGetAndSetFMUState="true"/>
{UNITS}  <DefaultExperiment startTime="0" stopTime="{cycle_time_s}" stepSize="0.001"/>
  <ModelVariables>
"#
    );
    for (reference, variable) in iter::zip(0_u32.., Variable::all()) {
        let Declaration { name, element, role, unit, description } = variable.declaration();
        let unit = unit.map(|unit| format!(r#" unit="{unit}""#)).unwrap_or_default();
        // Writing to a string does not fail.
        let _ = writeln!(
            xml,
            "    <{element} name=\"{name}\" valueReference=\"{reference}\" {role}{unit} \
             description=\"{description}\"/>"
        );
    }
    xml += "  </ModelVariables>\n  <ModelStructure>\n";
    for element in ["Output", "InitialUnknown"] {
        for (reference, _) in Variable::outputs() {
            let _ =
                writeln!(xml, r#"    <{element} valueReference="{reference}" dependencies=""/>"#);
        }
    }
    xml + "  </ModelStructure>\n</fmiModelDescription>\n"
}
