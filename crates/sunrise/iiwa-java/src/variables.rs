//! Variables and fields: name resolution and assignment.

use std::rc::Rc;

use crate::{
    class_id::ClassId,
    classes::simple,
    effects::Effects,
    machine::Machine,
    stop::EvaluationStop,
    syntax::{Expression, ExpressionKind, Field, Member, TypeName},
    type_names::is_primitive,
    unknown::Unknown,
    value::{JavaObject, Value},
};

/// Storage location of a value.
pub(crate) enum Slot {
    /// Local variable, by its index among the method's locals.
    Local(usize),
    /// Object field.
    Field(Rc<JavaObject>, ClassId, String),
    Static(ClassId, String),
    Element(Rc<crate::value::Array>, usize),
    /// Location outside the model, such as in a library or an unknown object: assigned values are
    /// lost.
    Elsewhere,
}

impl Machine {
    /// Evaluates a simple name.
    pub(crate) fn named(&mut self, name: &str) -> Result<Value, EvaluationStop> {
        if let Some(value) = self.variable(name)? {
            return Ok(value);
        }
        let Some(class) = self.java.activation().map(|activation| activation.class) else {
            return self.reject(format!("`{name}` is not known"));
        };
        if let Some(id) = self.java.classes.find(name, class) {
            return Ok(Value::Class(id));
        }
        for import in self.java.classes.static_imports(name, class) {
            if let Some(id) = self.java.classes.by_qualified_name(&import) {
                if let Some(value) = self.static_field(id, name)? {
                    return Ok(value);
                }
            } else if let Some(value) = self.foreign_constant(simple(&import), name)? {
                return Ok(value);
            }
        }
        if name.starts_with(|letter: char| letter.is_uppercase()) {
            return Ok(Value::ForeignClass(Rc::from(name)));
        }
        Ok(self.unknown(format!("`{name}`, which no source of the project declares")))
    }

    /// Returns a local variable, or a field of this object or of an enclosing one; `None` if no
    /// such variable exists.
    pub(crate) fn variable(&mut self, name: &str) -> Result<Option<Value>, EvaluationStop> {
        let Some(activation) = self.java.activation() else { return Ok(None) };
        if let Some(local) = activation.locals.iter().rev().find(|local| local.name == name) {
            return Ok(Some(local.value.clone()));
        }
        let mut around = activation.this.clone();
        let mut class = Some(activation.class);
        while let Some(id) = class {
            if let Some(object) = &around
                && let Some(value) = self.field_of(object, id, name)
            {
                return Ok(Some(value));
            }
            if let Some(value) = self.static_field(id, name)? {
                return Ok(Some(value));
            }
            if self.java.classes.is_in_method(id)
                && let Some(value) = around.as_ref().and_then(|object| object.captured.get(name))
            {
                return Ok(Some(value.clone()));
            }
            class = self.java.classes.known(id).outer;
            around = around.and_then(|object| match &object.outer {
                Some(Value::Object(outer)) => Some(Rc::clone(outer)),
                _ => None,
            });
        }
        Ok(None)
    }

    /// Returns a field of an object, as seen from the class `from`.
    pub(crate) fn field_of(
        &self,
        object: &Rc<JavaObject>,
        from: ClassId,
        name: &str,
    ) -> Option<Value> {
        self.owner_of(object, from, name)
            .and_then(|owner| object.fields.borrow().get(&(owner, name.to_owned())).cloned())
    }

    /// Returns the class that declares the accessed field.
    fn owner_of(&self, object: &Rc<JavaObject>, from: ClassId, name: &str) -> Option<ClassId> {
        let classes = &self.java.classes;
        let start = if classes.is_a(object.class, from) { from } else { object.class };
        let fields = object.fields.borrow();
        let has = |id: &ClassId| fields.contains_key(&(*id, name.to_owned()));
        let above = classes.with_parents(start).into_iter().find(has);
        above.or_else(|| classes.with_parents(object.class).into_iter().find(has))
    }

    /// Returns a static field of a class or of a superclass.
    pub(crate) fn static_field(
        &mut self,
        id: ClassId,
        name: &str,
    ) -> Result<Option<Value>, EvaluationStop> {
        match self.static_owner(id, name) {
            Some(owner) => {
                self.initialize(owner)?;
                Ok(self.java.statics.get(&(owner, name.to_owned())).cloned())
            }
            None => Ok(None),
        }
    }

