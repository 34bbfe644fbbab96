//! What was found of one body: as text, as one object, as a page.

use super::picture::{frames, motion, plans, surface};
use crate::document::document;
use maud::{Markup, PreEscaped, html};
use palmistry_bodies::pose_surface::{
    NoPlan, PosePlan, PoseSurvey, StablePose, SurfaceComponent, path_length, plan_of_figure_3_14,
};
use serde_json::{Value, json};
use std::fmt::Write;

fn poses_table(poses: &[StablePose]) -> String {
    let mut out = String::new();
    for pose in poses {
        let _ = writeln!(
            out,
            "  phi0 {:>8.5} rad   height {:.6} m   stiffness {:.4} m/rad^2   share {:.4}",
            pose.phi0, pose.height, pose.stiffness, pose.share
        );
    }
    out
}

fn component_words(one: &SurfaceComponent) -> String {
    match one.holonomy {
        0 => format!("{:.4} sheets, cycles bring it back, reaches {:.3} rad", one.sheets, one.reach),
        1 => format!("{:.4} sheets, comes round: a cycle turns the body once", one.sheets),
        turns => format!("{:.4} sheets, a cycle turns the body {turns} times", one.sheets),
    }
}

/// What is certain, as text.
fn certificate_words(survey: &PoseSurvey) -> String {
    let Some(found) = &survey.certificate else {
        return "nothing is certified of this kind of body\n".to_owned();
    };
    if found.interrupted {
        return "cut off before anything was certain\n".to_owned();
    }
    let mut out = format!(
        "certified at margin {} on {} squares of palm angles, {:.2} % of the triangle:\n",
        found.margin,
        found.squares,
        100.0 * found.region
    );
    for (count, part) in &found.counted {
        let poses = if *count == 1 { "pose" } else { "poses" };
        let _ = writeln!(out, "  exactly {count} stable {poses} over {:.2} %", 100.0 * part);
    }
    let _ = writeln!(out, "  components: {} or more", found.at_least);
    for one in found.components.iter().take(6) {
        let turn = if one.holonomy > 0 {
            format!("; a cycle turns the body by {} turn", one.holonomy)
        } else {
            String::new()
        };
        let _ = writeln!(out, "  {:.4} sheets are connected{turn}", one.sheets);
    }
    out.push_str(if found.reaches_all() {
        "  proved: from every orientation it can be brought to every other without a jump\n"
    } else if found.is_confined {
        "  proved: at this margin no way without a jump leads through all orientations\n"
    } else {
        "  undecided whether all orientations can be reached: more levels may decide it\n"
    });
    out
}

fn plan_words(plan: &Result<PosePlan, NoPlan>) -> String {
    match plan {
        Ok(plan) => format!(
            "{:.3} rad long, {} corners, touches {:.1} % of the normals, turns the body by {:.3} rad",
            plan.length,
            plan.path.len(),
            100.0 * plan.coverage,
            plan.slide.turned()
        ),
        Err(why) => why.to_string(),
    }
}

/// As text.
pub fn poses_text(survey: &PoseSurvey) -> String {
    let [x, y] = survey.body.centre();
    let mut out = format!("{}, centre of mass ({x:.6}, {y:.6}) m\n\non a level table:\n", survey.body.text());
    out.push_str(&poses_table(&survey.level));
    let (palms, poses) = &survey.palms;
    let _ = writeln!(out, "between palms at phi1 = {}, phi2 = {}:", palms.phi1, palms.phi2);
    out.push_str(&poses_table(poses));
    let _ = writeln!(out, "inside and outside boundary meet (3.47) at {} places", survey.closing_folds.len());
    for fold in &survey.closing_folds {
        let _ = writeln!(
            out,
            "  normal {:.5} rad at palm 1, phi1 = {:.4} phi2 as both close",
            fold.angle, fold.ratio
        );
    }
    out.push_str("components of the surface, computed:\n");
    for (margin, components) in &survey.components {
        let _ = writeln!(out, "  margin {margin} rad:");
        for one in components.iter().filter(|one| one.sheets > 1e-3) {
            let _ = writeln!(out, "    {}", component_words(one));
        }
    }
    out.push_str(&certificate_words(survey));
    let _ = writeln!(out, "a plan that touches every normal: {}", plan_words(&survey.touch_all));
    if let Some(([from, to], plan)) = &survey.turn {
        let _ = writeln!(out, "a plan from {from} to {to} rad: {}", plan_words(plan));
    }
    let round = &survey.figure_3_14;
    let _ = write!(
        out,
        "two rounds of plan 3.14: {:.3} rad long, {} jumps, touch {:.1} % of the normals, turn the body by {:.3} rad",
        path_length(&plan_of_figure_3_14(survey.limits.margin, 2)),
        round.jumps.len(),
        100.0 * round.coverage(),
        round.turned()
    );
    out
}

