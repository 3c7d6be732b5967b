//! Test that the documentation names existing items and files.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use syn::{ImplItem, Item, TraitItem, Visibility};

use crate::tests::architecture::module_tree::{Module, ModuleTree};
use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{files, members, root, shown, text};

fn documents() -> Vec<PathBuf> {
    let mut documents: Vec<PathBuf> = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"]
        .iter()
        .map(|name| root().join(name))
        .filter(|path| path.exists())
        .collect();
    documents.extend(files(&root().join("docs"), &["md"]));
    documents
}

#[test]
fn items_that_documents_name_exist() {
    let mut public: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut all = BTreeSet::new();
    for library in members().iter().filter(|member| member.is_library()) {
        let mut names = BTreeSet::new();
        for root in library.roots() {
            for module in &ModuleTree::read(&root).modules {
                add_public_names(module, &mut names);
            }
        }
        all.extend(names.iter().cloned());
        public.insert(library.name.replace('-', "_"), names);
    }
    // The facade re-exports the others.
    public.entry("iiwa".to_owned()).or_default().extend(all);

    let mut wrong = BTreeMap::new();
    for document in documents() {
        for path in paths(&text(&document)) {
            let (first, rest) = path.split_first().expect("a path has parts");
            let missing = match public.get(first) {
                Some(names) => rest.iter().find(|name| !names.contains(*name)),
                None => Some(first),
            };
            if let Some(missing) = missing {
                wrong.insert(
                    format!("{}: {}", shown(&document), path.join("::")),
                    format!("there is no public {missing}"),
                );
            }
        }
    }
    forbid("document", &wrong, "Correct the document, or mark the item there as private.");
}

#[test]
fn files_that_documents_link_to_exist() {
    let mut wrong = BTreeMap::new();
    for document in documents() {
        let folder = document.parent().expect("a file is in a folder");
        let text = text(&document);
        for (_, after) in
            text.match_indices("](").map(|(offset, mark)| text.split_at(offset + mark.len()))
        {
            let Some((link, _)) = after.split_once(')') else { continue };
            let target = link.split(['#', ' ']).next().unwrap_or_default();
            if !target.is_empty() && !target.contains(':') && !folder.join(target).exists() {
                wrong.insert(format!("{}: {target}", shown(&document)), "no such file".to_owned());
            }
        }
    }
    forbid("link", &wrong, "Point to where the file is now.");
}

/// Returns paths such as `iiwa_kin::Robot::flange_pose`; for `iiwa_path::{Program, Blend}`, one
/// path per name in the braces.
fn paths(text: &str) -> Vec<Vec<String>> {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let mut crate_names = Vec::new();
    for (offset, _) in text.match_indices("iiwa") {
        if text[..offset].ends_with(|c: char| word(c) || c == ':' || c == '/' || c == '-') {
            continue;
        }
        let mut path = Vec::new();
        let mut rest = &text[offset..];
        loop {
            let end = rest.find(|c| !word(c)).unwrap_or(rest.len());
            if end == 0 {
                break;
            }
            path.push(rest[..end].to_owned());
            let after = rest[end..].strip_prefix("::");
            rest = after.unwrap_or_default();
        }
        if let Some((names, _)) = rest.strip_prefix('{').and_then(|rest| rest.split_once('}')) {
            // Nested groups occur only in code, not in prose.
            for name in names.split(',').map(str::trim).filter(|name| name.chars().all(word)) {
                let end = (!name.is_empty() && name != "self").then(|| name.to_owned());
                crate_names.push(path.iter().cloned().chain(end).collect());
            }
        } else if path.len() > 1 {
            crate_names.push(path);
        }
    }
    crate_names
}

