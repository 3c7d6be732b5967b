//! Classes outside the project: Java library, KUKA classes, and libraries without source.

use std::{cell::RefCell, rc::Rc};

use crate::{
    java_sorting::Known,
    machine::Machine,
    stop::EvaluationStop,
    value::{List, ListKind, Map, MapOrder, Thrown, Value},
};

impl Machine {
    /// Evaluates `Class.name`; `None` if it is not modelled.
    pub(crate) fn foreign_constant(
        &mut self,
        class: &str,
        name: &str,
    ) -> Result<Option<Value>, EvaluationStop> {
        let value = match (class, name) {
            ("Math", "PI") => Value::Double(std::f64::consts::PI),
            ("Math", "E") => Value::Double(std::f64::consts::E),
            ("Integer", "MAX_VALUE") => Value::Int(i32::MAX),
            ("Integer", "MIN_VALUE") => Value::Int(i32::MIN),
            ("Long", "MAX_VALUE") => Value::Long(i64::MAX),
            ("Long", "MIN_VALUE") => Value::Long(i64::MIN),
            ("Double", "MAX_VALUE") => Value::Double(f64::MAX),
            // Smallest positive value.
            ("Double", "MIN_VALUE") => Value::Double(f64::from_bits(1)),
            ("Double", "NaN") => Value::Double(f64::NAN),
            ("Double", "POSITIVE_INFINITY") => Value::Double(f64::INFINITY),
            ("Double", "NEGATIVE_INFINITY") => Value::Double(f64::NEG_INFINITY),
            ("Float", "MAX_VALUE") => Value::Float(f32::MAX),
            ("Float", "MIN_VALUE") => Value::Float(f32::from_bits(1)),
            ("Byte", "MAX_VALUE") => Value::Int(127),
            ("Byte", "MIN_VALUE") => Value::Int(-128),
            ("Short", "MAX_VALUE") => Value::Int(32_767),
            ("Short", "MIN_VALUE") => Value::Int(-32_768),
            ("Boolean", "TRUE") => Value::Boolean(true),
            ("Boolean", "FALSE") => Value::Boolean(false),
            ("System", "out" | "err") => Value::ForeignClass(Rc::from("PrintStream")),
            _ => return Rc::clone(&self.host).constant(self, class, name),
        };
        Ok(Some(value))
    }

    /// Evaluates `Class.name(...)`; `None` if it is not modelled.
    pub(crate) fn foreign_static(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        self.check_usable(class)?;
        match self.library_static(class, name, arguments)? {
            Some(value) => Ok(Some(value)),
            None => Rc::clone(&self.host).call_static(self, class, name, arguments),
        }
    }

    /// Evaluates a static method of the Java library; `None` if it is not modelled.
    pub(crate) fn library_static(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(match class {
            "Math" | "StrictMath" => self.math(name, arguments)?,
            "Integer" | "Long" | "Double" | "Float" | "Boolean" | "Character" | "Short"
            | "Byte" => self.of_box(class, name, arguments)?,
            "String" => self.of_string_class(name, arguments)?,
            "Arrays" | "Collections" | "List" | "Objects" => {
                self.of_collections(class, name, arguments)?
            }
            "PrintStream" => Some(Value::Null),
            "System" => self.of_system(name, arguments)?,
            "Comparator" | "Function" | "UnaryOperator" | "Predicate" | "Entry" => {
                self.of_interface_class(class, name, arguments)
            }
            "Stream" | "IntStream" | "LongStream" | "DoubleStream" => {
                self.of_stream_class(class, name, arguments)?
            }
            "Collectors" => Self::of_collectors(name, arguments),
            "Optional" | "OptionalInt" | "OptionalLong" | "OptionalDouble" => {
                self.of_optional_class(name, arguments)?
            }
            _ => None,
        })
    }

