//! Test that no two files of a crate import each other, directly or indirectly.
//!
//! A file has an arrow to each file that defines a name it uses, however the name is re-exported. A
//! module that only declares its children or re-exports their names has no arrow to them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::parse::Parser;
use syn::punctuated::Punctuated;
use syn::visit::{self, Visit};
use syn::{Expr, Macro, Token};

use crate::tests::architecture::module_tree::{ModuleTree, for_tests_only};
use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{members, shown};

type Arrows = BTreeMap<String, BTreeSet<String>>;

#[test]
fn no_two_files_of_a_crate_import_each_other() {
    let mut wrong = BTreeMap::new();
    for root in members().iter().flat_map(crate::tests::architecture::sources::Member::roots) {
        let arrows = arrows(&ModuleTree::read(&root));
        let reach: BTreeMap<&String, BTreeSet<&String>> =
            arrows.keys().map(|file| (file, reachable(&arrows, file))).collect();
        for (file, next) in &arrows {
            if !reach[file].contains(file) {
                continue;
            }
            let back: Vec<&str> = next
                .iter()
                .filter(|next| reach.get(next).is_some_and(|reach| reach.contains(file)))
                .map(String::as_str)
                .collect();
            wrong.insert(file.clone(), format!("imports {}, and back", back.join(", ")));
        }
    }
    forbid(
        "circle",
        &wrong,
        "Move what both need into a file of its own, or pass it in as an argument.",
    );
}

/// Returns all files reachable by arrows from a file.
fn reachable<'a>(arrows: &'a Arrows, from: &str) -> BTreeSet<&'a String> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&str> = vec![from];
    while let Some(file) = open.pop() {
        for next in arrows.get(file).into_iter().flatten() {
            if reached.insert(next) {
                open.push(next);
            }
        }
    }
    reached
}

/// Returns the arrows from each file to the files that define its names.
fn arrows(tree: &ModuleTree) -> Arrows {
    let mut arrows = Arrows::new();
    for (index, module) in tree.modules.iter().enumerate() {
        let mut names = Names { paths: Vec::new() };
        for item in &module.code {
            names.visit_item(item);
        }
        let imported = module.imports.values().filter(|import| !import.reexport);
        names.paths.extend(imported.map(|import| import.path.clone()));
        let from: &Path = &module.file;
        for path in names.paths {
            if let Some(to) = tree.definition(index, &path)
                && to != from
            {
                arrows.entry(shown(from)).or_default().insert(shown(to));
            }
        }
    }
    arrows
}

/// All paths in code, including imports within functions and macro arguments.
struct Names {
    paths: Vec<Vec<String>>,
}

impl Names {
    fn push(&mut self, path: &syn::Path) {
        if path.leading_colon.is_none() {
            self.paths.push(path.segments.iter().map(|part| part.ident.to_string()).collect());
        }
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        if let syn::Item::Use(item) = item {
            imported(&item.tree, &mut Vec::new(), &mut self.paths);
        }
        visit::visit_item(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        if !item.attrs.iter().any(for_tests_only) {
            visit::visit_impl_item_fn(self, item);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.push(path);
        visit::visit_path(self, path);
    }

    fn visit_attribute(&mut self, _: &'ast syn::Attribute) {}

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.push(&call.path);
        let arguments = Punctuated::<Expr, Token![,]>::parse_terminated;
        for argument in arguments.parse2(call.tokens.clone()).into_iter().flatten() {
            self.visit_expr(&argument);
        }
    }
}

fn imported(tree: &syn::UseTree, path: &mut Vec<String>, paths: &mut Vec<Vec<String>>) {
    match tree {
        syn::UseTree::Path(part) => {
            path.push(part.ident.to_string());
            imported(&part.tree, path, paths);
            path.pop();
        }
        syn::UseTree::Group(group) => {
            for tree in &group.items {
                imported(tree, path, paths);
            }
        }
        syn::UseTree::Name(name) => {
            paths.push(path.iter().cloned().chain([name.ident.to_string()]).collect());
        }
        syn::UseTree::Rename(name) => {
            paths.push(path.iter().cloned().chain([name.ident.to_string()]).collect());
        }
        syn::UseTree::Glob(_) => paths.push(path.clone()),
    }
}
