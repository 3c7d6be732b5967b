//! The syntax of Java, as far as robot programs use it.

use std::sync::Arc;

/// A source file.
#[derive(Debug, Default)]
pub struct Unit {
    /// Its package, as `a.b`; empty if it names none.
    pub(crate) package: String,
    pub(crate) imports: Vec<Import>,
    pub(crate) classes: Vec<Arc<Class>>,
}

/// `import a.b.C;`, `import static a.b.C.d;`, `import a.b.*;`.
#[derive(Debug)]
pub(crate) struct Import {
    /// `a.b.C`; for all of a package or class, the name before `.*`.
    pub(crate) path: String,
    pub(crate) is_static: bool,
    pub(crate) is_all: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ClassKind {
    Class,
    Interface,
    Enum,
    /// Read as a class, with the members that it has by being one.
    Record,
}

/// A class, an interface or an enum.
#[derive(Debug)]
pub(crate) struct Class {
    pub(crate) name: String,
    pub(crate) kind: ClassKind,
    pub(crate) line: u32,
    pub(crate) is_abstract: bool,
    pub(crate) type_parameters: Vec<TypeParameter>,
    pub(crate) extends: Option<TypeName>,
    /// What it implements; what an interface extends.
    pub(crate) implements: Vec<TypeName>,
    /// Of an enum.
    pub(crate) constants: Vec<Constant>,
    /// Fields and initialisers in order.
    pub(crate) members: Vec<Member>,
    pub(crate) methods: Vec<Arc<Method>>,
    pub(crate) constructors: Vec<Arc<Method>>,
    /// Classes within it.
    pub(crate) classes: Vec<Arc<Class>>,
}

/// A constant of an enum.
#[derive(Debug)]
pub(crate) struct Constant {
    pub(crate) name: String,
    pub(crate) line: u32,
    pub(crate) arguments: Vec<Expression>,
    /// The body that it has of its own.
    pub(crate) body: Option<Arc<Class>>,
}

#[derive(Debug)]
pub(crate) enum Member {
    Field(Field),
    Initializer { is_static: bool, body: Vec<Statement> },
}

/// A field; `int a = 1, b;` is two.
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) type_name: TypeName,
    pub(crate) line: u32,
    /// Those of an interface are static.
    pub(crate) is_static: bool,
    pub(crate) annotations: Vec<Annotation>,
    pub(crate) initial: Option<Expression>,
}

/// `@Name`, `@Name("value")`; other arguments are left out.
#[derive(Debug)]
pub(crate) struct Annotation {
    /// Without a package.
    pub(crate) name: String,
    pub(crate) value: Option<String>,
}

/// A method or a constructor.
#[derive(Debug)]
pub(crate) struct Method {
    /// That of the class, for constructors.
    pub(crate) name: String,
    pub(crate) line: u32,
    pub(crate) is_static: bool,
    pub(crate) annotations: Vec<Annotation>,
    pub(crate) type_parameters: Vec<TypeParameter>,
    pub(crate) parameters: Vec<Parameter>,
    /// Whether the last parameter takes any number of arguments; its type has one dimension more than is written.
    pub(crate) is_variadic: bool,
    /// `void` if nothing is returned.
    pub(crate) returns: TypeName,
    /// None if it is abstract or native.
    pub(crate) body: Option<Vec<Statement>>,
}

#[derive(Debug)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) type_name: TypeName,
}

/// A type variable of a class or a method: `T extends Frame`.
#[derive(Clone, Debug)]
pub(crate) struct TypeParameter {
    pub(crate) name: String,
    /// The first of its bounds.
    pub(crate) bound: Option<TypeName>,
}

/// A type. Equality is that of erasures (JLS 4.6): type arguments do not count.
#[derive(Clone, Debug)]
pub(crate) struct TypeName {
    /// As written: `int`, `Frame`, `a.b.C`, `Outer.Inner`.
    pub(crate) name: String,
    /// Of an array.
    pub(crate) dimensions: usize,
    /// Type arguments; wildcards by their bounds. Those that a compiler would infer have an empty name.
    pub(crate) arguments: Vec<Self>,
}