    /// Evaluates `new Class(...)`; `None` if it is not modelled.
    pub(crate) fn foreign_new(
        &mut self,
        class: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        self.check_usable(class)?;
        let first = arguments.first();
        let value = match class {
            "ArrayList"
            | "LinkedList"
            | "Vector"
            | "Stack"
            | "ArrayDeque"
            | "CopyOnWriteArrayList"
            | "ConcurrentLinkedQueue"
            | "LinkedBlockingQueue" => {
                let kind = match class {
                    "Stack" => ListKind::Stack,
                    "ArrayList" | "Vector" | "CopyOnWriteArrayList" => ListKind::List,
                    _ => ListKind::Deque,
                };
                let list = List::new(kind, Vec::new());
                match self.first_elements(class, first) {
                    Ok(values) => list.renew(values),
                    Err(unknown) => list.spoil(&unknown),
                }
                Value::List(Rc::new(list))
            }
            "HashSet" | "TreeSet" | "LinkedHashSet" => {
                // Elements are in insertion order; `iterated` handles other orders.
                let order = order_of(class);
                let set = Map { order, is_set: true, ..Map::default() };
                let set = Value::Map(Rc::new(RefCell::new(set)));
                match self.first_elements(class, first) {
                    Ok(values) => {
                        self.call_library(&set, "addAll", &[Value::list(values)])?;
                    }
                    Err(unknown) => self.spoil(&set, &unknown),
                }
                set
            }
            "HashMap" | "LinkedHashMap" | "TreeMap" | "Hashtable" | "ConcurrentHashMap"
            | "EnumMap" => {
                let map = Map { order: order_of(class), ..Map::default() };
                let map = Value::Map(Rc::new(RefCell::new(map)));
                match first {
                    Some(other @ Value::Map(_)) => {
                        self.call_library(&map, "putAll", std::slice::from_ref(other))?;
                    }
                    // The class of an enum, or a capacity.
                    None | Some(Value::Int(_) | Value::Class(_) | Value::ForeignClass(_)) => {}
                    Some(other) => {
                        let created = self.unknown(format!("a `{class}` of {}", other.kind()));
                        if let Some(unknown) = other.unknown().or(created.unknown()) {
                            self.spoil(&map, &Rc::clone(unknown));
                        }
                    }
                }
                map
            }
            "StringBuilder" | "StringBuffer" => {
                let text = match first {
                    None | Some(Value::Int(_)) => Ok(String::new()),
                    Some(other) => self.text_of(other)?,
                };
                Value::Builder(Rc::new(RefCell::new(text)))
            }
            "String" => match first {
                None => Value::text(""),
                // A new object that equals its argument, but is not the same.
                Some(Value::Text(text)) => Value::text(text),
                _ => return Ok(None),
            },
            "Integer" | "Double" | "Long" | "Boolean" | "Float" => {
                return self.of_box(class, "valueOf", arguments);
            }
            "Object" => self.unknown("an `Object`"),
            "AtomicInteger" | "AtomicBoolean" | "AtomicLong" | "AtomicReference" => {
                let default = match class {
                    "AtomicBoolean" => Value::Boolean(false),
                    "AtomicReference" => Value::Null,
                    "AtomicLong" => Value::Long(0),
                    _ => Value::Int(0),
                };
                Value::Cell(Rc::new(RefCell::new(first.cloned().unwrap_or(default))))
            }
            _ if class.ends_with("Exception") || class.ends_with("Error") => {
                let (value, message) = match first {
                    Some(value @ Value::Text(text)) => (value.clone(), text.to_string()),
                    Some(value @ Value::Unknown(_)) => (value.clone(), String::new()),
                    _ => (Value::Null, String::new()),
                };
                let place = self.place.clone();
                Value::Exception(Rc::new(Thrown {
                    classes: vec![Rc::from(class)],
                    value,
                    message,
                    place,
                }))
            }
            _ => return Rc::clone(&self.host).construct(self, class, arguments),
        };
        Ok(Some(value))
    }

    /// Returns the initial elements of a collection.
    fn first_elements(&self, class: &str, first: Option<&Value>) -> Known<Vec<Value>> {
        let Some(first) = first else { return Ok(Vec::new()) };
        if let Value::Int(_) | Value::Class(_) = first {
            return Ok(Vec::new());
        }
        let unknown = first.unknown().cloned().or_else(|| Self::unknown_contents(first));
        match (unknown, Self::iterated(first)) {
            (Some(unknown), _) => Err(unknown),
            (None, Some(values)) => Ok(values),
            (None, None) => {
                let result =
                    self.unknown(format!("a `{class}` of {} without an order", first.kind()));
                result.unknown().cloned().map_or(Ok(Vec::new()), Err)
            }
        }
    }

    /// Refuses a project class whose file cannot be used.
    fn check_usable(&self, class: &str) -> Result<(), EvaluationStop> {
        match self.java.classes.faulty(class) {
            Some(error) => self.reject(format!("the class {class} cannot be used: {error}")),
            None => Ok(()),
        }
    }

    fn of_system(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(Some(match (name, arguments) {
            ("currentTimeMillis" | "nanoTime", []) => self.unknown("the controller's clock"),
            ("lineSeparator", []) => Value::text("\n"),
            ("gc", []) => Value::Null,
            ("getProperty" | "getenv", _) => self.unknown("the controller's environment"),
            ("exit", _) => return self.reject("`System.exit` ends the controller's Java"),
            (
                "arraycopy",
                [Value::Array(from), from_index, Value::Array(to), to_index, Value::Int(count)],
            ) => {
                let count = usize::try_from(*count).unwrap_or(0);
                // The ranges may overlap.
                let old = from.values.borrow().clone();
                for step in 0..count {
                    let offset = Value::Int(i32::try_from(step).unwrap_or(i32::MAX));
                    let [a, b] = [from_index, to_index].map(|start| {
                        start.integer().unwrap_or(-1).saturating_add(offset.integer().unwrap_or(0))
                    });
                    let a = self.index(&Value::Long(a), old.len())?;
                    let b = self.index(&Value::Long(b), to.values.borrow().len())?;
                    let value = old.get(a).cloned();
                    if let (Some(value), Some(place)) = (value, to.values.borrow_mut().get_mut(b)) {
                        *place = value;
                    }
                }
                self.java.changes += 1;
                Value::Null
            }
            _ => return Ok(None),
        }))
    }
}

fn order_of(class: &str) -> MapOrder {
    match class {
        "LinkedHashMap" | "LinkedHashSet" => MapOrder::Linked,
        "TreeMap" | "TreeSet" | "EnumMap" => MapOrder::Sorted,
        _ => MapOrder::Hashed,
    }
}
