//! Functional interfaces of the Java library: `java.lang`, `java.util.function`, `java.util`,
//! `java.util.concurrent`.

use crate::syntax::TypeName;

/// Abstract method of a functional interface. Types are primitive types, `void`, the index of a
/// type argument, or `Object`.
#[derive(Debug)]
pub(crate) struct Interface {
    pub(crate) name: &'static str,
    pub(crate) method: &'static str,
    pub(crate) parameters: &'static [&'static str],
    pub(crate) returns: &'static str,
}

const fn of(
    name: &'static str,
    method: &'static str,
    parameters: &'static [&'static str],
    returns: &'static str,
) -> Interface {
    Interface { name, method, parameters, returns }
}

const ALL: [Interface; 48] = [
    of("Runnable", "run", &[], "void"),
    of("Callable", "call", &[], "0"),
    of("Comparator", "compare", &["0", "0"], "int"),
    of("Comparable", "compareTo", &["0"], "int"),
    of("Iterable", "iterator", &[], "Object"),
    of("Supplier", "get", &[], "0"),
    of("BooleanSupplier", "getAsBoolean", &[], "boolean"),
    of("IntSupplier", "getAsInt", &[], "int"),
    of("LongSupplier", "getAsLong", &[], "long"),
    of("DoubleSupplier", "getAsDouble", &[], "double"),
    of("Consumer", "accept", &["0"], "void"),
    of("BiConsumer", "accept", &["0", "1"], "void"),
    of("IntConsumer", "accept", &["int"], "void"),
    of("LongConsumer", "accept", &["long"], "void"),
    of("DoubleConsumer", "accept", &["double"], "void"),
    of("ObjIntConsumer", "accept", &["0", "int"], "void"),
    of("ObjLongConsumer", "accept", &["0", "long"], "void"),
    of("ObjDoubleConsumer", "accept", &["0", "double"], "void"),
    of("Function", "apply", &["0"], "1"),
    of("BiFunction", "apply", &["0", "1"], "2"),
    of("UnaryOperator", "apply", &["0"], "0"),
    of("BinaryOperator", "apply", &["0", "0"], "0"),
    of("IntFunction", "apply", &["int"], "0"),
    of("LongFunction", "apply", &["long"], "0"),
    of("DoubleFunction", "apply", &["double"], "0"),
    of("ToIntFunction", "applyAsInt", &["0"], "int"),
    of("ToLongFunction", "applyAsLong", &["0"], "long"),
    of("ToDoubleFunction", "applyAsDouble", &["0"], "double"),
    of("ToIntBiFunction", "applyAsInt", &["0", "1"], "int"),
    of("ToLongBiFunction", "applyAsLong", &["0", "1"], "long"),
    of("ToDoubleBiFunction", "applyAsDouble", &["0", "1"], "double"),
    of("IntUnaryOperator", "applyAsInt", &["int"], "int"),
    of("LongUnaryOperator", "applyAsLong", &["long"], "long"),
    of("DoubleUnaryOperator", "applyAsDouble", &["double"], "double"),
    of("IntBinaryOperator", "applyAsInt", &["int", "int"], "int"),
    of("LongBinaryOperator", "applyAsLong", &["long", "long"], "long"),
    of("DoubleBinaryOperator", "applyAsDouble", &["double", "double"], "double"),
    of("IntToLongFunction", "applyAsLong", &["int"], "long"),
    of("IntToDoubleFunction", "applyAsDouble", &["int"], "double"),
    of("LongToIntFunction", "applyAsInt", &["long"], "int"),
    of("LongToDoubleFunction", "applyAsDouble", &["long"], "double"),
    of("DoubleToIntFunction", "applyAsInt", &["double"], "int"),
    of("DoubleToLongFunction", "applyAsLong", &["double"], "long"),
    of("Predicate", "test", &["0"], "boolean"),
    of("BiPredicate", "test", &["0", "1"], "boolean"),
    of("IntPredicate", "test", &["int"], "boolean"),
    of("LongPredicate", "test", &["long"], "boolean"),
    of("DoublePredicate", "test", &["double"], "boolean"),
];

/// Library methods, of any class, that run functions given as arguments.
const RUNNING: [&str; 28] = [
    "forEach",
    "forEachOrdered",
    "forEachRemaining",
    "removeIf",
    "replaceAll",
    "sort",
    "computeIfAbsent",
    "computeIfPresent",
    "compute",
    "merge",
    "updateAndGet",
    "getAndUpdate",
    "accumulateAndGet",
    "getAndAccumulate",
    "setAll",
    "ifPresent",
    "ifPresentOrElse",
    "orElseGet",
    "map",
    "mapToInt",
    "mapToDouble",
    "mapToObj",
    "flatMap",
    "filter",
    "peek",
    "anyMatch",
    "allMatch",
    "noneMatch",
];

/// Returns the functional interface with a simple name.
pub(crate) fn interface(name: &str) -> Option<&'static Interface> {
    ALL.iter().find(|interface| interface.name == name)
}

/// Returns true if a library method with this number of arguments may run a function of any
/// interface.
pub(crate) fn runs_any(method: &str, arguments: usize) -> bool {
    // A comparator may run key extractors.
    arguments > 0 && RUNNING.contains(&method) || method == "compare"
}

/// Returns true if a method with this number of arguments may run a function with this number of
/// parameters through a Java library interface.
pub(crate) fn may_run(method: &str, arguments: usize, parameters: Option<usize>) -> bool {
    let is_it = |interface: &Interface| {
        interface.method == method
            && interface.parameters.len() == arguments
            && parameters.is_none_or(|count| count == arguments)
    };
    ALL.iter().any(is_it)
}

impl Interface {
    /// Resolves a type of the method with these type arguments; `None` if they do not determine it.
    pub(crate) fn resolved(type_name: &str, arguments: &[TypeName]) -> Option<TypeName> {
        match type_name.parse::<usize>() {
            Ok(place) => arguments.get(place).filter(|argument| !argument.name.is_empty()).cloned(),
            Err(_) => Some(TypeName::new(type_name, 0)),
        }
    }

    pub(crate) fn returns_nothing(&self) -> bool {
        self.returns == "void"
    }
}
