//! Static types of expressions, where the value alone does not determine Java's behaviour: numeric
//! promotion in conditional expressions, overload resolution, and `==` on numbers or objects.

use crate::{
    class_id::ClassId,
    classes::simple,
    machine::Machine,
    syntax::{BinaryOperator, Expression, ExpressionKind, Literal, TypeName, UnaryOperator},
    type_names::{
        NULL, WIDENING, boxed, boxed_names, is_primitive, is_text, of_literal, plain, rank,
        unboxed, widens_to,
    },
    variables::fields,
};

/// Type of a sum that is only known to be a number.
pub(crate) const NUMBER: &str = "a number";

/// Type of a lambda expression or a method reference.
const FUNCTION: &str = "a function";

/// Java library methods that return primitive numbers, of any class.
const PRIMITIVE: [&str; 5] =
    ["abs", "incrementAndGet", "getAndIncrement", "decrementAndGet", "getAndDecrement"];

/// Java library methods that return collection elements, of any class.
const BOXED: [&str; 17] = [
    "valueOf", "next", "previous", "getKey", "getValue", "peek", "poll", "pop", "getFirst",
    "getLast", "first", "last", "put", "remove", "set", "element", "take",
];

impl Machine {
    /// Returns the type of an expression; `None` if it is unknown.
    pub(crate) fn static_type(&self, expression: &Expression) -> Option<TypeName> {
        self.erased(self.declared_type(expression)?)
    }

    /// Returns the type of an expression, which may be a type variable.
    fn declared_type(&self, expression: &Expression) -> Option<TypeName> {
        match &expression.kind {
            ExpressionKind::Lambda(_) | ExpressionKind::Reference(_) => Some(plain(FUNCTION)),
            ExpressionKind::Literal(literal) => Some(of_literal(literal)),
            ExpressionKind::Name(name) => self.type_of_name(name),
            ExpressionKind::Field { object, name } => {
                if let Some(object_type) = self.static_type(object)
                    && object_type.dimensions > 0
                {
                    return (name == "length").then(|| plain("int"));
                }
                let class = self.class_of(object)?;
                let (owner, declared) = self.type_of_field(class, name)?;
                self.type_of_member(Some(object), owner, &declared)
            }
            ExpressionKind::Call { on, name, arguments } => {
                self.type_of_call(on.as_deref(), name, arguments)
            }
            ExpressionKind::New { type_name, body: None, .. }
            | ExpressionKind::NewArray { type_name, .. }
            | ExpressionKind::Cast { type_name, .. } => Some(type_name.clone()),
            ExpressionKind::Index { array, .. } => {
                let array_type = self.static_type(array)?;
                (array_type.dimensions > 0).then(|| array_type.element())
            }
            ExpressionKind::Unary { operator: UnaryOperator::Not, .. }
            | ExpressionKind::InstanceOf { .. } => Some(plain("boolean")),
            ExpressionKind::Unary { value, .. } => {
                Some(self.promoted(value, value).unwrap_or_else(|| plain(NUMBER)))
            }
            ExpressionKind::Step { target, .. } | ExpressionKind::Assign { target, .. } => {
                self.static_type(target)
            }
            ExpressionKind::Binary { operator, left, right } => {
                self.type_of_binary(*operator, left, right)
            }
            ExpressionKind::Conditional { then_value, otherwise, .. } => {
                self.type_of_conditional(then_value, otherwise)
            }
            ExpressionKind::This => {
                let class = self.java.activation()?.class;
                Some(plain(&self.java.classes.known(class).class.name))
            }
            _ => None,
        }
    }

    fn type_of_binary(
        &self,
        operator: BinaryOperator,
        left: &Expression,
        right: &Expression,
    ) -> Option<TypeName> {
        use BinaryOperator as Op;
        match operator {
            Op::Less
            | Op::LessOrEqual
            | Op::Greater
            | Op::GreaterOrEqual
            | Op::Equal
            | Op::NotEqual
            | Op::AndAlso
            | Op::OrElse => Some(plain("boolean")),
            Op::ShiftLeft | Op::ShiftRight | Op::ShiftRightUnsigned => {
                Some(self.promoted(left, left).unwrap_or_else(|| plain(NUMBER)))
            }
            Op::Add => {
                let types = [self.static_type(left), self.static_type(right)];
                if types.iter().flatten().any(is_text) {
                    return Some(plain("String"));
                }
                let [left_type, right_type] = types;
                match (left_type, right_type) {
                    (Some(_), Some(_)) => self.promoted(left, right),
                    _ => None,
                }
            }
            Op::And | Op::Or | Op::Xor => {
                let is_boolean = |type_name: &TypeName| unboxed(type_name) == Some("boolean");
                if self.static_type(left).as_ref().is_some_and(is_boolean) {
                    Some(plain("boolean"))
                } else {
                    self.promoted(left, right)
                }
            }
            _ => Some(self.promoted(left, right).unwrap_or_else(|| plain(NUMBER))),
        }
    }

