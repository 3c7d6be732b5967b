//! Methods of Java library values, and static methods for collections and arrays.

use std::{cell::RefCell, rc::Rc};

use crate::{
    machine::Machine,
    stop::EvaluationStop,
    type_names::is_primitive,
    unknown::Unknown,
    value::{Array, Combined, List, ListKind, StreamKind, Value, View},
};

/// Maximum number of elements of a collection: larger ones would fill memory, and do not occur in
/// robot programs.
pub(crate) const MAX_ELEMENTS: usize = 1_000_000;

impl Machine {
    /// Calls a method of any Java library value.
    pub(crate) fn library_method(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        if let Some(unknown) = Self::unknown_contents(receiver) {
            return self.of_unknown_contents(receiver, name, arguments, unknown);
        }
        if let Some(value) = self.run_by_library(receiver, name, arguments)? {
            return Ok(value);
        }
        if let (Value::List(_) | Value::Map(_), "stream", []) = (receiver, name, arguments) {
            return Ok(Self::stream_of(StreamKind::Object, receiver.clone()));
        }
        let result = match receiver {
            Value::Text(text) => {
                if let Some(unknown) =
                    arguments.iter().find(|argument| argument.unknown().is_some())
                {
                    return Ok(unknown.clone());
                }
                let text = Rc::clone(text);
                self.of_string(&text, name, arguments)?
            }
            Value::Builder(_) => self.of_builder(receiver, name, arguments)?,
            Value::List(list) => {
                let list = Rc::clone(list);
                self.of_list(&list, name, arguments)?
            }
            Value::Map(map) => {
                let map = Rc::clone(map);
                if map.borrow().is_set {
                    self.of_set(receiver, &map, name, arguments)?
                } else {
                    self.of_map(receiver, &map, name, arguments)?
                }
            }
            Value::Stream(stream) => {
                let stream = Rc::clone(stream);
                self.of_stream(&stream, name, arguments)?
            }
            Value::Optional(optional) => {
                let optional = Rc::clone(optional);
                self.of_optional(&optional, name, arguments)?
            }
            Value::Iterator(iteration) => {
                let iteration = Rc::clone(iteration);
                self.of_iterator(&iteration, name, arguments)?
            }
            Value::Cell(value) => {
                let value = Rc::clone(value);
                self.of_cell(&value, name, arguments)?
            }
            Value::Exception(thrown) => match (name, arguments) {
                ("getMessage" | "getLocalizedMessage", []) => Some(match &thrown.value {
                    Value::Object(_) => self.unknown("the message of an exception"),
                    message => message.clone(),
                }),
                ("printStackTrace" | "initCause" | "getCause", _) => Some(Value::Null),
                _ => None,
            },
            Value::Array(array) => match (name, arguments) {
                ("clone", []) => {
                    let values = RefCell::new(array.values.borrow().clone());
                    let element = array.element.clone();
                    Some(Value::Array(Rc::new(Array { element, values })))
                }
                _ => None,
            },
            _ => Self::of_any(receiver, name, arguments),
        };
        match result {
            Some(value) => Ok(value),
            None => match (name, arguments) {
                ("equals", [other]) => Ok(match self.are_equal(receiver, other)? {
                    Ok(is_equal) => Value::Boolean(is_equal),
                    Err(unknown) => Value::Unknown(unknown),
                }),
                ("toString", []) => {
                    Ok(self.text_of(receiver)?.map_or_else(Value::Unknown, Value::text))
                }
                ("hashCode", []) => Ok(self.unknown("a hash code")),
                ("getClass", []) => Ok(self.unknown("the class of an object")),
                _ => self.unmodelled(receiver, name, arguments),
            },
        }
    }

