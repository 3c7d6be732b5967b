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
        let iterable_type = self.static_type(iterable)?;
        if iterable_type.dimensions > 0 {
            return Some(iterable_type.element());
        }
        if !COLLECTIONS.contains(&simple(&iterable_type.name)) || self.is_of_project(&iterable_type)
        {
            return None;
        }
        self.erased(argument(&iterable_type, 0)?)
    }

    /// Returns the result type of a Java library method; `None` if it is unknown.
    pub(crate) fn type_of_library_result(
        &self,
        type_name: &TypeName,
        name: &str,
        arguments: usize,
    ) -> Option<TypeName> {
        if type_name.dimensions > 0 || self.is_of_project(type_name) {
            return None;
        }
        let class = simple(&type_name.name);
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
                | ("remove", 0) => argument(type_name, 0),
                ("iterator" | "listIterator", _) => {
                    generic("Iterator", vec![argument(type_name, 0)?])
                }
                ("subList", _) => generic("List", vec![argument(type_name, 0)?]),
                _ => None,
            };
        }
        if MAPS.contains(&class) {
            let entry = || generic("Entry", vec![argument(type_name, 0)?, argument(type_name, 1)?]);
            return match (name, arguments) {
                (
                    "get" | "put" | "getOrDefault" | "putIfAbsent" | "computeIfAbsent"
                    | "computeIfPresent" | "compute" | "merge",
                    _,
                )
                | ("remove", 1) => argument(type_name, 1),
                (
                    "firstKey" | "lastKey" | "floorKey" | "ceilingKey" | "higherKey" | "lowerKey",
                    _,
                ) => argument(type_name, 0),
                ("keySet", _) => generic("Set", vec![argument(type_name, 0)?]),
                ("values", _) => generic("Collection", vec![argument(type_name, 1)?]),
                ("entrySet", _) => generic("Set", vec![entry()?]),
                ("firstEntry" | "lastEntry", _) => entry(),
                _ => None,
            };
        }
        match (class, name) {
            ("Iterator" | "ListIterator", "next" | "previous")
            | ("Entry", "getKey")
            | ("AtomicReference" | "Optional", "get" | "getAndSet" | "orElse" | "orElseThrow") => {
                argument(type_name, 0)
            }
            ("Entry", "getValue") => argument(type_name, 1),
            ("AtomicInteger", "get") => Some(plain("int")),
            ("AtomicLong", "get") => Some(plain("long")),
            ("AtomicBoolean", "get") => Some(plain("boolean")),
            ("String", "split") => Some(TypeName::new("String", 1)),
            ("String", "toCharArray") => Some(TypeName::new("char", 1)),
            _ => {
                let interface = interface(class).filter(|interface| interface.method == name)?;
                let object = [plain("Object"), plain("Object"), plain("Object")];
                let arguments =
                    if type_name.arguments.is_empty() { &object[..] } else { &type_name.arguments };
                Interface::resolved(interface.returns, arguments)
            }
        }
    }

    /// Replaces the type variables of the running method and its classes by their bounds.
    pub(crate) fn erased(&self, type_name: TypeName) -> Option<TypeName> {
        if type_name.name.is_empty() {
            return None;
        }
        let Some(activation) = self.java.activation() else { return Some(type_name) };
        let of_method = activation.type_parameters.iter();
        if let Some(variable) = of_method.clone().find(|variable| variable.name == type_name.name) {
            return Some(bounded(&type_name, variable));
        }
        let mut class = Some(activation.class);
        while let Some(id) = class {
            let known = self.java.classes.known(id);
            let variables = &known.class.type_parameters;
            if let Some(bound_variable) =
                variables.iter().find(|variable| variable.name == type_name.name)
            {
                return Some(bounded(&type_name, bound_variable));
            }
            class = known.outer;
        }
        Some(type_name)
    }

    /// Returns true if a type mentions type variables of a class.
    pub(crate) fn mentions_variables(&self, owner: ClassId, type_name: &TypeName) -> bool {
        mentions(type_name, &self.java.classes.known(owner).class.type_parameters)
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
                let receiver_type = self.static_type(on)?;
                let class = self.java.classes.find(&receiver_type.name, within)?;
                if receiver_type.arguments.is_empty()
                    && !self.java.classes.known(class).class.type_parameters.is_empty()
                {
                    // Members of a raw type are erased (JLS 4.8).
                    let bound_variable =
                        variables.iter().find(|variable| variable.name == declared.name);
                    return Some(match bound_variable {
                        Some(bound_variable) => bounded(declared, bound_variable),
                        None => TypeName { arguments: Vec::new(), ..declared.clone() },
                    });
                }
                (class, receiver_type.arguments)
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
            let declaration = &self.java.classes.known(class).class;
            let mut above = declaration.extends.iter().chain(&declaration.implements);
            let next = above.find_map(|name| {
                let id = self.java.classes.find(&name.name, class)?;
                self.java.classes.is_a(id, owner).then_some((id, name))
            });
            let (id, name) = next?;
            let given = name.arguments.iter();
            arguments = given
                .map(|given| {
                    if mentions(given, &declaration.type_parameters) {
                        substituted(given, &declaration.type_parameters, &arguments)
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
        let parameters = method.parameters.iter().enumerate();
        let mut places = parameters
            .filter(|(_, parameter)| mentions(&parameter.type_name, &method.type_parameters));
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
        type_name: &TypeName,
    ) -> TypeName {
        let of_class = &self.java.classes.known(owner).class.type_parameters;
        let mut variables = method.type_parameters.iter().chain(of_class);
        match variables.find(|variable| variable.name == type_name.name) {
            Some(bound_variable) => bounded(type_name, bound_variable),
            None => type_name.clone(),
        }
    }
}

/// Returns the type argument at an index; `Object` for a raw type.
fn argument(type_name: &TypeName, place: usize) -> Option<TypeName> {
    if type_name.arguments.is_empty() {
        return Some(plain("Object"));
    }
    type_name.arguments.get(place).filter(|argument| !argument.name.is_empty()).cloned()
}

/// Returns the bound of a type variable, as an array if the type is an array of the variable.
fn bounded(type_name: &TypeName, variable: &TypeParameter) -> TypeName {
    let bound = variable.bound.clone().unwrap_or_else(|| plain("Object"));
    bound.with_dimensions(bound.dimensions + type_name.dimensions)
}

fn mentions(type_name: &TypeName, variables: &[TypeParameter]) -> bool {
    variables.iter().any(|variable| variable.name == type_name.name)
        || type_name.arguments.iter().any(|argument| mentions(argument, variables))
}

/// Substitutes type arguments for type variables.
fn substituted(
    type_name: &TypeName,
    variables: &[TypeParameter],
    arguments: &[TypeName],
) -> Option<TypeName> {
    if variables.len() != arguments.len() {
        return None;
    }
    if let Some(place) = variables.iter().position(|variable| variable.name == type_name.name) {
        let given = &arguments[place];
        return (!given.name.is_empty())
            .then(|| given.with_dimensions(given.dimensions + type_name.dimensions));
    }
    let parts = type_name.arguments.iter().map(|part| substituted(part, variables, arguments));
    Some(TypeName { arguments: parts.collect::<Option<_>>()?, ..type_name.clone() })
}
