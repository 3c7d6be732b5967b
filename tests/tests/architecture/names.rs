//! Test that type names are unique.

use std::collections::BTreeMap;

use crate::tests::architecture::module_tree::ModuleTree;
use crate::tests::architecture::offenders::forbid;
use crate::tests::architecture::sources::{members, shown};

#[test]
fn no_type_name_is_used_twice_within_a_crate() {
    let mut wrong = BTreeMap::new();
    for member in members() {
        for root in member.roots() {
            let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
            for module in ModuleTree::read(&root).modules {
                for name in module.types {
                    places.entry(name).or_default().push(shown(&module.file));
                }
            }
            for (name, places) in places.into_iter().filter(|(_, places)| places.len() > 1) {
                wrong.insert(
                    format!("{}: {name}", member.name),
                    format!("in {}", places.join(", ")),
                );
            }
        }
    }
    forbid("type", &wrong, "Rename all but one after what sets them apart, or make them one type.");
}
