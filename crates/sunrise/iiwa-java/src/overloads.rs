//! Resolution of methods and constructors (JLS 15.12.2).

use std::{rc::Rc, sync::Arc};

use crate::{
    class_id::ClassId,
    classes::simple,
    interfaces::interface,
    machine::Machine,
    stop::EvaluationStop,
    syntax::{Method, TypeName},
    unknown::Unknown,
    value::{Function, FunctionCode, JavaObject, Value},
};

/// Method with its class.
type Candidate = (ClassId, Arc<Method>);

/// Result of a method resolution.
pub(crate) enum Choice {
    Method(ClassId, Arc<Method>),
    /// Several candidates, because the type of an argument is unknown.
    Undecided(Rc<Unknown>, Vec<Arc<Method>>),
}

impl Choice {
    pub(crate) fn has_body(&self) -> bool {
        match self {
            Self::Method(_, method) => method.body.is_some(),
            Self::Undecided(_, methods) => methods.iter().any(|method| method.body.is_some()),
        }
    }
}

impl Machine {
    /// Resolves a method; `None` if no method fits.
    ///
    /// If several methods fit the argument values, the argument types decide, as far as the call
    /// states them.
    pub(crate) fn method(&self, id: ClassId, name: &str, arguments: &[Value]) -> Option<Choice> {
        let candidates = self.java.classes.methods(id, name);
        self.chosen(candidates, name, arguments)
    }

    /// Returns the method without parameters, and its class.
    pub(crate) fn plain_method(&self, id: ClassId, name: &str) -> Option<Candidate> {
        match self.method(id, name, &[])? {
            Choice::Method(owner, method) => Some((owner, method)),
            Choice::Undecided(..) => None,
        }
    }

    /// Returns the best of these methods, which are sorted, the nearest first.
    pub(crate) fn chosen(
        &self,
        candidates: Vec<Candidate>,
        name: &str,
        arguments: &[Value],
    ) -> Option<Choice> {
        let mut fitting: Vec<(u32, Candidate)> = Vec::new();
        for (owner, method) in candidates {
            let Some(fit) = self.fit(owner, &method, arguments) else { continue };
            let same = fitting.iter_mut().find(|(_, (_, other))| is_overridden(other, &method));
            match same {
                // Among methods that override each other, the nearest with a body is kept.
                Some((_, cached)) => {
                    if cached.1.body.is_none() && method.body.is_some() {
                        *cached = (owner, method);
                    }
                }
                None => fitting.push((fit, (owner, method))),
            }
        }
        let unknown = arguments.iter().find_map(Value::unknown).cloned();
        let types = self.java.argument_types.as_ref().filter(|(method, _)| method == name);
        if let (Some((_, types)), true) = (types, fitting.len() > 1)
            && types.len() == arguments.len()
        {
            let all: Vec<Candidate> = fitting.into_iter().map(|(_, candidate)| candidate).collect();
            if let Some((owner, method)) = self.most_specific(&all, types) {
                return Some(Choice::Method(owner, method));
            }
            let unknown = unknown.unwrap_or_else(|| {
                let reason = format!("the types of the arguments of `{name}`, which are not known");
                Rc::new(Unknown { reason, place: self.place.clone(), is_unmodelled_call: false })
            });
            let all = all.into_iter().map(|(_, method)| method).collect();
            return Some(Choice::Undecided(unknown, all));
        }
        let best = fitting.iter().map(|(fit, _)| *fit).max()?;
        let mut best =
            fitting.into_iter().filter(|(fit, _)| *fit == best).map(|(_, method)| method);
        let (owner, method) = best.next()?;
        if let Some(unknown) = unknown {
            let open = |method: &Method| {
                let pairs = method.parameters.iter().zip(arguments);
                let open = pairs.filter(|(_, value)| value.unknown().is_some());
                open.map(|(parameter, _)| parameter.type_name.clone()).collect::<Vec<_>>()
            };
            let first = open(&method);
            let others: Vec<_> = best.map(|(_, method)| method).collect();
            if others.iter().any(|method| open(method) != first) {
                let all = std::iter::once(method).chain(others).collect();
                return Some(Choice::Undecided(unknown, all));
            }
        }
        Some(Choice::Method(owner, method))
    }

    /// Calls the resolved method, on this object unless the method is static. An undecided call
    /// runs no candidate, and the values that they may change are unknown.
    pub(crate) fn run_chosen(
        &mut self,
        choice: Choice,
        this: Option<Rc<JavaObject>>,
        name: &str,
        arguments: &[Value],
    ) -> Result<Value, EvaluationStop> {
        let (unknown, methods) = match choice {
            Choice::Method(owner, method) => {
                let this = this.filter(|_| !method.is_static);
                return self.run(owner, this, &method, arguments);
            }
            Choice::Undecided(unknown, methods) => (unknown, methods),
        };
        for method in methods {
            let effects = self.effects_of(method.body.iter().flatten());
            if effects.acts() {
                return self
                    .reject_unknown(&format!("which of the methods `{name}` is called"), &unknown);
            }
            self.forget_values(&effects, &unknown);
        }
        Ok(Value::Unknown(unknown))
    }

