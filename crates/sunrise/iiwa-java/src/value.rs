//! Values of Java, as the evaluator has them.

use std::{
    cell::{Cell, OnceCell, Ref, RefCell, RefMut},
    collections::HashMap,
    rc::Rc,
    sync::Arc,
};

use crate::{
    class_id::ClassId,
    host_value::HostValue,
    place::Place,
    syntax::{Lambda, Reference, TypeName},
    unknown::Unknown,
};

/// A value; copies of arrays, collections and objects are the same array, collection or object, as in Java.
#[derive(Clone, Debug)]
pub enum Value {
    /// `null`.
    Null,
    /// A `boolean`.
    Boolean(bool),
    /// A `char`, a unit of UTF-16.
    Char(u16),
    /// A `byte`, `short` or `int`.
    Int(i32),
    /// A `long`.
    Long(i64),
    /// A `float`.
    Float(f32),
    /// A `double`.
    Double(f64),
    /// A `String`.
    Text(Rc<str>),
    /// An array.
    Array(Rc<Array>),
    /// Any `java.util` list, stack or queue.
    List(Rc<List>),
    /// Any `java.util` map or set.
    Map(Rc<RefCell<Map>>),
    /// An `Iterator` or `ListIterator`.
    Iterator(Rc<RefCell<Iteration>>),
    /// An `AtomicInteger` or the like.
    Cell(Rc<RefCell<Value>>),
    /// A `StringBuilder` or `StringBuffer`.
    Builder(Rc<RefCell<Result<String, Rc<Unknown>>>>),
    /// Of a class of the project.
    Object(Rc<Object>),
    /// An exception of Java's or KUKA's.
    Exception(Rc<Thrown>),
    /// A class of the project.
    Class(ClassId),
    /// A class of KUKA's or of Java, by its simple name.
    ForeignClass(Rc<str>),
    /// A lambda expression or a method reference.
    Function(Rc<Function>),
    /// A `Stream`, `IntStream` or the like.
    Stream(Rc<Stream>),
    /// One of `Collectors`.
    Collector(Rc<Collector>),
    /// An `Optional` or the like.
    Optional(Rc<Option<Value>>),
    /// Of a class of the host.
    Host(Rc<dyn HostValue>),
    /// What cannot be known before the program runs.
    Unknown(Rc<Unknown>),
}

/// An array and the type of its elements.
#[derive(Debug)]
pub struct Array {
    pub(crate) element: TypeName,
    /// Its elements.
    pub values: RefCell<Vec<Value>>,
}

/// A `java.util` list, stack or queue.
#[derive(Debug)]
pub struct List {
    values: RefCell<Vec<Value>>,
    pub(crate) kind: ListKind,
    /// Reason for unknown contents.
    unknown: RefCell<Option<Rc<Unknown>>>,
    /// The object that the list shows, if any.
    pub(crate) view: RefCell<Option<View>>,
    /// The number of changes of the list as a whole, other than `set`: an iteration over it ends with the next one.
    pub(crate) structure: Cell<usize>,
}

/// The end of a list at which `push`, `pop` and `peek` work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ListKind {
    List,
    /// The last element.
    Stack,
    /// The first one.
    Deque,
    /// One that cannot be changed: `List.of`.
    Immutable,
}

/// An object that a list shows: changes of one are changes of the other.
#[derive(Clone, Debug)]
pub(crate) enum View {
    /// All of an array: `Arrays.asList`.
    Array(Rc<Array>),
    /// All of a list, which cannot be changed by this one: `Collections.unmodifiableList`.
    Whole(Rc<List>),
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
    /// The changes of the list that the iteration knows.
    pub(crate) structure: usize,
}

impl List {
    pub(crate) fn new(kind: ListKind, values: Vec<Value>) -> Self {
        Self {
            values: RefCell::new(values),
            kind,
            unknown: RefCell::default(),
            view: RefCell::default(),
            structure: Cell::default(),
        }
    }

    pub(crate) fn view(view: View, values: Vec<Value>) -> Value {
        let list = Self::new(ListKind::List, values);
        *list.view.borrow_mut() = Some(view);
        Value::List(Rc::new(list))
    }

    /// True if the list, or the one of which it is a part, cannot be changed.
    pub(crate) fn is_immutable(&self) -> bool {
        match &*self.view.borrow() {
            Some(View::Whole(_)) => true,
            Some(View::Part { of, .. }) => of.is_immutable(),
            _ => self.kind == ListKind::Immutable,
        }
    }

