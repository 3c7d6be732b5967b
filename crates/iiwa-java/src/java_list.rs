//! Lists of Java and their iterators: contents, kinds, and lists that are parts of others.

use std::{
    cell::{Ref, RefCell, RefMut},
    rc::Rc,
};

use crate::{
    unknown::Unknown,
    value::{Array, Map, Value},
};

/// A `java.util` list, stack or queue.
#[derive(Debug)]
pub struct List {
    values: RefCell<Vec<Value>>,
    pub(crate) kind: ListKind,
    /// What the contents depend on, if they are not known.
    unknown: RefCell<Option<Rc<Unknown>>>,
    /// What the contents are those of, if they are another object's.
    pub(crate) view: RefCell<Option<View>>,
}

/// Which end of a list `push`, `pop` and `peek` mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ListKind {
    List,
    /// The last element.
    Stack,
    /// The first one.
    Deque,
}

/// What a list shows of another object: changes of one are changes of the other.
#[derive(Clone, Debug)]
pub(crate) enum View {
    /// All of an array: `Arrays.asList`.
    Array(Rc<Array>),
    /// Elements of a list: `subList`.
    Part { of: Rc<List>, begin: usize, length: usize, whole: usize },
    /// `keySet`, `values`, `entrySet`.
    Map(Rc<RefCell<Map>>, MapPart),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MapPart {
    Keys,
    Values,
    Entries,
}

/// An iteration over a list or a set.
#[derive(Debug)]
pub struct Iteration {
    pub(crate) list: Rc<List>,
    /// The place of the next element.
    pub(crate) next: usize,
    /// The place of the element that was given last.
    pub(crate) last: Option<usize>,
}

impl List {
    pub(crate) fn new(kind: ListKind, values: Vec<Value>) -> Self {
        Self {
            values: RefCell::new(values),
            kind,
            unknown: RefCell::default(),
            view: RefCell::default(),
        }
    }

    pub(crate) fn view(view: View, values: Vec<Value>) -> Value {
        let list = Self::new(ListKind::List, values);
        *list.view.borrow_mut() = Some(view);
        Value::List(Rc::new(list))
    }

    /// Its elements; a single unknown one if they are not known.
    pub fn borrow(&self) -> Ref<'_, Vec<Value>> {
        self.values.borrow()
    }

    pub(crate) fn borrow_mut(&self) -> RefMut<'_, Vec<Value>> {
        self.values.borrow_mut()
    }

    /// What its contents depend on, if they are not known.
    pub(crate) fn unknown(&self) -> Option<Rc<Unknown>> {
        self.unknown.borrow().clone()
    }

    pub(crate) fn spoil(&self, unknown: &Rc<Unknown>) {
        *self.values.borrow_mut() = vec![Value::Unknown(Rc::clone(unknown))];
        *self.unknown.borrow_mut() = Some(Rc::clone(unknown));
    }

    /// Its contents are known again.
    pub(crate) fn renew(&self, values: Vec<Value>) {
        *self.values.borrow_mut() = values;
        *self.unknown.borrow_mut() = None;
    }
}
