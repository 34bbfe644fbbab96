//! Which of several known bodies was measured: the one that explains all measurements of the contacts, by chi-square.
//!
//! Of each body of a library the angle and the rate at the first sample are estimated; all else follows. A body *fits* where its residual passes the chi-square test that every estimate has to pass. One that fits is
//! recognised where no other explains the measurements nearly as well: with as many unknowns each, a body is a thousand times less likely than the best where its chi-square is larger by `2 ln 1000`.

use palmistry_bodies::shape::Measured;
use palmistry_observe::Fit;

/// A body that fits is distinguished from another one that fits where it is so many times as likely.
const LIKELIER: f64 = 1000.0;

/// The result for a library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RecognitionVerdict {
    /// One body fits, and no other nearly as well: its place in the library.
    Recognised(usize),
    /// Several explain the measurements, the best first.
    Alike(Vec<usize>),
    /// None explains them.
    NoneOfThem,
}

/// The estimate for one body.
#[derive(Clone, Debug)]
pub struct LibraryAnswer {
    /// `name`.
    pub name: String,
    /// Its angle at the first sample, in rad, from 0 to a whole turn, in the frame of its shape.
    pub orientation: Measured,
    /// Its rate there, in rad/s.
    pub rate: Measured,
    /// The root mean square residual of a contact, in m.
    pub rms_residual: f64,
    /// The test of fit: none where no motion of it could be followed.
    pub fit: Option<Fit>,
}

impl LibraryAnswer {
    /// Whether it explains the measurements.
    pub fn fits(&self) -> bool {
        self.fit.is_some_and(|fit| fit.fits)
    }
}

/// The estimates for a library of bodies.
#[derive(Clone, Debug)]
pub struct Recognition {
    /// Each body, in the order of the scene.
    pub bodies: Vec<LibraryAnswer>,
    /// Which of them it is.
    pub verdict: RecognitionVerdict,
}

impl Recognition {
    /// From the estimates for each body.
    pub(super) fn of(bodies: Vec<LibraryAnswer>) -> Recognition {
        let square = |place: usize| bodies[place].fit.map_or(f64::INFINITY, |fit| fit.chi_square);
        let mut fitting: Vec<usize> = (0..bodies.len()).filter(|place| bodies[*place].fits()).collect();
        fitting.sort_by(|a, b| square(*a).total_cmp(&square(*b)));
        let verdict = match fitting.first().copied() {
            None => RecognitionVerdict::NoneOfThem,
            Some(best) => {
                fitting.retain(|place| square(*place) - square(best) <= 2.0 * LIKELIER.ln());
                if fitting.len() == 1 {
                    RecognitionVerdict::Recognised(best)
                } else {
                    RecognitionVerdict::Alike(fitting)
                }
            }
        };
        Recognition { bodies, verdict }
    }

    /// The names of the bodies that may be it, the best first.
    pub fn names(&self) -> Vec<&str> {
        let places = match &self.verdict {
            RecognitionVerdict::Recognised(place) => std::slice::from_ref(place),
            RecognitionVerdict::Alike(places) => places,
            RecognitionVerdict::NoneOfThem => &[],
        };
        places.iter().map(|place| self.bodies[*place].name.as_str()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use palmistry_observe::NoiseFrom;

    fn answer(name: &str, chi_square: f64, fits: bool) -> LibraryAnswer {
        let measured = Measured { value: 0.0, deviation: 0.0 };
        let fit = Fit {
            chi_square,
            degrees: 100,
            probability: 0.5,
            outliers: 0,
            measurements: 100,
            squares: None,
            neighbours: None,
            drift: None,
            sigma: 1.0,
            from: NoiseFrom::Stated,
            fits,
        };
        LibraryAnswer {
            name: name.to_owned(),
            orientation: measured,
            rate: measured,
            rms_residual: 0.0,
            fit: Some(fit),
        }
    }

    /// By hand: 2 ln 1000 is 13.8.
    #[test]
    fn what_is_said_of_bodies_that_fit() {
        let said = |all: &[(&str, f64, bool)]| {
            let all = all.iter().map(|(name, square, fits)| answer(name, *square, *fits)).collect();
            let found = Recognition::of(all);
            (found.verdict.clone(), found.names().join(" "))
        };
        let (first, second) = (RecognitionVerdict::Recognised(0), RecognitionVerdict::Recognised(1));
        assert_eq!(said(&[("a", 100.0, true), ("b", 113.9, true)]), (first.clone(), "a".to_owned()));
        assert_eq!(said(&[("a", 90.0, false), ("b", 113.7, true)]), (second, "b".to_owned()));
        let alike = RecognitionVerdict::Alike(vec![1, 0]);
        assert_eq!(said(&[("a", 113.7, true), ("b", 100.0, true)]), (alike, "b a".to_owned()));
        assert_eq!(said(&[("a", 200.0, false)]), (RecognitionVerdict::NoneOfThem, String::new()));
        let unfollowed = LibraryAnswer { fit: None, ..answer("c", 0.0, true) };
        let found = Recognition::of(vec![answer("a", 100.0, true), unfollowed]);
        assert_eq!(found.verdict, first);
    }
}