    /// True if its elements can be changed, and not their number: `Arrays.asList`.
    pub(crate) fn is_fixed_size(&self) -> bool {
        matches!(&*self.view.borrow(), Some(View::Array(_)))
    }

    /// Its elements; a single unknown one if they are not known.
    pub fn borrow(&self) -> Ref<'_, Vec<Value>> {
        self.values.borrow()
    }

    pub(crate) fn borrow_mut(&self) -> RefMut<'_, Vec<Value>> {
        self.values.borrow_mut()
    }

    /// Elements have been added, removed or put into another order.
    pub(crate) fn count_change(&self) {
        self.structure.set(self.structure.get() + 1);
    }

    /// Reason for unknown contents.
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

/// A map or a set; entries are in the order in which they were put in.
#[derive(Debug, Default)]
pub struct Map {
    /// Keys and values; of a set, the keys alone count.
    pub entries: Vec<(Value, Value)>,
    /// Whether it is one of `java.util` that keeps this order, or sorts.
    pub order: MapOrder,
    /// Whether it is a set: its keys are the elements.
    pub is_set: bool,
    /// Reason for unknown contents.
    pub unknown: Option<Rc<Unknown>>,
}

/// An object, or a constant of an enum.
#[derive(Debug)]
pub struct Object {
    pub(crate) class: ClassId,
    /// Its fields by the class that declares them and their names.
    pub(crate) fields: RefCell<HashMap<(ClassId, String), Value>>,
    /// The object within which it was made, of an inner class.
    pub(crate) outer: Option<Value>,
    /// The local variables that an anonymous or local class sees.
    pub(crate) captured: HashMap<String, Value>,
    /// Its name and place, if it is a constant of an enum.
    pub(crate) constant: Option<(Rc<str>, i32)>,
    /// What its class inherits from one that is not of the project: the name of a group of inputs and outputs, say.
    pub inherited: RefCell<Option<Value>>,
    /// Its message, if it is an exception.
    pub(crate) message: RefCell<Option<Value>>,
    /// Its abstract method, if it is a lambda expression or a method reference as an interface of the project.
    pub(crate) function: Option<Rc<Function>>,
}

/// A local variable.
#[derive(Clone, Debug)]
pub(crate) struct Local {
    pub(crate) name: String,
    /// None if it takes any value.
    pub(crate) type_name: Option<TypeName>,
    pub(crate) value: Value,
    /// True once the program has given it a value.
    pub(crate) is_assigned: bool,
}

/// An object of a functional interface, of which only the abstract method is given.
#[derive(Debug)]
pub struct Function {
    /// The class in which it is written.
    pub(crate) class: ClassId,
    /// `this` where it was evaluated.
    pub(crate) this: Option<Rc<Object>>,
    /// The local variables around it.
    pub(crate) locals: Vec<Local>,
    pub(crate) line: u32,
    pub(crate) code: Code,
    /// The levels of functions of which it is made.
    pub(crate) depth: usize,
    /// Its interface, if that is one of Java's own and known by now.
    pub(crate) interface: OnceCell<TypeName>,
}

#[derive(Debug)]
pub(crate) enum Code {
    Lambda(Arc<Lambda>),
    /// With the value before `::`, if it is a value.
    Reference(Arc<Reference>, Option<Value>),
    Combined(Combined),
}

/// Functions that methods of Java's functional interfaces make.
#[derive(Debug)]
pub(crate) enum Combined {
    /// `Function.identity()`.
    Identity,
    /// `second` gets the result of `first`, which implements this interface.
    Chain {
        first: Value,
        interface: Rc<str>,
        second: Value,
    },
    /// Both get the arguments.
    Both {
        first: Value,
        second: Value,
        interface: Rc<str>,
    },
    Not {
        of: Value,
        interface: Rc<str>,
    },
    And {
        first: Value,
        second: Value,
        interface: Rc<str>,
    },
    Or {
        first: Value,
        second: Value,
        interface: Rc<str>,
    },
    /// A comparator by keys, which `key` gives as this interface; `order` is their comparator, if it is not the natural one.
    ByKey {
        key: Value,
        interface: Rc<str>,
        order: Option<Value>,
    },
    /// A comparator by keys or values of a map's entries.
    ByEntry {
        is_key: bool,
    },
    Reversed(Value),
    /// A comparator, and one for what is equal by it.
    Then(Value, Value),
}