    /// Calls a method of a collection or a builder with unknown contents.
    fn of_unknown_contents(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
        unknown: Rc<Unknown>,
    ) -> Result<Value, EvaluationStop> {
        match (receiver, name, arguments) {
            (Value::Builder(text), "setLength", [Value::Int(0)]) => {
                self.java.changes += 1;
                *text.borrow_mut() = Ok(String::new());
                Ok(Value::Null)
            }
            (
                Value::Builder(_),
                "append" | "insert" | "delete" | "deleteCharAt" | "replace" | "reverse"
                | "appendCodePoint",
                _,
            ) => Ok(receiver.clone()),
            (Value::List(list), "clear", []) if list.view.borrow().is_none() => {
                self.java.changes += 1;
                list.renew(Vec::new());
                Ok(Value::Null)
            }
            (Value::Map(map), "clear", []) => {
                self.java.changes += 1;
                let mut map = map.borrow_mut();
                map.entries.clear();
                map.unknown = None;
                Ok(Value::Null)
            }
            _ => {
                self.check_not_run(name, arguments)?;
                Ok(Value::Unknown(unknown))
            }
        }
    }

    /// Calls a method of a boxed number.
    fn of_any(receiver: &Value, name: &str, arguments: &[Value]) -> Option<Value> {
        use crate::java_math::primitive;
        Some(match (name, arguments) {
            ("intValue", []) => receiver.clone().cast_to(&primitive("int")),
            ("longValue", []) => receiver.clone().cast_to(&primitive("long")),
            ("doubleValue", []) => receiver.clone().cast_to(&primitive("double")),
            ("floatValue", []) => receiver.clone().cast_to(&primitive("float")),
            ("booleanValue" | "charValue", []) => receiver.clone(),
            ("compareTo", [Value::Char(other)]) => match receiver {
                Value::Char(character) => Value::Int(i32::from(*character) - i32::from(*other)),
                _ => return None,
            },
            ("compareTo", [other]) => match (receiver.number(), other.number()) {
                (Some(a), Some(b)) => Value::Int(a.total_cmp(&b) as i32),
                _ => return None,
            },
            ("isNaN", []) => Value::Boolean(receiver.number().is_some_and(f64::is_nan)),
            _ => return None,
        })
    }

    fn of_cell(
        &mut self,
        cell: &Rc<RefCell<Value>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let old = cell.borrow().clone();
        let (new, is_old) = match (name, arguments) {
            ("get" | "intValue", []) => return Ok(Some(old)),
            ("set" | "getAndSet", [value]) => (value.clone(), true),
            ("incrementAndGet", []) => (self.sum(&old, 1)?, false),
            ("decrementAndGet", []) => (self.sum(&old, -1)?, false),
            ("getAndIncrement", []) => (self.sum(&old, 1)?, true),
            ("getAndDecrement", []) => (self.sum(&old, -1)?, true),
            _ => return Ok(None),
        };
        self.java.changes += u64::from(!old.is_same(&new));
        *cell.borrow_mut() = new.clone();
        Ok(Some(if is_old { old } else { new }))
    }

    fn sum(&mut self, value: &Value, by: i32) -> Result<Value, EvaluationStop> {
        self.binary(crate::syntax::BinaryOperator::Add, value, &Value::Int(by))
    }

    /// Evaluates `Arrays.name(...)`, `Collections.name(...)` or `Objects.name(...)`; `None` if it
    /// is not modelled.
    pub(crate) fn of_collections(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        if class != "Collections" {
            return self.of_arrays(class, name, arguments);
        }
        match self.reordered(name, arguments)? {
            Some(value) => Ok(Some(value)),
            None => self.of_collections_class(name, arguments),
        }
    }