fn poses_list(poses: &[StablePose]) -> Value {
    let one = |pose: &StablePose| json!({ "phi0": pose.phi0, "height": pose.height, "stiffness": pose.stiffness, "share": pose.share });
    poses.iter().map(one).collect()
}

fn plan_json(plan: &Result<PosePlan, NoPlan>) -> Value {
    match plan {
        Ok(plan) => json!({
            "path": plan.path.iter().map(|palms| [palms.phi1, palms.phi2]).collect::<Vec<_>>(),
            "start": plan.slide.poses.first().map(|pose| pose.1), "length": plan.length, "coverage": plan.coverage,
            "turned": plan.slide.turned(),
        }),
        Err(why) => json!({ "why": why.to_string() }),
    }
}

/// As one object.
pub fn poses_json(survey: &PoseSurvey) -> Value {
    let component = |one: &SurfaceComponent| json!({ "sheets": one.sheets, "holonomy": one.holonomy, "reach": one.reach, "reaches_all": one.reaches_all() });
    let round = &survey.figure_3_14;
    json!({
        "body": survey.body.text(), "centre": survey.body.centre(),
        "level": poses_list(&survey.level),
        "palms": { "phi1": survey.palms.0.phi1, "phi2": survey.palms.0.phi2, "poses": poses_list(&survey.palms.1) },
        "closing_folds": survey.closing_folds.iter().map(|fold| json!({ "angle": fold.angle, "ratio": fold.ratio })).collect::<Vec<_>>(),
        "components": survey.components.iter().map(|(margin, all)| json!({ "margin": margin, "components": all.iter().map(component).collect::<Vec<_>>() })).collect::<Vec<_>>(),
        "certificate": survey.certificate.as_ref().map(|found| json!({
            "margin": found.margin, "squares": found.squares, "region": found.region,
            "counted": found.counted.iter().map(|(count, part)| json!({ "poses": count, "part": part })).collect::<Vec<_>>(),
            "components": found.components.iter().map(|one| json!({ "sheets": one.sheets, "holonomy": one.holonomy })).collect::<Vec<_>>(),
            "at_least": found.at_least, "reaches_all": found.reaches_all(), "confined": found.is_confined,
        })),
        "touch_all": plan_json(&survey.touch_all),
        "turn": survey.turn.as_ref().map(|(_, plan)| plan_json(plan)),
        "figure_3_14": {
            "length": path_length(&plan_of_figure_3_14(survey.limits.margin, 2)), "coverage": round.coverage(), "turned": round.turned(),
            "jumps": round.jumps.iter().map(|jump| json!({ "phi1": jump.palms.phi1, "phi2": jump.palms.phi2, "from": jump.orientation[0], "to": jump.orientation[1] })).collect::<Vec<_>>(),
        },
    })
}

fn row(pictures: Vec<String>) -> Markup {
    html! { div class="pictures" { @for picture in pictures { (PreEscaped(picture)) } } }
}

/// As a page with pictures.
pub fn poses_page(survey: &PoseSurvey) -> String {
    let title = format!("Stable poses of {}", survey.body.text());
    let content = html! {
        header {
            h1 { (title) }
            nav { a href="#surface" { "The surface" } a href="#plans" { "Plans" } a href="#found" { "All that was found" } }
        }
        main {
            section #surface {
                h2 { "The surface of stable poses" }
                p { "Each line joins stable poses of neighbouring palm angles between which the body slides. Where lines end inside the triangle is a fold, the inside boundary (3.43): there the body jumps." }
                (row(vec![surface(survey), plans(survey)]))
                p { "Circles over the palm angles are the darker the more stable poses there are (as figures 3.13 and 3.16)." }
                @if !survey.closing_folds.is_empty() { p { "Red: inside and outside boundary meet there as both palms close (3.47)." } }
            }
            section #plans {
                h2 { "Plans" }
                @if let Ok(plan) = &survey.touch_all {
                    p { "A plan that touches every normal: " (plan_words(&survey.touch_all)) "." }
                    (PreEscaped(motion(survey, &plan.slide.poses)))
                    (row(frames(survey, &plan.slide.poses, 8)))
                } @else { p { (plan_words(&survey.touch_all)) } }
                p { "The plan of figure 3.14, two rounds." }
                (PreEscaped(motion(survey, &survey.figure_3_14.poses)))
                (row(frames(survey, &survey.figure_3_14.poses, 8)))
            }
            section #found { h2 { "All that was found" } pre { (poses_text(survey)) } }
        }
    };
    document(&title, &content, false)
}