/// A stream of `java.util.stream`.
#[derive(Debug)]
pub struct Stream {
    pub(crate) kind: StreamKind,
    /// The collection or array, which is read by the terminal operation.
    pub(crate) source: Value,
    pub(crate) stages: Vec<Stage>,
    /// True once another operation has taken its elements.
    pub(crate) is_used: Cell<bool>,
}

/// The type of a stream's elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StreamKind {
    Object,
    Int,
    Long,
    Double,
}

/// An intermediate operation. Functions have the names of their interfaces.
#[derive(Clone, Debug)]
pub(crate) enum Stage {
    Map(Value, Rc<str>),
    Filter(Value, Rc<str>),
    Peek(Value, Rc<str>),
    /// Elements as those of another type.
    Convert(StreamKind),
    Limit(usize),
    Skip(usize),
    Sorted(Option<Value>),
    Distinct,
}

/// A collector of `Collectors`.
#[derive(Debug)]
pub enum Collector {
    /// `toList()`.
    List,
    /// `toSet()`.
    Set,
    /// `joining(between, before, behind)`.
    Joining([Rc<str>; 3]),
    /// `counting()`.
    Counting,
    /// `toMap(key, value)`.
    Map(Value, Value),
    /// `groupingBy(key)`.
    Grouping(Value),
}

/// An exception of Java.
#[derive(Debug)]
pub struct Thrown {
    /// Its class and those above it that are not of the project, by their simple names, from it upwards.
    pub classes: Vec<Rc<str>>,
    /// It, if its class is of the project; else its message, which may be null or unknown.
    pub value: Value,
    /// What it says.
    pub message: String,
    /// Where it was thrown.
    pub place: Place,
}

/// The order in which a map is iterated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapOrder {
    /// By hashes of its keys, as in a `HashMap`.
    #[default]
    Hashed,
    /// As put in.
    Linked,
    /// By its keys.
    Sorted,
}

impl Object {
    /// One whose class is none of a project's, for tests of a host alone.
    #[must_use]
    pub fn detached() -> Self {
        Self {
            class: ClassId(usize::MAX),
            fields: RefCell::default(),
            outer: None,
            captured: HashMap::new(),
            constant: None,
            inherited: RefCell::default(),
            message: RefCell::default(),
            function: None,
        }
    }
}

impl Value {
    /// A `String`.
    pub fn text(text: impl AsRef<str>) -> Self {
        Self::Text(Rc::from(text.as_ref()))
    }

    /// A list.
    #[must_use]
    pub fn list(values: Vec<Self>) -> Self {
        Self::List(Rc::new(List::new(ListKind::List, values)))
    }

    /// An array of objects of this type.
    #[must_use]
    pub fn array(element: &str, values: Vec<Self>) -> Self {
        let element = TypeName::new(element, 0);
        Self::Array(Rc::new(Array { element, values: RefCell::new(values) }))
    }

