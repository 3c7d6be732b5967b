//! Methods of lists, stacks, queues and their iterators.

use std::{cell::RefCell, rc::Rc};

use crate::{
    java_collections::MAX_ELEMENTS,
    machine::Machine,
    stop::EvaluationStop,
    value::{Array, Iteration, List, ListKind, MapPart, Value, View},
};

impl Machine {
    /// Updates a list view from its source.
    pub(crate) fn refresh(&mut self, value: &Value) {
        let Value::List(list) = value else { return };
        let view = list.view.borrow().clone();
        match view {
            None => {}
            Some(View::Array(array)) => list.renew(array.values.borrow().clone()),
            Some(View::Whole(source)) => {
                self.refresh(&Value::List(Rc::clone(&source)));
                match source.unknown() {
                    Some(unknown) => list.spoil(&unknown),
                    None => list.renew(source.borrow().clone()),
                }
                list.structure.set(source.structure.get());
            }
            Some(View::Part { list: source, begin, length, whole }) => {
                self.refresh(&Value::List(Rc::clone(&source)));
                let part = source.borrow().get(begin..begin + length).map(<[Value]>::to_vec);
                match (source.unknown(), part) {
                    (Some(unknown), _) => list.spoil(&unknown),
                    (None, Some(part)) if source.borrow().len() == whole => list.renew(part),
                    _ => {
                        let unknown = self.unknown("a part of a list that was changed since");
                        if let Value::Unknown(unknown) = unknown {
                            list.spoil(&unknown);
                        }
                    }
                }
            }
            Some(View::Map(map, part)) => match self.map_part(&map, part) {
                Ok(values) => list.renew(values),
                Err(unknown) => list.spoil(&unknown),
            },
        }
    }

    /// Writes a change of a list view back to its source.
    fn write_back(&mut self, list: &Rc<List>) -> Result<(), EvaluationStop> {
        let view = list.view.borrow().clone();
        match view {
            None | Some(View::Whole(_)) => {}
            Some(View::Array(array)) => {
                if list.borrow().len() != array.values.borrow().len() {
                    return self.throw("UnsupportedOperationException", "of `Arrays.asList`");
                }
                array.values.borrow_mut().clone_from(&list.borrow());
            }
            Some(View::Part { list: source, begin, length, whole }) => {
                let values = list.borrow().clone();
                let now = values.len();
                if now != length {
                    source.count_change();
                }
                source.borrow_mut().splice(begin..begin + length, values);
                let whole = whole + now - length;
                *list.view.borrow_mut() =
                    Some(View::Part { list: Rc::clone(&source), begin, length: now, whole });
                self.write_back(&source)?;
            }
            Some(View::Map(..)) => {
                let unknown = self.unknown("a map that was changed by its keys or values");
                if let Value::Unknown(unknown) = unknown {
                    self.spoil(&Value::List(Rc::clone(list)), &unknown);
                }
            }
        }
        Ok(())
    }

    /// Replaces the elements of a list.
    pub(crate) fn replace_elements(
        &mut self,
        list: &Rc<List>,
        values: Vec<Value>,
    ) -> Result<(), EvaluationStop> {
        self.check_changeable(list)?;
        self.java.changes += 1;
        list.count_change();
        list.renew(values);
        self.write_back(list)
    }

    /// Throws if a list is immutable.
    fn check_changeable(&self, list: &List) -> Result<(), EvaluationStop> {
        if list.is_immutable() {
            return self.throw("UnsupportedOperationException", "the list cannot be changed");
        }
        Ok(())
    }

    /// Calls a method of a list; `None` if it is not modelled.
    pub(crate) fn of_list(
        &mut self,
        list: &Rc<List>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        if list.borrow().len() > MAX_ELEMENTS {
            return self.reject("a list has more than a million elements");
        }
        if let Some(value) = self.read_list(list, name, arguments)? {
            return Ok(Some(value));
        }
        if CHANGING.iter().any(|prefix| name.starts_with(prefix)) {
            self.check_changeable(list)?;
        }
        let Some((value, is_changed)) = self.change_list(list, name, arguments)? else {
            return Ok(None);
        };
        if is_changed {
            self.java.changes += 1;
            if name != "set" {
                list.count_change();
            }
            self.write_back(list)?;
        }
        Ok(Some(value))
    }