    /// Returns the promoted type of two numbers.
    fn promoted(&self, left: &Expression, right: &Expression) -> Option<TypeName> {
        let rank = |expression: &Expression| rank(unboxed(&self.static_type(expression)?)?);
        let widest = rank(left)?.max(rank(right)?).max(3);
        WIDENING.get(widest).map(|name| plain(name))
    }

    /// Returns the type of `condition ? then : otherwise` (JLS 15.25); `None` if it is not
    /// primitive, or unknown.
    pub(crate) fn type_of_conditional(
        &self,
        then_value: &Expression,
        otherwise: &Expression,
    ) -> Option<TypeName> {
        let (first, second) = (self.static_type(then_value)?, self.static_type(otherwise)?);
        if first == second {
            return Some(first);
        }
        let (a, b) = (unboxed(&first)?, unboxed(&second)?);
        if a == b {
            return Some(plain(a));
        }
        // A constant is narrowed to the type of the other operand, if it fits.
        for (narrow, constant) in [(a, otherwise), (b, then_value)] {
            if !matches!(constant.kind, ExpressionKind::Literal(Literal::Char(_)))
                && let Some(value) = constant_of(constant)
            {
                let fits = match narrow {
                    "byte" => i8::try_from(value).is_ok(),
                    "short" => i16::try_from(value).is_ok(),
                    "char" => u16::try_from(value).is_ok(),
                    _ => false,
                };
                if fits {
                    return Some(plain(narrow));
                }
            }
        }
        if let ("byte", "short") | ("short", "byte") = (a, b) {
            return Some(plain("short"));
        }
        WIDENING.get(rank(a)?.max(rank(b)?).max(3)).map(|name| plain(name))
    }

    fn type_of_name(&self, name: &str) -> Option<TypeName> {
        let activation = self.java.activation()?;
        if let Some(local) = activation.locals.iter().rev().find(|local| local.name == name) {
            return local.type_name.clone().filter(|type_name| type_name.name != "var");
        }
        if activation.this.as_ref().is_some_and(|object| object.captured.contains_key(name)) {
            return None;
        }
        let mut class = Some(activation.class);
        while let Some(id) = class {
            if let Some((owner, declared)) = self.type_of_field(id, name) {
                // Type variables of an enclosing class may shadow each other's names.
                return if id == activation.class {
                    self.type_of_member(None, owner, &declared)
                } else {
                    Some(declared).filter(|type_name| !self.mentions_variables(owner, type_name))
                };
            }
            class = self.java.classes.known(id).outer;
        }
        None
    }

    /// Returns the class that declares a field, and the declared type.
    fn type_of_field(&self, class: ClassId, name: &str) -> Option<(ClassId, TypeName)> {
        self.java.classes.with_parents(class).into_iter().find_map(|id| {
            let class = &self.java.classes.known(id).class;
            if class.constants.iter().any(|constant| constant.name == name) {
                return Some((id, plain(&class.name)));
            }
            let field = fields(&class.members).find(|field| field.name == name)?;
            Some((id, field.type_name.clone()))
        })
    }

    /// Returns the project class of an expression's type, or the class that the expression names.
    pub(crate) fn class_of(&self, expression: &Expression) -> Option<ClassId> {
        let within = self.java.activation()?.class;
        match &expression.kind {
            ExpressionKind::This => return Some(within),
            ExpressionKind::Super => return self.java.classes.parent(within),
            _ => {}
        }
        if let Some(static_type) = self.static_type(expression) {
            return (static_type.dimensions == 0)
                .then(|| self.java.classes.find(&static_type.name, within))
                .flatten();
        }
        match &expression.kind {
            ExpressionKind::Name(name) => self.java.classes.find(name, within),
            _ => None,
        }
    }

