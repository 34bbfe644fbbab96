//! From a file to a system.

use super::components::is_component;
use super::declare::in_words;
use super::dimension::{self, Declared};
use super::elaborate::Wanted;
use super::error::{Problem, ReadError};
use super::grammar::{ClaimSyntax, Entries, Item, OutputSyntax, Statement, parse_entries};
use super::imports::Reading;
use super::model::{Field, FieldPlace, Kind, Range, Role, System, Time, Value};
use super::problems::{Cause, Full, Problems, Remnant, names_of_text};
use super::signals::{Derivatives, Knowledge};
use super::source_text::{load, refuse_reordering, with_plain_line_ends};
use super::unknowns::UnknownKind;
use super::written::{Scope, Written, in_one_line, places_in};
use crate::expression::syntax::{Expr, ExprKind, Name, Relation, Span};
use crate::expression::{Derivation, Graph, Guard, NodeId, Symbol, parse_expression};
use crate::file;
use miette::NamedSource;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

impl std::str::FromStr for System {
    type Err = ReadError;

    /// A system from a text alone: what it imports is looked for where the program runs.
    fn from_str(text: &str) -> Result<System, ReadError> {
        System::parse("the text", text, Path::new(""))
    }
}

impl System {
    /// Reads a proof file.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn read(path: &Path) -> Result<System, ReadError> {
        System::examine(path, 1).into_result()
    }

    /// Reads a system from a text; imports are looked for in `folder`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn parse(name: &str, text: &str, folder: &Path) -> Result<System, ReadError> {
        System::examine_text(name, text, folder, 1).into_result()
    }

    /// Reads a proof file and says all that is wrong with it, up to so many problems.
    pub fn examine(path: &Path, most: usize) -> Examination {
        let name = path.display().to_string();
        match load(path) {
            Ok(text) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let mut found = System::examine_text(&name, &text, folder, most);
                found.files.insert(path.to_owned());
                found
            }
            Err(message) => Examination {
                system: None,
                problems: vec![Problem::new(&(0..0), message, "").locate(&name, "")],
                more: false,
                files: BTreeSet::from([path.to_owned()]),
            },
        }
    }

    /// The same of a text; imports are looked for in `folder`.
    pub fn examine_text(name: &str, text: &str, folder: &Path, most: usize) -> Examination {
        let mut found = System::examine_draft(name, text, folder, most);
        found.system = found.system.filter(|_| found.problems.is_empty());
        found
    }

    /// The same of a text on which somebody is at work: the system is what could be understood, also where something is
    /// wrong. Nothing is decided of such a one.
    pub(crate) fn examine_draft(name: &str, text: &str, folder: &Path, most: usize) -> Examination {
        let text = with_plain_line_ends(text);
        let mut reading = Reading::default();
        reading.open.extend(file::identity(Path::new(name)));
        let mut problems = Problems::up_to(most);
        let built = System::build(name, &text, folder, Graph::default(), &mut reading, &mut problems);
        // what an imported file refers to is looked for where that file itself is read
        let system = built
            .ok()
            .filter(|system| system.check_references(folder, &mut problems, &mut reading.files).is_ok());
        let more = problems.more;
        let found = problems.into_found();
        let source = Arc::new(NamedSource::new(name, text));
        let mut problems: Vec<ReadError> =
            found.into_iter().map(|problem| problem.locate_in(&source)).collect();
        problems.sort_by_key(|problem| problem.span.offset());
        Examination { system, problems, more, files: reading.files }
    }

    /// The value of an expression that is not in the file but asked of it from outside.
    ///
    /// # Errors
    /// What is wrong with the expression, and where in it.
    pub fn evaluate_text(&mut self, text: &str) -> Result<Value, ReadError> {
        self.evaluate_text_guarded(text).map(|(value, _)| value)
    }

    /// The same, and where it exists: the value was simplified, and may have values where the text has none.
    ///
    /// # Errors
    /// What is wrong with the expression, and where in it.
    pub fn evaluate_text_guarded(&mut self, text: &str) -> Result<(Value, Vec<Guard>), ReadError> {
        let text = &with_plain_line_ends(text);
        let expr = parse_expression(text).map_err(|e| expected(e).locate("expression", text))?;
        self.elaborate_guarded(&expr).map_err(|problem| problem.locate("expression", text))
    }

    /// Reads a text into a graph; where the reading ends before the text does, that is given back.
    pub(super) fn build(
        name: &str,
        text: &str,
        folder: &Path,
        graph: Graph,
        reading: &mut Reading,
        problems: &mut Problems,
    ) -> Result<System, Box<Graph>> {
        let mut system = System {
            title: String::new(),
            cite: None,
            name: name.to_owned(),
            source: text.to_owned(),
            graph,
            states: Vec::new(),
            known: BTreeSet::new(),
            fields: Vec::new(),
            outputs: Vec::new(),
            output_guards: Vec::new(),
            avoid: Vec::new(),
            claims: Vec::new(),
            sets: Vec::new(),
            maps: Vec::new(),
            lines: Vec::new(),
            reductions: Vec::new(),
            symbols: BTreeMap::new(),
            coordinates: Default::default(),
            definitions: BTreeMap::new(),
            definition_domains: HashMap::new(),
            domain: Default::default(),
            written: BTreeMap::new(),
            imported_fields: Vec::new(),
            field_places: HashMap::new(),
            partials: HashMap::new(),
            states_are_final: false,
            aliases: Vec::new(),
            sampled: HashSet::new(),
            calculated: HashSet::new(),
            dimensions: Default::default(),
            imported_dimensions: Vec::new(),
            vectors: BTreeSet::new(),
            time: Time::Continuous,
        };
        match system.fill(folder, reading, problems) {
            Ok(()) => Ok(system),
            Err(Full) => Err(Box::new(system.graph)),
        }
    }

    /// Enters all that stands in the text.
    fn fill(&mut self, folder: &Path, reading: &mut Reading, problems: &mut Problems) -> Result<(), Full> {
        let text = self.source.clone();
        if let Err(problem) = refuse_reordering(&text) {
            problems.add(problem)?;
        }
        let Entries { items, damage, indices, .. } = parse_entries(&text, problems.room());
        for part in damage {
            problems.add(expected(part.expected))?;
            if let Some((word, names)) = names_of_text(&text[part.left_out]) {
                problems.break_names(word, names);
            }
        }
        let derivatives = self.look_ahead(&items);
        let mut ids = HashSet::new();
        for item in &items {
            if let Item::Claim(claim) = item
                && !ids.insert(claim.id.clone())
            {
                let message = format!("there is a claim '{}' already", claim.id);
                problems.add(Problem::new(&claim.span, message, "the second one"))?;
            }
            let remnant = Remnant::of(item, problems);
            if let Err(problem) = self.enter(item, folder, reading, &derivatives) {
                self.entry_failed(problem, remnant, problems)?;
            }
        }
        let finished = match self.time {
            Time::Continuous => self.finish_signals(),
            Time::Discrete => self.finish_discrete_signals(),
        };
        if let Err(problem) = finished {
            problems.add(problem)?;
        }
        for claim in self.claims.clone() {
            for statement in claim.body.statements() {
                if let Err(problem) = self.check(&claim, statement) {
                    let remnant = Remnant::of_statement(statement, problems);
                    self.entry_failed(problem, remnant, problems)?;
                }
            }
        }
        for index in &indices {
            if let Err(problem) = self.refuse_taken_index(index) {
                problems.add(problem)?;
            }
        }
        self.domain = Default::default();
        if self.title.is_empty() {
            problems.add(
                Problem::new(&(0..0), "the file does not name a system", "here")
                    .help("begin with: system \"what it is\"")
                    .because(Cause::Title),
            )?;
        }
        let imports = std::mem::take(&mut self.imported_dimensions);
        let (dimensions, mistakes) = dimension::check(self, &items, &imports);
        self.dimensions = Arc::new(dimensions);
        for mistake in mistakes {
            problems.add(mistake)?;
        }
        Ok(())
    }

    fn enter(
        &mut self,
        item: &Item,
        folder: &Path,
        reading: &mut Reading,
        derivatives: &Derivatives,
    ) -> Result<(), Problem> {
        match item {
            Item::System { title, cite, span } => {
                if !self.title.is_empty() {
                    let message = format!("the file describes a system already: \"{}\"", self.title);
                    return Err(
                        Problem::new(span, message, "the second one").help("one file holds one system")
                    );
                }
                if title.is_empty() {
                    return Err(Problem::new(span, "a system needs a title", "this is empty"));
                }
                (self.title, self.cite) = (title.clone(), cite.clone());
            }
            Item::Use { alias, path, span } => self.import(alias, &folder.join(path), span, reading)?,
            Item::State(list) => {
                for Declared { name, .. } in list {
                    self.declare_coordinate(name, UnknownKind::State)?;
                }
            }
            Item::Param(list) => {
                for Declared { name, value, knowledge, .. } in list {
                    let default = value.as_ref().map(|value| self.rational(value)).transpose()?;
                    if *knowledge == Some(Knowledge::Unknown) {
                        self.declare_unknown_constant(name, default)?;
                        continue;
                    }
                    let symbol = self.declare(name, Kind::Parameter)?;
                    if let Some(info) = self.symbols.get_mut(&symbol) {
                        info.default = default;
                    }
                }
            }
            Item::Angle(names) => {
                for name in names {
                    let Some(symbol) = self.find_symbol(&name.text) else {
                        return Err(self.unknown(&name.text, &name.span, Wanted::Symbol));
                    };
                    for one in self.everywhere(symbol) {
                        if let Some(info) = self.symbols.get_mut(&one) {
                            info.is_angle = true;
                        }
                    }
                }
            }
            Item::Let { name, value: expr, .. } => {
                self.refuse_taken(name)?;
                if self.find_symbol(&name.text).is_some() {
                    let message = format!("'{}' is a symbol of an imported system", name.text);
                    return Err(Problem::new(&name.span, message, "a definition of this name would hide it")
                        .help("choose another name, or declare the symbol with 'param'"));
                }
                let (value, domain) = self.apart(|system| system.elaborate(expr))?;
                if !self.calculates_nothing(expr) {
                    self.calculated.insert(name.text.clone());
                }
                let nameless = match &value {
                    Value::CodistributionRank => Some("the rank of the codistribution".to_owned()),
                    Value::Visible { .. } | Value::Solutions(_) | Value::Infinity => Some(value.describe()),
                    _ => None,
                };
                if let Some(nameless) = nameless {
                    let message = format!("{nameless} has no name");
                    return Err(Problem::new(&expr.span, message, "claim it as it is"));
                }
                self.note_component(&name.text);
                let written = match (&value, is_component(&name.text)) {
                    // the text speaks of all components
                    (Value::Scalar(value), true) => Written::plain(self.graph.text(*value)),
                    _ => self.written_as(&expr.span, [expr]),
                };
                self.written.insert(name.text.clone(), written);
                self.definition_domains.insert(name.text.clone(), domain);
                self.definitions.insert(name.text.clone(), value);
            }
            Item::Field { role, name, components, is_map: true, .. } => {
                self.enter_map(*role, name.clone(), components)?
            }
            Item::Field { role, name, components, others_are_zero, .. } => {
                self.enter_field(*role, name.clone(), components, *others_are_zero)?
            }
            Item::Output(list) | Item::Zero(list) => {
                let is_zero = matches!(item, Item::Zero(_));
                let mut further = Vec::new();
                for OutputSyntax { value: expr, is_repeated, .. } in list {
                    let (value, domain) = self.apart(|system| system.scalar(expr))?;
                    let guards = self.guards_of(&domain);
                    let text = match (&expr.kind, is_repeated) {
                        (_, false) => in_one_line(&self.source, &expr.span),
                        (ExprKind::Name(name), true) => name.clone(),
                        (_, true) => self.graph.text(value),
                    };
                    for (experiment, copies) in self.further_experiments() {
                        let there = self.graph.substitute(&[value], &copies)[0];
                        let guards = self.substitute_guards(&guards, &copies);
                        further.push((in_words(&text, experiment), there, guards));
                    }
                    if is_zero {
                        self.coordinates.zero_outputs.push(value);
                    }
                    self.see(text, value, guards);
                }
                for (text, value, guards) in further {
                    if is_zero {
                        self.coordinates.zero_outputs.push(value);
                    }
                    self.see(text, value, guards);
                }
            }
            Item::Signals { knowledge, list } => {
                for signal in list {
                    self.declare_signal(*knowledge, signal, derivatives)?;
                }
            }
            Item::Initial(list) => {
                for one in list {
                    self.enter_initial(one)?;
                }
            }
            Item::Experiments { count, span } => self.enter_experiments(count, span)?,
            Item::Sample { ranges, avoid } => self.sample(ranges, avoid)?,
            Item::Claim(claim) => self.claims.push((**claim).clone()),
            Item::View(view) => self.enter_view(view)?,
        }
        Ok(())
    }

    /// Adds an output. What is seen twice is seen once: a second time it would count as a measurement of its own.
    fn see(&mut self, text: String, value: NodeId, guards: Vec<Guard>) {
        match self.outputs.iter().position(|(_, known)| *known == value) {
            Some(place) => self.output_guards[place].extend(guards),
            None => {
                self.output_guards.push(guards);
                self.outputs.push((text, value));
            }
        }
    }

    /// Whether a statement of a claim can be understood: its names are known and its two sides can be equal at all.
    fn check(&mut self, claim: &ClaimSyntax, statement: &Statement) -> Result<(), Problem> {
        let (left, right) = (&statement.equation.left, &statement.equation.right);
        let values = Value::compared(self.elaborate(left)?, self.elaborate(right)?);
        let comparable = match &values {
            (Value::Matrix(l), Value::Matrix(r)) => (l.rows, l.columns) == (r.rows, r.columns),
            (Value::Matrix(_), _) | (_, Value::Matrix(_)) => false,
            (Value::Visible { .. }, _) | (_, Value::Visible { .. }) => statement.is_about_what_is_seen(),
            (left, right) => left.are_comparable(right),
        };
        let of_codistribution = matches!(
            values,
            (Value::CodistributionRank | Value::Visible { .. } | Value::Solutions(_), _)
                | (_, Value::CodistributionRank | Value::Solutions(_))
        );
        if of_codistribution
            && !self.states.is_empty()
            && !self.outputs.is_empty()
            && let Some(problem) = self.no_motion()
        {
            let span = if self.fields.is_empty() { statement.span.clone() } else { problem.span.clone() };
            return Err(Problem {
                span,
                message: format!("claim {}: {}", claim.id, problem.message),
                cause: Cause::Motion,
                ..problem
            });
        }
        if !comparable {
            let message = format!("{} cannot equal {}", values.0.describe(), values.1.describe());
            let problem = Problem::new(&statement.span, message, "this claim");
            return Err(problem.because(Cause::Shape));
        }
        let relation = statement.equation.relation;
        let of_numbers = values.0.as_number().is_some() && values.1.as_number().is_some();
        let of_solutions = matches!(values, (Value::Solutions(_), _) | (_, Value::Solutions(_)));
        if relation != Relation::Equal && !of_numbers && !of_solutions {
            let (left, right) = (values.0.describe(), values.1.describe());
            let message = format!("'{}' compares numbers, not {left} and {right}", relation.sign());
            return Err(Problem::new(&statement.equation.span, message, "this relation"));
        }
        for further in &statement.further {
            self.scalar(&further.right)?;
        }
        if statement.on_sample && !of_numbers {
            let message = "'on sample' is said of numbers; a rank is that at almost all states";
            return Err(Problem::new(&statement.span, message, "this claim"));
        }
        let is_rank = |value: &Value| matches!(value, Value::Rank(_) | Value::CodistributionRank);
        if statement.except.is_some() && !is_rank(&values.0) && !is_rank(&values.1) {
            let message =
                "'everywhere' and 'except where' are said of a rank: all else is claimed wherever it exists";
            return Err(Problem::new(&statement.span, message, "this claim"));
        }
        if let Some(unequal) =
            statement.except.iter().flatten().flatten().find(|e| e.relation != Relation::Equal)
        {
            let message = "what is left out is said by equations";
            return Err(Problem::new(&unequal.span, message, "no equation"));
        }
        for condition in statement.conditions.iter().chain(statement.except.iter().flatten().flatten()) {
            self.scalar(&condition.left)?;
            self.scalar(&condition.right)?;
            if let Some(within) = &condition.within {
                return Err(Problem::new(&within.span, "a condition is met exactly", "without 'within'"));
            }
        }
        if let Some(within) = &statement.equation.within {
            self.scalar(within)?;
        }
        if statement.carried.is_some() {
            let is_print = statement.equation.right.is_literal();
            if !is_print || !of_numbers || relation != Relation::Equal {
                let message = "'carrying ... digits' is said of a number in print, as in e at {x = 1} = 2.718 carrying 10 digits";
                return Err(Problem::new(&statement.span, message, "this claim"));
            }
        }
        Ok(())
    }

    pub(super) fn refuse_taken(&self, name: &Name) -> Result<(), Problem> {
        let declared = self.find_symbol(&name.text).and_then(|symbol| self.symbols.get(&symbol));
        let taken = declared.is_some_and(|info| info.kind != Kind::Imported)
            || self.definitions.contains_key(&name.text)
            || ["pi", "rank", "others"].contains(&name.text.as_str());
        if taken {
            return Err(Problem::new(
                &name.span,
                format!("'{}' has a meaning already", name.text),
                "declared again",
            ));
        }
        if name.text.contains('.') {
            let message = "a name with a dot belongs to an imported system";
            return Err(Problem::new(&name.span, message, "choose one without"));
        }
        if name.text.contains(['\'', '@']) {
            let message =
                "derivatives of signals, and what belongs to further experiments, come with what they are of";
            return Err(Problem::new(&name.span, message, "choose a name without"));
        }
        self.refuse_mixed(name)
    }

    pub(super) fn declare(&mut self, name: &Name, kind: Kind) -> Result<Symbol, Problem> {
        self.refuse_taken(name)?;
        Ok(self.declare_anew(&name.text, kind))
    }

    /// The same of a name that nobody else can give.
    pub(super) fn declare_anew(&mut self, name: &str, kind: Kind) -> Symbol {
        self.note_component(name);
        let symbol = self.graph.intern(name);
        let info = self.fresh_info(symbol, kind);
        self.symbols.insert(symbol, info);
        symbol
    }

    fn enter_field(
        &mut self,
        role: Role,
        name: Name,
        components: &[(Name, Expr)],
        others_are_zero: bool,
    ) -> Result<(), Problem> {
        self.refuse_field(&name, Time::Continuous)?;
        // asked in this order: a file of many fields is not gone through for each of them
        if role == Role::Drift
            && let Some(first) = self.drift()
        {
            let message = format!("there is a drift '{}' already", self.fields[first].name);
            return Err(Problem::new(&name.span, message, "the second one").help(format!(
                "write 'input {0}' if it is driven, 'field {0}' if it is only differentiated along",
                name.text
            )));
        }
        let (mut rates, mut guards) = self.rates_as_written(role, &name, components)?;
        let moved: HashSet<Symbol> = rates.iter().map(|(symbol, _)| *symbol).collect();
        let missing = self.moving_states().find(|state| !moved.contains(state));
        if let (Some(missing), false) = (missing, others_are_zero) {
            let message =
                format!("the field '{}' does not say how '{}' moves", name.text, self.symbol_name(missing));
            return Err(Problem::new(&name.span, message, "this field")
                .help("end it with: others' = 0, if the states that it does not name stand still"));
        }
        let written = self.written_components(components);
        let written = if others_are_zero { written.followed_by("others' = 0") } else { written };
        let mut fields = Vec::new();
        match role {
            Role::Drift => self.complete_drift(&mut rates, &mut guards),
            Role::Input => {
                for (experiment, copies) in self.further_experiments() {
                    let (rates, guards) = self.in_experiment(&rates, &guards, &copies);
                    fields.push((in_words(&name.text, experiment), rates, guards));
                }
            }
            Role::Other => {}
        }
        fields.insert(0, (name.text, rates, guards));
        for (title, rates, guards) in fields {
            let derivation = Derivation::new(rates.iter().copied().collect());
            self.field_places.insert(title.clone(), FieldPlace::Own(self.fields.len()));
            self.fields.push(Field {
                name: title,
                role,
                span: name.span.clone(),
                components: rates,
                guards,
                written: written.clone(),
                derivation,
            });
        }
        Ok(())
    }

    /// The components of a field as they are written.
    pub(super) fn written_components(&self, components: &[(Name, Expr)]) -> Written {
        match (components.first(), components.last()) {
            (Some((first, _)), Some((_, last))) => {
                self.written_as(&(first.span.start..last.span.end), components.iter().map(|(_, expr)| expr))
            }
            _ => Written::default(),
        }
    }

    /// What a field says of each state that it names, and where that exists.
    pub(super) fn rates_as_written(
        &mut self,
        role: Role,
        name: &Name,
        components: &[(Name, Expr)],
    ) -> Result<Components, Problem> {
        let mut rates: Vec<(Symbol, _)> = Vec::new();
        let mut moved: HashSet<Symbol> = HashSet::new();
        let mut guards = Vec::new();
        for (state, expr) in components {
            let is_state =
                |symbol: &Symbol| self.symbol_info(*symbol).is_some_and(|info| info.kind == Kind::State);
            let symbol = self.find_symbol(&state.text).filter(is_state);
            let Some(symbol) = symbol else {
                return Err(self.unknown(&state.text, &state.span, Wanted::State));
            };
            self.refuse_rate(role, symbol, &state.span)?;
            if !moved.insert(symbol) {
                let message = format!("'{}' is given twice in the field '{}'", state.text, name.text);
                return Err(Problem::new(&state.span, message, "the second time"));
            }
            let (rate, domain) = self.apart(|system| system.scalar(expr))?;
            rates.push((symbol, rate));
            guards.push(self.guards_of(&domain));
        }
        Ok((rates, guards))
    }

    /// Some expressions as they are written, within a span that holds them all.
    fn written_as<'a>(&self, span: &Span, expressions: impl IntoIterator<Item = &'a Expr>) -> Written {
        let states = self.column_names();
        let is_definition = |name: &str| self.definitions.contains_key(name);
        let scope = Scope { source: &self.source, is_definition: &is_definition, states: &states };
        let mut places = Vec::new();
        for expr in expressions {
            places_in(&scope, expr, &mut places);
        }
        Written::new(&self.source, span, places)
    }

    fn sample(&mut self, ranges: &[(Name, Expr, Expr)], avoid: &[Expr]) -> Result<(), Problem> {
        for (name, low, high) in ranges {
            let Some(symbol) = self.find_symbol(&name.text) else {
                return Err(self.unknown(&name.text, &name.span, Wanted::Symbol));
            };
            let range = Range { low: self.rational(low)?, high: self.rational(high)? };
            if range.low > range.high {
                let span = low.span.start..high.span.end;
                return Err(Problem::new(
                    &span,
                    format!("the range of '{}' is empty", name.text),
                    "low above high",
                ));
            }
            // a range that came with an import may be replaced, one of this file not
            if !self.sampled.insert(symbol) {
                let message = format!("'{}' has a range already", name.text);
                return Err(Problem::new(&name.span, message, "the second one"));
            }
            self.spread_range(symbol, &range);
            if let Some(info) = self.symbols.get_mut(&symbol) {
                info.range = Some(range);
            }
        }
        for expr in avoid {
            let value = self.scalar(expr)?;
            let text = in_one_line(&self.source, &expr.span);
            self.avoid.push((text.clone(), value));
            for (experiment, copies) in self.further_experiments() {
                let there = self.graph.substitute(&[value], &copies)[0];
                if there != value {
                    self.avoid.push((in_words(&text, experiment), there));
                }
            }
        }
        Ok(())
    }
}

/// What a field says of states, and where each component exists.
pub(super) type Components = (Vec<(Symbol, NodeId)>, Vec<Vec<Guard>>);

/// What examining a file came to.
#[derive(Debug)]
pub struct Examination {
    /// The system, where nothing is wrong.
    pub system: Option<System>,
    /// What is wrong, in the order of the file.
    pub problems: Vec<ReadError>,
    /// Whether there is more than was asked for.
    pub more: bool,
    /// The files that were read or looked for: this one, and all that it imports or refers to.
    pub files: BTreeSet<PathBuf>,
}

impl Examination {
    /// The system, or the first problem.
    ///
    /// # Errors
    /// What is wrong with the file, and where.
    pub fn into_result(self) -> Result<System, ReadError> {
        match self.system {
            Some(system) => Ok(system),
            None => Err(self
                .problems
                .into_iter()
                .next()
                .unwrap_or_else(|| Problem::new(&(0..0), "the file cannot be read", "").locate("", ""))),
        }
    }
}

fn expected(error: crate::expression::Expected) -> Problem {
    Problem {
        message: error.to_string(),
        span: error.at..error.at + 1,
        label: "here".to_owned(),
        help: error.help,
        cause: Cause::Itself,
    }
}
