//! Java values of the evaluator.

use std::{
    cell::{Cell, OnceCell, Ref, RefCell, RefMut},
    collections::HashMap,
    rc::Rc,
    sync::Arc,
};

use crate::{
    class_id::ClassId,
    host_value::HostValue,
    place::SourceLine,
    syntax::{Lambda, Reference, TypeName},
    unknown::Unknown,
};

/// Java value; copies of arrays, collections and objects refer to the same object, as in Java.
#[derive(Clone, Debug)]
pub enum Value {
    /// `null`.
    Null,
    /// `boolean`.
    Boolean(bool),
    /// `char`, a UTF-16 unit.
    Char(u16),
    /// `byte`, `short` or `int`.
    Int(i32),
    /// `long`.
    Long(i64),
    /// `float`.
    Float(f32),
    /// `double`.
    Double(f64),
    /// `String`.
    Text(Rc<str>),
    /// Array.
    Array(Rc<Array>),
    /// `java.util` list, stack or queue.
    List(Rc<List>),
    /// `java.util` map or set.
    Map(Rc<RefCell<Map>>),
    /// `Iterator` or `ListIterator`.
    Iterator(Rc<RefCell<Iteration>>),
    /// `AtomicInteger` or similar.
    Cell(Rc<RefCell<Value>>),
    /// `StringBuilder` or `StringBuffer`.
    Builder(Rc<RefCell<Result<String, Rc<Unknown>>>>),
    /// Object of a project class.
    Object(Rc<JavaObject>),
    /// Java or KUKA exception.
    Exception(Rc<Thrown>),
    /// Project class.
    Class(ClassId),
    /// KUKA or Java class, by its simple name.
    ForeignClass(Rc<str>),
    /// Lambda expression or method reference.
    Function(Rc<Function>),
    /// `Stream`, `IntStream` or similar.
    Stream(Rc<JavaStream>),
    /// Collector of `Collectors`.
    Collector(Rc<Collector>),
    /// `Optional` or similar.
    Optional(Rc<Option<Value>>),
    /// Object of a host class.
    Host(Rc<dyn HostValue>),
    /// Value that is unknown before the program runs.
    Unknown(Rc<Unknown>),
}

/// Array with its element type.
#[derive(Debug)]
pub struct Array {
    pub(crate) element: TypeName,
    /// Elements.
    pub values: RefCell<Vec<Value>>,
}

/// `java.util` list, stack or queue.
#[derive(Debug)]
pub struct List {
    values: RefCell<Vec<Value>>,
    pub(crate) kind: ListKind,
    /// Reason for unknown contents.
    unknown: RefCell<Option<Rc<Unknown>>>,
    /// Source object, if the list is a view.
    pub(crate) view: RefCell<Option<View>>,
    /// Number of structural changes, other than `set`: an iteration is invalid after the next one.
    pub(crate) structure: Cell<usize>,
}

/// Kind of a list, which determines the end at which `push`, `pop` and `peek` operate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ListKind {
    List,
    /// Stack: the last element.
    Stack,
    /// Deque: the first element.
    Deque,
    /// Immutable list: `List.of`.
    Immutable,
}

/// Source of a list view: changes of one are changes of the other.
#[derive(Clone, Debug)]
pub(crate) enum View {
    /// Whole array: `Arrays.asList`.
    Array(Rc<Array>),
    /// Whole list, which the view cannot change: `Collections.unmodifiableList`.
    Whole(Rc<List>),
    /// Range of a list: `subList`.
    Part { list: Rc<List>, begin: usize, length: usize, whole: usize },
    /// `keySet`, `values`, `entrySet`.
    Map(Rc<RefCell<Map>>, MapPart),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MapPart {
    Keys,
    Values,
    Entries,
}

/// Iteration over a list or a set.
#[derive(Debug)]
pub struct Iteration {
    pub(crate) list: Rc<List>,
    /// Index of the next element.
    pub(crate) next: usize,
    /// Index of the element that was returned last.
    pub(crate) last: Option<usize>,
    /// Number of structural changes that the iteration knows.
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

    /// Returns true if the list, or the list that it is a range of, is immutable.
    pub(crate) fn is_immutable(&self) -> bool {
        match &*self.view.borrow() {
            Some(View::Whole(_)) => true,
            Some(View::Part { list, .. }) => list.is_immutable(),
            _ => self.kind == ListKind::Immutable,
        }
    }

