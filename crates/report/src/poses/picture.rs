//! Pictures of the surface of stable poses: itself, from the side (as figures 3.13 and 3.16), the palms' plans (3.14), and the body between its palms, still
//! and in motion.

use crate::drawing::{INK, MESH, SOFT, svg};
use crate::moved_body::{MovedPose, moved_body, rows, still_body};
use palmistry_bodies::pose_surface::{PalmPair, PoseSurvey, measurements, plan_of_figure_3_14};
use plotters::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const PLAN: RGBColor = RGBColor(213, 94, 0);
const ROUND: RGBColor = RGBColor(0, 114, 178);
const MEETING: RGBColor = RGBColor(200, 40, 60);
/// Low orientations to high ones.
const HEIGHTS: [RGBColor; 6] = [
    RGBColor(68, 1, 84),
    RGBColor(65, 68, 135),
    RGBColor(42, 120, 142),
    RGBColor(34, 168, 132),
    RGBColor(122, 209, 81),
    RGBColor(222, 190, 37),
];

type Drawn = Result<(), Box<dyn std::error::Error>>;

/// A place in the space of `phi1`, `phi2`, `phi0` as a pixel: `phi1` to the lower right, `phi2` to the lower left, `phi0` up.
fn seen(palms: PalmPair, phi0: f64) -> (i32, i32) {
    let x = 330.0 + 88.0 * (palms.phi1 - palms.phi2);
    let y = 520.0 + 40.0 * (palms.phi1 + palms.phi2) - 78.0 * phi0;
    (x.round() as i32, y.round() as i32)
}

/// The surface over its grid, a line for each way between neighbours; coloured by the orientation.
pub(super) fn surface(survey: &PoseSurvey) -> String {
    svg((660, 700), "the surface of stable poses", |area| -> Drawn {
        let text = |words: &str, at: (i32, i32)| {
            area.draw(&Text::new(words.to_owned(), at, ("sans-serif", 14).into_font().color(&INK)))
        };
        for phi0 in [0.0, TAU] {
            let corners = [(0.0, 0.0), (PI, 0.0), (0.0, PI), (0.0, 0.0)];
            let outline: Vec<_> = corners.iter().map(|(a, b)| seen(PalmPair::new(*a, *b), phi0)).collect();
            area.draw(&PathElement::new(outline, SOFT.stroke_width(1)))?;
        }
        let edge = [0.0, TAU].map(|phi0| seen(PalmPair::new(0.0, 0.0), phi0)).to_vec();
        area.draw(&PathElement::new(edge, SOFT.stroke_width(1)))?;
        for pose in &survey.grid.poses {
            for (other, turned) in &pose.ways {
                let there = &survey.grid.poses[*other];
                // each way stands with both of its ends; one that goes round the turn is drawn at both of its ends
                let at = [seen(pose.palms, pose.phi0), seen(there.palms, pose.phi0 + turned)];
                let height = (pose.phi0 / TAU * HEIGHTS.len() as f64) as usize;
                if (pose.phi0 + turned - there.phi0).abs() < 1.0 && *turned < 0.0 {
                    continue;
                }
                area.draw(&PathElement::new(
                    at.to_vec(),
                    HEIGHTS[height.min(HEIGHTS.len() - 1)].stroke_width(1),
                ))?;
            }
        }
        // figure 3.16: where the boundaries meet as both palms close (3.47), the normal at palm 1 being -pi/2 - phi0
        for fold in &survey.closing_folds {
            let phi0 = (-FRAC_PI_2 - fold.angle).rem_euclid(TAU);
            area.draw(&Circle::new(seen(PalmPair::new(0.0, 0.0), phi0), 6, MEETING.filled()))?;
        }
        text("phi1", (560, 665))?;
        text("phi2", (70, 665))?;
        text("phi0, one turn", (346, 36))?;
        Ok(())
    })
}

