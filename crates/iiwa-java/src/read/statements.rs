//! Statements.

use java_lang::{Ident, Span, ast};

use super::{fault::Fault, reader::Reader};
use crate::syntax::{
    Catch, Expression, ExpressionKind, Literal, Statement, StatementKind, SwitchGroup, TypeName,
    Variable,
};

impl Reader<'_> {
    pub(super) fn block(&self, block: &ast::Block) -> Result<Vec<Statement>, Fault> {
        self.statements(&block.stmts)
    }

    pub(super) fn statements(&self, statements: &[ast::Stmt]) -> Result<Vec<Statement>, Fault> {
        statements.iter().map(|statement| self.statement(statement)).collect()
    }

    fn boxed_statement(&self, statement: &ast::Stmt) -> Result<Box<Statement>, Fault> {
        Ok(Box::new(self.statement(statement)?))
    }

    fn statement(&self, statement: &ast::Stmt) -> Result<Statement, Fault> {
        let (span, kind) = match statement {
            ast::Stmt::Empty(span) => (*span, StatementKind::Empty),
            ast::Stmt::Block(block) => {
                (block.brace_span.0, StatementKind::Block(self.block(block)?))
            }
            ast::Stmt::Labeled(labelled) => (
                labelled.label.span(),
                StatementKind::Labelled {
                    label: self.name(&labelled.label)?,
                    body: self.boxed_statement(&labelled.stmt)?,
                },
            ),
            ast::Stmt::Expr(statement) => (
                statement.expr.span(),
                StatementKind::Expression(self.expression(&statement.expr)?),
            ),
            ast::Stmt::LocalVarDecl(local) => return self.local(local),
            ast::Stmt::If(choice) => (choice.if_span, self.choice(choice)?),
            ast::Stmt::Assert(assert) => (assert.assert_span, StatementKind::Assert),
            ast::Stmt::Switch(switch) => (switch.switch_span, self.switch(switch)?),
            ast::Stmt::While(wait) => (
                wait.while_span,
                StatementKind::While {
                    condition: self.expression(&wait.cond)?,
                    body: self.boxed_statement(&wait.body)?,
                },
            ),
            ast::Stmt::DoWhile(wait) => (
                wait.do_span,
                StatementKind::DoWhile {
                    body: self.boxed_statement(&wait.body)?,
                    condition: self.expression(&wait.cond)?,
                },
            ),
            ast::Stmt::For(count) => (count.for_span, self.count(count)?),
            ast::Stmt::EnhancedFor(each) => (each.for_span, self.each(each)?),
            ast::Stmt::Break(jump) => (jump.keyword_span, StatementKind::Break(self.label(jump)?)),
            ast::Stmt::Continue(jump) => {
                (jump.keyword_span, StatementKind::Continue(self.label(jump)?))
            }
            ast::Stmt::Return(result) => {
                let value =
                    result.value.as_ref().map(|value| self.expression(value)).transpose()?;
                (result.return_span, StatementKind::Return(value))
            }
            ast::Stmt::Throw(throw) => {
                (throw.throw_span, StatementKind::Throw(self.expression(&throw.expr)?))
            }
            ast::Stmt::Synchronized(locked) => {
                let body = self.block(&locked.body)?;
                (locked.synchronized_span, StatementKind::Synchronized { body })
            }
            ast::Stmt::Try(attempt) => self.attempt(attempt)?,
            ast::Stmt::Yield(result) => {
                (result.yield_span, StatementKind::Unsupported("a yield statement".to_owned()))
            }
            ast::Stmt::ClassDecl(declaration) => return self.local_class(declaration),
        };
        Ok(Statement { line: self.line(span), kind })
    }

    fn local_class(&self, declaration: &ast::TypeDecl) -> Result<Statement, Fault> {
        let kind = match self.class(declaration)? {
            Some(class) => StatementKind::LocalClass(class),
            None => match declaration {
                ast::TypeDecl::Empty(_) => StatementKind::Empty,
                ast::TypeDecl::Record(_) => StatementKind::Unsupported("a record".to_owned()),
                _ => StatementKind::Unsupported("an annotation type".to_owned()),
            },
        };
        Ok(Statement { line: self.line(declaration.span()), kind })
    }

    fn local(&self, local: &ast::LocalVarDeclStmt) -> Result<Statement, Fault> {
        let (type_name, span) = match &local.ty {
            ast::LocalVarType::Type(written) => (self.type_name(written)?, written.span()),
            ast::LocalVarType::Var(span) => {
                (TypeName { name: "var".to_owned(), dimensions: 0 }, *span)
            }
        };
        let begins = local.modifiers.first().map_or(span, ast::Modifier::span);
        let variables = local.declarators.iter().map(|variable| self.variable(variable));
        let variables = variables.collect::<Result<_, _>>()?;
        let kind = StatementKind::Local { type_name, variables };
        Ok(Statement { line: self.line(begins), kind })
    }

    /// A variable or a field, from its name on.
    pub(super) fn variable(&self, variable: &ast::VariableDeclarator) -> Result<Variable, Fault> {
        let (name, span) = self.declared(variable)?;
        let initial = variable.initializer.as_ref();
        let initial = initial.map(|initial| self.expression(initial)).transpose()?;
        if initial.is_none() {
            self.check_without_value(span)?;
        }
        Ok(Variable { name, dimensions: variable.dims.len(), initial })
    }

    fn declared(&self, variable: &ast::VariableDeclarator) -> Result<(String, Span), Fault> {
        match &variable.name {
            Some(name) => Ok((self.name(name)?, name.span())),
            None => Ok(("_".to_owned(), Span::call_site())),
        }
    }

    /// The parser drops values that it cannot read, so that none is left only if there is no `=`.
    fn check_without_value(&self, name: Span) -> Result<(), Fault> {
        let mut index = self.token_behind(name);
        while matches!(self.tokens.text(index), "[" | "]") {
            index += 1;
        }
        match self.tokens.text(index) {
            "=" => Err(self.fault_of_value(index + 1)),
            _ => Ok(()),
        }
    }

    fn label(&self, jump: &ast::JumpStmt) -> Result<Option<String>, Fault> {
        jump.label.as_ref().map(|label: &Ident| self.name(label)).transpose()
    }

    fn choice(&self, choice: &ast::IfStmt) -> Result<StatementKind, Fault> {
        let otherwise = match &choice.else_clause {
            Some((_, otherwise)) => Some(self.boxed_statement(otherwise)?),
            None => None,
        };
        Ok(StatementKind::If {
            condition: self.expression(&choice.cond)?,
            then: self.boxed_statement(&choice.then_stmt)?,
            otherwise,
        })
    }

    fn count(&self, count: &ast::ForStmt) -> Result<StatementKind, Fault> {
        let initial = match &count.init {
            ast::ForInit::LocalVarDecl(local) => vec![self.local(local)?],
            ast::ForInit::Exprs(expressions) => self.expression_statements(expressions)?,
        };
        Ok(StatementKind::For {
            initial,
            condition: count.cond.as_ref().map(|cond| self.expression(cond)).transpose()?,
            update: self.expressions(&count.update)?,
            body: self.boxed_statement(&count.body)?,
        })
    }

    fn expression_statements(&self, expressions: &[ast::Expr]) -> Result<Vec<Statement>, Fault> {
        let statement = |expression: &ast::Expr| {
            let kind = StatementKind::Expression(self.expression(expression)?);
            Ok(Statement { line: self.line(expression.span()), kind })
        };
        expressions.iter().map(statement).collect()
    }

    fn each(&self, each: &ast::EnhancedForStmt) -> Result<StatementKind, Fault> {
        let names = each.var_decl.declarators.iter().map(|variable| self.declared(variable));
        let names: Vec<(String, Span)> = names.collect::<Result<_, _>>()?;
        let Some((name, _)) = names.into_iter().next() else {
            return Err(Fault::syntax(self.start(each.for_span), "a variable is expected"));
        };
        Ok(StatementKind::ForEach {
            name,
            iterable: self.expression(&each.iterable)?,
            body: self.boxed_statement(&each.body)?,
        })
    }

    fn switch(&self, switch: &ast::SwitchStmt) -> Result<StatementKind, Fault> {
        let value = self.expression(&switch.selector)?;
        let groups = switch.cases.iter().map(|group| self.switch_group(group));
        Ok(StatementKind::Switch { value, groups: groups.collect::<Result<_, _>>()? })
    }

    fn switch_group(&self, group: &ast::SwitchCaseGroup) -> Result<SwitchGroup, Fault> {
        let at = self.start(group.colon_span);
        if group.labels.is_empty() {
            return Err(Fault::syntax(at, "`case` or `default` is expected"));
        }
        let falls_through = self.source(group.colon_span) != "->";
        if !falls_through && group.stmts.len() != 1 {
            return Err(Fault::syntax(at, "one statement is expected behind `->`"));
        }
        let mut labels = Vec::new();
        for label in &group.labels {
            match label {
                ast::SwitchCase::CaseValues { values, .. } => {
                    labels.extend(self.expressions(values)?.into_iter().map(Some));
                }
                ast::SwitchCase::CaseNull { null_span, .. } => {
                    labels.push(Some(self.null(*null_span)));
                }
                ast::SwitchCase::CaseNullDefault { null_span, .. } => {
                    labels.extend([Some(self.null(*null_span)), None]);
                }
                ast::SwitchCase::CasePattern { case_span, .. } => labels.push(Some(Expression {
                    line: self.line(*case_span),
                    kind: ExpressionKind::Unsupported("a `case` with a pattern".to_owned()),
                })),
                ast::SwitchCase::Default { .. } => labels.push(None),
            }
        }
        Ok(SwitchGroup { labels, body: self.statements(&group.stmts)?, falls_through })
    }

    fn null(&self, span: Span) -> Expression {
        Expression { line: self.line(span), kind: ExpressionKind::Literal(Literal::Null) }
    }

    fn attempt(&self, attempt: &ast::TryStmt) -> Result<(Span, StatementKind), Fault> {
        let (span, written, block, catches, finally) = match attempt {
            ast::TryStmt::Basic { try_span, block, catches, finally_block, .. } => {
                (*try_span, &[][..], block, catches, finally_block)
            }
            ast::TryStmt::TryWithResources {
                try_span,
                resources,
                block,
                catches,
                finally_block,
                ..
            } => (*try_span, &resources[..], block, catches, finally_block),
        };
        if written.is_empty() && catches.is_empty() && finally.is_none() {
            let at = self.start(block.brace_span.1);
            return Err(Fault::syntax(at, "`catch` or `finally` is expected after this `}`"));
        }
        let mut resources = Vec::new();
        for resource in written {
            resources.push(match resource {
                ast::TryResource::Decl(local) => self.local(local)?,
                ast::TryResource::VarRef(name) => {
                    let line = self.line(name.span());
                    let name = Expression { line, kind: ExpressionKind::Name(self.name(name)?) };
                    Statement { line, kind: StatementKind::Expression(name) }
                }
            });
        }
        let catches = catches.iter().map(|clause| self.catch(clause));
        let kind = StatementKind::Try {
            resources,
            body: self.block(block)?,
            catches: catches.collect::<Result<_, _>>()?,
            finally: finally.as_ref().map(|(_, block)| self.block(block)).transpose()?,
        };
        Ok((span, kind))
    }

    fn catch(&self, clause: &ast::CatchClause) -> Result<Catch, Fault> {
        Ok(Catch {
            types: self.type_names(&clause.param.ty.types)?,
            name: self.name(&clause.param.name)?,
            body: self.block(&clause.block)?,
        })
    }
}