    fn static_owner(&self, id: ClassId, name: &str) -> Option<ClassId> {
        let classes = &self.java.classes;
        classes.with_parents(id).into_iter().find(|id| {
            let class = &classes.known(*id).class;
            class.constants.iter().any(|constant| constant.name == name)
                || static_fields(&class.members).any(|field| field.name == name)
        })
    }

    /// Returns the member `name` of a value.
    pub(crate) fn member(&mut self, receiver: &Value, name: &str) -> Result<Value, EvaluationStop> {
        match receiver {
            Value::Object(object) => {
                let from =
                    self.java.activation().map_or(object.class, |activation| activation.class);
                if let Some(value) = self.field_of(object, from, name) {
                    return Ok(value);
                }
                if let Some(value) = self.static_field(object.class, name)? {
                    return Ok(value);
                }
                Ok(self.unknown(format!(
                    "the field `{name}`, which no source of the project declares"
                )))
            }
            Value::Class(id) => self.class_member(*id, name),
            Value::ForeignClass(class) => match self.foreign_constant(class, name)? {
                Some(value) => Ok(value),
                None if name.starts_with(|letter: char| letter.is_uppercase())
                    && !name.chars().all(|c| c.is_uppercase() || c == '_' || c.is_numeric()) =>
                {
                    Ok(Value::ForeignClass(Rc::from(name)))
                }
                None => Ok(self.unknown(format!("`{class}.{name}`, of a library without source"))),
            },
            Value::Array(array) if name == "length" => {
                let length = i32::try_from(array.values.borrow().len());
                Ok(Value::Int(length.unwrap_or(i32::MAX)))
            }
            Value::Host(value) => {
                let (host, value) = (Rc::clone(&self.host), Rc::clone(value));
                host.field(self, &value, name)
            }
            Value::Unknown(_) => Ok(receiver.clone()),
            Value::Null => {
                self.throw("NullPointerException", format!("the field `{name}` of null is used"))
            }
            other => self.reject(format!("{} has no field `{name}`", other.kind())),
        }
    }

    fn class_member(&mut self, id: ClassId, name: &str) -> Result<Value, EvaluationStop> {
        if name == "this" {
            return Ok(self.this_within(id));
        }
        if let Some(value) = self.static_field(id, name)? {
            return Ok(value);
        }
        if let Some(inner) = self.java.classes.find(name, id) {
            Ok(Value::Class(inner))
        } else {
            let class = self.java.classes.known(id).class.name.clone();
            if let Some(parent) = self.java.classes.foreign_parent(id).map(str::to_owned)
                && let Some(value) = self.foreign_constant(&parent, name)?
            {
                return Ok(value);
            }
            self.reject(format!("the class {class} has no static field `{name}`"))
        }
    }

    /// Returns the running object of the class `id`, or its enclosing object of this class.
    pub(crate) fn this_within(&self, id: ClassId) -> Value {
        let mut around = self.java.activation().and_then(|activation| activation.this.clone());
        while let Some(object) = around {
            if self.java.classes.is_a(object.class, id) {
                return Value::Object(object);
            }
            around = match &object.outer {
                Some(Value::Object(outer)) => Some(Rc::clone(outer)),
                _ => None,
            };
        }
        Value::Null
    }

    /// Returns the storage location of an expression.
    pub(crate) fn slot(&mut self, target: &Expression) -> Result<Slot, EvaluationStop> {
        match &target.kind {
            ExpressionKind::Name(name) => self.slot_of_name(name),
            ExpressionKind::Field { object: receiver, name } => {
                let value = self.evaluated(receiver)?;
                self.place.line = target.line;
                match value {
                    Value::Object(object) => {
                        let within = self
                            .java
                            .activation()
                            .map_or(object.class, |activation| activation.class);
                        let object_class =
                            is_hidden(&object, name).then(|| self.class_of(receiver)).flatten();
                        let from = object_class.unwrap_or(within);
                        Ok(match self.owner_of(&object, from, name) {
                            Some(owner) => Slot::Field(object, owner, name.clone()),
                            None => self.static_slot(object.class, name)?,
                        })
                    }
                    Value::Class(id) => self.static_slot(id, name),
                    Value::Null => self.throw(
                        "NullPointerException",
                        format!("the field `{name}` of null is assigned"),
                    ),
                    _ => Ok(Slot::Elsewhere),
                }
            }
            ExpressionKind::Index { array, index } => {
                let array = self.evaluated(array)?;
                let index = self.evaluated(index)?;
                self.place.line = target.line;
                match (array, &index) {
                    (Value::Array(array), Value::Unknown(unknown)) => {
                        // Any element may be assigned.
                        let unknown = Value::Unknown(Rc::clone(unknown));
                        array.values.borrow_mut().fill(unknown);
                        Ok(Slot::Elsewhere)
                    }
                    (Value::Array(array), _) => {
                        let index = self.index(&index, array.values.borrow().len())?;
                        Ok(Slot::Element(array, index))
                    }
                    (Value::Null, _) => {
                        self.throw("NullPointerException", "an element of null is assigned")
                    }
                    _ => Ok(Slot::Elsewhere),
                }
            }
            _ => self.reject("a value is assigned to an expression that is not a variable"),
        }
    }

