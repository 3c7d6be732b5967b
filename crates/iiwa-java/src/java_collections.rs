//! Lists, maps, sets and arrays.

use std::{cell::RefCell, cmp::Ordering, rc::Rc};

use crate::{
    machine::Machine,
    stop::Stop,
    value::{Array, Map, MapOrder, Value},
};

/// Elements of a collection: more would fill memory, and no program has them.
const MAX_ELEMENTS: usize = 1_000_000;

impl Machine {
    /// A method of a value of Java's own.
    pub(crate) fn call_library(
        &mut self,
        receiver: &Value,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, Stop> {
        let found = match receiver {
            Value::Text(text) => {
                if let Some(unknown) = arguments.iter().find(|own| own.unknown().is_some()) {
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
            Value::Iterator(left) => match (name, arguments) {
                ("hasNext", []) => Some(Value::Boolean(!left.borrow().is_empty())),
                ("next", []) => {
                    self.java.changes += 1;
                    let next = left.borrow_mut().pop();
                    match next {
                        Some(value) => Some(value),
                        None => {
                            return self
                                .throw("NoSuchElementException", "an iterator is at its end");
                        }
                    }
                }
                _ => None,
            },
            Value::Cell(value) => {
                let value = Rc::clone(value);
                self.of_cell(&value, name, arguments)?
            }
            Value::Exception(thrown) => match (name, arguments) {
                ("getMessage" | "getLocalizedMessage", []) => Some(Value::text(&thrown.message)),
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
        match found {
            Some(value) => Ok(value),
            None => match (name, arguments) {
                ("equals", [other]) => Ok(Value::Boolean(receiver.is_same(other))),
                ("toString", []) => {
                    Ok(self.text_of(receiver)?.map_or_else(Value::Unknown, Value::text))
                }
                ("hashCode", []) => Ok(self.unknown("a hash code")),
                ("getClass", []) => Ok(self.unknown("the class of an object")),
                _ => Ok(self.unknown(format!(
                    "the result of `{name}` of {}, which is not known",
                    receiver.kind()
                ))),
            },
        }
    }

    /// Of boxed numbers.
    fn of_any(receiver: &Value, name: &str, arguments: &[Value]) -> Option<Value> {
        use crate::java_math::primitive;
        Some(match (name, arguments) {
            ("intValue", []) => receiver.clone().cast_to(&primitive("int")),
            ("longValue", []) => receiver.clone().cast_to(&primitive("long")),
            ("doubleValue", []) => receiver.clone().cast_to(&primitive("double")),
            ("floatValue", []) => receiver.clone().cast_to(&primitive("float")),
            ("booleanValue" | "charValue", []) => receiver.clone(),
            ("equals", [other]) => Value::Boolean(receiver.is_same(other)),
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
    ) -> Result<Option<Value>, Stop> {
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

    fn sum(&mut self, value: &Value, by: i32) -> Result<Value, Stop> {
        self.binary(crate::syntax::BinaryOperator::Add, value, &Value::Int(by))
    }

    fn of_list(
        &mut self,
        list: &Rc<RefCell<Vec<Value>>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop> {
        if list.borrow().len() > MAX_ELEMENTS {
            return self.refuse("a list has more than a million elements");
        }
        let is_change = ["add", "push", "pop", "remove", "clear", "set", "poll", "offer"];
        if is_change.iter().any(|beginning| name.starts_with(beginning)) {
            self.java.changes += 1;
            return self.change_list(list, name, arguments);
        }
        let length = list.borrow().len();
        Ok(Some(match (name, arguments) {
            ("size", []) => Value::Int(i32::try_from(length).unwrap_or(i32::MAX)),
            ("isEmpty" | "empty", []) => Value::Boolean(length == 0),
            ("get" | "elementAt", [index]) => {
                if let Value::Unknown(_) = index {
                    return Ok(Some(index.clone()));
                }
                let index = self.index(index, length)?;
                let value = list.borrow().get(index).cloned();
                value.unwrap_or(Value::Null)
            }
            ("getFirst" | "firstElement" | "element", []) => match list.borrow().first() {
                Some(value) => value.clone(),
                None => return self.empty_list(),
            },
            ("getLast" | "lastElement" | "peek", []) => match list.borrow().last() {
                Some(value) => value.clone(),
                None if name == "peek" => Value::Null,
                None => return self.empty_list(),
            },
            // Of an entry of a map.
            ("getKey", []) if length == 2 => list.borrow()[0].clone(),
            ("getValue", []) if length == 2 => list.borrow()[1].clone(),
            ("contains", [value]) => Value::Boolean(self.list_place(list, value)?.is_some()),
            ("indexOf", [value]) => {
                let place = self.list_place(list, value)?;
                Value::Int(place.and_then(|place| i32::try_from(place).ok()).unwrap_or(-1))
            }
            ("iterator", []) => {
                let left = list.borrow().iter().rev().cloned().collect();
                Value::Iterator(Rc::new(RefCell::new(left)))
            }
            ("toArray", _) => Value::array("Object", list.borrow().clone()),
            ("subList", [begin, end]) => {
                let [begin, end] = [self.index(begin, length + 1)?, self.index(end, length + 1)?];
                let part = list.borrow().get(begin..end).map(<[Value]>::to_vec);
                match part {
                    Some(values) => Value::list(values),
                    None => return self.throw("IndexOutOfBoundsException", "of a list's part"),
                }
            }

            _ => return Ok(None),
        }))
    }

    /// A method that changes a list.
    fn change_list(
        &mut self,
        list: &Rc<RefCell<Vec<Value>>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop> {
        let length = list.borrow().len();
        Ok(Some(match (name, arguments) {
            ("add" | "addLast" | "offer" | "addElement" | "put" | "offerLast", [value]) => {
                list.borrow_mut().push(value.clone());
                Value::Boolean(true)
            }
            ("push", [value]) => {
                list.borrow_mut().push(value.clone());
                value.clone()
            }
            ("addFirst" | "offerFirst", [value]) => {
                list.borrow_mut().insert(0, value.clone());
                Value::Null
            }
            ("add", [index, value]) => {
                let index = self.index(index, length + 1)?;
                list.borrow_mut().insert(index, value.clone());
                Value::Null
            }
            ("addAll", [values]) => match Self::iterated(values) {
                Some(values) => {
                    list.borrow_mut().extend(values);
                    Value::Boolean(true)
                }
                None => return Ok(None),
            },
            ("set", [index, value]) => {
                let index = self.index(index, length)?;
                std::mem::replace(&mut list.borrow_mut()[index], value.clone())
            }
            ("remove", [Value::Int(index)]) => {
                let index = self.index(&Value::Int(*index), length)?;
                list.borrow_mut().remove(index)
            }
            ("remove", [value]) => {
                let place = self.list_place(list, value)?;
                if let Some(place) = place {
                    list.borrow_mut().remove(place);
                }
                Value::Boolean(place.is_some())
            }
            ("remove" | "removeFirst", []) => {
                if length == 0 {
                    return self.empty_list();
                }
                list.borrow_mut().remove(0)
            }
            ("poll" | "pollFirst", []) => {
                if length == 0 {
                    Value::Null
                } else {
                    list.borrow_mut().remove(0)
                }
            }
            ("pop" | "removeLast", []) => match list.borrow_mut().pop() {
                Some(value) => value,
                None => return self.empty_list(),
            },
            ("clear", []) => {
                list.borrow_mut().clear();
                Value::Null
            }
            _ => return Ok(None),
        }))
    }

    /// What is thrown where a list has nothing to give.
    fn empty_list<T>(&self) -> Result<T, Stop> {
        self.throw("NoSuchElementException", "a list is empty")
    }

    fn list_place(
        &mut self,
        list: &Rc<RefCell<Vec<Value>>>,
        value: &Value,
    ) -> Result<Option<usize>, Stop> {
        let values = list.borrow().clone();
        for (place, other) in values.iter().enumerate() {
            if self.are_equal(other, value)? {
                return Ok(Some(place));
            }
        }
        Ok(None)
    }

    /// `equals`; what is unknown equals nothing.
    fn are_equal(&mut self, a: &Value, b: &Value) -> Result<bool, Stop> {
        if let Value::Object(object) = a {
            let own = self.java.classes.methods(object.class, "equals");
            if !own.is_empty() {
                let value = self.call_on_object(object, "equals", std::slice::from_ref(b))?;
                return Ok(matches!(value, Value::Boolean(true)));
            }
        }
        Ok(a.is_same(b))
    }

    fn of_set(
        &mut self,
        receiver: &Value,
        set: &Rc<RefCell<Map>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop> {
        let key = arguments.first().cloned().unwrap_or(Value::Null);
        Ok(Some(match name {
            "add" => {
                let is_new = self.key_place(set, &key)?.is_none();
                if is_new {
                    self.java.changes += 1;
                    set.borrow_mut().entries.push((key, Value::Null));
                }
                Value::Boolean(is_new)
            }
            "addAll" => {
                for value in Self::iterated(&key).unwrap_or_default() {
                    self.of_set(receiver, set, "add", &[value])?;
                }
                Value::Boolean(true)
            }
            "contains" => Value::Boolean(self.key_place(set, &key)?.is_some()),
            "iterator" => match Self::iterated(receiver) {
                Some(mut values) => {
                    values.reverse();
                    Value::Iterator(Rc::new(RefCell::new(values)))
                }
                None => return Ok(None),
            },
            _ => return self.of_map(receiver, set, name, arguments),
        }))
    }

    fn of_map(
        &mut self,
        receiver: &Value,
        map: &Rc<RefCell<Map>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop> {
        let length = map.borrow().entries.len();
        Ok(Some(match (name, arguments) {
            ("size", []) => Value::Int(i32::try_from(length).unwrap_or(i32::MAX)),
            ("isEmpty", []) => Value::Boolean(length == 0),
            ("put", [key, value]) => {
                if length > MAX_ELEMENTS {
                    return self.refuse("a map has more than a million entries");
                }
                self.java.changes += 1;
                if let Some(place) = self.key_place(map, key)? {
                    let entries = &mut map.borrow_mut().entries;
                    std::mem::replace(&mut entries[place].1, value.clone())
                } else {
                    map.borrow_mut().entries.push((key.clone(), value.clone()));
                    Value::Null
                }
            }
            ("get" | "getOrDefault", [key, rest @ ..]) => match self.key_place(map, key)? {
                Some(place) => map.borrow().entries[place].1.clone(),
                None => rest.first().cloned().unwrap_or(Value::Null),
            },
            ("containsKey", [key]) => Value::Boolean(self.key_place(map, key)?.is_some()),
            ("remove", [key]) => match self.key_place(map, key)? {
                Some(place) => {
                    self.java.changes += 1;
                    map.borrow_mut().entries.remove(place).1
                }
                None => Value::Null,
            },
            ("clear", []) => {
                self.java.changes += 1;
                map.borrow_mut().entries.clear();
                Value::Null
            }
            ("keySet", []) => match Self::iterated(receiver) {
                Some(keys) => Value::list(keys),
                None => return Ok(None),
            },
            ("values", []) => match Self::ordered_entries(map) {
                Some(entries) => Value::list(entries.into_iter().map(|(_, value)| value).collect()),
                None => return Ok(None),
            },
            ("entrySet", []) => match Self::ordered_entries(map) {
                Some(entries) => Value::list(
                    entries.into_iter().map(|(key, value)| Value::list(vec![key, value])).collect(),
                ),
                None => return Ok(None),
            },
            _ => return Ok(None),
        }))
    }

    fn key_place(&mut self, map: &Rc<RefCell<Map>>, key: &Value) -> Result<Option<usize>, Stop> {
        let count = map.borrow().entries.len();
        for place in 0..count {
            let other = map.borrow().entries.get(place).map(|(other, _)| other.clone());
            if let Some(other) = other
                && self.are_equal(&other, key)?
            {
                return Ok(Some(place));
            }
        }
        Ok(None)
    }

    /// What a loop goes through, in order; none if that has none.
    pub(crate) fn iterated(values: &Value) -> Option<Vec<Value>> {
        match values {
            Value::Map(map) => {
                let map = Rc::clone(map);
                Some(Self::ordered_entries(&map)?.into_iter().map(|(key, _)| key).collect())
            }
            other => other.elements(),
        }
    }

    /// The entries of a map in the order in which Java goes through them; none where that depends on hashes that are not
    /// known.
    fn ordered_entries(map: &Rc<RefCell<Map>>) -> Option<Vec<(Value, Value)>> {
        let mut entries = map.borrow().entries.clone();
        match map.borrow().order {
            MapOrder::Linked => {}
            MapOrder::Sorted => entries.sort_by(|(a, _), (b, _)| compared(a, b)),
            MapOrder::Hashed if entries.len() <= 1 => {}
            MapOrder::Hashed => {
                // As in a `HashMap`: by buckets, in which entries are in the order of insertion.
                let buckets = (entries.len() * 4).div_ceil(3).max(16).next_power_of_two();
                let hashes: Option<Vec<usize>> =
                    entries.iter().map(|(key, _)| bucket(key, buckets)).collect();
                let mut both: Vec<_> = hashes?.into_iter().zip(entries).collect();
                both.sort_by_key(|(bucket, _)| *bucket);
                entries = both.into_iter().map(|(_, entry)| entry).collect();
            }
        }
        Some(entries)
    }

    /// `Arrays.name(...)`, `Collections.name(...)`, `Objects.name(...)`; none if it is not known.
    pub(crate) fn of_collections(
        &mut self,
        class: &str,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop> {
        Ok(Some(match (class, name, arguments) {
            ("Arrays", "asList", [Value::Array(array)]) if array.element.name != "double" => {
                Value::list(array.values.borrow().clone())
            }
            ("Arrays", "asList", values) | ("List", "of", values) => Value::list(values.to_vec()),
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
                let (a, b) = (a.values.borrow(), b.values.borrow());
                let equal = a.len() == b.len() && a.iter().zip(&*b).all(|(a, b)| a.is_same(b));
                Value::Boolean(equal)
            }
            ("Arrays", "sort", [Value::Array(array)]) => {
                self.java.changes += 1;
                array.values.borrow_mut().sort_by(compared);
                Value::Null
            }
            ("Collections", "sort", [Value::List(list)])
                if list.borrow().iter().all(|own| !matches!(own, Value::Object(_))) =>
            {
                self.java.changes += 1;
                list.borrow_mut().sort_by(compared);
                Value::Null
            }
            ("Collections", "reverse", [Value::List(list)]) => {
                self.java.changes += 1;
                list.borrow_mut().reverse();
                Value::Null
            }
            ("Collections", "shuffle", [Value::List(list)]) => {
                let unknown = self.unknown("a random order");
                list.borrow_mut().fill(unknown);
                Value::Null
            }
            ("Collections", "addAll", [Value::List(list), values @ ..]) => {
                self.java.changes += 1;
                list.borrow_mut().extend(values.iter().cloned());
                Value::Boolean(true)
            }
            ("Collections", "emptyList", []) => Value::list(Vec::new()),
            ("Collections", _, [value])
                if name.starts_with("unmodifiable") || name.starts_with("synchronized") =>
            {
                value.clone()
            }
            ("Objects", "equals", [a, b]) => Value::Boolean(self.are_equal(a, b)?),
            ("Objects", "requireNonNull", [value, ..]) => value.clone(),
            _ => return Ok(None),
        }))
    }
}

/// The natural order of numbers and strings.
fn compared(a: &Value, b: &Value) -> Ordering {
    match (a, b) {
        (Value::Text(a), Value::Text(b)) => a.cmp(b),
        (Value::Object(a), Value::Object(b)) => {
            let ordinal = |object: &crate::value::Object| object.constant.as_ref().map(|own| own.1);
            ordinal(a).cmp(&ordinal(b))
        }
        _ => match (a.number(), b.number()) {
            (Some(a), Some(b)) => a.total_cmp(&b),
            _ => Ordering::Equal,
        },
    }
}

/// The bucket of a `HashMap` in which a key is; none if its hash is not known.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "as Java does")]
fn bucket(key: &Value, buckets: usize) -> Option<usize> {
    let hash = match key {
        Value::Text(text) => text
            .encode_utf16()
            .fold(0_u32, |hash, unit| hash.wrapping_mul(31).wrapping_add(u32::from(unit))),
        Value::Int(value) => *value as u32,
        Value::Char(code) => u32::from(*code),
        Value::Long(value) => (*value ^ (*value >> 32)) as u32,
        Value::Boolean(value) => {
            if *value {
                1231
            } else {
                1237
            }
        }
        _ => return None,
    };
    Some((hash ^ (hash >> 16)) as usize & (buckets - 1))
}