    /// Returns true if the elements can be changed, but not their number: `Arrays.asList`.
    pub(crate) fn is_fixed_size(&self) -> bool {
        matches!(&*self.view.borrow(), Some(View::Array(_)))
    }

    /// Returns the elements; a single unknown one if the contents are unknown.
    pub fn borrow(&self) -> Ref<'_, Vec<Value>> {
        self.values.borrow()
    }

    pub(crate) fn borrow_mut(&self) -> RefMut<'_, Vec<Value>> {
        self.values.borrow_mut()
    }

    /// Counts a structural change: elements added, removed or reordered.
    pub(crate) fn count_change(&self) {
        self.structure.set(self.structure.get() + 1);
    }

    /// Returns the reason for unknown contents.
    pub(crate) fn unknown(&self) -> Option<Rc<Unknown>> {
        self.unknown.borrow().clone()
    }

    pub(crate) fn spoil(&self, unknown: &Rc<Unknown>) {
        *self.values.borrow_mut() = vec![Value::Unknown(Rc::clone(unknown))];
        *self.unknown.borrow_mut() = Some(Rc::clone(unknown));
    }

    /// Replaces the contents by known ones.
    pub(crate) fn renew(&self, values: Vec<Value>) {
        *self.values.borrow_mut() = values;
        *self.unknown.borrow_mut() = None;
    }
}

/// Map or set; entries are in insertion order.
#[derive(Debug, Default)]
pub struct Map {
    /// Keys and values; a set uses only the keys.
    pub entries: Vec<(Value, Value)>,
    /// Iteration order of the map's class.
    pub order: MapOrder,
    /// `true` for a set: its keys are the elements.
    pub is_set: bool,
    /// Reason for unknown contents.
    pub unknown: Option<Rc<Unknown>>,
}

/// Object, or enum constant.
#[derive(Debug)]
pub struct JavaObject {
    pub(crate) class: ClassId,
    /// Fields by declaring class and name.
    pub(crate) fields: RefCell<HashMap<(ClassId, String), Value>>,
    /// Enclosing object of an inner class.
    pub(crate) outer: Option<Value>,
    /// Local variables captured by an anonymous or local class.
    pub(crate) captured: HashMap<String, Value>,
    /// Name and ordinal of an enum constant.
    pub(crate) constant: Option<(Rc<str>, i32)>,
    /// Value inherited from a class outside the project, such as the name of an I/O group.
    pub inherited: RefCell<Option<Value>>,
    /// Message of an exception.
    pub(crate) message: RefCell<Option<Value>>,
    /// Abstract method, if the object is a lambda expression or a method reference with a project
    /// interface.
    pub(crate) function: Option<Rc<Function>>,
}

/// Local variable.
#[derive(Clone, Debug)]
pub(crate) struct Local {
    pub(crate) name: String,
    /// Type; `None` for any value.
    pub(crate) type_name: Option<TypeName>,
    pub(crate) value: Value,
    /// `true` once the program has assigned a value.
    pub(crate) is_assigned: bool,
}

/// Object of a functional interface, defined only by its abstract method.
#[derive(Debug)]
pub struct Function {
    /// Class that contains the code.
    pub(crate) class: ClassId,
    /// Value of `this` at the evaluation.
    pub(crate) this: Option<Rc<JavaObject>>,
    /// Captured local variables.
    pub(crate) locals: Vec<Local>,
    pub(crate) line: u32,
    pub(crate) code: FunctionCode,
    /// Composition depth.
    pub(crate) depth: usize,
    /// Interface, once determined and if it belongs to the Java library.
    pub(crate) interface: OnceCell<TypeName>,
}

#[derive(Debug)]
pub(crate) enum FunctionCode {
    Lambda(Arc<Lambda>),
    /// Method reference, with the value before `::` if it is a value.
    Reference(Arc<Reference>, Option<Value>),
    Combined(Combined),
}