    /// Returns the most specific method for the argument types; `None` if they do not decide.
    fn most_specific(&self, all: &[Candidate], types: &[Option<TypeName>]) -> Option<Candidate> {
        for phase in [ResolutionPhase::Strict, ResolutionPhase::Loose, ResolutionPhase::Variadic] {
            let mut applicable = Vec::new();
            let mut is_certain = true;
            for candidate in all {
                match self.applies(candidate, types, phase) {
                    Some(true) => applicable.push(candidate),
                    Some(false) => {}
                    None => {
                        is_certain = false;
                        applicable.push(candidate);
                    }
                }
            }
            let is_best = |candidate: &&Candidate| {
                applicable.iter().all(|other| {
                    Arc::ptr_eq(&candidate.1, &other.1)
                        || self.is_more_specific(candidate, other, phase)
                })
            };
            match (&applicable[..], is_certain) {
                ([], _) => {}
                ([only], _) => return Some((*only).clone()),
                (_, true) => return applicable.iter().copied().find(is_best).cloned(),
                (_, false) => return None,
            }
        }
        None
    }

    /// Returns the rank of arguments for a method's parameters; `None` if they do not fit.
    pub(crate) fn fit(&self, owner: ClassId, method: &Method, arguments: &[Value]) -> Option<u32> {
        let parameters = &method.parameters;
        let all = |arguments: &[Value]| {
            let pairs = arguments.iter().zip(parameters);
            let fits = pairs.map(|(value, type_name)| {
                let wanted = self.erased_parameter(owner, method, &type_name.type_name);
                self.fits(owner, value, &wanted)
            });
            fits.sum::<Option<u32>>()
        };
        if arguments.len() == parameters.len()
            && let Some(fit) = all(arguments)
        {
            return Some(1000 + fit);
        }
        let fixed = parameters.len().checked_sub(1).filter(|_| method.is_variadic)?;
        let (first, others) = arguments.split_at_checked(fixed)?;
        let last = &parameters.get(fixed)?.type_name;
        let last = self.erased_parameter(owner, method, last);
        let element = last.with_dimensions(last.dimensions.checked_sub(1)?);
        let rest = others.iter().map(|value| self.fits(owner, value, &element));
        Some(all(first)? + rest.sum::<Option<u32>>()?)
    }

    pub(crate) fn fits(&self, owner: ClassId, value: &Value, wanted: &TypeName) -> Option<u32> {
        if wanted.dimensions > 0 {
            return match value {
                Value::Array(array) if array.element.dimensions + 1 == wanted.dimensions => Some(9),
                Value::Null | Value::Unknown(_) => Some(3),
                _ => None,
            };
        }
        let name = simple(&wanted.name);
        let rank = |order: &[&str]| {
            let place = order.iter().position(|primitive| *primitive == name);
            place.and_then(|place| u32::try_from(9 - place.min(8)).ok())
        };
        let is_primitive = matches!(
            name,
            "boolean" | "char" | "byte" | "short" | "int" | "long" | "float" | "double"
        );
        match value {
            Value::Unknown(_) => Some(3),
            Value::Null => (!is_primitive).then_some(3),
            Value::Boolean(_) => rank(&["boolean", "Boolean", "Object", "Comparable"]),
            Value::Char(_) => rank(&[
                "char",
                "int",
                "long",
                "float",
                "double",
                "Character",
                "Object",
                "Comparable",
            ]),
            Value::Int(_) => rank(&[
                "int",
                "long",
                "float",
                "double",
                "Integer",
                "Number",
                "Object",
                "short",
                "byte",
                "Comparable",
            ]),
            Value::Long(_) => {
                rank(&["long", "float", "double", "Long", "Number", "Object", "Comparable"])
            }
            Value::Float(_) => {
                rank(&["float", "double", "Float", "Number", "Object", "Comparable"])
            }
            Value::Double(_) => rank(&["double", "Double", "Number", "Object", "Comparable"]),
            Value::Text(_) => rank(&["String", "CharSequence", "Object", "Comparable"]),
            Value::Object(object) => match self.java.classes.find(&wanted.name, owner) {
                Some(id) => {
                    let parents = self.java.classes.with_parents(object.class);
                    let place = parents.iter().position(|parent| *parent == id)?;
                    u32::try_from(9 - place.min(7)).ok()
                }
                None if is_primitive || name == "String" => None,
                None => Some(1),
            },
            Value::Array(_) => (name == "Object").then_some(2),
            Value::Function(function) => self.fits_interface(owner, function, wanted),
            _ if is_primitive || name == "String" => None,
            Value::Host(host) => Some(match self.java.classes.find(&wanted.name, owner) {
                Some(_) => return None,
                None if host.class() == name => 8,
                None => 2,
            }),
            _ => match self.java.classes.find(&wanted.name, owner) {
                Some(_) => None,
                None => Some(2),
            },
        }
    }

