//! Java syntax, as far as robot programs use it.

use std::sync::Arc;

/// Source file.
#[derive(Debug, Default)]
pub struct CompilationUnit {
    /// Package as `a.b`; empty for the default package.
    pub(crate) package: String,
    pub(crate) imports: Vec<ImportDeclaration>,
    pub(crate) classes: Vec<Arc<Class>>,
}

/// Import: `import a.b.C;`, `import static a.b.C.d;` or `import a.b.*;`.
#[derive(Debug)]
pub(crate) struct ImportDeclaration {
    /// Imported name `a.b.C`; for an on-demand import, the name before `.*`.
    pub(crate) path: String,
    pub(crate) is_static: bool,
    pub(crate) is_all: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ClassKind {
    Class,
    Interface,
    Enum,
    /// Record, read as a class with its implicit members.
    Record,
}

/// Class, interface, enum or record.
#[derive(Debug)]
pub(crate) struct Class {
    pub(crate) name: String,
    pub(crate) kind: ClassKind,
    pub(crate) line: u32,
    pub(crate) is_abstract: bool,
    pub(crate) type_parameters: Vec<TypeParameter>,
    pub(crate) extends: Option<TypeName>,
    /// Implemented interfaces; for an interface, the interfaces that it extends.
    pub(crate) implements: Vec<TypeName>,
    /// Enum constants.
    pub(crate) constants: Vec<Constant>,
    /// Fields and initialisers in order.
    pub(crate) members: Vec<Member>,
    pub(crate) methods: Vec<Arc<Method>>,
    pub(crate) constructors: Vec<Arc<Method>>,
    /// Member classes.
    pub(crate) classes: Vec<Arc<Class>>,
}

/// Enum constant.
#[derive(Debug)]
pub(crate) struct Constant {
    pub(crate) name: String,
    pub(crate) line: u32,
    pub(crate) arguments: Vec<Expression>,
    /// Class body of the constant.
    pub(crate) body: Option<Arc<Class>>,
}

#[derive(Debug)]
pub(crate) enum Member {
    Field(Field),
    Initializer { is_static: bool, body: Vec<Statement> },
}

/// Field; `int a = 1, b;` declares two.
#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) type_name: TypeName,
    pub(crate) line: u32,
    /// `true` for static fields, including all fields of an interface.
    pub(crate) is_static: bool,
    pub(crate) annotations: Vec<Annotation>,
    pub(crate) initial: Option<Expression>,
}

/// Annotation `@Name` or `@Name("value")`; other arguments are left out.
#[derive(Debug)]
pub(crate) struct Annotation {
    /// Name without the package.
    pub(crate) name: String,
    pub(crate) value: Option<String>,
}

/// Method or constructor.
#[derive(Debug)]
pub(crate) struct Method {
    /// Name; for constructors, the name of the class.
    pub(crate) name: String,
    pub(crate) line: u32,
    pub(crate) is_static: bool,
    pub(crate) annotations: Vec<Annotation>,
    pub(crate) type_parameters: Vec<TypeParameter>,
    pub(crate) parameters: Vec<Parameter>,
    /// `true` for variable arity; the type of the last parameter then has one more dimension than
    /// written.
    pub(crate) is_variadic: bool,
    /// Result type, `void` if nothing is returned.
    pub(crate) returns: TypeName,
    /// Body; `None` if the method is abstract or native.
    pub(crate) body: Option<Vec<Statement>>,
}

#[derive(Debug)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) type_name: TypeName,
}

/// Type variable of a class or a method: `T extends Frame`.
#[derive(Clone, Debug)]
pub(crate) struct TypeParameter {
    pub(crate) name: String,
    /// First bound.
    pub(crate) bound: Option<TypeName>,
}

/// Type. Equality compares erasures (JLS 4.6), without type arguments.
#[derive(Clone, Debug)]
pub(crate) struct TypeName {
    /// Name as written: `int`, `Frame`, `a.b.C`, `Outer.Inner`.
    pub(crate) name: String,
    /// Number of array dimensions.
    pub(crate) dimensions: usize,
    /// Type arguments; wildcards by their bounds. Arguments that a compiler would infer have an
    /// empty name.
    pub(crate) arguments: Vec<Self>,
}

impl TypeName {
    pub(crate) fn new(name: &str, dimensions: usize) -> Self {
        Self { name: name.to_owned(), dimensions, arguments: Vec::new() }
    }

    /// Returns the element type of an array.
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
        variables: Vec<LocalVariable>,
    },
    LocalClass(Arc<Class>),
    Expression(Expression),
    If {
        condition: Expression,
        then_branch: Box<Statement>,
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
        /// Declaration, or expressions.
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
    /// Yields the value of the enclosing switch.
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
    /// Unsupported statement, with an article: "an annotation type".
    Unsupported(String),
}

