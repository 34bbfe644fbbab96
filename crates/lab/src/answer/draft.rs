//! What a text says while somebody writes it: its mistakes, what it declares and claims, the system as mathematics.

use super::place::Place;
use dashu::rational::RBig;
use palmistry_lang::{Declaration, DeclarationKind, Dimension, Kind, Range, System, Time, without_claims};
use palmistry_lsp::Draft;
use palmistry_math::expression::Symbol;
use palmistry_math::number::rational_to_f64;
use palmistry_report::{formula_mathml_in, system_mathematics};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

pub(super) fn draft(place: &Place<'_>) -> Value {
    let draft = place.draft();
    let base = base(place, &draft);
    let is_claim = |one: &&Declaration| matches!(one.kind, DeclarationKind::Claim(_));
    let claim = |one: &Declaration| json!({ "id": one.name, "range": draft.range(&one.entry), "key": key(&base, &draft, one) });
    let claims: Vec<Value> = draft.outline().declarations.iter().filter(is_claim).map(claim).collect();
    let mut found = json!({
        "problems": draft.diagnostics,
        "claims": claims,
        "base": base,
        // of a text with mistakes nothing is decided
        "sound": draft.diagnostics.is_empty(),
    });
    if let Some(system) = &draft.system {
        found["title"] = json!(system.title);
        found["cite"] = json!(system.cite);
        found["discrete"] = json!(system.time == Time::Discrete);
        found["symbols"] = symbols(system);
        found["outputs"] = system.outputs.iter().map(|(text, _)| json!(text)).collect();
        let signals = signals(system);
        // an input along which a signal changes is driven by the signal itself
        let is_own = |name: &str| !signals.iter().any(|signal| name.trim_end_matches('\'') == signal);
        found["fields"] = system
            .roles()
            .iter()
            .filter(|one| is_own(&one.name))
            .map(|one| json!({ "name": one.name, "role": one.role.name() }))
            .collect();
        found["signals"] = json!(signals);
        found["maps"] = maps(system);
        found["mathematics"] = json!(system_mathematics(system).into_string());
    }
    found
}

/// A number for all that verdicts depend on but the claims: two texts with one number have one system.
fn base(place: &Place<'_>, draft: &Draft) -> String {
    let mut hash = Sha256::new();
    let mut part = |text: &str| {
        hash.update((text.len() as u64).to_le_bytes());
        hash.update(text);
    };
    part(&place.own.to_string_lossy());
    part(&without_remarks(&without_claims(draft.plain())));
    // how many derivatives of a signal there are follows from what is claimed, too
    if let Some(system) = &draft.system {
        for name in system.state_names().iter().chain(&system.known_names()) {
            part(name);
        }
        for field in system.roles() {
            part(&field.name);
        }
    }
    for (file, text) in &place.named {
        part(&file.to_string_lossy());
        part(text);
    }
    hex(&hash.finalize())
}

/// A text without its comments and empty lines.
fn without_remarks(text: &str) -> String {
    let (mut found, mut quoted, mut comment) = (String::with_capacity(text.len()), false, false);
    for c in text.chars() {
        quoted ^= c == '"' && !comment;
        comment = (comment || c == '#' && !quoted) && c != '\n';
        if !comment {
            found.push(c);
        }
    }
    let lines = found.lines().map(str::trim_end).filter(|line| !line.is_empty());
    lines.map(|line| format!("{line}\n")).collect()
}

/// The same for a claim. One that another one follows from, or that restates another, depends on what stands there.
fn key(base: &str, draft: &Draft, claim: &Declaration) -> String {
    let mut hash = Sha256::new();
    hash.update(base);
    let plain = draft.plain();
    let entry = plain.get(claim.entry.clone()).unwrap_or_default();
    hash.update(entry);
    let within = |span: &std::ops::Range<usize>| claim.entry.contains(&span.start);
    if draft.outline().references.iter().any(|reference| within(&reference.span)) {
        hash.update(plain);
    }
    hex(&hash.finalize())
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}

/// The signals: what is a function of time, and not of the states.
fn signals(system: &System) -> Vec<String> {
    let first = |chain: &Vec<Symbol>| chain.first().map(|symbol| system.symbol_name(*symbol).to_owned());
    system.signal_chains().iter().filter_map(first).collect()
}

/// The symbols with the ranges that sliders have.
fn symbols(system: &System) -> Value {
    let unknowns = system.unknowns();
    let signals: Vec<Symbol> = system.signal_chains().into_iter().flatten().collect();
    let symbol = |(symbol, info): (Symbol, &palmistry_lang::SymbolInfo)| {
        if info.kind == Kind::Imported {
            return None;
        }
        let name = system.symbol_name(symbol);
        let range = info.range.clone().or_else(|| system.default_range(symbol));
        let [low, high] = ends(range.as_ref(), info.default.as_ref());
        Some(json!({
            "name": name,
            "kind": if system.states.contains(&symbol) { "state" } else { "parameter" },
            "unknown": unknowns.contains(&symbol),
            "signal": signals.contains(&symbol),
            "angle": info.is_angle,
            "low": low,
            "high": high,
            "value": info.default.as_ref().map(rational_to_f64),
            "dimension": system.dimension_of(symbol).map(Dimension::in_words),
            "mathml": formula_mathml_in(name, &system.looks),
        }))
    };
    system.symbols().filter_map(symbol).collect()
}

/// What a slider goes through: the range, or a half of a value to both sides of it.
fn ends(range: Option<&Range>, value: Option<&RBig>) -> [f64; 2] {
    match (range, value.map(rational_to_f64)) {
        (Some(range), _) if range.low < range.high => [&range.low, &range.high].map(rational_to_f64),
        (_, Some(value)) if value != 0.0 => {
            let far = value.abs() / 2.0;
            [value - far, value + far]
        }
        _ => [-1.0, 1.0],
    }
}

/// The maps that the file asks for.
fn maps(system: &System) -> Value {
    let axis = |one: &palmistry_lang::CoordinateRange<RBig>| {
        json!([one.name, rational_to_f64(&one.low), rational_to_f64(&one.high)])
    };
    let map = |map: &palmistry_lang::MapView| {
        let at: serde_json::Map<String, Value> =
            map.at.iter().map(|(name, value)| (name.clone(), json!(rational_to_f64(value)))).collect();
        json!({ "title": map.title, "x": axis(&map.axes[0]), "y": axis(&map.axes[1]), "at": at, "of": map.of, "order": map.order })
    };
    system.maps.iter().map(map).collect()
}
