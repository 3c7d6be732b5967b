//! The choice among methods of a name.

use std::{rc::Rc, sync::Arc};

use crate::{
    class_id::ClassId,
    classes::simple,
    machine::Machine,
    stop::Stop,
    syntax::{Method, TypeName},
    unknown::Unknown,
    value::Value,
};

impl Machine {
    /// The method that is meant, and the class in which it stands.
    pub(crate) fn method(
        &self,
        id: ClassId,
        name: &str,
        arguments: &[Value],
    ) -> Option<(ClassId, Arc<Method>)> {
        let mut best: Option<(u32, ClassId, Arc<Method>)> = None;
        for (owner, method) in self.java.classes.methods(id, name) {
            let Some(fit) = self.fit(owner, &method, arguments) else { continue };
            // Among equal fits, the nearest method with a body wins.
            let is_better = best.as_ref().is_none_or(|(other, _, found)| {
                fit > *other || (fit == *other && found.body.is_none() && method.body.is_some())
            });
            if is_better {
                best = Some((fit, owner, method));
            }
        }
        best.map(|(_, owner, method)| (owner, method))
    }

    /// How well arguments fit parameters; none if they do not.
    pub(crate) fn fit(&self, owner: ClassId, method: &Method, arguments: &[Value]) -> Option<u32> {
        let parameters = &method.parameters;
        let all = |arguments: &[Value]| {
            let pairs = arguments.iter().zip(parameters);
            let fits = pairs.map(|(value, own)| self.fits(owner, value, &own.type_name));
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
        let element = TypeName { dimensions: last.dimensions.checked_sub(1)?, ..last.clone() };
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
            let place = order.iter().position(|own| *own == name);
            place.and_then(|place| u32::try_from(9 - place.min(8)).ok())
        };
        let is_primitive = matches!(
            name,
            "boolean" | "char" | "byte" | "short" | "int" | "long" | "float" | "double"
        );
        match value {
            Value::Unknown(_) => Some(3),
            Value::Null => (!is_primitive).then_some(3),
            Value::Boolean(_) => rank(&["boolean", "Boolean", "Object"]),
            Value::Char(_) => {
                rank(&["char", "int", "long", "float", "double", "Character", "Object"])
            }
            Value::Int(_) => rank(&[
                "int", "long", "float", "double", "Integer", "Number", "Object", "short", "byte",
            ]),
            Value::Long(_) => rank(&["long", "float", "double", "Long", "Number", "Object"]),
            Value::Float(_) => rank(&["float", "double", "Float", "Number", "Object"]),
            Value::Double(_) => rank(&["double", "Double", "Number", "Object"]),
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
            _ if is_primitive || name == "String" => None,
            Value::Host(own) => Some(match self.java.classes.find(&wanted.name, owner) {
                Some(_) => return None,
                None if own.class() == name => 8,
                None => 2,
            }),
            _ => match self.java.classes.find(&wanted.name, owner) {
                Some(_) => None,
                None => Some(2),
            },
        }
    }

    /// The result of a call for which several methods fit equally well, since the type of an argument is not known: none of
    /// them is run. None if the method is known.
    pub(crate) fn undecided(
        &mut self,
        id: ClassId,
        name: &str,
        arguments: &[Value],
    ) -> Result<Option<Value>, Stop> {
        let methods = self.java.classes.methods(id, name);
        let Some((unknown, fitting)) = self.fitting(methods, arguments) else { return Ok(None) };
        for method in fitting {
            let effects = self.effects_of(method.body.iter().flatten());
            if effects.acts() {
                return self
                    .refuse_unknown(&format!("which of the methods `{name}` is called"), &unknown);
            }
            self.forget_values(&effects, &unknown);
        }
        Ok(Some(Value::Unknown(unknown)))
    }

    /// The methods that fit equally well and differ in the type of an argument that is not known; none if that decides nothing.
    pub(crate) fn fitting(
        &self,
        methods: Vec<(ClassId, Arc<Method>)>,
        arguments: &[Value],
    ) -> Option<(Rc<Unknown>, Vec<Arc<Method>>)> {
        let unknown = Rc::clone(arguments.iter().find_map(Value::unknown)?);
        let fits = methods
            .into_iter()
            .filter_map(|(owner, method)| Some((self.fit(owner, &method, arguments)?, method)));
        let fits: Vec<_> = fits.collect();
        let best = fits.iter().map(|(fit, _)| *fit).max()?;
        let fitting: Vec<_> =
            fits.into_iter().filter(|(fit, _)| *fit == best).map(|(_, method)| method).collect();
        let types = |method: &Method| {
            let pairs = method.parameters.iter().zip(arguments);
            let open = pairs.filter(|(_, value)| value.unknown().is_some());
            open.map(|(own, _)| own.type_name.clone()).collect::<Vec<_>>()
        };
        let first = types(fitting.first()?);
        fitting.iter().any(|own| types(own) != first).then_some((unknown, fitting))
    }
}
