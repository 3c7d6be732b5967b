//! Type arguments and type variables: types of elements, results, and members of generic classes.

use crate::{
    class_id::ClassId,
    classes::simple,
    interfaces::{Interface, interface},
    machine::Machine,
    syntax::{Expression, ExpressionKind, Method, TypeName, TypeParameter},
    type_names::{boxed, plain},
};

/// Java library collections, whose type argument is the element type.
const COLLECTIONS: [&str; 20] = [
    "Iterable",
    "Collection",
    "List",
    "ArrayList",
    "LinkedList",
    "Vector",
    "Stack",
    "CopyOnWriteArrayList",
    "Set",
    "HashSet",
    "LinkedHashSet",
    "TreeSet",
    "SortedSet",
    "NavigableSet",
    "Queue",
    "Deque",
    "ArrayDeque",
    "PriorityQueue",
    "LinkedBlockingQueue",
    "ConcurrentLinkedQueue",
];

/// Java library maps, whose type arguments are the key and value types.
const MAPS: [&str; 9] = [
    "Map",
    "HashMap",
    "LinkedHashMap",
    "TreeMap",
    "SortedMap",
    "NavigableMap",
    "Hashtable",
    "ConcurrentHashMap",
    "EnumMap",
];

impl Machine {
    /// Returns the element type of an iterated expression.
    pub(crate) fn type_of_element(&self, iterable: &Expression) -> Option<TypeName> {
        let of = self.static_type(iterable)?;
        if of.dimensions > 0 {
            return Some(of.element());
        }
        if !COLLECTIONS.contains(&simple(&of.name)) || self.is_of_project(&of) {
            return None;
        }
        self.erased(argument(&of, 0)?)
    }

    /// Returns the result type of a Java library method; `None` if it is unknown.
    pub(crate) fn type_of_library_result(
        &self,
        of: &TypeName,
        name: &str,
        arguments: usize,
    ) -> Option<TypeName> {
        if of.dimensions > 0 || self.is_of_project(of) {
            return None;
        }
        let class = simple(&of.name);
        let generic = |name: &str, arguments: Vec<TypeName>| {
            Some(TypeName { name: name.to_owned(), dimensions: 0, arguments })
        };
        if COLLECTIONS.contains(&class) {
            return match (name, arguments) {
                (
                    "get" | "set" | "elementAt" | "getFirst" | "getLast" | "firstElement"
                    | "lastElement" | "removeFirst" | "removeLast" | "peek" | "peekFirst"
                    | "peekLast" | "poll" | "pollFirst" | "pollLast" | "pop" | "element" | "first"
                    | "last" | "take" | "floor" | "ceiling" | "higher" | "lower",
                    _,
                )
                | ("remove", 0) => argument(of, 0),
                ("iterator" | "listIterator", _) => generic("Iterator", vec![argument(of, 0)?]),
                ("subList", _) => generic("List", vec![argument(of, 0)?]),
                _ => None,
            };
        }
        if MAPS.contains(&class) {
            let entry = || generic("Entry", vec![argument(of, 0)?, argument(of, 1)?]);
            return match (name, arguments) {
                (
                    "get" | "put" | "getOrDefault" | "putIfAbsent" | "computeIfAbsent"
                    | "computeIfPresent" | "compute" | "merge",
                    _,
                )
                | ("remove", 1) => argument(of, 1),
                (
                    "firstKey" | "lastKey" | "floorKey" | "ceilingKey" | "higherKey" | "lowerKey",
                    _,
                ) => argument(of, 0),
                ("keySet", _) => generic("Set", vec![argument(of, 0)?]),
                ("values", _) => generic("Collection", vec![argument(of, 1)?]),
                ("entrySet", _) => generic("Set", vec![entry()?]),
                ("firstEntry" | "lastEntry", _) => entry(),
                _ => None,
            };
        }
        match (class, name) {
            ("Iterator" | "ListIterator", "next" | "previous")
            | ("Entry", "getKey")
            | ("AtomicReference" | "Optional", "get" | "getAndSet" | "orElse" | "orElseThrow") => {
                argument(of, 0)
            }
            ("Entry", "getValue") => argument(of, 1),
            ("AtomicInteger", "get") => Some(plain("int")),
            ("AtomicLong", "get") => Some(plain("long")),
            ("AtomicBoolean", "get") => Some(plain("boolean")),
            ("String", "split") => Some(TypeName::new("String", 1)),
            ("String", "toCharArray") => Some(TypeName::new("char", 1)),
            _ => {
                let own = interface(class).filter(|own| own.method == name)?;
                let object = [plain("Object"), plain("Object"), plain("Object")];
                let arguments = if of.arguments.is_empty() { &object[..] } else { &of.arguments };
                Interface::resolved(own.returns, arguments)
            }
        }
    }

    /// Replaces the type variables of the running method and its classes by their bounds.
    pub(crate) fn erased(&self, own: TypeName) -> Option<TypeName> {
        if own.name.is_empty() {
            return None;
        }
        let Some(activation) = self.java.activation() else { return Some(own) };
        let of_method = activation.type_parameters.iter();
        if let Some(found) = of_method.clone().find(|variable| variable.name == own.name) {
            return Some(bounded(&own, found));
        }
        let mut class = Some(activation.class);
        while let Some(id) = class {
            let known = self.java.classes.known(id);
            let variables = &known.class.type_parameters;
            if let Some(found) = variables.iter().find(|variable| variable.name == own.name) {
                return Some(bounded(&own, found));
            }
            class = known.outer;
        }
        Some(own)
    }

    /// Returns true if a type mentions type variables of a class.
    pub(crate) fn mentions_variables(&self, owner: ClassId, own: &TypeName) -> bool {
        mentions(own, &self.java.classes.known(owner).class.type_parameters)
    }