    /// As a number, with what Java widens to it; none if it is no number.
    #[must_use]
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Char(code) => Some(f64::from(*code)),
            Self::Int(value) => Some(f64::from(*value)),
            #[expect(clippy::cast_precision_loss, reason = "as Java does")]
            Self::Long(value) => Some(*value as f64),
            Self::Float(value) => Some(f64::from(*value)),
            Self::Double(value) => Some(*value),
            _ => None,
        }
    }

    /// As a whole number; none if it is of another type.
    #[must_use]
    pub fn integer(&self) -> Option<i64> {
        match self {
            Self::Char(code) => Some(i64::from(*code)),
            Self::Int(value) => Some(i64::from(*value)),
            Self::Long(value) => Some(*value),
            _ => None,
        }
    }

    /// What cannot be known, if it is that.
    #[must_use]
    pub fn unknown(&self) -> Option<&Rc<Unknown>> {
        match self {
            Self::Unknown(unknown) => Some(unknown),
            _ => None,
        }
    }

    /// The elements of an array or a collection.
    #[must_use]
    pub fn elements(&self) -> Option<Vec<Self>> {
        match self {
            Self::Array(array) => Some(array.values.borrow().clone()),
            Self::List(list) => Some(list.borrow().clone()),
            _ => None,
        }
    }

    /// `==` of Java, but for strings, which are compared by their text: equal literals are the same object there.
    #[must_use]
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Null, Self::Null) => true,
            (Self::Boolean(a), Self::Boolean(b)) => a == b,
            (Self::Text(a), Self::Text(b)) | (Self::ForeignClass(a), Self::ForeignClass(b)) => {
                a == b
            }
            (Self::Array(a), Self::Array(b)) => Rc::ptr_eq(a, b),
            (Self::List(a), Self::List(b)) => Rc::ptr_eq(a, b),
            (Self::Iterator(a), Self::Iterator(b)) => Rc::ptr_eq(a, b),
            (Self::Map(a), Self::Map(b)) => Rc::ptr_eq(a, b),
            (Self::Builder(a), Self::Builder(b)) => Rc::ptr_eq(a, b),
            (Self::Cell(a), Self::Cell(b)) => Rc::ptr_eq(a, b),
            (Self::Object(a), Self::Object(b)) => {
                let functions = a.function.as_ref().zip(b.function.as_ref());
                Rc::ptr_eq(a, b) || functions.is_some_and(|(a, b)| Rc::ptr_eq(a, b))
            }
            (Self::Function(a), Self::Function(b)) => Rc::ptr_eq(a, b),
            (Self::Stream(a), Self::Stream(b)) => Rc::ptr_eq(a, b),
            (Self::Collector(a), Self::Collector(b)) => Rc::ptr_eq(a, b),
            (Self::Optional(a), Self::Optional(b)) => Rc::ptr_eq(a, b),
            (Self::Function(a), Self::Object(object))
            | (Self::Object(object), Self::Function(a)) => {
                object.function.as_ref().is_some_and(|own| Rc::ptr_eq(a, own))
            }
            (Self::Exception(a), Self::Exception(b)) => Rc::ptr_eq(a, b),
            (Self::Class(a), Self::Class(b)) => a == b,
            (Self::Host(a), Self::Host(b)) => a.is_same(&**b),
            (a, b) => match (a.integer(), b.integer()) {
                (Some(a), Some(b)) => a == b,
                #[expect(clippy::float_cmp, reason = "as Java does")]
                _ => a.number().zip(b.number()).is_some_and(|(a, b)| a == b),
            },
        }
    }

    /// The function that it is, as an interface of the project or of Java's library.
    pub(crate) fn function(&self) -> Option<&Rc<Function>> {
        match self {
            Self::Function(function) => Some(function),
            Self::Object(object) => object.function.as_ref(),
            _ => None,
        }
    }

    /// `equals` of Java, of values whose classes are not of the project: numbers are equal to those of their own type alone.
    #[must_use]
    pub fn is_equal(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Double(a), Self::Double(b)) => {
                a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
            }
            (Self::Float(a), Self::Float(b)) => {
                a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
            }
            (Self::Int(a), Self::Int(b)) => a == b,
            (Self::Long(a), Self::Long(b)) => a == b,
            (Self::Char(a), Self::Char(b)) => a == b,
            _ if self.number().is_some() => false,
            _ => self.is_same(other),
        }
    }

    /// What it is, with its article, for messages.
    #[must_use]
    pub fn kind(&self) -> String {
        match self {
            Self::Null => "null".to_owned(),
            Self::Boolean(_) => "a boolean".to_owned(),
            Self::Char(_) => "a character".to_owned(),
            Self::Int(_) | Self::Long(_) | Self::Float(_) | Self::Double(_) => {
                "a number".to_owned()
            }
            Self::Text(_) => "a string".to_owned(),
            Self::Array(_) => "an array".to_owned(),
            Self::List(_) => "a list".to_owned(),
            Self::Map(_) => "a map".to_owned(),
            Self::Iterator(_) => "an iterator".to_owned(),
            Self::Cell(_) => "an atomic value".to_owned(),
            Self::Builder(_) => "a StringBuilder".to_owned(),
            Self::Object(_) => "an object of the project".to_owned(),
            Self::Exception(_) => "an exception".to_owned(),
            Self::Class(_) | Self::ForeignClass(_) => "a class".to_owned(),
            Self::Function(function) => function.kind().to_owned(),
            Self::Stream(_) => "a stream".to_owned(),
            Self::Collector(_) => "a collector".to_owned(),
            Self::Optional(_) => "an optional value".to_owned(),
            Self::Host(value) => value.kind().to_owned(),
            Self::Unknown(unknown) => unknown.to_string(),
        }
    }
}
