//! The fields and some functions of a system as programs over points: what anybody needs who differentiates by values
//! alone, be it by dual numbers or by differences.

use palmistry_lang::{Role, System};
use palmistry_math::expression::{Input, Loaded, NodeId, Program, Symbol};
use palmistry_math::number::{Arithmetic, Refusal};

/// A program whose inputs are places of a point.
#[derive(Clone, Debug)]
struct Function {
    program: Program,
    places: Vec<usize>,
}

/// Fields and functions over points: one number for each symbol, angles in radians.
#[derive(Clone, Debug)]
pub struct PointPrograms {
    symbols: Vec<Symbol>,
    states: Vec<usize>,
    /// The places that each field of the system moves, and its rates; of fields that are only differentiated along none.
    fields: Vec<(Vec<usize>, Function)>,
    functions: Vec<Function>,
}

impl PointPrograms {
    /// The drift and the inputs of a system, and these functions.
    pub fn new(system: &System, functions: &[NodeId]) -> PointPrograms {
        let components = |field: usize| {
            let field = &system.fields[field];
            if field.role == Role::Other { [].iter() } else { field.components.iter() }
        };
        let mut symbols = system.graph.symbols_of(functions.iter().copied());
        for field in 0..system.fields.len() {
            symbols.extend(system.graph.symbols_of(components(field).map(|(_, node)| *node)));
            symbols.extend(components(field).map(|(symbol, _)| *symbol));
        }
        symbols.extend(&system.states);
        symbols.sort_unstable();
        symbols.dedup();
        let place = |symbol: &Symbol| symbols.partition_point(|other| other < symbol);
        let function = |nodes: &[NodeId]| {
            let program = Program::plain(&system.graph, nodes);
            let symbol = |input: &Input| input.symbol().map(|symbol| place(&symbol));
            let places = program.inputs().iter().filter_map(symbol).collect();
            Function { program, places }
        };
        let field = |field: usize| {
            let moved = components(field).map(|(symbol, _)| place(symbol)).collect();
            (moved, function(&components(field).map(|(_, node)| *node).collect::<Vec<_>>()))
        };
        PointPrograms {
            states: system.unknowns().iter().map(place).collect(),
            fields: (0..system.fields.len()).map(field).collect(),
            functions: functions.iter().map(|node| function(&[*node])).collect(),
            symbols,
        }
    }

    /// The symbols whose values make up a point, in this order.
    pub fn symbols(&self) -> &[Symbol] {
        &self.symbols
    }

    /// The places of the unknown states in a point, in their order: the variables of differentiation.
    pub fn states(&self) -> &[usize] {
        &self.states
    }

    /// With constants in the numbers of an arithmetic.
    ///
    /// # Errors
    /// Where a constant has no image.
    pub fn load<A: Arithmetic + Clone>(&self, arithmetic: A) -> Result<LoadedPoints<'_, A>, Refusal> {
        let fields = self.fields.iter().map(|(_, field)| field.load(&arithmetic));
        let functions = self.functions.iter().map(|function| function.load(&arithmetic));
        Ok(LoadedPoints {
            fields: fields.collect::<Result<_, _>>()?,
            functions: functions.collect::<Result<_, _>>()?,
            source: self,
        })
    }
}

impl Function {
    fn load<A: Arithmetic + Clone>(&self, arithmetic: &A) -> Result<Loaded<'_, A>, Refusal> {
        self.program.load(arithmetic.clone())
    }
}

/// [`PointPrograms`] over one arithmetic.
pub struct LoadedPoints<'p, A: Arithmetic> {
    source: &'p PointPrograms,
    fields: Vec<Loaded<'p, A>>,
    functions: Vec<Loaded<'p, A>>,
}

impl<A: Arithmetic> LoadedPoints<'_, A> {
    /// The places of the states in a point.
    pub fn states(&self) -> &[usize] {
        &self.source.states
    }

    /// The value of a function at a point.
    ///
    /// # Errors
    /// Where an operation is refused, here and below.
    pub fn function(&self, function: usize, point: &[A::Number]) -> Result<A::Number, Refusal> {
        let values = run(&self.functions[function], &self.source.functions[function].places, point)?;
        values.into_iter().next().ok_or(Refusal::NotFinite)
    }

    /// The places that a field moves, and its rates at a point.
    pub fn rates(&self, field: usize, point: &[A::Number]) -> Result<(&[usize], Vec<A::Number>), Refusal> {
        let (moved, function) = &self.source.fields[field];
        Ok((moved, run(&self.fields[field], &function.places, point)?))
    }
}

fn run<A: Arithmetic>(
    loaded: &Loaded<'_, A>,
    places: &[usize],
    point: &[A::Number],
) -> Result<Vec<A::Number>, Refusal> {
    let inputs: Vec<A::Number> = places.iter().map(|place| point[*place].clone()).collect();
    loaded.run(&inputs, &mut Vec::new()).map_err(|failure| failure.refusal)
}