/// Adds the names of public items, their fields, variants and methods, including re-exports.
fn add_public_names(module: &Module, names: &mut BTreeSet<String>) {
    names.extend(module.children.keys().cloned());
    names.extend(
        module.imports.iter().filter(|(_, import)| import.reexport).map(|(name, _)| name.clone()),
    );
    let public = |visibility: &Visibility| matches!(visibility, Visibility::Public(_));
    for item in &module.code {
        match item {
            Item::Struct(item) if public(&item.vis) => {
                names.insert(item.ident.to_string());
                let fields = item.fields.iter().filter(|field| public(&field.vis));
                names.extend(
                    fields.filter_map(|field| field.ident.as_ref()).map(ToString::to_string),
                );
            }
            Item::Enum(item) if public(&item.vis) => {
                names.insert(item.ident.to_string());
                for variant in &item.variants {
                    names.insert(variant.ident.to_string());
                    let fields = variant.fields.iter().filter_map(|field| field.ident.as_ref());
                    names.extend(fields.map(ToString::to_string));
                }
            }
            Item::Trait(item) if public(&item.vis) => {
                names.insert(item.ident.to_string());
                for item in &item.items {
                    if let TraitItem::Fn(item) = item {
                        names.insert(item.sig.ident.to_string());
                    }
                }
            }
            Item::Impl(item) => {
                for item in &item.items {
                    match item {
                        ImplItem::Fn(item) if public(&item.vis) => {
                            names.insert(item.sig.ident.to_string());
                        }
                        ImplItem::Const(item) if public(&item.vis) => {
                            names.insert(item.ident.to_string());
                        }
                        _ => {}
                    }
                }
            }
            Item::Fn(item) if public(&item.vis) => {
                names.insert(item.sig.ident.to_string());
            }
            Item::Type(item) if public(&item.vis) => {
                names.insert(item.ident.to_string());
            }
            Item::Const(item) if public(&item.vis) => {
                names.insert(item.ident.to_string());
            }
            _ => {}
        }
    }
}

/// Checks that an item named in a table beside the link to a file, such as `` `Limits::check`
/// ([limits.rs](..)) ``, is in that file.
#[test]
fn items_are_in_the_files_that_documents_name_beside_them() {
    let mut wrong = BTreeMap::new();
    for document in documents() {
        let folder = document.parent().expect("a file is in a folder");
        for line in text(&document).lines() {
            let mut parts = line.split("](").peekable();
            while let (Some(before), Some(after)) = (parts.next(), parts.peek()) {
                let Some((target, _)) = after.split_once(')') else { continue };
                let file = folder.join(target);
                if file.extension().is_none_or(|extension| extension != "rs") || !file.exists() {
                    continue;
                }
                let source = text(&file);
                // After the previous link, and within a table cell.
                let before = before.split_once(')').map_or(before, |(_, rest)| rest);
                let cell = before.rsplit('|').next().unwrap_or_default();
                for name in cell.split('`').skip(1).step_by(2) {
                    let item = name.rsplit("::").next().unwrap_or_default();
                    let is_name =
                        !item.is_empty() && item.chars().all(|c| c.is_alphanumeric() || c == '_');
                    // A module is in the file of its name.
                    let is_module = file.with_extension("").ends_with(item);
                    if is_name
                        && !is_module
                        && !defines(&source, item)
                        && !name.starts_with("iiwa_fri")
                    {
                        wrong.insert(
                            format!("{}: {name}", shown(&document)),
                            format!("{target} does not define {item}"),
                        );
                    }
                }
            }
        }
    }
    forbid("place", &wrong, "Point to the file that defines it.");
}

/// Returns true if a source defines an item, a field or a variant of this name.
fn defines(source: &str, name: &str) -> bool {
    let keywords = ["fn", "struct", "enum", "trait", "const", "type", "static"];
    source.lines().any(|line| {
        let words: Vec<&str> = line
            .split(|c: char| !(c.is_alphanumeric() || c == '_'))
            .filter(|w| !w.is_empty())
            .collect();
        words.windows(2).any(|pair| keywords.contains(&pair[0]) && pair[1] == name)
            || words.first() == Some(&name)
            || (words.first() == Some(&"pub") && words.get(1) == Some(&name))
    })
}
