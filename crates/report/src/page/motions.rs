//! Unobservable directions as vector fields, and identifiable combinations as functions, as mathematics.

use crate::formula::{field_mathml, formula_mathml_in};
use crate::ranks::motions::{signed_parts, unobservable_field_text};
use maud::{Markup, PreEscaped, html};
use palmistry_lang::Looks;
use palmistry_rank::observability::{UnobservableDirections, UnobservableField};
use palmistry_workbench::paper::SetRank;

/// For each set with unobservable directions, the fields and the functions.
pub(super) fn unobservable_directions(ranks: &[SetRank], looks: &Looks) -> Markup {
    let found = ranks.iter().filter_map(|rank| Some((rank, rank.answer().ok()?)));
    let found: Vec<(&SetRank, &UnobservableDirections)> = found
        .flat_map(|(rank, answer)| {
            answer.branches.iter().filter_map(move |b| Some((rank, b.motions.as_ref()?)))
        })
        .collect();
    html! {
        @for (rank, found) in found { (of_a_set(rank.name(), found, looks)) }
    }
}

fn of_a_set(name: &str, found: &UnobservableDirections, looks: &Looks) -> Markup {
    let scope =
        if found.for_all_parameters { ", for all parameter values" } else { " at the values in the file" };
    html! {
        p {
            "Unobservable directions (generically; " (name) (scope) "): "
            @for (place, field) in found.fields.iter().enumerate() {
                @if place > 0 { "; " }
                span.f { (field_formula(field, looks)) }
            }
            @if found.fields_missing > 0 {
                @if !found.fields.is_empty() { "; " }
                (found.fields_missing) " directions of which no field of low degree was found"
            }
            "."
            @if !found.fields.is_empty() {
                " Along such a field no output and none of its Lie derivatives changes (proved)."
            }
            @if !found.observable.is_empty() {
                " Observable: "
                @for (place, name) in found.observable_names.iter().enumerate() {
                    @if place > 0 { ", " }
                    span.f { (expression(name, looks)) }
                }
                "."
            }
            @if !found.functions.is_empty() {
                " Identifiable combinations (generically): "
                @for (place, function) in found.functions.iter().enumerate() {
                    @if place > 0 { ", " }
                    span.f { (expression(&function.text, looks)) }
                }
                "."
            }
            @if found.functions_missing > 0 {
                " " (found.functions_missing) " more identifiable combinations exist, which were not found in low degree."
            }
        }
    }
}

fn field_formula(field: &UnobservableField, looks: &Looks) -> PreEscaped<String> {
    field_mathml(&signed_parts(field), looks)
        .map_or_else(|| in_letters(&unobservable_field_text(field)), PreEscaped)
}

fn expression(text: &str, looks: &Looks) -> PreEscaped<String> {
    formula_mathml_in(text, looks).map_or_else(|| in_letters(text), PreEscaped)
}

fn in_letters(text: &str) -> PreEscaped<String> {
    html! { code { (text) } }
}
