//! The body whose poses are looked at, as its user writes it down.

use crate::mechanics::moving::{BodyForm, CentreOfMass, FormError, Knots, Shape};

/// Why a text is no body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BodyTextError {
    /// No kind of that name.
    #[error(
        "'{0}' is no kind of body; write harmonics:MEAN[,P2,Q2,P3,Q3...], ellipse:A,B, spline:Q1,Q2,Q3 or centripetal:Q1,Q2,Q3"
    )]
    Kind(String),
    /// Not a number.
    #[error("'{0}' is not a number")]
    Number(String),
    /// Too few or too many.
    #[error("{kind} takes {wanted}, and {found} are given")]
    Count {
        /// The kind of body.
        kind: &'static str,
        /// How many numbers it takes.
        wanted: &'static str,
        /// How many there are.
        found: usize,
    },
    /// The numbers make no smooth convex body with its centre of mass inside.
    #[error(transparent)]
    Form(FormError),
}

/// A smooth, strictly convex body in the plane with its centre of mass.
#[derive(Clone, Debug)]
pub struct PoseBody {
    form: BodyForm,
    shape: Shape,
}

/// `1.5,-0.2` as numbers.
pub fn numbers(text: &str) -> Result<Vec<f64>, BodyTextError> {
    let number = |part: &str| {
        let part = part.trim();
        let value = part.parse::<f64>().ok().filter(|value| value.is_finite());
        value.ok_or_else(|| BodyTextError::Number(part.to_owned()))
    };
    text.split(',').map(number).collect()
}

impl PoseBody {
    /// A body by its outline and the place of its centre of mass; an error where the outline is no smooth convex body.
    pub fn new(form: BodyForm, centre: CentreOfMass) -> Result<PoseBody, FormError> {
        let shape = Shape::new(&form, centre)?.without_corners()?;
        Ok(PoseBody { form, shape })
    }

    /// From a text such as `spline:0.4,2.1,1.1` (three radii of section 3.4), `centripetal:...` (the same with centripetal knots), `ellipse:2,1`
    /// or `harmonics:1,0.1,0.02,0.03,0` (mean, then pairs from the second harmonic on), lengths in m. The mass is uniform unless its centre
    /// is given, in the frame of the form.
    ///
    /// # Errors
    /// What is wrong with the text.
    pub fn parse(text: &str, centre: Option<[f64; 2]>) -> Result<PoseBody, BodyTextError> {
        let (kind, rest) = text.split_once(':').ok_or_else(|| BodyTextError::Kind(text.to_owned()))?;
        let values = numbers(rest)?;
        let three = |kind: &'static str| {
            let wanted = "three radii";
            values.clone().try_into().map_err(|_| BodyTextError::Count { kind, wanted, found: values.len() })
        };
        let form = match kind {
            "spline" => BodyForm::Spline { radii: three("spline")?, knots: Knots::Uniform },
            "centripetal" => BodyForm::Spline { radii: three("centripetal")?, knots: Knots::Centripetal },
            "ellipse" => {
                let count = |_| BodyTextError::Count {
                    kind: "ellipse",
                    wanted: "two semi-axes",
                    found: values.len(),
                };
                BodyForm::Ellipse { semi_axes: values.clone().try_into().map_err(count)? }
            }
            "harmonics" if values.len() % 2 == 1 => {
                let pairs = values[1..].chunks_exact(2).map(|pair| [pair[0], pair[1]]);
                BodyForm::Harmonics {
                    mean: values[0],
                    harmonics: std::iter::once([0.0; 2]).chain(pairs).collect(),
                }
            }
            "harmonics" => {
                let wanted = "a mean and pairs";
                return Err(BodyTextError::Count { kind: "harmonics", wanted, found: values.len() });
            }
            _ => return Err(BodyTextError::Kind(kind.to_owned())),
        };
        PoseBody::new(form, centre.map_or(CentreOfMass::Uniform, CentreOfMass::At))
            .map_err(BodyTextError::Form)
    }

    /// `[r, r', r'']` about the centre of mass at the normal with this angle in the body's frame, in m.
    pub fn support(&self, angle: f64) -> [f64; 3] {
        self.shape.support(angle)
    }

    /// Points of the outline about the centre of mass, counterclockwise, in m.
    pub fn outline(&self, count: usize) -> Vec<[f64; 2]> {
        self.shape.outline(count)
    }

    /// The perimeter over a whole turn: the mean of the support function, in m.
    pub fn mean_radius(&self) -> f64 {
        self.shape.perimeter() / std::f64::consts::TAU
    }

    /// The centre of mass in the frame in which the form is given, in m.
    pub fn centre(&self) -> [f64; 2] {
        self.shape.centre_of_mass()
    }

    pub(super) fn form(&self) -> &BodyForm {
        &self.form
    }

    /// The body as a text, for kinds that [`PoseBody::parse`] knows one that it accepts; the centre of mass is not in it.
    pub fn text(&self) -> String {
        let list = |values: &[f64]| values.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
        match &self.form {
            BodyForm::Harmonics { mean, harmonics } => {
                let rest = harmonics.iter().skip(1).flatten().copied();
                format!("harmonics:{}", list(&std::iter::once(*mean).chain(rest).collect::<Vec<_>>()))
            }
            BodyForm::Ellipse { semi_axes } => format!("ellipse:{}", list(semi_axes)),
            BodyForm::Superellipse { semi_axes, exponent, rounding } => {
                format!(
                    "superellipse of a scene: {}, exponent {exponent}, rounding {rounding}",
                    list(semi_axes)
                )
            }
            BodyForm::Arcs { corners, radius } => {
                let corners: Vec<f64> = corners.iter().flatten().copied().collect();
                format!("arcs of a scene: {}, radius {radius}", list(&corners))
            }
            BodyForm::Spline { radii, knots: Knots::Uniform } => format!("spline:{}", list(radii)),
            BodyForm::Spline { radii, knots: Knots::Centripetal } => format!("centripetal:{}", list(radii)),
            BodyForm::Spline { radii, knots: Knots::Chord } => {
                format!("chord spline of a scene: {}", list(radii))
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Two and three harmonics, of one material.
    pub fn egg() -> PoseBody {
        PoseBody::parse("harmonics:1,0.12,0.03,0.05,-0.02", None).unwrap()
    }

    /// A spline of section 3.4 whose mass is not uniform.
    pub fn off_centre() -> PoseBody {
        PoseBody::parse("spline:1.2,1.7,1.3", Some([0.1, -0.15])).unwrap()
    }

    #[test]
    fn a_text_that_is_no_body_is_told_why() {
        for (text, why) in [
            ("cube:1", "no kind"),
            ("spline", "no kind"),
            ("spline:1,2", "three radii, and 2"),
            ("ellipse:1,x", "'x' is not a number"),
            ("ellipse:1,inf", "'inf' is not a number"),
            ("harmonics:1,0.1", "a mean and pairs, and 2"),
            ("harmonics:1,0.5,0", "not strictly convex"),
            ("spline:0,1,1", "has to be positive"),
        ] {
            let error = PoseBody::parse(text, None).unwrap_err().to_string();
            assert!(error.contains(why), "{text}: {error}");
        }
        let outside = PoseBody::parse("ellipse:1,1", Some([1.5, 0.0])).unwrap_err().to_string();
        assert!(outside.contains("not inside"), "{outside}");
        for text in
            ["spline:0.4,2.1,1.1", "harmonics:1,0.1,0.02,0.03,0", "ellipse:2,1", "centripetal:1,1.5,2"]
        {
            assert_eq!(PoseBody::parse(text, None).unwrap().text(), text);
        }
    }
}
