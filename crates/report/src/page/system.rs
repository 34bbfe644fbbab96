//! A system as a paper writes it: what its letters are, its fields, its outputs.

use crate::axis::{unit_in_print, unit_of};
use crate::formula::{definition_mathml, formula_mathml_in};
use crate::names::plain_number;
use maud::{Markup, PreEscaped, html};
use palmistry_lang::{FieldAsWritten, Kind, Looks, System, SystemAsWritten, Time, UnknownKind};
use palmistry_math::expression::Symbol;

/// Expressions that are longer as texts are not set as formulas.
const LONGEST: usize = 1500;
/// Outputs of fewer letters stand on one line.
const SHORT: usize = 12;
/// More abbreviations than these are folded.
const FEW: usize = 6;

/// The system as mathematics: its letters with their units, fields, outputs, and what abbreviations stand for.
pub fn system_mathematics(system: &System) -> Markup {
    let SystemAsWritten { fields, mut outputs, definitions } = system.as_written();
    let experiments = 1 + outputs
        .iter()
        .filter_map(|text| text.rsplit_once('@')?.1.parse::<usize>().ok())
        .map(|n| n - 1)
        .max()
        .unwrap_or(0);
    outputs.retain(|text| text.rsplit_once('@').is_none_or(|(_, behind)| behind.parse::<usize>().is_err()));
    let looks = &system.looks;
    let mark = if system.time == Time::Discrete { "\u{207a}" } else { "\u{2032}" };
    let abbreviations = html! {
        table.system {
            @for (name, text) in &definitions { tr { td { (definition(name, text, looks)) } } }
        }
    };
    html! {
        (letters(system))
        @if experiments > 1 { p { (experiments) " experiments with the same constants." } }
        @for field in &fields { (field_rows(field, mark, looks)) }
        @if !outputs.is_empty() {
            @if outputs.iter().all(|text| text.len() < SHORT) {
                p.field { "measured " @for (place, text) in outputs.iter().enumerate() { @if place > 0 { ", " } (formula(text, looks)) } }
            } @else {
                p.field { "measured" }
                table.system { @for text in &outputs { tr { td { (formula(text, looks)) } } } }
            }
        }
        @if !definitions.is_empty() && definitions.len() <= FEW { p.field { "where" } (abbreviations) }
        @else if !definitions.is_empty() {
            details { summary { "the " (definitions.len()) " abbreviations" } (abbreviations) }
        }
    }
}

fn field_rows(field: &FieldAsWritten, mark: &str, looks: &Looks) -> Markup {
    html! {
        p.field { (field.role.name()) " " (formula(&field.name, looks)) }
        table.system {
            @for (state, rate) in &field.rates {
                tr {
                    @if state == "others" { td colspan="3" { "the other states stand still" } }
                    @else {
                        td.nb { (formula(state, looks)) (mark) } td { "=" } td { (formula(rate, looks)) }
                    }
                }
            }
        }
    }
}

/// What each letter is, kind by kind.
fn letters(system: &System) -> Markup {
    let looks = &system.looks;
    let coordinates: Vec<(Symbol, Option<UnknownKind>)> =
        system.states.iter().map(|symbol| (*symbol, system.unknown_kind(*symbol))).collect();
    let of = |wanted: Option<UnknownKind>| -> Vec<Symbol> {
        let own = coordinates.iter().filter(|(_, kind)| *kind == wanted);
        // the states of further experiments, and the derivatives of signals, have names of their own
        own.map(|(symbol, _)| *symbol)
            .filter(|symbol| !system.symbol_name(*symbol).contains(['@', '\'']))
            .collect()
    };
    let is_coordinate = |symbol: &Symbol| system.states.contains(symbol);
    let constants = system.symbols().filter(|(_, info)| info.kind == Kind::Parameter);
    let constants = constants.map(|(symbol, _)| symbol).filter(|symbol| !is_coordinate(symbol)).collect();
    // a state whose initial condition is known is a state
    let signals: Vec<Symbol> = system.signal_chains().into_iter().flatten().collect();
    let (known_signals, known_at_first): (Vec<Symbol>, Vec<Symbol>) =
        of(None).into_iter().partition(|symbol| signals.contains(symbol));
    let kinds: [(&str, Vec<Symbol>); 6] = [
        ("states", of(Some(UnknownKind::State))),
        ("states with a known initial condition", known_at_first),
        ("known signals", known_signals),
        ("unknown constants", of(Some(UnknownKind::Parameter))),
        ("unknown signals", of(Some(UnknownKind::Signal))),
        ("known constants", constants),
    ];
    html! {
        p {
            @for (place, (kind, symbols)) in kinds.iter().filter(|(_, symbols)| !symbols.is_empty()).enumerate() {
                @if place > 0 { "; " }
                @if place == 0 { (kind[..1].to_uppercase()) (kind[1..]) } @else { (kind) }
                " "
                @for (place, symbol) in symbols.iter().enumerate() {
                    @let name = system.symbol_name(*symbol);
                    @let value = system.symbol_info(*symbol).and_then(|info| info.default.as_ref());
                    @let unit = unit_of(system, name);
                    @if place > 0 { ", " }
                    // on one line: a value, and its unit behind it
                    span.nb {
                        (formula(name, looks))
                        @if let Some(value) = value { " = " (plain_number(value)) }
                        @match (value, unit) {
                            (Some(_), Some(unit)) => { "\u{a0}" (unit_in_print(&unit)) }
                            (None, Some(unit)) => { " (" (unit_in_print(&unit)) ")" }
                            _ => {}
                        }
                    }
                }
            }
            "."
        }
    }
}

fn definition(name: &str, text: &str, looks: &Looks) -> Markup {
    match definition_mathml(name, text, looks).filter(|_| text.len() <= LONGEST) {
        Some(formula) => PreEscaped(formula),
        None => html! { code { (name) " = " (cut(text)) } },
    }
}

fn formula(text: &str, looks: &Looks) -> Markup {
    // what an index runs through is no formula
    let has_an_index =
        text.split('[').skip(1).any(|behind| behind.starts_with(|c: char| c.is_ascii_alphabetic()));
    let is_range = has_an_index && !text.starts_with('[');
    match formula_mathml_in(text, looks).filter(|_| text.len() <= LONGEST && !is_range) {
        Some(formula) => PreEscaped(formula),
        None => html! { code { (cut(text)) } },
    }
}

fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{} ...", &text[..end]),
        None => text.to_owned(),
    }
}
