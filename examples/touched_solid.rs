//! What three palms tell of the volume of a body in space: the scene of figure 5.3 of M. Moll's thesis, an ellipsoid, held four times. With
//! `cargo run --release --example touched_solid -- FOLDER` it prints the volumes, and writes a page with a picture that can be turned, and both surfaces as OBJ and PLY.
//!
//! ```text
//! contacts: 540
//! volume of the body: 20.9440 m^3
//! their hull: 12.0512 m^3
//! with no radius of curvature below 0.4 m: 15.6401 m^3
//! half-spaces: 29.4226 m^3
//! balls of radius 20 m: 27.7382 m^3
//! balls of radius 6.25 m: 24.3529 m^3
//! ```

use nalgebra::Vector3;
use palmistry::mechanics::moving::Course;
use palmistry::mechanics::spatial::{
    ConvexSolid, Orientation, SolidForm, SpatialDrive, SpatialPalm, SpatialScene, balanced_orientation,
    simulate_solid,
};
use palmistry::report::{ShownSurface, solid_page};
use palmistry::shape::sphere::{
    OuterBound, SurfaceTouch, ball_intersection, contact_hull, half_space_intersection, rounded_hull,
};
use std::f64::consts::{PI, TAU};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let solid = ConvexSolid::new(SolidForm::Ellipsoid { semi_axes: [2.5, 2.0, 1.0] }, None)?;
    let resting = |angle: f64| Course { start: angle, ..Course::default() };
    let palm = |azimuth: f64| SpatialPalm { azimuth, inertia: 0.5, ..Default::default() };
    // near which poses it is laid, and at what rates it then turns
    let runs = [
        ([0.2, -0.3, 0.4], [0.0, 0.3, 0.3]),
        ([1.2, 0.4, -0.6], [0.3, -0.2, 0.4]),
        ([-0.4, 1.3, 0.8], [-0.3, 0.3, -0.2]),
        ([0.3, -0.8, 2.6], [0.2, 0.4, 0.5]),
    ];
    let times: Vec<f64> = (0..=44).map(|i| f64::from(i) * 0.04).collect();
    let mut touches = Vec::new();
    for (turn, rate) in runs {
        let mut scene = SpatialScene {
            mass: 1.0,
            inertia_over_mass: solid.uniform_inertia(),
            solid: solid.clone(),
            orientation: Orientation::by(&Vector3::from(turn)),
            rate,
            gravity: [0.0, 0.0, -9.81],
            palms: [0.0, TAU / 3.0, 2.0 * TAU / 3.0].map(palm),
            drive: SpatialDrive::Prescribed([PI / 3.0; 3].map(resting)),
            tolerance: 1e-12,
        };
        scene.orientation = balanced_orientation(&scene)?.ok_or("no pose of balance")?;
        let motion = simulate_solid(&scene, &times)?;
        let palms = motion.moments.iter().flat_map(|moment| moment.palms);
        touches
            .extend(palms.map(|palm| SurfaceTouch { point: palm.touched, normal: palm.outward.normalize() }));
    }
    let inner = contact_hull(&touches)?;
    let round = rounded_hull(&touches, 0.4)?;
    let mut rows = vec![
        ("contacts".to_owned(), touches.len().to_string()),
        ("volume of the body".to_owned(), format!("{:.4} m^3", solid.volume())),
        ("their hull".to_owned(), format!("{:.4} m^3", inner.volume.low())),
        ("with no radius of curvature below 0.4 m".to_owned(), format!("{:.4} m^3", round.volume.low())),
    ];
    let mut surfaces =
        vec![ShownSurface { name: "hull of the contacts", colour: "#1f77b4", surface: &inner.surface }];
    let outer = half_space_intersection(&touches)?;
    match &outer {
        OuterBound::Bounded(region) => {
            rows.push(("half-spaces".to_owned(), format!("{:.4} m^3", region.volume.high())));
            surfaces.push(ShownSurface { name: "half-spaces", colour: "#ff7f0e", surface: &region.surface });
        }
        OuterBound::Unbounded { direction } => {
            let [x, y, z]: [f64; 3] = (*direction).into();
            rows.push(("half-spaces".to_owned(), format!("unbounded along ({x:.4}, {y:.4}, {z:.4})")));
        }
    }
    for radius in [20.0, 6.25] {
        let balls = ball_intersection(&touches, radius)?;
        rows.push((format!("balls of radius {radius} m"), format!("{:.4} m^3", balls.volume.high())));
    }
    for (what, value) in &rows {
        println!("{what}: {value}");
    }
    if let Some(folder) = std::env::args_os().nth(1) {
        let folder = std::path::PathBuf::from(folder);
        std::fs::create_dir_all(&folder)?;
        for (name, shown) in ["hull", "half-spaces"].iter().zip(&surfaces) {
            std::fs::write(folder.join(name).with_extension("obj"), shown.surface.obj())?;
            std::fs::write(folder.join(name).with_extension("ply"), shown.surface.ply())?;
        }
        std::fs::write(folder.join("index.html"), solid_page("A body that was touched", &rows, &surfaces))?;
    }
    Ok(())
}
