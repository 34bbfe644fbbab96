//! What was found, as JSON, as text, as JUnit XML, and as a page with plots.
//!
//! Nothing is decided here.

#![warn(missing_docs)]

mod advice;
mod axis;
mod certificate;
mod choice;
mod claims;
mod compact;
mod document;
mod drawing;
mod formula;
mod inline_hash;
mod joint;
mod layout;
mod least;
mod motion;
mod moved_body;
mod names;
mod notebook;
mod object;
mod page;
mod plot;
mod poses;
mod ranks;
mod recheck;
mod slow;
mod slow_observed;
mod slow_plot;
mod slow_section;
mod slow_speed;
mod slow_study;
mod solid_picture;
mod space;
mod space_advice;
mod space_page;
mod space_surfaces;
mod stress;
mod structure;
mod trade;
mod value;

#[doc(hidden)]
pub use advice::{advice_json, advice_text};
#[doc(hidden)]
pub use axis::unit_of;
#[doc(hidden)]
pub use certificate::percent;
pub use certificate::{region_curve, region_json, region_map, region_text};
#[doc(hidden)]
pub use choice::{choice_json, choice_text};
pub use claims::{
    ClaimsForm, ClaimsSummary, Shown, claim_json, claim_line, claim_text, claims_text, counts_text,
    errata_markdown, junit,
};
#[doc(hidden)]
pub use formula::definition_mathml;
pub use formula::{
    expression_latex, expression_latex_in, formula_mathml, formula_mathml_in, statement_latex,
    statement_latex_in,
};
#[doc(hidden)]
pub use joint::{JointObserved, joint_json, joint_page, joint_parameters, joint_simulation, joint_text};
#[doc(hidden)]
pub use layout::Colour;
pub use layout::Layout;
pub use least::{least_json, least_text, plan_json, plan_text};
pub use motion::{Observed, modes_json, modes_text, observe_json, observe_page, observe_text};
#[doc(hidden)]
pub use motion::{stream_end_json, stream_end_text, stream_json, stream_text};
pub use notebook::{claims_html, rank_html};
pub use object::{claims_json, read_error_json, versioned};
pub use page::{
    TheoremAddresses, drops_page, findings_json, findings_text, page, page_with, system_mathematics,
};
#[doc(hidden)]
pub use page::{forget_seconds, forget_times};
#[doc(hidden)]
pub use poses::{conjecture_json, conjecture_text, poses_json, poses_page, poses_text};
pub use ranks::{
    RankTextParts, SingularSet, StateTableWriter, TableForm, accessibility_json, accessibility_text,
    design_json, design_text, drops_json, drops_text, global_json, global_text, rank_json, rank_so_far_json,
    rank_so_far_text, rank_text, rank_text_with, singular_set_json, unobservable_directions_json,
    unobservable_field_text,
};
pub use recheck::{has_failed, recheck_json, recheck_text};
#[doc(hidden)]
pub use slow::{slow_json, slow_page, slow_text};
#[doc(hidden)]
pub use slow_observed::SlowObserved;
pub use solid_picture::{ShownSurface, solid_page};
#[doc(hidden)]
pub use space::{SpaceObserved, space_ended, space_json, space_text};
#[doc(hidden)]
pub use space_advice::{runs_advice_json, runs_advice_text};
pub use space_page::space_page;
pub use space_surfaces::{SpaceSurface, SurfaceKind, space_surfaces};
#[doc(hidden)]
pub use stress::{stress_json, stress_pictures, stress_text};
#[doc(hidden)]
pub use structure::{DiagramGround, structure_picture};
#[doc(hidden)]
pub use trade::{trade_front_table, trade_json, trade_plot, trade_text};
pub use value::{ValueAsked, how_certain, value_json, value_text};