    fn read_list(
        &mut self,
        list: &Rc<List>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let length = list.borrow().len();
        let count = |number: usize| Value::Int(i32::try_from(number).unwrap_or(i32::MAX));
        let values = || list.borrow().clone();
        Ok(Some(match (name, arguments) {
            ("size", []) => count(length),
            ("isEmpty" | "empty", []) => Value::Boolean(length == 0),
            ("get" | "elementAt", [index]) => {
                if let Value::Unknown(_) = index {
                    return Ok(Some(index.clone()));
                }
                let index = self.index(index, length)?;
                let value = list.borrow().get(index).cloned();
                value.unwrap_or(Value::Null)
            }
            ("getFirst" | "firstElement" | "element", []) => match values().first() {
                Some(value) => value.clone(),
                None => return self.empty_list(),
            },
            ("getLast" | "lastElement", []) => match values().last() {
                Some(value) => value.clone(),
                None => return self.empty_list(),
            },
            ("peek", []) if list.kind == ListKind::Stack => match values().last() {
                Some(value) => value.clone(),
                None => return self.throw("EmptyStackException", "a stack is empty"),
            },
            ("peek" | "peekFirst", []) => values().first().cloned().unwrap_or(Value::Null),
            ("peekLast", []) => values().last().cloned().unwrap_or(Value::Null),
            // Methods of a map entry.
            ("getKey", []) if length == 2 => list.borrow()[0].clone(),
            ("getValue", []) if length == 2 => list.borrow()[1].clone(),
            ("setValue", [_]) => {
                return self.reject("`setValue` of a map's entry is not evaluated: use `put`");
            }
            ("contains", [value]) => match self.place_of(&values(), value)? {
                Ok(place) => Value::Boolean(place.is_some()),
                Err(unknown) => Value::Unknown(unknown),
            },
            ("containsAll", [others]) => {
                let Some(others) = Self::iterated(others) else { return Ok(None) };
                for other in others {
                    match self.place_of(&values(), &other)? {
                        Ok(Some(_)) => {}
                        Ok(None) => return Ok(Some(Value::Boolean(false))),
                        Err(unknown) => return Ok(Some(Value::Unknown(unknown))),
                    }
                }
                Value::Boolean(true)
            }
            ("indexOf", [value]) => match self.place_of(&values(), value)? {
                Ok(place) => place.map_or(Value::Int(-1), count),
                Err(unknown) => Value::Unknown(unknown),
            },
            ("lastIndexOf", [value]) => {
                let reversed: Vec<_> = values().into_iter().rev().collect();
                match self.place_of(&reversed, value)? {
                    Ok(place) => place.map_or(Value::Int(-1), |index| count(length - 1 - index)),
                    Err(unknown) => Value::Unknown(unknown),
                }
            }
            ("iterator" | "listIterator", []) => iterator(list, 0),
            ("listIterator", [begin]) => iterator(list, self.index(begin, length + 1)?),
            ("toArray", [Value::Array(wanted)]) => {
                let (element, values) = (wanted.element.clone(), RefCell::new(values()));
                Value::Array(Rc::new(Array { element, values }))
            }
            ("toArray", []) => Value::array("Object", values()),
            ("clone", []) => Value::List(Rc::new(List::new(list.kind, values()))),
            ("ensureCapacity" | "trimToSize", _) => Value::Null,
            ("subList", [begin, end]) => {
                let [begin, end] = [self.index(begin, length + 1)?, self.index(end, length + 1)?];
                let part = list.borrow().get(begin..end).map(<[Value]>::to_vec);
                let Some(values) = part else {
                    return self.throw("IndexOutOfBoundsException", "of a list's part");
                };
                let (source, length, whole) = (Rc::clone(list), end - begin, length);
                List::view(View::Part { list: source, begin, length, whole }, values)
            }
            _ => return Ok(None),
        }))
    }