/// Local variable of a declaration.
#[derive(Debug)]
pub(crate) struct LocalVariable {
    pub(crate) name: String,
    /// Number of `[]` after the name, beyond those of the type.
    pub(crate) dimensions: usize,
    pub(crate) initial: Option<Expression>,
}

/// Switch group: `case 1: case 2: ...`.
#[derive(Debug)]
pub(crate) struct SwitchGroup {
    pub(crate) labels: Vec<Label>,
    /// Condition after `when`.
    pub(crate) guard: Option<Expression>,
    pub(crate) body: Vec<Statement>,
    /// `true` if the group falls through into the next one: false with `->`.
    pub(crate) falls_through: bool,
}

#[derive(Debug)]
pub(crate) enum Label {
    Default,
    Value(Expression),
    Pattern(Pattern),
}

/// Pattern of `instanceof` or `case` (JLS 14.30).
#[derive(Debug)]
pub(crate) enum Pattern {
    /// Type pattern: `Type`, `Type name`; `var name` within a record pattern.
    Type { type_name: TypeName, name: Option<String> },
    /// Record pattern: `Point(int x, var y)`.
    Record { type_name: TypeName, parts: Vec<Self> },
    /// Unnamed pattern: `_`.
    Any,
}

/// Lambda expression.
#[derive(Debug)]
pub(crate) struct Lambda {
    pub(crate) line: u32,
    /// Parameters; their type is `var` if it is not written.
    pub(crate) parameters: Vec<Parameter>,
    /// Statements; an expression body is a `return`.
    pub(crate) body: Vec<Statement>,
    /// Names in the lambda, in order, without duplicates: candidates for captured variables.
    pub(crate) names: Vec<String>,
    /// `true` if the lambda can implement a method that returns nothing.
    pub(crate) is_void_compatible: bool,
    /// `true` if the lambda can implement a method that returns a value.
    pub(crate) is_value_compatible: bool,
}

/// Method reference.
#[derive(Debug)]
pub(crate) struct Reference {
    pub(crate) line: u32,
    pub(crate) target: ReferenceTarget,
    /// Name of the method; `None` for `new`.
    pub(crate) name: Option<String>,
    /// Names in the reference, in order, without duplicates.
    pub(crate) names: Vec<String>,
}

/// Part of a method reference before `::`.
#[derive(Debug)]
pub(crate) enum ReferenceTarget {
    /// Value, or a name that may be a class name.
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
    /// First line; for a call or a field access, the line of the name.
    pub(crate) line: u32,
    pub(crate) kind: ExpressionKind,
}

#[derive(Debug)]
pub(crate) enum ExpressionKind {
    Literal(Literal),
    /// Simple name of a local variable, a field or a class.
    Name(String),
    Field {
        object: Box<Expression>,
        name: String,
    },
    Call {
        on: Option<Box<Expression>>,
        name: String,
        arguments: Vec<Expression>,
    },
    /// Call of `this(...)` in a constructor.
    ThisCall(Vec<Expression>),
    /// Call of `super(...)` in a constructor.
    SuperCall(Vec<Expression>),
    New {
        type_name: TypeName,
        arguments: Vec<Expression>,
        /// Body of an anonymous class.
        body: Option<Arc<Class>>,
    },
    /// Array creation: `new int[2][]`, `new int[] {1, 2}`.
    NewArray {
        /// Type with all dimensions.
        type_name: TypeName,
        /// Given lengths.
        lengths: Vec<Expression>,
        values: Option<Vec<Expression>>,
    },
    /// Array initialiser `{1, 2}` in an array declaration, or within another one.
    Array(Vec<Expression>),
    Index {
        array: Box<Expression>,
        index: Box<Expression>,
    },
    Unary {
        operator: UnaryOperator,
        value: Box<Expression>,
    },
    /// Increment or decrement: `++a`, `a--`.
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
    /// Assignment: `a = b`, `a += b`.
    Assign {
        operator: Option<BinaryOperator>,
        target: Box<Expression>,
        value: Box<Expression>,
    },
    Conditional {
        condition: Box<Expression>,
        then_value: Box<Expression>,
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
    /// Switch expression: its groups [yield](StatementKind::Yield) the value.
    Switch {
        value: Box<Expression>,
        groups: Vec<SwitchGroup>,
    },
    Lambda(Arc<Lambda>),
    Reference(Arc<Reference>),
    /// Unsupported expression, with an article: "a string template".
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
    /// `&`, bitwise or without short circuit.
    And,
    Xor,
    Or,
    /// `&&`.
    AndAlso,
    /// `||`.
    OrElse,
}
