//! The modes of two contacts, by name.

use std::fmt;

/// What one contact does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactMode {
    /// The body's point at the contact moves with the palm.
    Sticks,
    /// It slides along the palm's tangent as the thesis turns it: away from the origin on palm 1, towards it on palm 2.
    Along,
    /// It slides the other way.
    Against,
}

impl ContactMode {
    /// The sense in which the body slides, 1 or -1; zero where it sticks.
    pub fn sense(self) -> f64 {
        match self {
            ContactMode::Sticks => 0.0,
            ContactMode::Along => 1.0,
            ContactMode::Against => -1.0,
        }
    }
}

/// What both contacts do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModePair(pub [ContactMode; 2]);

impl fmt::Display for ModePair {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use ContactMode::Sticks;
        let slides = |palm: usize| if self.0[palm] == ContactMode::Along { "along" } else { "against" };
        match self.0 {
            [Sticks, Sticks] => write!(f, "stuck"),
            [Sticks, _] => write!(f, "rolls on palm 1, slides {} the tangent of palm 2", slides(1)),
            [_, Sticks] => write!(f, "slides {} the tangent of palm 1, rolls on palm 2", slides(0)),
            [_, _] => write!(f, "slides {} the tangent of palm 1, {} that of palm 2", slides(0), slides(1)),
        }
    }
}
