//! Streams of the Java library. Elements pass all stages one by one, as on a JVM, so that side
//! effects occur in the same order.

use std::{cell::Cell, rc::Rc};

use crate::{
    java_collections::MAX_ELEMENTS,
    java_lists::CHANGED_MEANWHILE,
    java_sorting::Known,
    machine::Machine,
    stop::EvaluationStop,
    value::{JavaStream, List, ListKind, StreamKind, StreamStage, Value},
};

/// Continuation of a pipeline after an element, or the reason why it is unknown.
type Flowed = Known<bool>;

/// End of a pipeline.
type StreamEnd<'s> = dyn FnMut(&mut Machine, Value) -> Result<Flowed, EvaluationStop> + 's;

/// Terminal operations that need only the elements.
const ENDS: [&str; 10] = [
    "count",
    "toList",
    "toArray",
    "sum",
    "average",
    "reduce",
    "max",
    "min",
    "collect",
    "findFirst",
];

impl Machine {
    /// Evaluates `list.stream()`.
    pub(crate) fn stream_of(kind: StreamKind, source: Value) -> Value {
        let stages = Vec::new();
        Value::Stream(Rc::new(JavaStream { kind, source, stages, is_used: Cell::new(false) }))
    }

    /// Evaluates a static method of `Stream`, `IntStream` and similar classes; `None` if it is not
    /// modelled.
    pub(crate) fn of_stream_class(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let kind = match class {
            "IntStream" => StreamKind::Int,
            "LongStream" => StreamKind::Long,
            "DoubleStream" => StreamKind::Double,
            _ => StreamKind::Object,
        };
        let values = match (name, arguments) {
            ("of", [Value::Array(array)]) => array.values.borrow().clone(),
            ("of", values) => values.to_vec(),
            ("empty", []) => Vec::new(),
            ("range" | "rangeClosed", [Value::Int(begin), Value::Int(end)])
                if kind == StreamKind::Int =>
            {
                let end = i64::from(*end) + i64::from(name == "rangeClosed");
                let length = usize::try_from(end - i64::from(*begin)).unwrap_or(0);
                if length > MAX_ELEMENTS {
                    return self.reject("a stream has more than a million elements");
                }
                (i64::from(*begin)..end)
                    .filter_map(|value| i32::try_from(value).ok())
                    .map(Value::Int)
                    .collect()
            }
            _ => return Ok(None),
        };
        let values = values.into_iter().map(|value| kind.converted(value)).collect();
        Ok(Some(Self::stream_of(kind, Value::list(values))))
    }

    /// Calls a method of a stream; `None` if it is not modelled.
    pub(crate) fn of_stream(
        &mut self,
        stream: &Rc<JavaStream>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        if stream.is_used.replace(true) {
            return self.throw("IllegalStateException", "a stream is used again");
        }
        if let Some((kind, stage)) = stage(stream.kind, name, arguments) {
            let mut stages = stream.stages.clone();
            stages.push(stage);
            let (source, is_used) = (stream.source.clone(), Cell::new(false));
            return Ok(Some(Value::Stream(Rc::new(JavaStream { kind, source, stages, is_used }))));
        }
        // Since Java 9, `count` runs no functions if the number of elements is known without them.
        let is_count_known = name == "count"
            && stream.stages.iter().all(StreamStage::keeps_count)
            && stream.stages.iter().any(|stage| stage.function().is_some());
        let result = if is_count_known { None } else { self.ended(stream, name, arguments)? };
        let result = result.unwrap_or_else(|| self.unmodelled_result(name, " of a stream"));
        if result.unknown().is_some() {
            // Functions may have been run for other elements, too.
            let functions = stream.stages.iter().filter_map(StreamStage::function);
            let functions: Vec<_> = functions.chain(arguments).cloned().collect();
            self.after_unmodelled(None, name, &functions, &result)?;
        }
        Ok(Some(result))
    }

