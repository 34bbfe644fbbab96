//! The robot and its ground.

use super::super::robot::{SceneGround, SceneRobot, SimulatedRobot};
use super::{Checks, Problem};

/// Waves of the ground at most.
const MOST_WAVES: usize = 64;

/// The steepest slope that all waves together may have: steeper, and wheels meet the ground more than once.
const STEEPEST: f64 = 1.0;

impl Checks<'_> {
    /// A robot on its ground: both have to be there, and nothing else beside them.
    pub(super) fn robot(
        &self,
        span: Option<(f64, usize)>,
        robot: Option<SceneRobot>,
        ground: Option<SceneGround>,
    ) -> Result<Option<SimulatedRobot>, Problem> {
        let (robot, ground, (duration, samples)) = match (robot, ground, span) {
            (None, None, _) => return Ok(None),
            (None, Some(_), _) => {
                let help = "add [robot] with wheels, mass, radius_of_gyration and speed; or leave it out";
                return Err(self.wrong_key("ground", "'ground' is given without [robot]", help));
            }
            (Some(_), None, _) | (Some(_), _, None) => {
                let help = "add [ground], for instance with waves = [{ amplitude = 0.1, wavelength = 4 }]";
                return Err(self.wrong_key("robot", "'robot' is given without [ground]", help));
            }
            (Some(robot), Some(ground), Some(span)) => (robot, ground, span),
        };
        for (index, wheel) in robot.wheels.iter().enumerate() {
            self.all_finite(&format!("robot.wheels[{index}]"), wheel)?;
        }
        if robot.wheels[0][0] == robot.wheels[1][0] {
            let help = "let their first coordinates differ: one wheel goes ahead of the other";
            return Err(self.wrong("robot.wheels", "both wheels are above each other", help));
        }
        self.positive("robot.mass", robot.mass, "kg")?;
        self.positive("robot.radius_of_gyration", robot.radius_of_gyration, "m")?;
        self.finite("robot.speed", robot.speed)?;
        if robot.speed == 0.0 {
            let help = "give it in m/s: a wheel that stands still measures nothing of the ground under it";
            return Err(self.wrong("robot.speed", "wheel 1 stands", help));
        }
        self.finite("robot.start", robot.start)?;
        self.finite("robot.gravity", robot.gravity)?;
        if ground.waves.len() > MOST_WAVES {
            let message = format!("{} waves are too many", ground.waves.len());
            return Err(self.wrong("ground.waves", message, format!("give at most {MOST_WAVES}")));
        }
        let (mut steepest, step) = (0.0, duration / samples.saturating_sub(1).max(1) as f64);
        for (index, wave) in ground.waves.iter().enumerate() {
            let place = format!("ground.waves[{index}]");
            self.finite(&format!("{place}.amplitude"), wave.amplitude)?;
            self.positive(&format!("{place}.wavelength"), wave.wavelength, "m")?;
            self.finite(&format!("{place}.phase"), wave.phase)?;
            if robot.speed.abs() * step > wave.wavelength {
                let message = format!(
                    "from one sample to the next wheel 1 goes {:.3e} m, more than this wave",
                    robot.speed.abs() * step
                );
                return Err(self.wrong(
                    &format!("{place}.wavelength"),
                    message,
                    "take more samples, or leave the wave out",
                ));
            }
            steepest += std::f64::consts::TAU * (wave.amplitude / wave.wavelength).abs();
        }
        if steepest > STEEPEST {
            let message = format!("the slopes of the waves add up to {steepest:.2}");
            let help = "let 2 pi amplitude/wavelength of all waves be 1 at most: on steeper ground a wheel may touch twice";
            return Err(self.wrong("ground.waves", message, help));
        }
        Ok(Some(SimulatedRobot { duration, samples, robot, ground }))
    }
}
