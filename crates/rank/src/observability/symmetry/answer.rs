//! What was found of the unobservable directions and of the observable functions.

use palmistry_lang::Assignment;
use palmistry_math::expression::{NodeId, Symbol};
use std::ops::Range;

/// A component of a vector field that is not zero.
#[derive(Clone, Debug)]
pub struct FieldComponent {
    /// The state that it moves.
    pub state: Symbol,
    /// The state's name.
    pub name: String,
    /// How it moves it.
    pub rate: NodeId,
    /// The same in the notation of the language.
    pub text: String,
}

/// A vector field along which no output changes, proved.
#[derive(Clone, Debug)]
pub struct UnobservableField {
    /// Its components that are not zero, in the order of the states.
    pub components: Vec<FieldComponent>,
    /// The proof errs with a probability below `2^log2_error`.
    pub log2_error: f64,
}

/// A function of several unknowns whose differential lies in the codistribution, proved.
#[derive(Clone, Debug)]
pub struct ObservableFunction {
    /// The function.
    pub value: NodeId,
    /// The same in the notation of the language.
    pub text: String,
    /// The proof errs with a probability below `2^log2_error`.
    pub log2_error: f64,
    /// It is the product of these powers.
    pub(super) factors: Vec<(NodeId, i32)>,
}

/// States that no unobservable direction couples with others.
#[derive(Clone, Debug)]
pub(super) struct UnseenBlock {
    pub states: Vec<Symbol>,
    /// How many unobservable directions there are among them.
    pub unobservable: usize,
    /// The functions of these states, among all functions.
    pub functions: Range<usize>,
}

/// What is observable and what is not, at almost all states.
#[derive(Clone, Debug, Default)]
pub struct UnobservableDirections {
    /// Independent fields, at almost all states.
    pub fields: Vec<UnobservableField>,
    /// How many further unobservable directions there are, of which no field was found.
    pub fields_missing: usize,
    /// The observable states, in their order.
    pub observable: Vec<Symbol>,
    /// Their names.
    pub observable_names: Vec<String>,
    /// Observable functions of the other states, independent of one another.
    pub functions: Vec<ObservableFunction>,
    /// How many further such functions there are.
    pub functions_missing: usize,
    /// Whether polynomials of a low degree were left untried, because they have too many coefficients.
    pub cut_off: bool,
    /// Whether the fields are unobservable directions for all values of the parameters that the file gives a value to, and the functions observable for
    /// almost all; otherwise at these values.
    pub for_all_parameters: bool,
    /// Whether the fields show that the rank is no greater, whatever further Lie derivatives are taken.
    pub settles_the_rank: bool,
    /// The values of parameters with which it was found.
    pub(super) values: Assignment,
    pub(super) blocks: Vec<UnseenBlock>,
}

impl UnobservableDirections {
    /// How many directions are unobservable at almost all states: the dimension less the rank.
    pub fn directions(&self) -> usize {
        self.fields.len() + self.fields_missing
    }
}
