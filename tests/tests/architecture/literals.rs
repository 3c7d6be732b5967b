//! Test that libraries are independent of the programs that use them: their texts contain no
//! commands and no flags. The command line adds such hints.

use std::collections::BTreeMap;

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{Attribute, Lit, LitStr, Macro};

use crate::tests::architecture::module_tree::ModuleTree;
use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{members, shown};

#[test]
fn libraries_name_no_commands_and_no_flags() {
    let mut wrong = BTreeMap::new();
    for root in members()
        .iter()
        .filter(|member| member.is_library())
        .flat_map(crate::tests::architecture::sources::Member::roots)
    {
        for module in &ModuleTree::read(&root).modules {
            let mut literals = Literals { texts: Vec::new() };
            for item in &module.code {
                literals.visit_item(item);
            }
            for text in literals.texts {
                if text.contains("`iiwasim ") || names_flag(&text) {
                    wrong.insert(shown(&module.file), format!("{text:?}"));
                }
            }
        }
    }
    forbid(
        "hint",
        &wrong,
        "State what was asked and what was found; add the hint in cli, where the error is shown.",
    );
}

/// Returns true for a flag such as `--key`. Rules of Markdown tables, HTML comments and CSS
/// variables do not count.
fn names_flag(text: &str) -> bool {
    text.match_indices("--").any(|(offset, mark)| {
        !["-", "<!", "var("].iter().any(|before| text[..offset].ends_with(before))
            && text[offset + mark.len()..].starts_with(|c: char| c.is_ascii_alphabetic())
    })
}

/// All string literals except documentation.
struct Literals {
    texts: Vec<String>,
}

impl Literals {
    fn tokens(&mut self, tokens: TokenStream) {
        for token in tokens {
            match token {
                TokenTree::Group(group) => self.tokens(group.stream()),
                TokenTree::Literal(literal) => {
                    if let Lit::Str(text) = Lit::new(literal) {
                        self.texts.push(text.value());
                    }
                }
                _ => {}
            }
        }
    }
}

impl<'ast> Visit<'ast> for Literals {
    fn visit_lit_str(&mut self, text: &'ast LitStr) {
        self.texts.push(text.value());
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if attribute.path().is_ident("doc") {
            return;
        }
        // For example in `#[error("...")]`.
        if let Ok(list) = attribute.meta.require_list() {
            self.tokens(list.tokens.clone());
        }
        visit::visit_attribute(self, attribute);
    }
}
