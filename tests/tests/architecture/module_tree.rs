//! Modules of a crate with their definitions and imports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::{Attribute, Item, UseTree, Visibility};

use crate::tests::architecture::sources::{shown, text};

/// Name imported by a `use`.
pub(crate) struct Import {
    /// Path of the `use`, with `crate`, `self` and `super`. Ends in `*` for all names of a module.
    pub(crate) path: Vec<String>,
    /// `true` for a re-export: `pub use` of any visibility.
    pub(crate) reexport: bool,
}

/// Module, in a separate file or inline.
pub(crate) struct Module {
    pub(crate) file: PathBuf,
    pub(crate) parent: Option<usize>,
    pub(crate) children: BTreeMap<String, usize>,
    /// Names of the items defined here.
    pub(crate) items: BTreeSet<String>,
    /// Names of the structs, enums, unions, traits and type aliases defined here.
    pub(crate) types: Vec<String>,
    pub(crate) imports: BTreeMap<String, Import>,
    pub(crate) globs: Vec<Import>,
    /// Items without modules and imports.
    pub(crate) code: Vec<Item>,
}

/// Modules of a crate, without test-only modules; the first one is the root.
pub(crate) struct ModuleTree {
    pub(crate) modules: Vec<Module>,
}

impl ModuleTree {
    pub(crate) fn read(root: &Path) -> Self {
        let mut tree = Self { modules: Vec::new() };
        let folder = root.parent().expect("a file is in a folder").to_path_buf();
        tree.add_file(root, &folder, None);
        tree
    }

    /// Adds a file; its child modules are in `folder`.
    fn add_file(&mut self, file: &Path, folder: &Path, parent: Option<usize>) -> usize {
        let parsed =
            syn::parse_file(&text(file)).unwrap_or_else(|error| panic!("{}: {error}", shown(file)));
        self.add(file, folder, parent, parsed.items)
    }

    fn add(
        &mut self,
        file: &Path,
        folder: &Path,
        parent: Option<usize>,
        items: Vec<Item>,
    ) -> usize {
        let index = self.modules.len();
        self.modules.push(Module {
            file: file.to_path_buf(),
            parent,
            children: BTreeMap::new(),
            items: BTreeSet::new(),
            types: Vec::new(),
            imports: BTreeMap::new(),
            globs: Vec::new(),
            code: Vec::new(),
        });
        for item in items {
            if attributes(&item).iter().any(for_tests_only) {
                continue;
            }
            match item {
                Item::Mod(module) => {
                    let name = module.ident.to_string();
                    let below = folder.join(&name);
                    let child = match module.content {
                        Some((_, items)) => self.add(file, &below, Some(index), items),
                        None => self.add_file(&module_file(folder, &name), &below, Some(index)),
                    };
                    self.modules[index].children.insert(name, child);
                }
                Item::Use(item) => {
                    let reexport = !matches!(item.vis, Visibility::Inherited);
                    self.modules[index].import(&item.tree, Vec::new(), reexport);
                }
                item => self.modules[index].define(item),
            }
        }
        index
    }

    /// Returns the file that defines the item of a path, as seen from a module. `None` for modules,
    /// and for items of other crates.
    pub(crate) fn definition(&self, module: usize, path: &[String]) -> Option<&Path> {
        match self.follow(module, path, 0)? {
            Found::Module(_) => None,
            Found::Item(module) => Some(&self.modules[module].file),
        }
    }

    fn follow(&self, module: usize, path: &[String], depth: usize) -> Option<Found> {
        let (first, rest) = path.split_first()?;
        let mut module = match first.as_str() {
            "crate" => Found::Module(0),
            "self" => Found::Module(module),
            "super" => Found::Module(self.modules[module].parent?),
            name => self.look_up(module, name, depth)?,
        };
        for name in rest {
            module = match module {
                // The rest are variants and associated items.
                Found::Item(_) => return Some(module),
                Found::Module(module) if name == "super" => {
                    Found::Module(self.modules[module].parent?)
                }
                Found::Module(module) if name == "self" => Found::Module(module),
                Found::Module(module) => self.look_up(module, name, depth)?,
            };
        }
        Some(module)
    }

    fn look_up(&self, module: usize, name: &str, depth: usize) -> Option<Found> {
        // Globs may form a cycle.
        if depth > 20 {
            return None;
        }
        let current = &self.modules[module];
        if let Some(child) = current.children.get(name) {
            return Some(Found::Module(*child));
        }
        if current.items.contains(name) {
            return Some(Found::Item(module));
        }
        if let Some(import) = current.imports.get(name) {
            // For example `use serde::{self, Serialize}`: avoids recursion into the name itself.
            let is_module_name = import.path.len() == 1 && import.path[0] == name;
            return if is_module_name {
                None
            } else {
                self.follow(module, &import.path, depth + 1)
            };
        }
        current.globs.iter().find_map(|glob| {
            let Found::Module(from) = self.follow(module, &glob.path, depth + 1)? else {
                return None;
            };
            self.look_up(from, name, depth + 1)
        })
    }
}

enum Found {
    Module(usize),
    Item(usize),
}

impl Module {
    fn import(&mut self, tree: &UseTree, mut path: Vec<String>, reexport: bool) {
        match tree {
            UseTree::Path(part) => {
                path.push(part.ident.to_string());
                self.import(&part.tree, path, reexport);
            }
            UseTree::Name(name) if name.ident == "self" => {
                if let Some(last) = path.last().cloned() {
                    self.imports.insert(last, Import { path, reexport });
                }
            }
            UseTree::Name(name) => {
                let name = name.ident.to_string();
                path.push(name.clone());
                self.imports.insert(name, Import { path, reexport });
            }
            UseTree::Rename(rename) => {
                if rename.ident != "self" {
                    path.push(rename.ident.to_string());
                }
                // `as _` imports only the methods of a trait; several such imports may exist.
                let name = match rename.rename.to_string().as_str() {
                    "_" => format!("_ {}", path.join("::")),
                    name => name.to_owned(),
                };
                self.imports.insert(name, Import { path, reexport });
            }
            UseTree::Glob(_) => self.globs.push(Import { path, reexport }),
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.import(tree, path.clone(), reexport);
                }
            }
        }
    }

    fn define(&mut self, item: Item) {
        let (name, is_type) = match &item {
            Item::Struct(item) => (Some(&item.ident), true),
            Item::Enum(item) => (Some(&item.ident), true),
            Item::Union(item) => (Some(&item.ident), true),
            Item::Trait(item) => (Some(&item.ident), true),
            Item::Type(item) => (Some(&item.ident), true),
            Item::Fn(item) => (Some(&item.sig.ident), false),
            Item::Const(item) => (Some(&item.ident), false),
            Item::Static(item) => (Some(&item.ident), false),
            Item::Macro(item) => (item.ident.as_ref(), false),
            _ => (None, false),
        };
        if let Some(name) = name {
            self.items.insert(name.to_string());
            if is_type {
                self.types.push(name.to_string());
            }
        }
        self.code.push(item);
    }
}

fn module_file(folder: &Path, name: &str) -> PathBuf {
    let file = folder.join(format!("{name}.rs"));
    if file.exists() { file } else { folder.join(name).join("mod.rs") }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// Returns true for `#[cfg(test)]`, alone or among other conditions.
pub(crate) fn for_tests_only(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg")
        && attribute.meta.require_list().is_ok_and(|list| {
            list.tokens.to_string().split(|c: char| !c.is_alphanumeric()).any(|word| word == "test")
        })
}