    /// Evaluates `Arrays.name(...)`, `List.of(...)` or `Objects.name(...)`; `None` if it is not
    /// modelled.
    fn of_arrays(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(Some(match (class, name, arguments) {
            ("Arrays", "asList", [Value::Array(array)]) if !is_primitive(&array.element) => {
                let values = array.values.borrow().clone();
                List::view(View::Array(Rc::clone(array)), values)
            }
            ("Arrays", "asList", values) => {
                // A view of a new array: its length cannot change.
                let Value::Array(array) = Value::array("Object", values.to_vec()) else {
                    return Ok(None);
                };
                List::view(View::Array(array), values.to_vec())
            }
            ("List", "of", values) => {
                Value::List(Rc::new(List::new(ListKind::Immutable, values.to_vec())))
            }
            ("Arrays", "fill", [Value::Array(array), value]) => {
                self.java.changes += 1;
                let value = value.clone().converted_to(&array.element);
                array.values.borrow_mut().fill(value);
                Value::Null
            }
            ("Arrays", "copyOf", [Value::Array(array), Value::Int(length)]) => {
                let length = usize::try_from(*length).unwrap_or(0).min(MAX_ELEMENTS);
                let mut values = array.values.borrow().clone();
                values.resize(length, Value::default_of(&array.element));
                let element = array.element.clone();
                Value::Array(Rc::new(Array { element, values: RefCell::new(values) }))
            }
            ("Arrays", "toString", [Value::Array(array)]) => {
                let values = array.values.borrow().clone();
                self.text_of_elements(&values)?.map_or_else(Value::Unknown, Value::text)
            }
            ("Arrays", "equals", [Value::Array(a), Value::Array(b)]) => {
                let [a, b] = [a, b].map(|list| Value::list(list.values.borrow().clone()));
                match self.are_equal(&a, &b)? {
                    Ok(is_equal) => Value::Boolean(is_equal),
                    Err(unknown) => Value::Unknown(unknown),
                }
            }
            (
                "Arrays",
                "copyOfRange",
                [Value::Array(array), Value::Int(begin), Value::Int(end)],
            ) => {
                let length = array.values.borrow().len();
                let begin = self.index(&Value::Int(*begin), length + 1)?;
                let end = usize::try_from(*end).unwrap_or(0).min(MAX_ELEMENTS);
                if end < begin {
                    return self.throw("IllegalArgumentException", "of a range of an array");
                }
                let mut values: Vec<_> =
                    array.values.borrow().iter().skip(begin).take(end - begin).cloned().collect();
                values.resize(end - begin, Value::default_of(&array.element));
                let element = array.element.clone();
                Value::Array(Rc::new(Array { element, values: RefCell::new(values) }))
            }
            ("Arrays", "sort", [Value::Array(array), rest @ ..]) if rest.len() != 2 => {
                let length = array.values.borrow().len();
                let (begin, end, comparator) = match rest {
                    [] => (0, length, None),
                    [comparator] => (0, length, Some(comparator)),
                    [begin, end, others @ ..] => (
                        self.index(begin, length + 1)?,
                        self.index(end, length + 1)?,
                        others.first(),
                    ),
                };
                self.sort_array(array, begin, end, comparator)?
            }
            ("Arrays", "sort", [Value::Array(array), begin, end]) => {
                let length = array.values.borrow().len();
                let [begin, end] = [self.index(begin, length + 1)?, self.index(end, length + 1)?];
                self.sort_array(array, begin, end, None)?
            }
            ("Arrays", "setAll", [Value::Array(array), function])
                if matches!(function, Value::Function(_) | Value::Object(_)) =>
            {
                let array = Rc::clone(array);
                self.set_all(&array, function)?
            }
            ("Arrays", "stream", [Value::Array(array)]) => {
                let kind = StreamKind::of_element(&array.element.name);
                let kind = kind.filter(|_| array.element.dimensions == 0);
                Self::stream_of(kind.unwrap_or(StreamKind::Object), arguments[0].clone())
            }
            ("Objects", "isNull", [value]) if value.unknown().is_none() => {
                Value::Boolean(matches!(value, Value::Null))
            }
            ("Objects", "nonNull", [value]) if value.unknown().is_none() => {
                Value::Boolean(!matches!(value, Value::Null))
            }
            ("Objects", "equals", [a, b]) => match self.are_equal(a, b)? {
                Ok(is_equal) => Value::Boolean(is_equal),
                Err(unknown) => Value::Unknown(unknown),
            },
            ("Objects", "requireNonNull", [value, ..]) => value.clone(),
            _ => return Ok(None),
        }))
    }