impl TypeName {
    pub(crate) fn new(name: &str, dimensions: usize) -> Self {
        Self { name: name.to_owned(), dimensions, arguments: Vec::new() }
    }

    /// The type of the elements of an array.
    pub(crate) fn element(&self) -> Self {
        self.with_dimensions(self.dimensions.saturating_sub(1))
    }

    pub(crate) fn with_dimensions(&self, dimensions: usize) -> Self {
        Self { dimensions, ..self.clone() }
    }
}

impl PartialEq for TypeName {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && self.dimensions == other.dimensions
    }
}

impl Eq for TypeName {}

#[derive(Debug)]
pub(crate) struct Statement {
    pub(crate) line: u32,
    pub(crate) kind: StatementKind,
}

#[derive(Debug)]
pub(crate) enum StatementKind {
    Block(Vec<Statement>),
    Local {
        type_name: TypeName,
        variables: Vec<Variable>,
    },
    LocalClass(Arc<Class>),
    Expression(Expression),
    If {
        condition: Expression,
        then: Box<Statement>,
        otherwise: Option<Box<Statement>>,
    },
    While {
        condition: Expression,
        body: Box<Statement>,
    },
    DoWhile {
        body: Box<Statement>,
        condition: Expression,
    },
    For {
        /// A declaration, or expressions.
        initial: Vec<Statement>,
        condition: Option<Expression>,
        update: Vec<Expression>,
        body: Box<Statement>,
    },
    ForEach {
        type_name: TypeName,
        name: String,
        iterable: Expression,
        body: Box<Statement>,
    },
    Switch {
        value: Expression,
        groups: Vec<SwitchGroup>,
    },
    Break(Option<String>),
    Continue(Option<String>),
    Return(Option<Expression>),
    Throw(Expression),
    /// The value of the switch around it.
    Yield(Expression),
    Try {
        /// Declarations, or expressions.
        resources: Vec<Statement>,
        body: Vec<Statement>,
        catches: Vec<Catch>,
        finally: Option<Vec<Statement>>,
    },
    Labelled {
        label: String,
        body: Box<Statement>,
    },
    Synchronized {
        body: Vec<Statement>,
    },
    Assert,
    Empty,
    /// What it is, with its article: "an annotation type".
    Unsupported(String),
}

/// A local variable of a declaration.
#[derive(Debug)]
pub(crate) struct Variable {
    pub(crate) name: String,
    /// `[]` behind the name, beyond those of the type.
    pub(crate) dimensions: usize,
    pub(crate) initial: Option<Expression>,
}

/// `case 1: case 2: ...`.
#[derive(Debug)]
pub(crate) struct SwitchGroup {
    pub(crate) labels: Vec<Label>,
    /// The condition behind `when`.
    pub(crate) guard: Option<Expression>,
    pub(crate) body: Vec<Statement>,
    /// Whether it goes on into the next group: false for those with `->`.
    pub(crate) falls_through: bool,
}

#[derive(Debug)]
pub(crate) enum Label {
    Default,
    Value(Expression),
    Pattern(Pattern),
}

/// A pattern of `instanceof` or `case` (JLS 14.30).
#[derive(Debug)]
pub(crate) enum Pattern {
    /// `Type`, `Type name`; `var name` within a record pattern.
    Type { type_name: TypeName, name: Option<String> },
    /// `Point(int x, var y)`.
    Record { type_name: TypeName, parts: Vec<Self> },
    /// `_`.
    Any,
}

/// A lambda expression.
#[derive(Debug)]
pub(crate) struct Lambda {
    pub(crate) line: u32,
    /// Parameters; their type is `var` if none is written.
    pub(crate) parameters: Vec<Parameter>,
    /// An expression body is a `return`.
    pub(crate) body: Vec<Statement>,
    /// The names in it, in order, each once: those of variables that it may capture.
    pub(crate) names: Vec<String>,
    /// True if it can implement a method that returns nothing.
    pub(crate) is_void_compatible: bool,
    /// True if it can implement a method that returns a value.
    pub(crate) is_value_compatible: bool,
}

