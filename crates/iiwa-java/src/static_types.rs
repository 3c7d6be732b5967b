//! Types of expressions as far as a choice of methods needs them: whether a whole number is an `int`, or a boxed `Integer`.

use crate::{
    machine::Machine,
    syntax::{Expression, ExpressionKind, Literal, TypeName, UnaryOperator},
};

/// Methods of Java's library that give primitive numbers, of any class.
const PRIMITIVE: [&str; 22] = [
    "size",
    "length",
    "indexOf",
    "lastIndexOf",
    "intValue",
    "parseInt",
    "ordinal",
    "abs",
    "min",
    "max",
    "compare",
    "compareTo",
    "nextInt",
    "hashCode",
    "charAt",
    "nextIndex",
    "previousIndex",
    "getNumericValue",
    "incrementAndGet",
    "getAndIncrement",
    "decrementAndGet",
    "getAndDecrement",
];

/// Methods of Java's library that give elements of collections, of any class.
const BOXED: [&str; 12] = [
    "valueOf", "next", "previous", "getKey", "getValue", "peek", "poll", "pop", "getFirst",
    "getLast", "first", "last",
];

impl Machine {
    /// True if a whole number is an object, by the type of its expression; none if that is not known.
    pub(crate) fn is_boxed(&self, expression: &Expression) -> Option<bool> {
        match &expression.kind {
            ExpressionKind::Literal(Literal::Int(_) | Literal::Char(_))
            | ExpressionKind::Binary { .. } => Some(false),
            ExpressionKind::Unary { operator, .. } => matches!(
                operator,
                UnaryOperator::Plus | UnaryOperator::Minus | UnaryOperator::Complement
            )
            .then_some(false),
            ExpressionKind::Cast { type_name, .. } | ExpressionKind::New { type_name, .. } => {
                Some(is_object(type_name))
            }
            ExpressionKind::Name(name) => self.declared(name).map(|own| is_object(&own)),
            ExpressionKind::Field { name, .. } if name == "length" => Some(false),
            ExpressionKind::Field { of, name } if matches!(of.kind, ExpressionKind::This) => {
                self.declared_field(name).map(|own| is_object(&own))
            }
            ExpressionKind::Index { of, .. } => match &of.kind {
                ExpressionKind::Name(name) => self.declared(name).map(|own| {
                    let dimensions = own.dimensions.saturating_sub(1);
                    is_object(&TypeName { dimensions, ..own })
                }),
                _ => None,
            },
            ExpressionKind::Step { target, .. } | ExpressionKind::Assign { target, .. } => {
                self.is_boxed(target)
            }
            ExpressionKind::Conditional { then, otherwise, .. } => {
                let sides = (self.is_boxed(then)?, self.is_boxed(otherwise)?);
                // One primitive side makes both primitive.
                Some(sides.0 && sides.1)
            }
            ExpressionKind::Call { on, name, .. } => self.is_boxed_result(on.as_deref(), name),
            _ => None,
        }
    }

    fn is_boxed_result(&self, on: Option<&Expression>, name: &str) -> Option<bool> {
        let classes = &self.java.classes;
        let mut of_project = classes.ids().flat_map(|id| {
            let methods = classes.known(id).class.methods.iter();
            methods.filter(|own| own.name == name).map(|own| is_object(&own.returns))
        });
        if let Some(first) = of_project.next() {
            return of_project.all(|other| other == first).then_some(first);
        }
        let of = match &on?.kind {
            ExpressionKind::Name(name) => self.declared(name),
            _ => None,
        };
        let of = of.map(|own| crate::classes::simple(&own.name).to_owned()).unwrap_or_default();
        match name {
            "get" | "getOrDefault" | "elementAt" if of.starts_with("Atomic") => Some(false),
            "get" | "getOrDefault" | "elementAt" => ["List", "Map", "Vector", "Stack"]
                .iter()
                .any(|end| of.ends_with(end))
                .then_some(true),
            _ if PRIMITIVE.contains(&name) => Some(false),
            _ if BOXED.contains(&name) => Some(true),
            _ => None,
        }
    }

    /// The type with which a variable is declared.
    fn declared(&self, name: &str) -> Option<TypeName> {
        let activation = self.java.activation()?;
        match activation.locals.iter().rev().find(|local| local.name == name) {
            Some(local) => local.type_name.clone(),
            None => self.declared_field(name),
        }
    }

    fn declared_field(&self, name: &str) -> Option<TypeName> {
        let classes = &self.java.classes;
        let mut class = Some(self.java.activation()?.class);
        while let Some(id) = class {
            for parent in classes.with_parents(id) {
                let members = &classes.known(parent).class.members;
                if let Some(field) =
                    crate::variables::fields(members).find(|field| field.name == name)
                {
                    return Some(field.type_name.clone());
                }
            }
            class = classes.known(id).outer;
        }
        None
    }
}

fn is_object(type_name: &TypeName) -> bool {
    let is_primitive =
        matches!(type_name.name.as_str(), "int" | "short" | "byte" | "char" | "long");
    type_name.dimensions > 0 || !is_primitive
}