    fn type_of_call(
        &self,
        on: Option<&Expression>,
        name: &str,
        arguments: &[Expression],
    ) -> Option<TypeName> {
        let mut class = match on {
            None => Some(self.java.activation()?.class),
            Some(on) => self.class_of(on),
        };
        while let Some(id) = class {
            let methods = self.java.classes.methods(id, name);
            let mut fitting = methods.iter().filter(|(_, method)| {
                method.is_variadic || method.parameters.len() == arguments.len()
            });
            if let Some((owner, first)) = fitting.next() {
                let others: Vec<_> = fitting.collect();
                if others.iter().any(|(_, method)| method.returns != first.returns) {
                    return None;
                }
                let declared = self.type_by_arguments(first, arguments)?;
                let result = self.type_of_member(on, *owner, &declared)?;
                return (others.is_empty() || result.arguments.is_empty()).then_some(result);
            }
            class = self.java.classes.known(id).outer.filter(|_| on.is_none());
        }
        if let Some(ExpressionKind::Name(class)) = on.map(|on| &on.kind)
            && class == "Math"
        {
            return match (name, arguments) {
                ("abs", [argument]) => self.promoted(argument, argument),
                ("max" | "min", [a, b]) => self.promoted(a, b),
                ("round", [argument]) => {
                    let is_float = self.static_type(argument)?.name == "float";
                    Some(plain(if is_float { "int" } else { "long" }))
                }
                ("floorMod" | "floorDiv" | "signum" | "ulp", _) => None,
                _ => Some(plain("double")),
            };
        }
        if let (Some(ExpressionKind::Name(class)), "valueOf") = (on.map(|on| &on.kind), name) {
            return Some(plain(class));
        }
        let on = on?;
        if let Some(receiver_type) = self.static_type(on)
            && let Some(result) = self.type_of_library_result(&receiver_type, name, arguments.len())
        {
            return Some(result);
        }
        let library_type = plain(match name {
            "length" | "size" | "indexOf" | "lastIndexOf" | "ordinal" | "intValue" | "compare"
            | "compareTo" | "parseInt" | "hashCode" | "nextInt" | "nextIndex" | "previousIndex"
            | "getNumericValue" => "int",
            "longValue" | "parseLong" => "long",
            "doubleValue" | "parseDouble" => "double",
            "charAt" | "charValue" => "char",
            "equals" | "isEmpty" | "contains" | "booleanValue" => "boolean",
            "toString" | "substring" | "trim" | "toUpperCase" | "toLowerCase" | "getMessage"
            | "name" | "format" => "String",
            _ => return None,
        });
        // The object may belong to the project, whose methods may return another type.
        let is_certain = self.static_type(on).is_some()
            || self.declared_results(name).iter().all(|result| *result == library_type);
        is_certain.then_some(library_type)
    }

    /// Returns the result types of all project methods of a name.
    fn declared_results(&self, name: &str) -> Vec<TypeName> {
        let methods = self.java.classes.named_methods(name).iter();
        methods.map(|method| method.returns.clone()).collect()
    }

    /// Returns true if the expression's type is a boxed number such as `Integer`; `None` if
    /// unknown.
    pub(crate) fn is_boxed(&self, expression: &Expression) -> Option<bool> {
        if let Some(static_type) = self.static_type(expression) {
            return Some(static_type.name != NUMBER && !is_primitive(&static_type));
        }
        match &expression.kind {
            ExpressionKind::Binary { .. } => Some(false),
            ExpressionKind::Field { name, .. } if name == "length" => Some(false),
            ExpressionKind::Conditional { then_value, otherwise, .. } => {
                let sides = (self.is_boxed(then_value)?, self.is_boxed(otherwise)?);
                // One primitive operand makes both primitive.
                Some(sides.0 && sides.1)
            }
            ExpressionKind::Call { on, name, .. } => self.is_boxed_result(on.as_deref(), name),
            _ => None,
        }
    }

    fn is_boxed_result(&self, on: Option<&Expression>, name: &str) -> Option<bool> {
        let receiver_type = on.and_then(|on| self.static_type(on));
        if receiver_type.is_none() {
            let declared = self.declared_results(name);
            if let Some(first) = declared.first().map(is_primitive) {
                return declared
                    .iter()
                    .all(|type_name| is_primitive(type_name) == first)
                    .then_some(!first);
            }
        }
        let class_name =
            receiver_type.map(|type_name| simple(&type_name.name).to_owned()).unwrap_or_default();
        let is_collections = matches!(&on?.kind,
            ExpressionKind::Name(class) if class == "Collections");
        match name {
            "get" | "getOrDefault" | "elementAt" if class_name.starts_with("Atomic") => Some(false),
            "get" | "getOrDefault" | "elementAt" => ["List", "Map", "Vector", "Stack"]
                .iter()
                .any(|end| class_name.ends_with(end))
                .then_some(true),
            "max" | "min" => Some(is_collections),
            _ if PRIMITIVE.contains(&name) => Some(false),
            _ if BOXED.contains(&name) => Some(true),
            _ => None,
        }
    }