    fn static_slot(&mut self, id: ClassId, name: &str) -> Result<Slot, EvaluationStop> {
        let Some(owner) = self.static_owner(id, name) else { return Ok(Slot::Elsewhere) };
        self.initialize(owner)?;
        Ok(Slot::Static(owner, name.to_owned()))
    }

    fn slot_of_name(&mut self, name: &str) -> Result<Slot, EvaluationStop> {
        let Some(activation) = self.java.activation() else { return Ok(Slot::Elsewhere) };
        if let Some(index) = activation.locals.iter().rposition(|local| local.name == name) {
            return Ok(Slot::Local(index));
        }
        let mut around = activation.this.clone();
        let mut class = Some(activation.class);
        while let Some(id) = class {
            if let Some(object) = &around
                && let Some(owner) = self.owner_of(object, id, name)
            {
                return Ok(Slot::Field(Rc::clone(object), owner, name.to_owned()));
            }
            if self.static_owner(id, name).is_some() {
                return self.static_slot(id, name);
            }
            class = self.java.classes.known(id).outer;
            around = around.and_then(|object| match &object.outer {
                Some(Value::Object(outer)) => Some(Rc::clone(outer)),
                _ => None,
            });
        }
        Ok(Slot::Elsewhere)
    }

    /// Returns the stored value.
    pub(crate) fn kept(&mut self, slot: &Slot) -> Value {
        let value = match slot {
            Slot::Local(index) => {
                let locals = self.java.activation().map(|activation| &activation.locals);
                locals.and_then(|slots| slots.get(*index)).map(|local| local.value.clone())
            }
            Slot::Field(object, owner, name) => {
                object.fields.borrow().get(&(*owner, name.clone())).cloned()
            }
            Slot::Static(owner, name) => self.java.statics.get(&(*owner, name.clone())).cloned(),
            Slot::Element(array, index) => array.values.borrow().get(*index).cloned(),
            Slot::Elsewhere => None,
        };
        value.unwrap_or_else(|| self.unknown("a field of a library without source"))
    }

    /// Stores a value, converted to the type of the variable, and returns the stored value.
    pub(crate) fn keep(&mut self, slot: &Slot, value: Value) -> Result<Value, EvaluationStop> {
        let old = self.kept(slot);
        let value = match self.type_of(slot) {
            Some(wanted) => self.for_variable(value, &wanted)?,
            None => value,
        };
        let lasts = match slot {
            // A variable cannot be read before its first assignment.
            Slot::Local(index) => self.java.activation().is_some_and(|activation| {
                let is_assigned =
                    activation.locals.get(*index).is_some_and(|local| local.is_assigned);
                is_assigned && *index < activation.outside_loop
            }),
            Slot::Elsewhere => false,
            _ => true,
        };
        if lasts && !old.is_same(&value) {
            self.java.changes += 1;
        }
        match slot {
            Slot::Local(index) => {
                if let Some(local) =
                    self.java.locals_mut().and_then(|locals| locals.get_mut(*index))
                {
                    local.value = value.clone();
                    local.is_assigned = true;
                }
            }
            Slot::Field(object, owner, name) => {
                object.fields.borrow_mut().insert((*owner, name.clone()), value.clone());
            }
            Slot::Static(owner, name) => {
                self.java.statics.insert((*owner, name.clone()), value.clone());
            }
            Slot::Element(array, index) => {
                if let Some(element) = array.values.borrow_mut().get_mut(*index) {
                    *element = value.clone();
                }
            }
            Slot::Elsewhere if value.function().is_some() => {
                let unknown = self.unknown("a field of a library without source");
                let function = std::slice::from_ref(&value);
                self.after_unmodelled(None, "a library", function, &unknown)?;
            }
            Slot::Elsewhere => {}
        }
        Ok(value)
    }