/// A method reference.
#[derive(Debug)]
pub(crate) struct Reference {
    pub(crate) line: u32,
    pub(crate) of: ReferenceOf,
    /// The method; none for `new`.
    pub(crate) name: Option<String>,
    /// The names in it, in order, each once.
    pub(crate) names: Vec<String>,
}

/// The part of a method reference before `::`.
#[derive(Debug)]
pub(crate) enum ReferenceOf {
    /// A value, or a name that may be that of a class.
    Expression(Expression),
    Type(TypeName),
}

#[derive(Debug)]
pub(crate) struct Catch {
    pub(crate) types: Vec<TypeName>,
    pub(crate) name: String,
    pub(crate) body: Vec<Statement>,
}

#[derive(Debug)]
pub(crate) struct Expression {
    /// Where it begins; of a call or an access to a field, where its name stands.
    pub(crate) line: u32,
    pub(crate) kind: ExpressionKind,
}

#[derive(Debug)]
pub(crate) enum ExpressionKind {
    Literal(Literal),
    /// A single name: of a local variable, a field or a class.
    Name(String),
    Field {
        of: Box<Expression>,
        name: String,
    },
    Call {
        on: Option<Box<Expression>>,
        name: String,
        arguments: Vec<Expression>,
    },
    /// `this(...)` in a constructor.
    ThisCall(Vec<Expression>),
    /// `super(...)` in a constructor.
    SuperCall(Vec<Expression>),
    New {
        type_name: TypeName,
        arguments: Vec<Expression>,
        /// Of an anonymous class.
        body: Option<Arc<Class>>,
    },
    /// `new int[2][]`, `new int[] {1, 2}`.
    NewArray {
        /// With all dimensions.
        type_name: TypeName,
        /// Those that are given.
        lengths: Vec<Expression>,
        values: Option<Vec<Expression>>,
    },
    /// `{1, 2}` where an array is declared, or within another.
    Array(Vec<Expression>),
    Index {
        of: Box<Expression>,
        index: Box<Expression>,
    },
    Unary {
        operator: UnaryOperator,
        value: Box<Expression>,
    },
    /// `++a`, `a--`.
    Step {
        target: Box<Expression>,
        is_increment: bool,
        is_prefix: bool,
    },
    Binary {
        operator: BinaryOperator,
        left: Box<Expression>,
        right: Box<Expression>,
    },
    /// `a = b`, `a += b`.
    Assign {
        operator: Option<BinaryOperator>,
        target: Box<Expression>,
        value: Box<Expression>,
    },
    Conditional {
        condition: Box<Expression>,
        then: Box<Expression>,
        otherwise: Box<Expression>,
    },
    Cast {
        type_name: TypeName,
        value: Box<Expression>,
    },
    InstanceOf {
        value: Box<Expression>,
        pattern: Pattern,
    },
    This,
    /// `super` before a method or field.
    Super,
    /// `Name.super`.
    SuperOf(TypeName),
    /// `Name.class`.
    ClassLiteral(TypeName),
    /// A `switch` with a value: what its groups [yield](StatementKind::Yield).
    Switch {
        value: Box<Expression>,
        groups: Vec<SwitchGroup>,
    },
    Lambda(Arc<Lambda>),
    Reference(Arc<Reference>),
    /// Its name with an article: "a string template".
    Unsupported(String),
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Literal {
    Null,
    Boolean(bool),
    Char(u16),
    Int(i32),
    Long(i64),
    Float(f32),
    Double(f64),
    String(String),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UnaryOperator {
    Plus,
    Minus,
    Not,
    /// `~`.
    Complement,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum BinaryOperator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Remainder,
    ShiftLeft,
    ShiftRight,
    /// `>>>`.
    ShiftRightUnsigned,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
    /// `&`, of bits or without short circuit.
    And,
    Xor,
    Or,
    /// `&&`.
    AndAlso,
    /// `||`.
    OrElse,
}
