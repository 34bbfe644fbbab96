//! What of SBML is not read because it changes what a model means: events, algebraic rules, fast reactions, packages.

use super::xml::{is, listed, place, says};
use palmistry_lang::{Code, Problem};
use roxmltree::Node;
use std::collections::BTreeSet;

/// What changes the meaning of a model and is not read.
pub(super) fn refuse(model: Node<'_, '_>) -> Result<(), Problem> {
    let named = |node: Node<'_, '_>| {
        node.attribute("id").or(node.attribute("variable")).map_or(String::new(), |id| format!(" '{id}'"))
    };
    if let Some(event) = listed(model, "listOfEvents").into_iter().next() {
        return Err(Problem::new(
            Code::Foreign,
            &place(event),
            format!("the event{} is not read", named(event)),
            "this",
        )
        .help("events change states in jumps: take them out, and look at the time between them"));
    }
    for rule in listed(model, "listOfRules") {
        if is(rule, "algebraicRule") {
            return Err(Problem::new(
                Code::Foreign,
                &place(rule),
                "algebraic rules are not read",
                "this rule",
            )
            .help("solve it for one of its variables, and write an assignment rule"));
        }
    }
    for reaction in listed(model, "listOfReactions") {
        if says(reaction, "fast", false) {
            return Err(Problem::new(
                Code::Foreign,
                &place(reaction),
                format!("the reaction{} is fast: that is not read", named(reaction)),
                "this",
            )
            .help("fast reactions are equations between states: eliminate them"));
        }
    }
    Ok(())
}

/// Packages of level 3 that change what the core says, and are used: many writers declare one that they then say nothing in.
pub(super) fn refuse_packages(root: Node<'_, '_>) -> Result<(), Problem> {
    let declared = root.attributes().filter(|attribute| {
        attribute.name() == "required" && matches!(attribute.value().trim(), "true" | "1")
    });
    let needed: BTreeSet<&str> = declared.filter_map(|attribute| attribute.namespace()).collect();
    if needed.is_empty() {
        return Ok(());
    }
    let of_package = |name: Option<&str>| name.and_then(|name| needed.get(name).copied());
    for node in root.descendants().filter(|node| node.is_element()) {
        let attributes = || {
            let mut all = node.attributes();
            all.find_map(|one| of_package(one.namespace().filter(|_| node != root)))
        };
        let Some(package) = of_package(node.tag_name().namespace()).or_else(attributes) else { continue };
        // .../level3/version1/comp/version1
        let mut parts = package.rsplit('/').filter(|part| !part.starts_with("version"));
        let name = parts.next().unwrap_or(package);
        let message = format!("the package '{name}' changes what the model means, and is not read");
        return Err(
            Problem::new(Code::Foreign, &place(node), message, "this").help("export the model as core SBML")
        );
    }
    Ok(())
}