    /// Passes the elements of a stream to a sink, one by one.
    fn flow(
        &mut self,
        stream: &JavaStream,
        sink: &mut StreamEnd<'_>,
    ) -> Result<Flowed, EvaluationStop> {
        let source = stream.source.clone();
        self.refresh(&source);
        if let Some(unknown) = Self::unknown_contents(&source) {
            return Ok(Err(unknown));
        }
        let Some(values) = Self::iterated(&source) else {
            return Ok(match self.unknown("the order of the elements of a stream") {
                Value::Unknown(unknown) => Err(unknown),
                _ => Ok(true),
            });
        };
        let begin = Self::structure(&source);
        self.flow_through(values, &stream.stages, &mut |machine, value| {
            let flowed = sink(machine, value)?;
            machine.refresh(&source);
            if Self::structure(&source) != begin {
                return machine.reject(CHANGED_MEANWHILE);
            }
            Ok(flowed)
        })
    }

    fn flow_through(
        &mut self,
        values: Vec<Value>,
        stages: &[StreamStage],
        sink: &mut StreamEnd<'_>,
    ) -> Result<Flowed, EvaluationStop> {
        let barrier = stages.iter().position(|stage| matches!(stage, StreamStage::Sorted(_)));
        if let Some(place) = barrier
            && let StreamStage::Sorted(comparator) = &stages[place]
        {
            let mut before = Vec::new();
            let flowed = self.flow_through(values, &stages[..place], &mut |_, value| {
                before.push(value);
                Ok(Ok(true))
            })?;
            if flowed.is_err() {
                return Ok(flowed);
            }
            return match self.sorted(before, comparator.as_ref())? {
                Ok(sorted) => self.flow_through(sorted, &stages[place + 1..], sink),
                Err(unknown) => Ok(Err(unknown)),
            };
        }
        let mut counts = vec![0; stages.len()];
        let mut seen = vec![Vec::new(); stages.len()];
        if stages.iter().any(|stage| matches!(stage, StreamStage::Limit(0))) {
            return Ok(Ok(true));
        }
        for value in values {
            let passed = self.passed_through(value, stages, &mut counts, &mut seen)?;
            let flowed = match passed {
                Ok(Some(value)) => sink(self, value)?,
                Ok(None) => Ok(true),
                Err(unknown) => Err(unknown),
            };
            let is_full = stages
                .iter()
                .zip(&counts)
                .any(|(stage, count)| matches!(stage, StreamStage::Limit(limit) if count >= limit));
            if is_full || !matches!(flowed, Ok(true)) {
                return Ok(flowed);
            }
        }
        Ok(Ok(true))
    }

    /// Passes an element through all stages; `None` if a stage drops it.
    fn passed_through(
        &mut self,
        value: Value,
        stages: &[StreamStage],
        counts: &mut [usize],
        seen: &mut [Vec<Value>],
    ) -> Result<Known<Option<Value>>, EvaluationStop> {
        let mut value = value;
        self.count_step()?;
        for (place, stage) in stages.iter().enumerate() {
            match stage {
                StreamStage::Map(function, interface) => {
                    value = self.apply(function, interface, &[value])?;
                }
                StreamStage::Filter(function, interface) => {
                    match self.apply(function, interface, std::slice::from_ref(&value))? {
                        Value::Boolean(true) => {}
                        Value::Unknown(unknown) => return Ok(Err(unknown)),
                        _ => return Ok(Ok(None)),
                    }
                }
                StreamStage::Peek(function, interface) => {
                    self.apply(function, interface, std::slice::from_ref(&value))?;
                }
                StreamStage::Convert(kind) => value = kind.converted(value),
                StreamStage::Limit(_) => counts[place] += 1,
                StreamStage::Skip(count) => {
                    counts[place] += 1;
                    if counts[place] <= *count {
                        return Ok(Ok(None));
                    }
                }
                StreamStage::Distinct => match self.place_of(&seen[place], &value)? {
                    Ok(None) => seen[place].push(value.clone()),
                    Ok(Some(_)) => return Ok(Ok(None)),
                    Err(unknown) => return Ok(Err(unknown)),
                },
                StreamStage::Sorted(_) => {}
            }
        }
        Ok(Ok(Some(value)))
    }

