//! Files, classes and their members.

use std::sync::Arc;

use super::{
    fault::SyntaxFault,
    reader::{TreeReader, brackets, child_of_kind, children, is_annotation, named},
    tree::SyntaxNode,
};
use crate::syntax::{
    Annotation, Class, ClassKind, CompilationUnit, Constant, Expression, ExpressionKind, Field,
    ImportDeclaration, Literal, Member, Method, Parameter, Statement, StatementKind, TypeName,
};

impl TreeReader<'_> {
    pub(super) fn unit(&self, program: SyntaxNode<'_>) -> Result<CompilationUnit, SyntaxFault> {
        let mut read = CompilationUnit::default();
        let mut is_within_head = true;
        for node in children(program) {
            match node.kind() {
                "package_declaration" | "import_declaration" if !is_within_head => {
                    let message = "`package` and `import` are expected before all classes";
                    return Err(SyntaxFault::syntax(node.start(), message));
                }
                "package_declaration" => {
                    let name = named(node).into_iter().find(|node| !is_annotation(*node));
                    read.package = self.path(name.ok_or_else(|| self.misread(node))?)?;
                }
                "import_declaration" => read.imports.push(self.import(node)?),
                // A module does not declare classes.
                "module_declaration" | ";" => {}
                _ if is_class(node) => {
                    is_within_head = false;
                    read.classes.extend(self.class(node)?);
                }
                _ => {
                    let message = "expected a class: this code is outside of any class";
                    return Err(SyntaxFault::syntax(node.start(), message));
                }
            }
        }
        Ok(read)
    }

    fn import(&self, node: SyntaxNode<'_>) -> Result<ImportDeclaration, SyntaxFault> {
        let path = named(node).into_iter().next().ok_or_else(|| self.misread(node))?;
        Ok(ImportDeclaration {
            path: self.path(path)?,
            is_static: child_of_kind(node, "static").is_some(),
            is_all: child_of_kind(node, "asterisk").is_some(),
        })
    }

    /// Reads a class; `None` for an annotation type, which has no code.
    pub(super) fn class(&self, node: SyntaxNode<'_>) -> Result<Option<Arc<Class>>, SyntaxFault> {
        let kind = match node.kind() {
            "class_declaration" => ClassKind::Class,
            "interface_declaration" => ClassKind::Interface,
            "enum_declaration" => ClassKind::Enum,
            "record_declaration" => ClassKind::Record,
            _ => return Ok(None),
        };
        let name = self.field(node, "name")?;
        let mut read = empty_class(self.name(name)?, kind);
        read.line = self.line(name);
        read.type_parameters = self.type_parameters(node)?;
        read.is_abstract = kind == ClassKind::Interface || has_modifier(node, "abstract");
        if let Some(superclass) = node.field("superclass") {
            let extends = named(superclass).pop().ok_or_else(|| self.misread(superclass))?;
            read.extends = Some(self.type_name(extends)?);
        }
        let interfaces =
            node.field("interfaces").or_else(|| child_of_kind(node, "extends_interfaces"));
        if let Some(list) = interfaces.and_then(|node| child_of_kind(node, "type_list")) {
            read.implements = self.type_names(&named(list))?;
        }
        let body = self.field(node, "body")?;
        if kind == ClassKind::Record {
            self.record(&mut read, self.field(node, "parameters")?, body)?;
        } else {
            self.members(&mut read, body)?;
        }
        Ok(Some(Arc::new(read)))
    }

    /// Reads the body of an anonymous class, or of a constant: it has no name, and extends or
    /// implements the class above.
    pub(super) fn unnamed_class(
        &self,
        place: SyntaxNode<'_>,
        above: TypeName,
        body: SyntaxNode<'_>,
    ) -> Result<Arc<Class>, SyntaxFault> {
        let mut read = empty_class(String::new(), ClassKind::Class);
        read.extends = Some(above);
        read.line = self.line(place);
        self.members(&mut read, body)?;
        Ok(Arc::new(read))
    }

    /// Expands a record to a class: a field and a method for each component, and a canonical
    /// constructor.
    fn record(
        &self,
        class: &mut Class,
        written: SyntaxNode<'_>,
        body: SyntaxNode<'_>,
    ) -> Result<(), SyntaxFault> {
        let (components, is_variadic) = self.parameters(written)?;
        for component in &components {
            class.members.push(Member::Field(Field {
                name: component.name.clone(),
                type_name: component.type_name.clone(),
                line: class.line,
                is_static: false,
                annotations: Vec::new(),
                initial: None,
            }));
        }
        self.members(class, body)?;
        let line = class.line;
        let expression = |kind| Expression { line, kind };
        let field = |name: &str| {
            let object = Box::new(expression(ExpressionKind::This));
            expression(ExpressionKind::Field { object, name: name.to_owned() })
        };
        let is_canonical = |method: &Arc<Method>| {
            let types = method.parameters.iter().map(|parameter| &parameter.type_name);
            types.eq(components.iter().map(|component| &component.type_name))
        };
        if !class.constructors.iter().any(is_canonical) {
            let compact = children(body)
                .into_iter()
                .find(|child| child.kind() == "compact_constructor_declaration");
            let mut statements = match compact {
                Some(compact) => self.block(self.field(compact, "body")?)?,
                None => Vec::new(),
            };
            for Parameter { name, .. } in &components {
                let kind = StatementKind::Expression(expression(ExpressionKind::Assign {
                    operator: None,
                    target: Box::new(field(name)),
                    value: Box::new(expression(ExpressionKind::Name(name.clone()))),
                }));
                statements.push(Statement { line, kind });
            }
            let parameters = components.iter().map(|component| Parameter {
                name: component.name.clone(),
                type_name: component.type_name.clone(),
            });
            class.constructors.push(Arc::new(Method {
                name: class.name.clone(),
                line,
                is_static: false,
                annotations: Vec::new(),
                type_parameters: Vec::new(),
                parameters: parameters.collect(),
                is_variadic,
                returns: void(),
                body: Some(statements),
            }));
        }
        for Parameter { name, type_name } in components {
            let is_declared = class
                .methods
                .iter()
                .any(|method| method.name == name && method.parameters.is_empty());
            if !is_declared {
                let kind = StatementKind::Return(Some(field(&name)));
                class.methods.push(Arc::new(Method {
                    name,
                    line,
                    is_static: false,
                    annotations: Vec::new(),
                    type_parameters: Vec::new(),
                    parameters: Vec::new(),
                    is_variadic: false,
                    returns: type_name,
                    body: Some(vec![Statement { line, kind }]),
                }));
            }
        }
        Ok(())
    }

    fn members(&self, class: &mut Class, body: SyntaxNode<'_>) -> Result<(), SyntaxFault> {
        for member in children(body) {
            match member.kind() {
                "{" | "}" | "," | ";" => {}
                "enum_constant" => class.constants.push(self.constant(&class.name, member)?),
                "enum_body_declarations" => self.members(class, member)?,
                "field_declaration" | "constant_declaration" => self.fields(class, member)?,
                "method_declaration" => class.methods.push(Arc::new(self.method(member)?)),
                "constructor_declaration" => {
                    let constructor = self.constructor(&class.name, member)?;
                    class.constructors.push(Arc::new(constructor));
                }
                "static_initializer" => {
                    let block =
                        child_of_kind(member, "block").ok_or_else(|| self.misread(member))?;
                    let body = self.block(block)?;
                    class.members.push(Member::Initializer { is_static: true, body });
                }
                "block" => {
                    let body = self.block(member)?;
                    class.members.push(Member::Initializer { is_static: false, body });
                }
                // Read together with the components.
                "compact_constructor_declaration" if class.kind == ClassKind::Record => {}
                _ if is_class(member) => class.classes.extend(self.class(member)?),
                _ => return Err(self.misread(member)),
            }
        }
        Ok(())
    }

    fn constant(&self, class: &str, node: SyntaxNode<'_>) -> Result<Constant, SyntaxFault> {
        let name = self.field(node, "name")?;
        let arguments = node.field("arguments");
        let body = node.field("body");
        Ok(Constant {
            name: self.name(name)?,
            line: self.line(name),
            arguments: arguments
                .map_or(Ok(Vec::new()), |argument| self.expressions(&named(argument)))?,
            body: body
                .map(|body| self.unnamed_class(name, TypeName::new(class, 0), body))
                .transpose()?,
        })
    }

    fn fields(&self, class: &mut Class, node: SyntaxNode<'_>) -> Result<(), SyntaxFault> {
        let is_static = class.kind == ClassKind::Interface || has_modifier(node, "static");
        let type_name = self.type_name(self.field(node, "type")?)?;
        for declarator in node.fields("declarator") {
            let variable = self.variable(declarator)?;
            class.members.push(Member::Field(Field {
                name: variable.name,
                type_name: type_name.with_dimensions(type_name.dimensions + variable.dimensions),
                line: self.line(declarator),
                is_static,
                annotations: self.annotations(node)?,
                initial: variable.initial,
            }));
        }
        Ok(())
    }

    fn method(&self, node: SyntaxNode<'_>) -> Result<Method, SyntaxFault> {
        let name = self.field(node, "name")?;
        let (parameters, is_variadic) = self.parameters(self.field(node, "parameters")?)?;
        let mut returns = self.type_name(self.field(node, "type")?)?;
        // `int values()[]` is legacy syntax for `int[] values()`.
        returns.dimensions += node.field("dimensions").map_or(0, brackets);
        let body = node.field("body");
        Ok(Method {
            name: self.name(name)?,
            line: self.line(name),
            is_static: has_modifier(node, "static"),
            annotations: self.annotations(node)?,
            type_parameters: self.type_parameters(node)?,
            parameters,
            is_variadic,
            returns,
            body: body.map(|body| self.block(body)).transpose()?,
        })
    }

    fn constructor(&self, class: &str, node: SyntaxNode<'_>) -> Result<Method, SyntaxFault> {
        let written = self.field(node, "name")?;
        let name = self.name(written)?;
        if name != class {
            let message = format!("`{name}` lacks the type that it returns, or `void`");
            return Err(SyntaxFault::syntax(written.start(), message));
        }
        let (parameters, is_variadic) = self.parameters(self.field(node, "parameters")?)?;
        let mut body = Vec::new();
        for statement in named(self.field(node, "body")?) {
            body.push(match statement.kind() {
                "explicit_constructor_invocation" => self.constructor_call(statement)?,
                _ => self.statement(statement)?,
            });
        }
        Ok(Method {
            name,
            line: self.line(written),
            is_static: false,
            annotations: self.annotations(node)?,
            type_parameters: self.type_parameters(node)?,
            parameters,
            is_variadic,
            returns: void(),
            body: Some(body),
        })
    }

    fn constructor_call(&self, node: SyntaxNode<'_>) -> Result<Statement, SyntaxFault> {
        let constructor = self.field(node, "constructor")?;
        let arguments = named(self.field(node, "arguments")?);
        let kind = if node.field("object").is_some() {
            ExpressionKind::Unsupported("a `super(...)` of an outer object".to_owned())
        } else if constructor.kind() == "this" {
            ExpressionKind::ThisCall(self.expressions(&arguments)?)
        } else {
            ExpressionKind::SuperCall(self.expressions(&arguments)?)
        };
        let line = self.line(constructor);
        Ok(Statement { line, kind: StatementKind::Expression(Expression { line, kind }) })
    }

    /// Reads the parameters; returns true as well if the last one has variable arity.
    pub(super) fn parameters(
        &self,
        node: SyntaxNode<'_>,
    ) -> Result<(Vec<Parameter>, bool), SyntaxFault> {
        let mut parameters = Vec::new();
        let mut is_variadic = false;
        for written in named(node) {
            if is_variadic {
                let message = "a parameter with `...` is expected to be the last";
                return Err(SyntaxFault::syntax(written.start(), message));
            }
            match written.kind() {
                "formal_parameter" => {
                    let mut type_name = self.type_name(self.field(written, "type")?)?;
                    type_name.dimensions += written.field("dimensions").map_or(0, brackets);
                    let name = self.name(self.field(written, "name")?)?;
                    parameters.push(Parameter { name, type_name });
                }
                "spread_parameter" => {
                    is_variadic = true;
                    let parts = named(written)
                        .into_iter()
                        .filter(|part| !is_annotation(*part) && part.kind() != "modifiers");
                    let parts: Vec<_> = parts.collect();
                    let [type_node, declarator] = parts[..] else {
                        return Err(self.misread(written));
                    };
                    let mut type_name = self.type_name(type_node)?;
                    type_name.dimensions += 1;
                    let name = self.name(self.field(declarator, "name")?)?;
                    parameters.push(Parameter { name, type_name });
                }
                // `void run(Program this)` declares the receiver type, and takes no argument.
                "receiver_parameter" => {}
                _ => return Err(self.misread(written)),
            }
        }
        Ok((parameters, is_variadic))
    }

    fn annotations(&self, node: SyntaxNode<'_>) -> Result<Vec<Annotation>, SyntaxFault> {
        let mut read = Vec::new();
        let modifiers = child_of_kind(node, "modifiers").map_or(Vec::new(), named);
        for annotation in modifiers.into_iter().filter(|modifier| is_annotation(*modifier)) {
            let path = self.path(self.field(annotation, "name")?)?;
            let mut value = None;
            let arguments = annotation.field("arguments");
            for argument in arguments.map_or(Vec::new(), named) {
                let node = match argument.kind() {
                    "element_value_pair" => {
                        let is_value = self.source(self.field(argument, "key")?) == "value";
                        is_value.then(|| self.field(argument, "value")).transpose()?
                    }
                    _ => Some(argument),
                };
                if let Some(node) = node.filter(|node| node.kind() == "string_literal")
                    && let ExpressionKind::Literal(Literal::String(text)) = self.literal(node)?
                {
                    value = Some(text);
                }
            }
            read.push(Annotation { name: crate::classes::simple(&path).to_owned(), value });
        }
        Ok(read)
    }
}

/// Returns true if a node declares a class or an annotation type.
pub(super) fn is_class(node: SyntaxNode<'_>) -> bool {
    matches!(
        node.kind(),
        "class_declaration"
            | "interface_declaration"
            | "enum_declaration"
            | "record_declaration"
            | "annotation_type_declaration"
    )
}

fn void() -> TypeName {
    TypeName::new("void", 0)
}

fn empty_class(name: String, kind: ClassKind) -> Class {
    Class {
        name,
        kind,
        line: 0,
        is_abstract: false,
        type_parameters: Vec::new(),
        extends: None,
        implements: Vec::new(),
        constants: Vec::new(),
        members: Vec::new(),
        methods: Vec::new(),
        constructors: Vec::new(),
        classes: Vec::new(),
    }
}

fn has_modifier(node: SyntaxNode<'_>, modifier: &str) -> bool {
    child_of_kind(node, "modifiers")
        .is_some_and(|modifiers| child_of_kind(modifiers, modifier).is_some())
}
