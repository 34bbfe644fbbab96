//! Scenes as they are drawn for the table of arrivals, and for its test.
//!
//! A body between half a metre and two metres in size whose support function has three harmonics (up to a tenth, a twenty-fifth and a fiftieth of its mean),
//! a mass of 0.5 to 2 kg, any orientation, a rate of up to 3 rad/s either way. Palm 1 stands at 0.2 to 1.2 rad, palm 2 at 1 to 2.2 rad from it. The four regimes
//! come in turn: both palms at one rate, palm 2 alone, both fixed (rates of up to 1 rad/s), both swinging. Circular palms are hollow or bulging, with
//! radii of 2 to 8 of the body's size. 81 samples over 0.28 s, which is a window of the thesis; with noise over 0.84 s, since in a third of that
//! the contacts move too little for nearly all scenes to tell anything to one percent. Scenes that are not held by both palms all that time
//! are drawn anew.

use std::f64::consts::TAU;

/// Marsaglia's generator: the same scenes everywhere.
pub struct Draws(u64);

impl Draws {
    pub fn new(seed: u64) -> Draws {
        Draws(0x9e37_79b9_7f4a_7c15 ^ seed.wrapping_mul(0xbf58_476d_1ce4_e5b9))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        for _ in 0..3 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
        }
        low + (high - low) * (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn swing(&mut self) -> String {
        let (amplitude, frequency, phase) =
            (self.between(0.0, 0.2), self.between(0.2, 1.0), self.between(0.0, TAU));
        format!("swings = [{{ amplitude = {amplitude:?}, frequency = {frequency:?}, phase = {phase:?} }}]")
    }
}

/// The text of a scene of a regime, 0 to 3, between flat or circular palms.
pub fn drawn(draws: &mut Draws, regime: usize, noise: f64, is_circular: bool) -> String {
    let model = if is_circular { "constraint/circular_palms" } else { "general" };
    let size = draws.between(0.5, 2.0);
    let mut harmonic = |most: f64| [0, 1].map(|_| size * draws.between(-most, most));
    let harmonics = [[0.0; 2], harmonic(0.1), harmonic(0.04), harmonic(0.02)];
    let (mass, orientation, rate) =
        (draws.between(0.5, 2.0), draws.between(0.0, TAU), draws.between(-3.0, 3.0));
    let inertia = [draws.between(0.2, 1.0), draws.between(0.2, 1.0)];
    let (first, second) = (draws.between(0.2, 1.2), draws.between(1.0, 2.2));
    let rates = [draws.between(-1.0, 1.0), draws.between(-1.0, 1.0)];
    let moving = match regime {
        0 => [format!("rate = {:?}", rates[0]), "rate = 0.0".to_owned()],
        1 => ["rate = 0.0".to_owned(), format!("rate = {:?}", rates[1])],
        2 => ["rate = 0.0".to_owned(), "rate = 0.0".to_owned()],
        _ => [0, 1].map(|palm| format!("rate = {:?}, {}", rates[palm], draws.swing())),
    };
    let radii = match is_circular {
        false => String::new(),
        true => {
            let mut radius = || {
                let side = if draws.between(-1.0, 1.0) > 0.0 { 1.0 } else { -1.0 };
                side * size * draws.between(2.0, 8.0)
            };
            format!("radii = [{:?}, {:?}]\n", radius(), radius())
        }
    };
    let sensor = match noise {
        0.0 => String::new(),
        noise => format!("[sensor]\nnoise = {:?}\n", noise * size),
    };
    let duration = if noise == 0.0 { 0.28 } else { 0.84 };
    format!(
        "title = \"A drawn scene\"\nmodel = \"proofs/moll2002/{model}.proof\"\nduration = {duration}\nsamples = 81\n\
         [body]\nshape = {{ kind = \"harmonics\", mean = {size:?}, harmonics = {harmonics:?} }}\n\
         mass = {mass:?}\norientation = {orientation:?}\nrate = {rate:?}\n\
         [palms]\n{radii}inertia = {inertia:?}\nprescribed = [{{ start = {first:?}, {} }}, {{ start = {second:?}, {} }}]\n\
         {sensor}[observer]\nmethods = [\"trust-region\"]\ninputs = {{ g1 = \"tau1\", g2 = \"tau2\" }}\n\
         estimate = [\"r1\", \"r2\", \"omega0\", \"rho\"]\nguess_off = 0.0\nwindow = 80\nsteps = 50\n",
        moving[0], moving[1]
    )
}