    /// Evaluates a terminal operation; `None` if it is not modelled.
    fn ended(
        &mut self,
        stream: &JavaStream,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let kind = stream.kind;
        let prefix = kind.prefix();
        if let ("forEach" | "forEachOrdered", [f @ (Value::Function(_) | Value::Object(_))]) =
            (name, arguments)
        {
            let interface = format!("{prefix}Consumer");
            let result = self.flow(stream, &mut |machine, value| {
                machine.apply(f, &interface, &[value]).map(|_| Ok(true))
            })?;
            return Ok(Some(result.map_or_else(Value::Unknown, |_| Value::Null)));
        }
        if let (
            "anyMatch" | "allMatch" | "noneMatch",
            [f @ (Value::Function(_) | Value::Object(_))],
        ) = (name, arguments)
        {
            let interface = format!("{prefix}Predicate");
            let ends_by = name != "allMatch";
            let mut is_found = false;
            let result = self.flow(stream, &mut |machine, value| match machine.apply(
                f,
                &interface,
                &[value],
            )? {
                Value::Boolean(boolean) => {
                    is_found |= boolean == ends_by;
                    Ok(Ok(boolean != ends_by))
                }
                Value::Unknown(unknown) => Ok(Err(unknown)),
                other => machine.reject(format!("the result of a test is {}", other.kind())),
            })?;
            return Ok(Some(match result {
                Ok(_) => Value::Boolean(is_found == (name == "anyMatch")),
                Err(unknown) => Value::Unknown(unknown),
            }));
        }
        if !ENDS.contains(&name) {
            return Ok(None);
        }
        if name == "findFirst" {
            let mut first = None;
            let result = self.flow(stream, &mut |_, value| {
                first = Some(value);
                Ok(Ok(false))
            })?;
            return Ok(Some(match result {
                Ok(_) => Value::Optional(Rc::new(first)),
                Err(unknown) => Value::Unknown(unknown),
            }));
        }
        let mut values = Vec::new();
        let result = self.flow(stream, &mut |_, value| {
            values.push(value);
            Ok(Ok(true))
        })?;
        match result {
            Ok(_) => self.gathered(kind, values, name, arguments),
            Err(unknown) => Ok(Some(Value::Unknown(unknown))),
        }
    }

    /// Evaluates a terminal operation that needs all elements.
    fn gathered(
        &mut self,
        kind: StreamKind,
        values: Vec<Value>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let prefix = kind.prefix();
        let count = i64::try_from(values.len()).unwrap_or(i64::MAX);
        let optional = |value: Option<Value>| Value::Optional(Rc::new(value));
        Ok(Some(match (name, arguments) {
            ("count", []) => Value::Long(count),
            ("toList", []) => Value::List(Rc::new(List::new(ListKind::Immutable, values))),
            ("toArray", []) => Value::array(kind.element(), values),
            ("toArray", [f @ (Value::Function(_) | Value::Object(_))]) => {
                let length = Value::Int(i32::try_from(count).unwrap_or(i32::MAX));
                let array = self.apply(f, "IntFunction", &[length])?;
                if let Value::Array(array) = &array {
                    array.values.borrow_mut().clone_from(&values);
                }
                array
            }
            ("sum", []) if kind != StreamKind::Object && kind != StreamKind::Double => {
                let mut sum = kind.converted(Value::Int(0));
                for value in &values {
                    sum = self.binary(crate::syntax::BinaryOperator::Add, &sum, value)?;
                }
                sum
            }
            ("average", []) if matches!(kind, StreamKind::Int | StreamKind::Long) => {
                let sum: i64 = values.iter().filter_map(Value::integer).sum();
                #[expect(clippy::cast_precision_loss, reason = "as Java does")]
                optional((count > 0).then(|| Value::Double(sum as f64 / count as f64)))
            }
            ("reduce", [first, f @ (Value::Function(_) | Value::Object(_))]) => {
                let interface = format!("{prefix}BinaryOperator");
                let mut result = kind.converted(first.clone());
                for value in values {
                    result = self.apply(f, &interface, &[result, value])?;
                }
                result
            }
            ("reduce", [f @ (Value::Function(_) | Value::Object(_))]) => {
                let interface = format!("{prefix}BinaryOperator");
                let mut values = values.into_iter();
                let Some(mut result) = values.next() else { return Ok(Some(optional(None))) };
                for value in values {
                    result = self.apply(f, &interface, &[result, value])?;
                }
                optional(Some(result))
            }
            ("max" | "min", comparator) if comparator.len() <= 1 => {
                match self.extreme(values, comparator.first(), name == "max", true)? {
                    Err(unknown) => Value::Unknown(unknown),
                    Ok(extreme) => optional(extreme),
                }
            }
            ("collect", [Value::Collector(collector)]) => {
                let collector = Rc::clone(collector);
                return self.collected(values, &collector).map(Some);
            }
            _ => return Ok(None),
        }))
    }
}