    /// Calls a method of `Collections` that orders or replaces elements.
    fn reordered(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(Some(match (name, arguments) {
            ("sort", [Value::List(list), rest @ ..]) => {
                let values = list.borrow().clone();
                match self.sorted(values, rest.first())? {
                    Ok(values) => self.replace_elements(list, values)?,
                    Err(unknown) => self.spoil(&arguments[0], &unknown),
                }
                Value::Null
            }
            ("max" | "min", [values, rest @ ..]) => {
                let Some(values) = Self::iterated(values) else { return Ok(None) };
                match self.extreme(values, rest.first(), name == "max", false)? {
                    Err(unknown) => Value::Unknown(unknown),
                    Ok(Some(value)) => value,
                    Ok(None) => {
                        return self.throw("NoSuchElementException", "a collection is empty");
                    }
                }
            }
            ("reverse", [Value::List(list)]) => {
                let values = list.borrow().iter().rev().cloned().collect();
                self.replace_elements(list, values)?;
                Value::Null
            }
            ("swap", [Value::List(list), a, b]) => {
                let length = list.borrow().len();
                let [a, b] = [self.index(a, length)?, self.index(b, length)?];
                let mut values = list.borrow().clone();
                values.swap(a, b);
                self.replace_elements(list, values)?;
                Value::Null
            }
            ("rotate", [Value::List(list), Value::Int(distance)]) => {
                let mut values = list.borrow().clone();
                if let Ok(length) = i64::try_from(values.len())
                    && length > 0
                {
                    let by = i64::from(*distance).rem_euclid(length);
                    values.rotate_right(usize::try_from(by).unwrap_or(0));
                }
                self.replace_elements(list, values)?;
                Value::Null
            }
            ("fill", [Value::List(list), value]) => {
                let values = vec![value.clone(); list.borrow().len()];
                self.replace_elements(list, values)?;
                Value::Null
            }
            ("shuffle", [Value::List(list), ..]) => {
                let unknown = self.unknown("a random order");
                let values = vec![unknown; list.borrow().len()];
                self.replace_elements(list, values)?;
                Value::Null
            }
            _ => return Ok(None),
        }))
    }

    /// Calls another method of `Collections`.
    fn of_collections_class(
        &mut self,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(Some(match (name, arguments) {
            ("reverseOrder", []) => self.reverse_order(),
            ("reverseOrder", [comparator]) if !matches!(comparator, Value::Null) => {
                self.library_function(Combined::Reversed(comparator.clone()))
            }
            ("nCopies", [Value::Int(count), value]) => {
                let count = usize::try_from(*count).unwrap_or(0).min(MAX_ELEMENTS);
                Value::list(vec![value.clone(); count])
            }
            ("frequency", [values, value]) => {
                let Some(values) = Self::iterated(values) else { return Ok(None) };
                let mut count = 0;
                for other in values {
                    match self.are_equal(value, &other)? {
                        Ok(is_equal) => count += i32::from(is_equal),
                        Err(unknown) => return Ok(Some(Value::Unknown(unknown))),
                    }
                }
                Value::Int(count)
            }
            ("addAll", [list, values @ ..]) => {
                let mut is_changed = false;
                for value in values {
                    let added = self.call_on(list, "add", std::slice::from_ref(value))?;
                    is_changed |= matches!(added, Value::Boolean(true));
                }
                Value::Boolean(is_changed)
            }
            ("singletonList" | "singleton", [value]) => Value::list(vec![value.clone()]),
            ("emptyList", []) => Value::list(Vec::new()),
            (_, [Value::List(list)]) if name.starts_with("unmodifiable") => {
                let values = list.borrow().clone();
                let view = List::view(View::Whole(Rc::clone(list)), values);
                self.refresh(&view);
                view
            }
            (_, [value]) if name.starts_with("synchronized") => value.clone(),
            _ => return Ok(None),
        }))
    }

    fn sort_array(
        &mut self,
        array: &Rc<Array>,
        begin: usize,
        end: usize,
        comparator: Option<&Value>,
    ) -> Result<Value, EvaluationStop> {
        let part = array.values.borrow().get(begin..end).map(<[Value]>::to_vec);
        let Some(part) = part else {
            return self.throw("IllegalArgumentException", "of a range of an array");
        };
        self.java.changes += 1;
        match self.sorted(part, comparator)? {
            Ok(part) => {
                array.values.borrow_mut().splice(begin..end, part);
            }
            Err(unknown) => self.spoil(&Value::Array(Rc::clone(array)), &unknown),
        }
        Ok(Value::Null)
    }
}