    /// Returns the type of a class member for the expression before its dot; `None` if it is
    /// undetermined.
    pub(crate) fn type_of_member(
        &self,
        on: Option<&Expression>,
        owner: ClassId,
        declared: &TypeName,
    ) -> Option<TypeName> {
        let variables = &self.java.classes.known(owner).class.type_parameters;
        if !self.mentions_variables(owner, declared) {
            return Some(declared.clone());
        }
        let within = self.java.activation()?.class;
        let on = on.filter(|on| !matches!(on.kind, ExpressionKind::This));
        let (class, arguments) = match on {
            None if within == owner => return Some(declared.clone()),
            None => (within, Vec::new()),
            Some(on) => {
                let of = self.static_type(on)?;
                let class = self.java.classes.find(&of.name, within)?;
                if of.arguments.is_empty()
                    && !self.java.classes.known(class).class.type_parameters.is_empty()
                {
                    // Members of a raw type are erased (JLS 4.8).
                    let found = variables.iter().find(|variable| variable.name == declared.name);
                    return Some(match found {
                        Some(found) => bounded(declared, found),
                        None => TypeName { arguments: Vec::new(), ..declared.clone() },
                    });
                }
                (class, of.arguments)
            }
        };
        let arguments = self.arguments_above(class, arguments, owner)?;
        substituted(declared, variables, &arguments)
    }

    /// Returns the type arguments of a superclass, for a class with type arguments.
    fn arguments_above(
        &self,
        class: ClassId,
        arguments: Vec<TypeName>,
        owner: ClassId,
    ) -> Option<Vec<TypeName>> {
        let (mut class, mut arguments) = (class, arguments);
        for _ in 0..crate::java_state::MAX_DEPTH {
            if class == owner {
                return Some(arguments);
            }
            let own = &self.java.classes.known(class).class;
            let mut above = own.extends.iter().chain(&own.implements);
            let next = above.find_map(|name| {
                let id = self.java.classes.find(&name.name, class)?;
                self.java.classes.is_a(id, owner).then_some((id, name))
            });
            let (id, name) = next?;
            let given = name.arguments.iter();
            arguments = given
                .map(|given| {
                    if mentions(given, &own.type_parameters) {
                        substituted(given, &own.type_parameters, &arguments)
                    } else {
                        Some(given.clone())
                    }
                })
                .collect::<Option<_>>()?;
            class = id;
        }
        None
    }

    /// Returns the result type of a method that mentions its own type variables: the type of the
    /// argument for the only parameter of this type.
    pub(crate) fn type_by_arguments(
        &self,
        method: &Method,
        arguments: &[Expression],
    ) -> Option<TypeName> {
        if !mentions(&method.returns, &method.type_parameters) {
            return Some(method.returns.clone());
        }
        let of = method.parameters.iter().enumerate();
        let mut places = of.filter(|(_, own)| mentions(&own.type_name, &method.type_parameters));
        let (place, parameter) = places.next().filter(|_| places.next().is_none())?;
        let given = self.static_type(arguments.get(place)?)?;
        let is_last = place + 1 == method.parameters.len();
        if method.returns.dimensions > 0 || method.is_variadic && is_last {
            return None;
        }
        if parameter.type_name == method.returns {
            let name = boxed(&given.name).filter(|_| given.dimensions == 0);
            return Some(name.map_or(given, plain));
        }
        // Methods such as `T first(List<T> list)`.
        let [variable] = &parameter.type_name.arguments[..] else { return None };
        let [argument] = &given.arguments[..] else { return None };
        (*variable == method.returns && !argument.name.is_empty()).then(|| argument.clone())
    }

    /// Returns the type of a parameter, without type variables of its method and class.
    pub(crate) fn erased_parameter(
        &self,
        owner: ClassId,
        method: &Method,
        own: &TypeName,
    ) -> TypeName {
        let of_class = &self.java.classes.known(owner).class.type_parameters;
        let mut variables = method.type_parameters.iter().chain(of_class);
        match variables.find(|variable| variable.name == own.name) {
            Some(found) => bounded(own, found),
            None => own.clone(),
        }
    }
}

/// Returns the type argument at an index; `Object` for a raw type.
fn argument(of: &TypeName, place: usize) -> Option<TypeName> {
    if of.arguments.is_empty() {
        return Some(plain("Object"));
    }
    of.arguments.get(place).filter(|own| !own.name.is_empty()).cloned()
}

/// Returns the bound of a type variable, as an array if the type is an array of the variable.
fn bounded(own: &TypeName, variable: &TypeParameter) -> TypeName {
    let bound = variable.bound.clone().unwrap_or_else(|| plain("Object"));
    bound.with_dimensions(bound.dimensions + own.dimensions)
}

fn mentions(own: &TypeName, variables: &[TypeParameter]) -> bool {
    variables.iter().any(|variable| variable.name == own.name)
        || own.arguments.iter().any(|argument| mentions(argument, variables))
}

/// Substitutes type arguments for type variables.
fn substituted(
    own: &TypeName,
    variables: &[TypeParameter],
    arguments: &[TypeName],
) -> Option<TypeName> {
    if variables.len() != arguments.len() {
        return None;
    }
    if let Some(place) = variables.iter().position(|variable| variable.name == own.name) {
        let given = &arguments[place];
        return (!given.name.is_empty())
            .then(|| given.with_dimensions(given.dimensions + own.dimensions));
    }
    let parts = own.arguments.iter().map(|part| substituted(part, variables, arguments));
    Some(TypeName { arguments: parts.collect::<Option<_>>()?, ..own.clone() })
}