/// Returns an intermediate operation, and the kind of the resulting stream; `None` for other
/// methods.
fn stage(kind: StreamKind, name: &str, arguments: &[Value]) -> Option<(StreamKind, StreamStage)> {
    let is_function = |value: &Value| matches!(value, Value::Function(_) | Value::Object(_));
    let prefix = kind.prefix();
    let map = |to: StreamKind, function: &Value| {
        let interface = match (kind, to) {
            (StreamKind::Object, StreamKind::Object) => "Function".to_owned(),
            (StreamKind::Object, to) => format!("To{}Function", to.prefix()),
            (from, to) if from == to => format!("{prefix}UnaryOperator"),
            (_, StreamKind::Object) => format!("{prefix}Function"),
            (_, to) => format!("{prefix}To{}Function", to.prefix()),
        };
        (to, StreamStage::Map(function.clone(), Rc::from(interface)))
    };
    Some(match (name, arguments) {
        ("map", [f]) if is_function(f) => map(kind, f),
        ("mapToInt", [f]) if is_function(f) => map(StreamKind::Int, f),
        ("mapToLong", [f]) if is_function(f) => map(StreamKind::Long, f),
        ("mapToDouble", [f]) if is_function(f) => map(StreamKind::Double, f),
        ("mapToObj", [f]) if is_function(f) => map(StreamKind::Object, f),
        ("boxed", []) => (StreamKind::Object, StreamStage::Convert(kind)),
        ("asDoubleStream", []) => (StreamKind::Double, StreamStage::Convert(StreamKind::Double)),
        ("asLongStream", []) => (StreamKind::Long, StreamStage::Convert(StreamKind::Long)),
        ("filter", [f]) if is_function(f) => {
            (kind, StreamStage::Filter(f.clone(), Rc::from(format!("{prefix}Predicate"))))
        }
        ("peek", [f]) if is_function(f) => {
            (kind, StreamStage::Peek(f.clone(), Rc::from(format!("{prefix}Consumer"))))
        }
        ("limit", [Value::Int(count)]) => (kind, StreamStage::Limit(usize::try_from(*count).ok()?)),
        ("skip", [Value::Int(count)]) => (kind, StreamStage::Skip(usize::try_from(*count).ok()?)),
        ("sorted", []) => (kind, StreamStage::Sorted(None)),
        ("sorted", [comparator]) if is_function(comparator) => {
            (kind, StreamStage::Sorted(Some(comparator.clone())))
        }
        ("distinct", []) => (kind, StreamStage::Distinct),
        ("sequential" | "parallel" | "unordered", []) => (kind, StreamStage::Convert(kind)),
        _ => return None,
    })
}