/// A pair of palms as a pixel: `phi1` to the right, `phi2` up.
fn flat(palms: PalmPair) -> (i32, i32) {
    ((60.0 + 110.0 * palms.phi1).round() as i32, (400.0 - 110.0 * palms.phi2).round() as i32)
}

/// How many stable poses there are over the palm angles, and where both plans lead.
pub(super) fn plans(survey: &PoseSurvey) -> String {
    svg((440, 450), "stable poses over the palm angles, and plans", |area| -> Drawn {
        let nodes = survey.grid.poses.chunk_by(|a, b| a.palms == b.palms);
        let shades = [
            MESH,
            RGBColor(198, 219, 239),
            RGBColor(107, 174, 214),
            RGBColor(49, 130, 189),
            RGBColor(8, 69, 148),
        ];
        let radius = (60.0 / survey.grid.side as f64 * 1.6).clamp(2.0, 8.0) as i32;
        for node in nodes {
            let shade = shades[node.len().min(shades.len() - 1)];
            area.draw(&Circle::new(flat(node[0].palms), radius, shade.filled()))?;
        }
        let corners = [(0.0, 0.0), (PI, 0.0), (0.0, PI), (0.0, 0.0)];
        let outline: Vec<_> = corners.iter().map(|(a, b)| flat(PalmPair::new(*a, *b))).collect();
        area.draw(&PathElement::new(outline, SOFT.stroke_width(1)))?;
        let round: Vec<_> = plan_of_figure_3_14(survey.limits.margin, 1).into_iter().map(flat).collect();
        area.draw(&PathElement::new(round, ROUND.stroke_width(2)))?;
        if let Ok(plan) = &survey.touch_all {
            area.draw(&PathElement::new(
                plan.path.iter().copied().map(flat).collect::<Vec<_>>(),
                PLAN.stroke_width(3),
            ))?;
        }
        for jump in &survey.figure_3_14.jumps {
            area.draw(&Circle::new(flat(jump.palms), 5, ROUND.filled()))?;
        }
        let style = |colour: RGBColor| ("sans-serif", 14).into_font().color(&colour);
        area.draw(&Text::new("plan of figure 3.14, dots where it jumps", (150, 20), style(ROUND)))?;
        area.draw(&Text::new("plan that touches every normal", (150, 40), style(PLAN)))?;
        area.draw(&Text::new("phi1", (400, 408), style(INK)))?;
        area.draw(&Text::new("phi2", (20, 50), style(INK)))?;
        Ok(())
    })
}

/// Points of an outline, and frames of a motion.
const OUTLINE: usize = 96;
const MOVED: usize = 120;

fn moved(survey: &PoseSurvey, (palms, phi0): (PalmPair, f64)) -> MovedPose {
    let [r1, r2] = palms.normals(phi0).map(|angle| survey.body.support(angle)[0]);
    let (both, sine) = (palms.phi1 + palms.phi2, palms.phi2.sin());
    MovedPose {
        phi0,
        centre: [
            (both.cos() * r1 + palms.phi1.cos() * r2) / sine,
            (both.sin() * r1 + palms.phi1.sin() * r2) / sine,
        ],
        palms: [palms.phi1, palms.phi2],
        contacts: measurements(&survey.body, palms, phi0),
    }
}

/// The body between its palms at some places of a run.
pub(super) fn frames(survey: &PoseSurvey, poses: &[(PalmPair, f64)], count: usize) -> Vec<String> {
    let (outline, mean) = (survey.body.outline(OUTLINE), survey.body.mean_radius());
    let places = rows(poses.len(), count).into_iter();
    places.map(|place| still_body(&outline, &moved(survey, poses[place]), mean)).collect()
}

/// The body and its palms along a run.
pub(super) fn motion(survey: &PoseSurvey, poses: &[(PalmPair, f64)]) -> String {
    let shown: Vec<MovedPose> =
        rows(poses.len(), MOVED).into_iter().map(|place| moved(survey, poses[place])).collect();
    moved_body(&survey.body.outline(OUTLINE), &shown)
}
