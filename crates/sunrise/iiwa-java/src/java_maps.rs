//! Methods of maps and sets.

use std::{cell::RefCell, cmp::Ordering, rc::Rc};

use crate::{
    java_collections::MAX_ELEMENTS,
    java_lists::set_iterator,
    java_sorting::{Known, natural},
    machine::Machine,
    stop::EvaluationStop,
    unknown::Unknown,
    value::{List, Map, MapOrder, MapPart, Value, View},
};

impl Machine {
    /// Calls a method of a set; `None` if it is not modelled.
    pub(crate) fn of_set(
        &mut self,
        receiver: &Value,
        set: &Rc<RefCell<Map>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        Ok(Some(match (name, arguments) {
            ("add", [key]) => match self.key_place(set, key)? {
                Ok(place) => {
                    if place.is_none() {
                        self.java.changes += 1;
                        set.borrow_mut().entries.push((key.clone(), Value::Null));
                    }
                    Value::Boolean(place.is_none())
                }
                Err(unknown) => self.spoiled(receiver, unknown),
            },
            ("addAll", [values]) => {
                let Some(values) = Self::iterated(values) else { return Ok(None) };
                let mut is_changed = false;
                for value in values {
                    match self.of_set(receiver, set, "add", &[value])? {
                        Some(Value::Boolean(is_new)) => is_changed |= is_new,
                        other => return Ok(other),
                    }
                }
                Value::Boolean(is_changed)
            }
            ("remove", [key]) => match self.key_place(set, key)? {
                Ok(place) => {
                    if let Some(place) = place {
                        self.java.changes += 1;
                        set.borrow_mut().entries.remove(place);
                    }
                    Value::Boolean(place.is_some())
                }
                Err(unknown) => self.spoiled(receiver, unknown),
            },
            ("removeAll" | "retainAll", [others]) => {
                let Some(others) = Self::iterated(others) else { return Ok(None) };
                let keys: Vec<_> =
                    set.borrow().entries.iter().map(|(key, _)| key.clone()).collect();
                let count = keys.len();
                let mut kept = Vec::new();
                for key in keys {
                    match self.place_of(&others, &key)? {
                        Ok(place) if place.is_some() == (name == "retainAll") => {
                            kept.push((key, Value::Null));
                        }
                        Ok(_) => {}
                        Err(unknown) => return Ok(Some(self.spoiled(receiver, unknown))),
                    }
                }
                self.java.changes += 1;
                let is_changed = kept.len() != count;
                set.borrow_mut().entries = kept;
                Value::Boolean(is_changed)
            }
            ("contains", [key]) => match self.key_place(set, key)? {
                Ok(place) => Value::Boolean(place.is_some()),
                Err(unknown) => Value::Unknown(unknown),
            },
            ("iterator", []) => match Self::iterated(receiver) {
                Some(keys) => set_iterator(set, keys),
                None => self.without_order("a set"),
            },
            ("toArray", []) => match Self::iterated(receiver) {
                Some(keys) => Value::array("Object", keys),
                None => self.without_order("a set"),
            },
            ("first" | "last", []) => match Self::iterated(receiver) {
                Some(keys) => {
                    let key = if name == "first" { keys.first() } else { keys.last() };
                    match key {
                        Some(key) => key.clone(),
                        None => return self.throw("NoSuchElementException", "a set is empty"),
                    }
                }
                None => self.without_order("a set"),
            },
            ("size" | "isEmpty" | "clear", []) => {
                return self.of_map(receiver, set, name, arguments);
            }
            _ => return Ok(None),
        }))
    }

    /// Calls a method of a map; `None` if it is not modelled.
    pub(crate) fn of_map(
        &mut self,
        receiver: &Value,
        map: &Rc<RefCell<Map>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let length = map.borrow().entries.len();
        Ok(Some(match (name, arguments) {
            ("size", []) => Value::Int(i32::try_from(length).unwrap_or(i32::MAX)),
            ("isEmpty", []) => Value::Boolean(length == 0),
            ("put" | "putIfAbsent", [key, value]) => {
                if length > MAX_ELEMENTS {
                    return self.reject("a map has more than a million entries");
                }
                match self.key_place(map, key)? {
                    Ok(Some(place)) => {
                        self.java.changes += 1;
                        let entries = &mut map.borrow_mut().entries;
                        let stored = &mut entries[place].1;
                        if name == "put" || matches!(stored, Value::Null) {
                            std::mem::replace(stored, value.clone())
                        } else {
                            stored.clone()
                        }
                    }
                    Ok(None) => {
                        self.java.changes += 1;
                        map.borrow_mut().entries.push((key.clone(), value.clone()));
                        Value::Null
                    }
                    Err(unknown) => self.spoiled(receiver, unknown),
                }
            }
            ("putAll", [Value::Map(other)]) => {
                if let Some(unknown) = other.borrow().unknown.clone() {
                    return Ok(Some(self.spoiled(receiver, unknown)));
                }
                // The order is relevant only if the map keeps it.
                let keeps_order = map.borrow().order == MapOrder::Linked;
                let in_any = || (!keeps_order).then(|| other.borrow().entries.clone());
                let Some(entries) = Self::ordered_entries(other).or_else(in_any) else {
                    return Ok(None);
                };
                for (key, value) in entries {
                    self.of_map(receiver, map, "put", &[key, value])?;
                }
                Value::Null
            }
            ("get", [key]) | ("getOrDefault", [key, _]) => match self.key_place(map, key)? {
                Ok(Some(place)) => map.borrow().entries[place].1.clone(),
                Ok(None) => arguments.get(1).cloned().unwrap_or(Value::Null),
                Err(unknown) => Value::Unknown(unknown),
            },
            ("containsKey", [key]) => match self.key_place(map, key)? {
                Ok(place) => Value::Boolean(place.is_some()),
                Err(unknown) => Value::Unknown(unknown),
            },
            ("containsValue", [value]) => {
                let values: Vec<_> =
                    map.borrow().entries.iter().map(|(_, value)| value.clone()).collect();
                match self.place_of(&values, value)? {
                    Ok(place) => Value::Boolean(place.is_some()),
                    Err(unknown) => Value::Unknown(unknown),
                }
            }
            ("remove", [key]) => match self.key_place(map, key)? {
                Ok(Some(place)) => {
                    self.java.changes += 1;
                    map.borrow_mut().entries.remove(place).1
                }
                Ok(None) => Value::Null,
                Err(unknown) => self.spoiled(receiver, unknown),
            },
            ("clear", []) => {
                self.java.changes += 1;
                let mut map = map.borrow_mut();
                map.entries.clear();
                map.unknown = None;
                Value::Null
            }
            ("firstKey" | "lastKey", []) => match Self::ordered_entries(map) {
                Some(entries) => {
                    let entry = if name == "firstKey" { entries.first() } else { entries.last() };
                    match entry {
                        Some((key, _)) => key.clone(),
                        None => return self.throw("NoSuchElementException", "a map is empty"),
                    }
                }
                None => self.without_order("a map"),
            },
            ("keySet" | "values" | "entrySet", []) => {
                let part = match name {
                    "keySet" => MapPart::Keys,
                    "values" => MapPart::Values,
                    _ => MapPart::Entries,
                };
                match self.map_part(map, part) {
                    Ok(values) => List::view(View::Map(Rc::clone(map), part), values),
                    Err(unknown) => Value::Unknown(unknown),
                }
            }
            _ => return Ok(None),
        }))
    }

