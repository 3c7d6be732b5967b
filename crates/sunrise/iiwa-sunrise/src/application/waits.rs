//! Waits of programs: for a duration, or for the robot.

use iiwa_java::{EvaluationStop, Value};

use crate::application::{
    enum_constant::EnumConstant,
    robot_value::{RobotValue, Sent, robot},
    robotics::Robotics,
};

impl Robotics<'_> {
    /// Evaluates `ThreadUtil.milliSleep` and `Thread.sleep`.
    pub(crate) fn sleep_ms(&mut self, amount: &Value) -> Result<Value, EvaluationStop> {
        self.sleep(amount, |ms| Some(ms / 1e3))
    }

    /// Calls a method of an enum constant.
    pub(crate) fn call_constant(
        &mut self,
        constant: &EnumConstant,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        match (name, arguments) {
            ("name", []) => Ok(Value::text(&constant.name)),
            ("ordinal", []) => Ok(Value::Int(constant.ordinal)),
            ("compareTo", [other]) => Ok(match crate::application::arguments::robot_value(other) {
                Some(RobotValue::Constant(other)) => Value::Int(constant.ordinal - other.ordinal),
                _ => self.not_known("Enum.compareTo"),
            }),
            ("sleep", [amount]) => self.sleep(amount, |amount| constant.seconds(amount)),
            (_, [amount]) if name.starts_with("to") => Ok(self.converted(constant, name, amount)),
            ("convert", [amount, unit]) => match crate::application::arguments::robot_value(unit) {
                Some(RobotValue::Constant(unit)) => {
                    let name = format!("to{}", constant.name);
                    Ok(self.converted(&unit, &name, amount))
                }
                _ => Ok(self.not_known("TimeUnit.convert")),
            },
            // Current world frame.
            ("getRootFrame", []) if &*constant.class == "World" => {
                Ok(robot(RobotValue::Spot(crate::application::spot::Spot::World)))
            }
            _ => Ok(self.not_known(&format!("{}.{name}", constant.class))),
        }
    }

    /// Converts an amount between time units, in whole units, such as `TimeUnit.SECONDS.toMillis`.
    fn converted(&self, unit: &EnumConstant, name: &str, amount: &Value) -> Value {
        if let Value::Unknown(unknown) = amount {
            return Value::Unknown(unknown.clone());
        }
        let wanted = match name.to_ascii_lowercase().as_str() {
            "tonanos" | "tonanoseconds" => "NANOSECONDS",
            "tomicros" | "tomicroseconds" => "MICROSECONDS",
            "tomillis" | "tomilliseconds" => "MILLISECONDS",
            "toseconds" => "SECONDS",
            "tominutes" => "MINUTES",
            "tohours" => "HOURS",
            _ => "DAYS",
        };
        let one = |unit: &EnumConstant| unit.seconds(1.0);
        let wanted = EnumConstant::named("TimeUnit", wanted);
        let factor = one(unit).zip(wanted.and_then(|wanted| one(&wanted)));
        match (amount.integer(), factor) {
            (Some(amount), Some((unit_s, wanted))) if unit_s >= wanted => {
                #[expect(clippy::cast_possible_truncation, reason = "they are whole numbers")]
                let factor = (unit_s / wanted).round() as i64;
                Value::Long(amount.saturating_mul(factor))
            }
            (Some(amount), Some((unit_s, wanted))) => {
                #[expect(clippy::cast_possible_truncation, reason = "they are whole numbers")]
                let factor = (wanted / unit_s).round() as i64;
                Value::Long(amount / factor.max(1))
            }
            _ => self.not_known(&format!("TimeUnit.{name}")),
        }
    }

    fn sleep(
        &mut self,
        amount: &Value,
        seconds: impl Fn(f64) -> Option<f64>,
    ) -> Result<Value, EvaluationStop> {
        if let Value::Unknown(unknown) = amount {
            return self.reject_unknown("the time of this wait", unknown);
        }
        let Some(seconds) = amount.number().and_then(seconds) else {
            return self.reject("the time of this wait is not a number of a unit of time");
        };
        if seconds < 0.0 {
            return self.throw("IllegalArgumentException", "timeout value is negative");
        }
        // A wait of zero duration has no effect.
        if seconds > 0.0 {
            self.wait(seconds)?;
        }
        Ok(Value::Null)
    }

    /// Evaluates `waitFor` of an observer manager: a wait for a condition, with or without a time
    /// limit. A condition that does not come true takes the whole time limit.
    pub(crate) fn wait_for(&mut self, arguments: &[Value]) -> Result<Value, EvaluationStop> {
        let condition = arguments.first().cloned().unwrap_or(Value::Null);
        let [_, amount, unit] = arguments else {
            let seconds = self.given_seconds("a wait for a condition")?;
            self.wait_for_signal(&condition, seconds)?;
            return Ok(Value::Null);
        };
        let limit_s = match crate::application::arguments::robot_value(unit) {
            Some(RobotValue::Constant(unit)) => {
                amount.number().and_then(|amount| unit.seconds(amount)).map(|limit| limit.max(0.0))
            }
            _ => None,
        };
        let fired = self.answer_condition("the condition of a wait");
        match (&fired, limit_s) {
            (Value::Boolean(false), Some(limit_s)) => {
                if limit_s > 0.0 {
                    self.wait(limit_s)?;
                }
            }
            (Value::Boolean(false), None) => {
                if let Value::Unknown(unknown) = amount {
                    return self.reject_unknown("the time limit of this wait", unknown);
                }
                return self
                    .reject("the time limit of this wait is not a number of a unit of time");
            }
            (_, Some(limit_s)) => {
                let event = format!("a wait for a condition, of at most {limit_s} s");
                let seconds = self.given_seconds(&event)?;
                if seconds > limit_s {
                    let place = self.place.to_string();
                    return self.reject(format!(
                        "`{place}` is given as {seconds}: this wait ends after {limit_s} s"
                    ));
                }
                self.wait_for_signal(&condition, seconds)?;
            }
            (_, None) => self.take_given_time("a wait for a condition")?,
        }
        Ok(fired)
    }

    /// Calls a method of a motion container.
    pub(crate) fn call_container(
        &mut self,
        sent: Sent,
        name: &str,
    ) -> Result<Value, EvaluationStop> {
        let Sent { count: sent, has_break } = sent;
        let is_under_way =
            self.station.schedule.is_under_way() && sent == self.station.schedule.sent();
        match name {
            "await" => {
                if sent < self.station.schedule.sent() && self.station.schedule.is_under_way() {
                    self.note(
                        "a motion is awaited while others follow it: the program is planned \
                        as if it awaited them all",
                    );
                }
                self.station.schedule.await_all();
                Ok(Value::Null)
            }
            "isFinished" => {
                if self.station.schedule.is_under_way() || self.station.schedule.is_holding() {
                    self.note(
                        "a program that asks whether a motion is over is planned as if it \
                        awaited its end",
                    );
                    self.station.schedule.await_all();
                }
                Ok(Value::Boolean(true))
            }
            "hasFired" if has_break => Ok(self.answer_condition("the break condition of a motion")),
            "getFiredBreakConditionInfo" if has_break => {
                Ok(match self.answer_condition("the break condition of a motion") {
                    Value::Boolean(true) => robot(RobotValue::source(
                        "IFiredConditionInfo",
                        "the state of the robot when a break condition fired",
                    )),
                    Value::Boolean(false) => Value::Null,
                    other => other,
                })
            }
            "hasFired" | "hasError" | "isCanceled" => Ok(Value::Boolean(false)),
            "cancel"
                if sent == self.station.schedule.sent() && self.station.schedule.is_holding() =>
            {
                self.station.schedule.end_hold();
                Ok(Value::Null)
            }
            "cancel" if is_under_way => self.reject(
                "a motion is cancelled while it runs: where the arm stops depends on when that is; \
                 send a motion that ends there",
            ),
            "cancel" | "getFiredBreakConditionInfo" | "getErrorMessage" => Ok(Value::Null),
            name => Ok(self.not_known(&format!("IMotionContainer.{name}"))),
        }
    }
}
