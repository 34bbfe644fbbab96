//! The shape that is recovered from an experiment, as a part of a page.

use crate::motion::answers::Observed;
use crate::motion::outline_plot::{band_picture, outline_picture};
use crate::motion::reconstruction::{
    EXPLAINED, apart_in_words, convexity_in_words, from_in_words, gaps, length, model_in_words,
    no_shape_in_words, reasons, reconstruction, residual_in_words, sizes_in_words, truth, widened_in_words,
    widest,
};
use crate::motion::shape::support_error;
use maud::{Markup, PreEscaped, html};

/// The shape with its pictures; nothing where none was asked for.
pub(super) fn shape_section(observed: &Observed<'_>) -> Markup {
    let Some(found) = reconstruction(observed.answers) else { return html! {} };
    let Some(shape) = &found.shape else {
        return html! {
            p.remark { "Shape: " (no_shape_in_words(found)) @for why in reasons(found) { "; " (why) } "." }
        };
    };
    let truth = truth(observed.experiment);
    let covered = |angle: f64| found.coverage.contains(angle);
    let (picture, magnified) = outline_picture(found, shape, truth);
    html! {
        p {
            "A closed support function, " (model_in_words(shape)) ", " (from_in_words(found)) ". "
            b { (format!("{:.1} %", 100.0 * found.coverage.fraction())) " of the normals were touched" } (gaps(found)) ". "
            @if let Some(band) = widest(found, shape, covered) {
                "The band, two standard deviations to either side, is at most " b { (length(band)) } " wide where it was touched: "
                (format!("{:.1e}", band / shape.support.mean())) " of the mean radius " (length(shape.support.mean())) ". "
            }
            @if let Some((largest, rms)) = truth.and_then(|truth| support_error(shape, truth, covered)) {
                "The largest error there is " b { (length(largest)) } " (rms " (length(rms)) "). "
            }
        }
        p {
            @for (name, size) in sizes_in_words(found, shape, "m²", 6) { (name) " " (size) "; " }
            "the function is " (convexity_in_words(shape))
            @if let Some(apart) = &found.apart { "; " (apart_in_words(apart)) }
            @match &found.whole {
                Some(whole) => { "; " (residual_in_words(whole, shape)) }
                None if shape.widened > EXPLAINED => { "; " (widened_in_words(shape)) }
                None => {}
            }
            "."
        }
        figure {
            div.two { (PreEscaped(picture)) (PreEscaped(band_picture(found, shape, truth))) }
            figcaption {
                "Left: the outline"
                @if truth.is_some() { " over the true one (grey)" }
                ", with its band"
                @if magnified > 1.0 { " drawn " b { (format!("{magnified:.0}")) " times as wide as it is" } }
                "; pale where no normal was touched: there convexity alone says how wide it is, and no more than 0.3 of the mean radius is drawn. Right: the band over the angle of the normal"
                @if truth.is_some() { ", and the error of the support radius in it" }
                "."
            }
        }
    }
}
