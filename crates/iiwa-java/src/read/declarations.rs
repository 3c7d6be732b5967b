//! Files, classes and what is in them.

use std::sync::Arc;

use java_lang::{Span, ast};

use super::{fault::Fault, reader::Reader};
use crate::syntax::{
    Annotation, Class, ClassKind, Constant, Expression, ExpressionKind, Field, Import, Literal,
    Member, Method, Parameter, Statement, StatementKind, TypeName, Unit,
};

impl Reader<'_> {
    pub(super) fn unit(&self, unit: &ast::CompilationUnit) -> Result<Unit, Fault> {
        if let ast::CompilationUnitKind::Compact(members) = &unit.kind {
            let what = "a class is expected: what is here is outside of any";
            return Err(Fault::syntax(self.start(members.span()), what));
        }
        let mut read = Unit::default();
        if let Some(package) = unit.package() {
            read.package = self.path(&package.name)?;
        }
        for import in &unit.imports {
            read.imports.extend(self.import(import)?);
        }
        for declaration in unit.type_decls() {
            read.classes.extend(self.class(declaration)?);
        }
        Ok(read)
    }

    /// None for a module, which names no class.
    fn import(&self, import: &ast::ImportDecl) -> Result<Option<Import>, Fault> {
        let (path, is_static, is_all) = match import {
            ast::ImportDecl::SingleType { path, .. } => (path, false, false),
            ast::ImportDecl::TypeOnDemand { path, .. } => (path, false, true),
            ast::ImportDecl::SingleStatic { path, .. } => (path, true, false),
            ast::ImportDecl::StaticOnDemand { path, .. } => (path, true, true),
            ast::ImportDecl::Module { .. } => return Ok(None),
        };
        Ok(Some(Import { path: self.path(path)?, is_static, is_all }))
    }

    /// None for what holds no code: a semicolon, a type of annotations; and for records.
    pub(super) fn class(&self, declaration: &ast::TypeDecl) -> Result<Option<Arc<Class>>, Fault> {
        Ok(match declaration {
            ast::TypeDecl::Class(class) => Some(self.named_class(class)?),
            ast::TypeDecl::Interface(interface) => Some(self.interface(interface)?),
            ast::TypeDecl::Enum(listed) => Some(self.enumeration(listed)?),
            ast::TypeDecl::Record(_)
            | ast::TypeDecl::AnnotationType(_)
            | ast::TypeDecl::Empty(_) => None,
        })
    }

    fn named_class(&self, class: &ast::ClassDecl) -> Result<Arc<Class>, Fault> {
        let mut read = empty_class(self.name(&class.name)?, ClassKind::Class);
        read.line = self.line(class.name.span());
        read.is_abstract = self.is_declared_abstract(class.class_span);
        if let Some(extends) = &class.extends_clause {
            read.extends = Some(self.type_name(&extends.supertype)?);
        }
        if let Some(implements) = &class.implements_clause {
            read.implements = self.type_names(&implements.supertypes)?;
        }
        self.members(&mut read, &class.body.declarations)?;
        Ok(Arc::new(read))
    }

    /// Of classes in methods, the parser drops what is before `class`.
    fn is_declared_abstract(&self, class: Span) -> bool {
        let keyword = self.token(class);
        let words = (0..keyword).rev().map(|index| self.tokens.text(index));
        let modifiers =
            ["public", "protected", "private", "static", "final", "strictfp", "abstract"];
        words.take_while(|word| modifiers.contains(word)).any(|word| word == "abstract")
    }

    /// The body of an anonymous class, or of a constant: it has no name.
    pub(super) fn unnamed_class(
        &self,
        place: Span,
        body: &ast::ClassBodyDeclList,
    ) -> Result<Arc<Class>, Fault> {
        let mut read = empty_class(String::new(), ClassKind::Class);
        read.line = self.line(place);
        self.members(&mut read, &body.declarations)?;
        Ok(Arc::new(read))
    }

    fn enumeration(&self, listed: &ast::EnumDecl) -> Result<Arc<Class>, Fault> {
        let mut read = empty_class(self.name(&listed.name)?, ClassKind::Enum);
        read.line = self.line(listed.name.span());
        if let Some(implements) = &listed.implements_clause {
            read.implements = self.type_names(&implements.supertypes)?;
        }
        for constant in &listed.body.constants {
            let body = match &constant.body {
                Some(body) => Some(self.unnamed_class(constant.name.span(), body)?),
                None => None,
            };
            read.constants.push(Constant {
                name: self.name(&constant.name)?,
                line: self.line(constant.name.span()),
                arguments: self.expressions(&constant.args)?,
                body,
            });
        }
        self.members(&mut read, &listed.body.members)?;
        Ok(Arc::new(read))
    }

    fn interface(&self, interface: &ast::InterfaceDecl) -> Result<Arc<Class>, Fault> {
        let mut read = empty_class(self.name(&interface.name)?, ClassKind::Interface);
        read.line = self.line(interface.name.span());
        read.is_abstract = true;
        if let Some(extends) = &interface.extends_clause {
            read.implements = self.type_names(&extends.supertypes)?;
        }
        for member in &interface.body.members {
            match member {
                ast::InterfaceMemberDecl::Field(field) => self.field(&mut read, field)?,
                ast::InterfaceMemberDecl::Method(method) => {
                    read.methods.push(Arc::new(self.method(method)?));
                }
                ast::InterfaceMemberDecl::Class(class) => {
                    read.classes.push(self.named_class(class)?);
                }
                ast::InterfaceMemberDecl::Interface(inner) => {
                    read.classes.push(self.interface(inner)?);
                }
                ast::InterfaceMemberDecl::Enum(listed) => {
                    read.classes.push(self.enumeration(listed)?);
                }
                ast::InterfaceMemberDecl::Record(_)
                | ast::InterfaceMemberDecl::AnnotationInterface(_)
                | ast::InterfaceMemberDecl::Empty(_) => {}
            }
        }
        Ok(Arc::new(read))
    }

    fn members(&self, class: &mut Class, members: &[ast::ClassBodyDecl]) -> Result<(), Fault> {
        for member in members {
            match member {
                ast::ClassBodyDecl::Field(field) => self.field(class, field)?,
                ast::ClassBodyDecl::Method(method) => {
                    class.methods.push(Arc::new(self.method(method)?));
                }
                ast::ClassBodyDecl::Constructor(constructor) => {
                    let constructor = self.constructor(&class.name, constructor)?;
                    class.constructors.push(Arc::new(constructor));
                }
                ast::ClassBodyDecl::StaticInit(initializer) => {
                    let body = self.block(&initializer.block)?;
                    class.members.push(Member::Initializer { is_static: true, body });
                }
                ast::ClassBodyDecl::InstanceInit(initializer) => {
                    let is_static = self.is_static_initializer(initializer.block.brace_span.0);
                    let body = self.block(&initializer.block)?;
                    class.members.push(Member::Initializer { is_static, body });
                }
                ast::ClassBodyDecl::Class(inner) => class.classes.push(self.named_class(inner)?),
                ast::ClassBodyDecl::Interface(inner) => class.classes.push(self.interface(inner)?),
                ast::ClassBodyDecl::Enum(inner) => class.classes.push(self.enumeration(inner)?),
                ast::ClassBodyDecl::Record(_)
                | ast::ClassBodyDecl::AnnotationType(_)
                | ast::ClassBodyDecl::Empty(_) => {}
            }
        }
        Ok(())
    }

    /// The parser takes the word before a block for a modifier, and drops it.
    fn is_static_initializer(&self, brace: Span) -> bool {
        self.tokens.text_before(self.token(brace)) == "static"
    }

    fn field(&self, class: &mut Class, field: &ast::FieldDecl) -> Result<(), Fault> {
        let is_static = class.kind == ClassKind::Interface || is_static(&field.modifiers);
        let TypeName { name: type_name, dimensions } = self.type_name(&field.ty)?;
        for declarator in &field.declarators {
            let variable = self.variable(declarator)?;
            let name_span =
                declarator.name.as_ref().map_or(field.ty.span(), java_lang::Ident::span);
            class.members.push(Member::Field(Field {
                name: variable.name,
                type_name: TypeName {
                    name: type_name.clone(),
                    dimensions: dimensions + variable.dimensions,
                },
                line: self.line(name_span),
                is_static,
                annotations: self.annotations(&field.modifiers)?,
                initial: variable.initial,
            }));
        }
        Ok(())
    }

    fn method(&self, method: &ast::MethodDecl) -> Result<Method, Fault> {
        let (parameters, is_variadic) = self.parameters(&method.params)?;
        let mut returns = match &method.return_type {
            ast::MethodReturnType::Type(written) => self.type_name(written)?,
            ast::MethodReturnType::Void(_) => TypeName { name: "void".to_owned(), dimensions: 0 },
        };
        // `int values()[]` is an old way to write `int[] values()`, of which the parser drops the brackets.
        let mut behind = self.token_behind(method.paren_span.1);
        while self.tokens.text(behind) == "[" {
            returns.dimensions += 1;
            behind += 2;
        }
        Ok(Method {
            name: self.name(&method.name)?,
            line: self.line(method.name.span()),
            is_static: is_static(&method.modifiers),
            annotations: self.annotations(&method.modifiers)?,
            parameters,
            is_variadic,
            returns,
            body: method.body.as_ref().map(|body| self.block(body)).transpose()?,
        })
    }

    fn constructor(&self, class: &str, written: &ast::ConstructorDecl) -> Result<Method, Fault> {
        let name = self.name(&written.name)?;
        if name != class {
            let what = format!("`{name}` lacks the type that it returns, or `void`");
            return Err(Fault::syntax(self.start(written.name.span()), what));
        }
        let (parameters, is_variadic) = self.parameters(&written.params)?;
        let mut body = Vec::new();
        if let Some(call) = &written.body.explicit_constructor_call {
            body.push(self.constructor_call(call)?);
        }
        body.extend(self.statements(&written.body.stmts)?);
        Ok(Method {
            name,
            line: self.line(written.name.span()),
            is_static: false,
            annotations: self.annotations(&written.modifiers)?,
            parameters,
            is_variadic,
            returns: TypeName { name: "void".to_owned(), dimensions: 0 },
            body: Some(body),
        })
    }

    fn constructor_call(&self, call: &ast::ExplicitConstructorCall) -> Result<Statement, Fault> {
        let (span, kind) = match call {
            ast::ExplicitConstructorCall::This { this_span, args, .. } => {
                (*this_span, ExpressionKind::ThisCall(self.expressions(args)?))
            }
            ast::ExplicitConstructorCall::Super { super_span, args, .. } => {
                (*super_span, ExpressionKind::SuperCall(self.expressions(args)?))
            }
            ast::ExplicitConstructorCall::SuperFromExpr { super_span, .. } => {
                let what = "a `super(...)` of an outer object".to_owned();
                (*super_span, ExpressionKind::Unsupported(what))
            }
        };
        let line = self.line(span);
        Ok(Statement { line, kind: StatementKind::Expression(Expression { line, kind }) })
    }

    /// The parameters, and whether the last takes any number of arguments.
    fn parameters(
        &self,
        written: &[ast::FormalParameter],
    ) -> Result<(Vec<Parameter>, bool), Fault> {
        let mut parameters = Vec::new();
        let mut is_variadic = false;
        for parameter in written {
            let (ty, name, is_any_number) = match parameter {
                ast::FormalParameter::Normal { ty, name, .. } => (ty, name, false),
                ast::FormalParameter::VarArgs { ty, name, .. } => (ty, name, true),
            };
            let Some(name) = name else {
                let at = self.mended.original(ty.span().end());
                return Err(Fault::syntax(at, "the name of a parameter is expected"));
            };
            // `void run(Program this)` says of what the method is, and is given no argument.
            if name.name() == "this" {
                continue;
            }
            let mut type_name = self.type_name(ty)?;
            type_name.dimensions += usize::from(is_any_number);
            is_variadic = is_any_number;
            parameters.push(Parameter { name: self.name(name)?, type_name });
        }
        Ok((parameters, is_variadic))
    }

    fn annotations(&self, modifiers: &[ast::Modifier]) -> Result<Vec<Annotation>, Fault> {
        let mut read = Vec::new();
        for modifier in modifiers {
            let ast::Modifier::Annotation(annotation) = modifier else { continue };
            let value = match annotation {
                ast::Annotation::Marker { .. } => None,
                ast::Annotation::SingleElement { value, .. } => Some(value.as_ref()),
                ast::Annotation::Normal { pairs, .. } => {
                    pairs.iter().find(|pair| pair.key.name() == "value").map(|pair| &pair.value)
                }
            };
            let value = match value {
                Some(ast::ElementValue::Expr(ast::Expr::Literal(literal))) => {
                    text_of(self.literal(literal)?)
                }
                _ => None,
            };
            let name = annotation.path().last_ident();
            read.push(Annotation { name: self.name(name)?, value });
        }
        Ok(read)
    }
}

fn text_of(literal: ExpressionKind) -> Option<String> {
    match literal {
        ExpressionKind::Literal(Literal::String(text)) => Some(text),
        _ => None,
    }
}

fn empty_class(name: String, kind: ClassKind) -> Class {
    Class {
        name,
        kind,
        line: 0,
        is_abstract: false,
        extends: None,
        implements: Vec::new(),
        constants: Vec::new(),
        members: Vec::new(),
        methods: Vec::new(),
        constructors: Vec::new(),
        classes: Vec::new(),
    }
}

fn is_static(modifiers: &[ast::Modifier]) -> bool {
    modifiers.iter().any(|modifier| matches!(modifier, ast::Modifier::Static(_)))
}