    /// Returns the rank of a function as an argument for an interface; `None` if it does not fit
    /// (JLS 15.12.2.1).
    fn fits_interface(
        &self,
        owner: ClassId,
        function: &Function,
        wanted: &TypeName,
    ) -> Option<u32> {
        if simple(&wanted.name) == "Object" {
            return None;
        }
        let class = self.java.classes.find(&wanted.name, owner);
        let own_method = class.and_then(|id| self.abstract_method(id));
        let foreign = match class {
            Some(id) => self.foreign_interface(id),
            None => interface(simple(&wanted.name)),
        };
        let (parameters, is_void) = match (own_method, foreign) {
            (Some((_, method)), _) => (method.parameters.len(), method.returns.name == "void"),
            (None, Some(interface)) => (interface.parameters.len(), interface.returns_nothing()),
            (None, None) if class.is_some() => return None,
            // Interface of a library without source.
            (None, None) => return Some(2),
        };
        let FunctionCode::Lambda(lambda) = &function.code else { return Some(8) };
        let is_compatible =
            if is_void { lambda.is_void_compatible } else { lambda.is_value_compatible };
        (is_compatible && lambda.parameters.len() == parameters).then_some(8)
    }

    /// Returns true if a method is applicable to arguments of these types; `None` if undecided.
    fn applies(
        &self,
        (owner, method): &Candidate,
        types: &[Option<TypeName>],
        phase: ResolutionPhase,
    ) -> Option<bool> {
        let mut is_certain = true;
        if phase == ResolutionPhase::Variadic && !method.is_variadic
            || phase != ResolutionPhase::Variadic && types.len() != method.parameters.len()
        {
            return Some(false);
        }
        for (place, type_name) in types.iter().enumerate() {
            let wanted = parameter(method, place, phase)?;
            let wanted = self.erased_parameter(*owner, method, &wanted);
            match type_name.as_ref().and_then(|type_name| {
                self.widens(type_name, &wanted, phase != ResolutionPhase::Strict)
            }) {
                Some(true) => {}
                Some(false) => return Some(false),
                None => is_certain = false,
            }
        }
        is_certain.then_some(true)
    }

    fn is_more_specific(
        &self,
        candidate: &Candidate,
        other: &Candidate,
        phase: ResolutionPhase,
    ) -> bool {
        let count = candidate.1.parameters.len().max(other.1.parameters.len());
        let parameter_type = |(owner, method): &Candidate, place| {
            let declared = parameter(method, place, phase)?;
            Some(self.erased_parameter(*owner, method, &declared))
        };
        (0..count).all(|place| {
            match (parameter_type(candidate, place), parameter_type(other, place)) {
                (Some(type_name), Some(other)) => {
                    self.widens(&type_name, &other, false) == Some(true)
                }
                _ => false,
            }
        })
    }
}

/// Phases of Java's method resolution: without boxing, with boxing, and with variable arity.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ResolutionPhase {
    Strict,
    Loose,
    Variadic,
}

/// Returns the type of a parameter; in the third phase, the last parameter provides the type of
/// each further argument.
fn parameter(method: &Method, place: usize, phase: ResolutionPhase) -> Option<TypeName> {
    let last = method.parameters.len().checked_sub(1)?;
    let type_name = &method.parameters.get(place.min(last))?.type_name;
    if phase == ResolutionPhase::Variadic && method.is_variadic && place >= last {
        return Some(type_name.with_dimensions(type_name.dimensions.checked_sub(1)?));
    }
    (place <= last).then(|| type_name.clone())
}

/// Returns true if a superclass method has the same parameters, or, without a body, type variables
/// in their place.
fn is_overridden(method: &Method, other: &Method) -> bool {
    let mut pairs = method.parameters.iter().zip(&other.parameters);
    let is_variable =
        |type_name: &TypeName| type_name.dimensions == 0 && is_type_variable(&type_name.name);
    method.parameters.len() == other.parameters.len()
        && pairs.all(|(parameter, above)| {
            parameter.type_name == above.type_name
                || other.body.is_none() && is_variable(&above.type_name)
        })
}

/// Returns true for names such as `T` or `K2`.
fn is_type_variable(name: &str) -> bool {
    name.len() <= 2 && name.bytes().all(|byte| byte.is_ascii_uppercase() || byte.is_ascii_digit())
}