/// Functions that methods of Java's functional interfaces create.
#[derive(Debug)]
pub(crate) enum Combined {
    /// `Function.identity()`.
    Identity,
    /// Composition: `second` is applied to the result of `first`, which implements this interface.
    Chain {
        first: Value,
        interface: Rc<str>,
        second: Value,
    },
    /// Both functions applied to the arguments.
    Both {
        first: Value,
        second: Value,
        interface: Rc<str>,
    },
    Not {
        predicate: Value,
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
    /// Comparator by keys, which `key` extracts through this interface; `order` compares them, if
    /// it is not the natural order.
    ByKey {
        key: Value,
        interface: Rc<str>,
        order: Option<Value>,
    },
    /// Comparator by keys or values of map entries.
    ByEntry {
        is_key: bool,
    },
    Reversed(Value),
    /// Comparator, and a second one for elements that the first considers equal.
    Then(Value, Value),
}

/// `java.util.stream` stream.
#[derive(Debug)]
pub struct JavaStream {
    pub(crate) kind: StreamKind,
    /// Collection or array, which the terminal operation reads.
    pub(crate) source: Value,
    pub(crate) stages: Vec<StreamStage>,
    /// `true` once another operation has consumed the stream.
    pub(crate) is_used: Cell<bool>,
}

/// Element type of a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum StreamKind {
    Object,
    Int,
    Long,
    Double,
}

/// Intermediate operation. Functions have the names of their interfaces.
#[derive(Clone, Debug)]
pub(crate) enum StreamStage {
    Map(Value, Rc<str>),
    Filter(Value, Rc<str>),
    Peek(Value, Rc<str>),
    /// Conversion of elements to another type.
    Convert(StreamKind),
    Limit(usize),
    Skip(usize),
    Sorted(Option<Value>),
    Distinct,
}

/// Collector of `Collectors`.
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

/// Java exception.
#[derive(Debug)]
pub struct Thrown {
    /// Class and superclasses outside the project, by their simple names, from the class upwards.
    pub classes: Vec<Rc<str>>,
    /// Exception object, if its class belongs to the project; otherwise its message, which may be
    /// null or unknown.
    pub value: Value,
    /// Message text.
    pub message: String,
    /// Place of the `throw`.
    pub place: SourceLine,
}

/// Iteration order of a map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapOrder {
    /// Order of key hashes, as in a `HashMap`.
    #[default]
    Hashed,
    /// Insertion order.
    Linked,
    /// Order of keys.
    Sorted,
}

impl JavaObject {
    /// Creates an object whose class is outside any project, for tests of a host alone.
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
    /// Creates a `String`.
    pub fn text(text: impl AsRef<str>) -> Self {
        Self::Text(Rc::from(text.as_ref()))
    }

    /// Creates a list.
    #[must_use]
    pub fn list(values: Vec<Self>) -> Self {
        Self::List(Rc::new(List::new(ListKind::List, values)))
    }

    /// Creates an array of objects of this type.
    #[must_use]
    pub fn array(element: &str, values: Vec<Self>) -> Self {
        let element = TypeName::new(element, 0);
        Self::Array(Rc::new(Array { element, values: RefCell::new(values) }))
    }

    /// Returns a number with Java's widening; `None` for other types.
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

    /// Returns an integer; `None` for other types.
    #[must_use]
    pub fn integer(&self) -> Option<i64> {
        match self {
            Self::Char(code) => Some(i64::from(*code)),
            Self::Int(value) => Some(i64::from(*value)),
            Self::Long(value) => Some(*value),
            _ => None,
        }
    }

    /// Returns the reason of an unknown value.
    #[must_use]
    pub fn unknown(&self) -> Option<&Rc<Unknown>> {
        match self {
            Self::Unknown(unknown) => Some(unknown),
            _ => None,
        }
    }

    /// Returns the elements of an array or a collection.
    #[must_use]
    pub fn elements(&self) -> Option<Vec<Self>> {
        match self {
            Self::Array(array) => Some(array.values.borrow().clone()),
            Self::List(list) => Some(list.borrow().clone()),
            _ => None,
        }
    }

    /// Evaluates `==` as Java does, except for strings, which are compared by their text: equal
    /// literals are the same object there.
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
                object.function.as_ref().is_some_and(|function| Rc::ptr_eq(a, function))
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

    /// Returns the function of the value, with a project or Java library interface.
    pub(crate) fn function(&self) -> Option<&Rc<Function>> {
        match self {
            Self::Function(function) => Some(function),
            Self::Object(object) => object.function.as_ref(),
            _ => None,
        }
    }

    /// Evaluates `equals` for values of classes outside the project: numbers equal only numbers of
    /// their own type.
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

    /// Returns a description with an article, for messages.
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