    /// Marks a collection as unknown, and returns the unknown result of the method.
    fn spoiled(&mut self, receiver: &Value, unknown: Rc<Unknown>) -> Value {
        self.spoil(receiver, &unknown);
        Value::Unknown(unknown)
    }

    fn without_order(&self, subject: &str) -> Value {
        self.unknown(format!("the order of {subject}, which depends on hashes or comparisons"))
    }

    /// Returns the keys, values or entries of a map, in order.
    pub(crate) fn map_part(&mut self, map: &Rc<RefCell<Map>>, part: MapPart) -> Known<Vec<Value>> {
        if let Some(unknown) = map.borrow().unknown.clone() {
            return Err(unknown);
        }
        let Some(entries) = Self::ordered_entries(map) else {
            return match self.without_order("a map") {
                Value::Unknown(unknown) => Err(unknown),
                _ => Ok(Vec::new()),
            };
        };
        let part_of = |(key, value): (Value, Value)| match part {
            MapPart::Keys => key,
            MapPart::Values => value,
            MapPart::Entries => Value::list(vec![key, value]),
        };
        Ok(entries.into_iter().map(part_of).collect())
    }

    /// Removes the entry at this position in the map's order.
    pub(crate) fn remove_entry(map: &Rc<RefCell<Map>>, place: usize) {
        let key = Self::ordered_entries(map).and_then(|entries| entries.into_iter().nth(place));
        if let Some((key, _)) = key {
            map.borrow_mut().entries.retain(|(entry_key, _)| !entry_key.is_equal(&key));
        }
    }

    pub(crate) fn key_place(
        &mut self,
        map: &Rc<RefCell<Map>>,
        key: &Value,
    ) -> Result<Known<Option<usize>>, EvaluationStop> {
        let is_plain = |value: &Value| {
            matches!(
                value,
                Value::Text(_)
                    | Value::Boolean(_)
                    | Value::Char(_)
                    | Value::Int(_)
                    | Value::Long(_)
            )
        };
        // These keys are compared without project methods.
        if is_plain(key) && map.borrow().entries.iter().all(|(entry_key, _)| is_plain(entry_key)) {
            return Ok(Ok(map
                .borrow()
                .entries
                .iter()
                .position(|(entry_key, _)| entry_key.is_equal(key))));
        }
        let keys: Vec<_> = map.borrow().entries.iter().map(|(key, _)| key.clone()).collect();
        self.place_of(&keys, key)
    }

    /// Returns the elements of an iteration, in order; `None` if their order is unknown.
    pub(crate) fn iterated(values: &Value) -> Option<Vec<Value>> {
        match values {
            Value::Map(map) if map.borrow().unknown.is_none() => {
                Some(Self::ordered_entries(map)?.into_iter().map(|(key, _)| key).collect())
            }
            Value::List(list) if list.unknown().is_none() => Some(list.borrow().clone()),
            Value::Array(array) => Some(array.values.borrow().clone()),
            _ => None,
        }
    }

    /// Returns the entries of a map in Java's iteration order; `None` if the order depends on
    /// unknown hashes.
    pub(crate) fn ordered_entries(map: &Rc<RefCell<Map>>) -> Option<Vec<(Value, Value)>> {
        let mut entries = map.borrow().entries.clone();
        match map.borrow().order {
            MapOrder::Linked => {}
            MapOrder::Sorted => {
                // Keys that only a project method can compare have an unknown order.
                let (first, others) = entries.split_first().unzip();
                let mut keys = others.into_iter().flatten().map(|(key, _)| key);
                if !keys.all(|key| first.is_some_and(|(first, _)| natural(first, key).is_some())) {
                    return None;
                }
                entries.sort_by(|(a, _), (b, _)| natural(a, b).unwrap_or(Ordering::Equal));
            }
            MapOrder::Hashed if entries.len() <= 1 => {}
            MapOrder::Hashed => {
                // Order of a `HashMap`: by buckets, with insertion order within each bucket.
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
}

/// Returns the `HashMap` bucket of a key; `None` if its hash is unknown.
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