    /// Calls a method that changes a list; returns its result, and true if the list changed.
    fn change_list(
        &mut self,
        list: &Rc<List>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<(Value, bool)>, EvaluationStop> {
        let length = list.borrow().len();
        let value = match (name, arguments) {
            ("add" | "offer" | "offerLast", [value]) => {
                list.borrow_mut().push(value.clone());
                Value::Boolean(true)
            }
            ("addLast" | "addElement" | "put", [value]) => {
                list.borrow_mut().push(value.clone());
                Value::Null
            }
            ("push", [value]) => {
                let place = if list.kind == ListKind::Stack { length } else { 0 };
                list.borrow_mut().insert(place, value.clone());
                value.clone()
            }
            ("addFirst", [value]) => {
                list.borrow_mut().insert(0, value.clone());
                Value::Null
            }
            ("offerFirst", [value]) => {
                list.borrow_mut().insert(0, value.clone());
                Value::Boolean(true)
            }
            ("add", [index, value]) => {
                let index = self.index(index, length + 1)?;
                list.borrow_mut().insert(index, value.clone());
                Value::Null
            }
            ("addAll", [values]) => match Self::iterated(values) {
                Some(values) => {
                    let is_changed = !values.is_empty();
                    list.borrow_mut().extend(values);
                    return Ok(Some((Value::Boolean(is_changed), is_changed)));
                }
                None => return Ok(None),
            },
            ("addAll", [index, values]) => {
                let index = self.index(index, length + 1)?;
                let Some(values) = Self::iterated(values) else { return Ok(None) };
                let is_changed = !values.is_empty();
                list.borrow_mut().splice(index..index, values);
                return Ok(Some((Value::Boolean(is_changed), is_changed)));
            }
            ("removeAll" | "retainAll", [others]) => {
                return self.keep_elements(list, others, name == "retainAll");
            }
            ("set", [index, value]) => {
                let index = self.index(index, length)?;
                std::mem::replace(&mut list.borrow_mut()[index], value.clone())
            }
            // The call has determined that the argument is an element, not an index.
            (REMOVE_ELEMENT, [value]) => {
                return self.remove_element(list, value);
            }
            ("remove", [Value::Int(index)]) => {
                let index = self.index(&Value::Int(*index), length)?;
                list.borrow_mut().remove(index)
            }
            ("remove", [Value::Unknown(_)]) => return Ok(None),
            ("remove" | "removeFirstOccurrence", [value]) => {
                return self.remove_element(list, value);
            }
            _ => return self.shorten_list(list, name, arguments),
        };
        Ok(Some((value, true)))
    }

    /// Calls a method that removes elements from a list or sorts it; returns its result, and true
    /// if the list changed.
    fn shorten_list(
        &mut self,
        list: &Rc<List>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<(Value, bool)>, EvaluationStop> {
        let length = list.borrow().len();
        // A stack is accessed at its end, other lists at the beginning.
        let top = if list.kind == ListKind::Stack { length.saturating_sub(1) } else { 0 };
        let value = match (name, arguments) {
            ("remove" | "removeFirst", []) => {
                if length == 0 {
                    return self.empty_list();
                }
                list.borrow_mut().remove(0)
            }
            ("poll" | "pollFirst", []) => {
                if length == 0 {
                    return Ok(Some((Value::Null, false)));
                }
                list.borrow_mut().remove(0)
            }
            ("pollLast", []) => {
                let last = list.borrow_mut().pop();
                last.unwrap_or(Value::Null)
            }
            ("pop", []) => {
                if length == 0 && list.kind == ListKind::Stack {
                    return self.throw("EmptyStackException", "a stack is empty");
                }
                if length == 0 {
                    return self.empty_list();
                }
                list.borrow_mut().remove(top)
            }
            ("removeLast", []) => {
                let last = list.borrow_mut().pop();
                match last {
                    Some(value) => value,
                    None => return self.empty_list(),
                }
            }
            ("clear" | "removeAllElements", []) => {
                list.renew(Vec::new());
                Value::Null
            }
            ("sort", [comparator]) => {
                let values = list.borrow().clone();
                match self.sorted(values, Some(comparator))? {
                    Ok(values) => list.renew(values),
                    Err(unknown) => self.spoil(&Value::List(Rc::clone(list)), &unknown),
                }
                Value::Null
            }
            _ => return Ok(None),
        };
        Ok(Some((value, true)))
    }

    fn remove_element(
        &mut self,
        list: &Rc<List>,
        value: &Value,
    ) -> Result<Option<(Value, bool)>, EvaluationStop> {
        let values = list.borrow().clone();
        Ok(Some(match self.place_of(&values, value)? {
            Ok(Some(place)) => {
                list.borrow_mut().remove(place);
                (Value::Boolean(true), true)
            }
            Ok(None) => (Value::Boolean(false), false),
            Err(unknown) => {
                self.spoil(&Value::List(Rc::clone(list)), &unknown);
                (Value::Unknown(unknown), false)
            }
        }))
    }

    /// Evaluates `retainAll` or `removeAll`: keeps the elements that are in another collection, or
    /// those that are not.
    fn keep_elements(
        &mut self,
        list: &Rc<List>,
        others: &Value,
        keeps: bool,
    ) -> Result<Option<(Value, bool)>, EvaluationStop> {
        let Some(others) = Self::iterated(others) else { return Ok(None) };
        let values = list.borrow().clone();
        let mut kept = Vec::new();
        for value in values {
            match self.place_of(&others, &value)? {
                Ok(place) if place.is_some() == keeps => kept.push(value),
                Ok(_) => {}
                Err(unknown) => {
                    self.spoil(&Value::List(Rc::clone(list)), &unknown);
                    return Ok(Some((Value::Unknown(unknown), false)));
                }
            }
        }
        let is_changed = kept.len() != list.borrow().len();
        list.renew(kept);
        Ok(Some((Value::Boolean(is_changed), is_changed)))
    }

    /// Throws the exception of an access to an empty list.
    fn empty_list<T>(&self) -> Result<T, EvaluationStop> {
        self.throw("NoSuchElementException", "a list is empty")
    }

    /// Calls a method of an iterator; `None` if it is not modelled.
    pub(crate) fn of_iterator(
        &mut self,
        iteration: &Rc<RefCell<Iteration>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, EvaluationStop> {
        let (list, next, last, known) = {
            let iteration = iteration.borrow();
            (Rc::clone(&iteration.list), iteration.next, iteration.last, iteration.structure)
        };
        // The same number of keys means the same keys, because any other change ends an iteration.
        let is_current = match &*list.view.borrow() {
            Some(View::Map(map, MapPart::Keys)) => {
                map.borrow().entries.len() == list.borrow().len()
            }
            _ => false,
        };
        if !is_current {
            self.refresh(&Value::List(Rc::clone(&list)));
        }
        let length = list.borrow().len();
        let count = |number: usize| Value::Int(i32::try_from(number).unwrap_or(i32::MAX));
        let to = |next: usize, last: Option<usize>| {
            let mut iteration = iteration.borrow_mut();
            (iteration.next, iteration.last) = (next, last);
        };
        Ok(Some(match (name, arguments) {
            ("hasNext" | "hasMoreElements", []) => Value::Boolean(next < length),
            ("hasPrevious", []) => Value::Boolean(next > 0),
            ("nextIndex", []) => count(next),
            ("next" | "nextElement" | "previous", []) if list.structure.get() != known => {
                return self.reject(CHANGED_MEANWHILE);
            }
            ("next" | "nextElement", []) => {
                self.java.changes += 1;
                let element = list.borrow().get(next).cloned();
                let Some(value) = element else {
                    return self.throw("NoSuchElementException", "an iterator is at its end");
                };
                to(next + 1, Some(next));
                value
            }
            ("previous", []) => {
                self.java.changes += 1;
                let element =
                    next.checked_sub(1).and_then(|index| list.borrow().get(index).cloned());
                let Some(value) = element else {
                    return self.throw("NoSuchElementException", "an iterator is at its beginning");
                };
                to(next - 1, Some(next - 1));
                value
            }
            ("remove" | "set" | "add", _) if list.is_immutable() => {
                self.check_changeable(&list)?;
                return Ok(None);
            }
            ("remove" | "set", _) => {
                let Some(place) = last.filter(|index| *index < length) else {
                    return self.throw("IllegalStateException", "an iterator has no element");
                };
                self.java.changes += 1;
                match arguments {
                    [] => {
                        to(if next > place { next - 1 } else { next }, None);
                        if let Some(View::Map(map, _)) = list.view.borrow().clone() {
                            Self::remove_entry(&map, place);
                            return Ok(Some(Value::Null));
                        }
                        list.borrow_mut().remove(place);
                        list.count_change();
                        iteration.borrow_mut().structure = list.structure.get();
                    }
                    [value] => list.borrow_mut()[place] = value.clone(),
                    _ => return Ok(None),
                }
                self.write_back(&list)?;
                Value::Null
            }
            ("add", [value]) => {
                list.borrow_mut().insert(next.min(length), value.clone());
                to(next + 1, None);
                self.java.changes += 1;
                list.count_change();
                iteration.borrow_mut().structure = list.structure.get();
                self.write_back(&list)?;
                Value::Null
            }
            _ => return Ok(None),
        }))
    }
}

/// Reason for an unknown iteration: Java throws at the next element, or ends silently.
pub(crate) const CHANGED_MEANWHILE: &str =
    "a list, a set or a map is changed while a loop iterates over it";

/// Prefixes of method names that change a list.
const CHANGING: [&str; 7] = ["add", "remove", "clear", "retain", "set", "sort", "replaceAll"];

/// Name for `remove(Object)` with a number as argument.
pub(crate) const REMOVE_ELEMENT: &str = "remove(Object)";

fn iterator(list: &Rc<List>, next: usize) -> Value {
    let list = Rc::clone(list);
    let structure = list.structure.get();
    Value::Iterator(Rc::new(RefCell::new(Iteration { list, next, last: None, structure })))
}

/// Creates an iterator over the elements of a set.
pub(crate) fn set_iterator(set: &Rc<RefCell<crate::value::Map>>, keys: Vec<Value>) -> Value {
    match List::view(View::Map(Rc::clone(set), MapPart::Keys), keys) {
        Value::List(list) => iterator(&list, 0),
        other => other,
    }
}