    /// Converts a value to a variable of this type.
    pub(crate) fn for_variable(
        &self,
        value: Value,
        wanted: &TypeName,
    ) -> Result<Value, EvaluationStop> {
        if matches!(value, Value::Null) && is_primitive(wanted) {
            return self.throw("NullPointerException", format!("null is no `{}`", wanted.name));
        }
        let within = self.java.activation().map_or(ClassId(0), |activation| activation.class);
        Ok(match &value {
            Value::Function(function) => self.as_interface(function, wanted, within),
            _ => value.converted_to(wanted),
        })
    }

    /// Converts the result of a method to its result type.
    pub(crate) fn for_result(
        &self,
        value: Value,
        returns: &TypeName,
    ) -> Result<Value, EvaluationStop> {
        if returns.name == "void" {
            return Ok(Value::Null);
        }
        self.for_variable(value, returns)
    }

    pub(crate) fn type_of(&self, slot: &Slot) -> Option<TypeName> {
        let field = |owner: &ClassId, name: &str| {
            let members = &self.java.classes.known(*owner).class.members;
            let field = fields(members).find(|field| field.name == name);
            field.map(|field| field.type_name.clone())
        };
        match slot {
            Slot::Local(index) => {
                let local = self.java.activation()?.locals.get(*index)?;
                local.type_name.clone()
            }
            Slot::Field(_, owner, name) | Slot::Static(owner, name) => field(owner, name),
            Slot::Element(array, _) => Some(array.element.clone()),
            Slot::Elsewhere => None,
        }
    }

    /// Checks an index into `length` elements.
    pub(crate) fn index(&mut self, index: &Value, length: usize) -> Result<usize, EvaluationStop> {
        let Some(index) = index.integer() else {
            return self.reject(format!("an index is {}", index.kind()));
        };
        match usize::try_from(index) {
            Ok(index) if index < length => Ok(index),
            _ => self.throw(
                "ArrayIndexOutOfBoundsException",
                format!("the index {index} is outside of {length} elements"),
            ),
        }
    }

    /// Marks the values that `effects` may change as unknown.
    pub(crate) fn forget_values(&mut self, effects: &Effects, unknown: &Rc<Unknown>) {
        self.java.changes += u64::from(!effects.assigns.is_empty() || !effects.changes.is_empty());
        // Objects that may be referenced by other names.
        let mut changed: Vec<Value> = Vec::new();
        let mut forget = |name: &str, value: &mut Value| {
            let has_contents = match value {
                Value::List(_)
                | Value::Map(_)
                | Value::Array(_)
                | Value::Builder(_)
                | Value::Iterator(_)
                | Value::Cell(_) => true,
                Value::Host(host) => host.is_mutable(),
                _ => false,
            };
            let changes = has_contents && effects.changes.contains(name);
            if changes {
                changed.push(value.clone());
            }
            if changes || effects.assigns.contains(name) {
                *value = Value::Unknown(Rc::clone(unknown));
            }
        };
        for local in self.java.activations.iter_mut().flat_map(|activation| &mut activation.locals)
        {
            forget(&local.name, &mut local.value);
        }
        for ((_, name), value) in &mut self.java.statics {
            forget(name, value);
        }
        self.java.objects.retain(|object| object.strong_count() > 0);
        for object in self.java.objects.iter().filter_map(std::rc::Weak::upgrade) {
            for ((_, name), value) in object.fields.borrow_mut().iter_mut() {
                forget(name, value);
            }
        }
        for value in changed {
            match &value {
                Value::Host(host) => host.forget(unknown),
                _ => self.spoil(&value, unknown),
            }
        }
    }
}

/// Returns true if an object has several fields of this name.
pub(crate) fn is_hidden(object: &JavaObject, name: &str) -> bool {
    let fields = object.fields.borrow();
    fields.keys().filter(|(_, field)| field == name).count() > 1
}

pub(crate) fn fields(members: &[Member]) -> impl Iterator<Item = &Field> {
    members.iter().filter_map(|member| match member {
        Member::Field(field) => Some(field),
        Member::Initializer { .. } => None,
    })
}

fn static_fields(members: &[Member]) -> impl Iterator<Item = &Field> {
    fields(members).filter(|field| field.is_static)
}