    /// Returns true if the static type of a collection has no indices: its `remove` takes an
    /// element.
    pub(crate) fn has_no_indices(&self, collection: &Expression) -> bool {
        self.static_type(collection).is_some_and(|type_name| {
            let name = simple(&type_name.name);
            matches!(name, "Collection" | "Iterable")
                || name.ends_with("Queue")
                || name.ends_with("Deque")
        })
    }

    /// Returns true if the value of an expression may be a boxed number such as `Integer`.
    pub(crate) fn may_be_boxed(&self, expression: &Expression) -> bool {
        self.is_boxed(expression).unwrap_or(match &expression.kind {
            ExpressionKind::Call { on: Some(_), name, .. } => {
                matches!(name.as_str(), "get" | "getOrDefault" | "elementAt")
            }
            ExpressionKind::Name(_) | ExpressionKind::Conditional { .. } => true,
            _ => false,
        })
    }

    /// Returns true if a value can be passed to a parameter of this type without a conversion of
    /// the third resolution phase (JLS 15.12.2); `None` if it depends on library classes.
    pub(crate) fn widens(&self, from: &TypeName, to: &TypeName, boxes: bool) -> Option<bool> {
        if from == to {
            return Some(true);
        }
        if from.name == NULL {
            return Some(!is_primitive(to));
        }
        if from.name == FUNCTION {
            // The other conditions are checked when the applicable methods are searched.
            return Some(!is_primitive(to) && !is_text(to));
        }
        if from.dimensions > 0 || to.dimensions > 0 {
            return Some(to.dimensions == 0 && simple(&to.name) == "Object");
        }
        match (is_primitive(from), is_primitive(to)) {
            (true, true) => Some(widens_to(&from.name, &to.name)),
            (true, false) => {
                let boxed = boxed(&from.name)?;
                Some(boxes && self.widens(&plain(boxed), to, false)?)
            }
            (false, true) => {
                Some(boxes && unboxed(from).is_some_and(|primitive| widens_to(primitive, &to.name)))
            }
            (false, false) => self.inherits(from, to),
        }
    }

    fn inherits(&self, from: &TypeName, to: &TypeName) -> Option<bool> {
        let (below, above) = (simple(&from.name), simple(&to.name));
        if below == above || above == "Object" {
            return Some(true);
        }
        if below == "Object" {
            return Some(false);
        }
        // These classes are final.
        if above == "String" || boxed_names().any(|boxed| boxed == above) {
            return Some(false);
        }
        let within = self.java.activation()?.class;
        let [class, other] =
            [from, to].map(|type_name| self.java.classes.find(&type_name.name, within));
        match (class, other) {
            (Some(class), Some(other)) => Some(self.java.classes.is_a(class, other)),
            (None, Some(_)) => Some(false),
            _ if below == "String" || unboxed(from).is_some() => Some(match above {
                "CharSequence" => below == "String",
                "Comparable" | "Serializable" => true,
                "Number" => below != "String" && below != "Character" && below != "Boolean",
                _ => return None,
            }),
            _ => None,
        }
    }
}

/// Returns the value of a constant integer expression (JLS 15.28); `None` if it contains names, or
/// has another value.
fn constant_of(expression: &Expression) -> Option<i32> {
    use BinaryOperator as Op;
    Some(match &expression.kind {
        ExpressionKind::Literal(Literal::Int(value)) => *value,
        ExpressionKind::Literal(Literal::Char(value)) => i32::from(*value),
        ExpressionKind::Unary { operator, value } => match operator {
            UnaryOperator::Plus => constant_of(value)?,
            UnaryOperator::Minus => constant_of(value)?.wrapping_neg(),
            UnaryOperator::Complement => !constant_of(value)?,
            UnaryOperator::Not => return None,
        },
        ExpressionKind::Binary { operator, left, right } => {
            let (a, b) = (constant_of(left)?, constant_of(right)?);
            match operator {
                Op::Add => a.wrapping_add(b),
                Op::Subtract => a.wrapping_sub(b),
                Op::Multiply => a.wrapping_mul(b),
                Op::Divide => a.checked_div(b)?,
                Op::Remainder => a.checked_rem(b)?,
                Op::ShiftLeft => a.wrapping_shl(b.cast_unsigned()),
                Op::ShiftRight => a.wrapping_shr(b.cast_unsigned()),
                Op::And => a & b,
                Op::Or => a | b,
                Op::Xor => a ^ b,
                _ => return None,
            }
        }
        _ => return None,
    })
}
