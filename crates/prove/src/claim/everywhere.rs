//! Claims about a rank at all states, `rank = 6 except where g*omega0 = 0`, and what the checker needs of them.

use super::question::{BOUNDS_ARE_NOT_CHECKED, Question, guards_of_conditions};
use super::verdict::{Verdict, Witness};
use crate::drops::{
    ClaimedEverywhere, Everywhere, MinorIdentity, NamedSet, StatesOfCases, decide_everywhere,
    share_of_the_box,
};
use crate::evidence::{Lowering, StatementAt, exact_state, largest_minor};
use dashu::rational::RBig;
use palmistry_checker::{
    CertifiedRank, Effort, Evidence, Finding, Missing, RankedState, Ratio, StatedIdentity,
};
use palmistry_io::UNINTERRUPTED;
use palmistry_lang::{Statement, System, in_one_line};
use palmistry_math::expression::syntax::{Equation, Expr, Relation};
use palmistry_math::expression::{Guard, NodeId, Program, add_guard, expand_angles};
use palmistry_math::number::{PrimeField, Rationals};
use palmistry_rank::observability::{Coordinate, State, assumed, kernel};
use rand::{Rng, RngExt};

/// What a proof rests on.
const ENGINE: &str = "minors as products of factors that do not vanish";
/// The work of the checker on a refutation.
const WORK: u64 = 200_000_000;
/// The length to which exact values may grow.
const BITS: usize = 1 << 14;
/// At so many states the two sides of a minor's identity are looked for.
const STATES: usize = 20;

/// What became of a claim about a rank at all states.
pub(super) struct DecidedEverywhere {
    pub verdict: Verdict,
    /// What it rests on.
    pub evidence: Vec<Evidence>,
    /// What the rank is on the sets that are left out, in words.
    pub beside: Vec<String>,
}

/// Reads a claim about a rank at all states but those of some sets.
///
/// # Errors
/// In words, where the statement is no such claim.
pub(super) fn read(
    system: &mut System,
    statement: &Statement,
    question: &Question,
    except: &[Vec<Equation>],
    (mut guards, conditions): (Vec<Guard>, Vec<NodeId>),
) -> Result<ClaimedEverywhere, String> {
    let (matrix, rank) = match question {
        Question::Rank { entries, columns, claimed } => (Some((entries.clone(), *columns)), *claimed),
        Question::Codistribution { claimed } => (None, *claimed),
        _ => return Err("'except where' is said of a rank".to_owned()),
    };
    if rank.are_bounds && rank.most != usize::MAX {
        return Err("'everywhere' and 'except where' take rank = n or rank >= n".to_owned());
    }
    let may_be_greater = rank.are_bounds;
    let rank = rank.least;
    for guard in guards_of_conditions(system, statement)? {
        add_guard(&system.graph, &mut guards, guard);
    }
    for condition in statement.conditions.iter().filter(|one| one.relation != Relation::Equal) {
        let left = system.scalar(&condition.left).map_err(|problem| problem.message)?;
        let right = system.scalar(&condition.right).map_err(|problem| problem.message)?;
        if let Some(guard) = assumed(&mut system.graph, condition.relation, left, right) {
            add_guard(&system.graph, &mut guards, guard);
        }
    }
    guards.retain(|guard| guard.is_obvious(&system.graph) != Some(true));
    let sets = except.iter().map(|set| left_out(system, set, &guards)).collect::<Result<_, _>>()?;
    Ok(ClaimedEverywhere {
        matrix,
        rank,
        may_be_greater,
        guards,
        conditions,
        except: sets,
        with_examples: false,
    })
}

/// A set that is left out. What its equations need to exist is needed of its own states, and not of those that the claim is about.
fn left_out(system: &mut System, set: &[Equation], known: &[Guard]) -> Result<NamedSet, String> {
    let ends = set.first().zip(set.last()).map(|(first, last)| first.span.start..last.span.end);
    let written = in_one_line(&system.source, &ends.unwrap_or_default());
    let (mut vanishing, mut guards) = (Vec::new(), Vec::new());
    for equation in set {
        let mut side = |expr: &Expr| -> Result<NodeId, String> {
            let (value, needed) = system.elaborate_guarded(expr).map_err(|problem| problem.message)?;
            needed.into_iter().for_each(|guard| add_guard(&system.graph, &mut guards, guard));
            value.as_number().ok_or_else(|| "what is left out is given by numbers".to_owned())
        };
        let (left, right) = (side(&equation.left)?, side(&equation.right)?);
        vanishing.push(system.graph.sub(left, right));
    }
    guards.retain(|guard| guard.is_obvious(&system.graph) != Some(true) && !known.contains(guard));
    Ok(NamedSet { vanishing, guards, written })
}

/// Decides a claim about a rank at all states, and notes what the verdict rests on.
///
/// # Errors
/// In words, where it is out of reach.
pub(super) fn decide(
    system: &mut System,
    claim: &ClaimedEverywhere,
    rng: &mut impl Rng,
) -> Result<DecidedEverywhere, String> {
    let seed = rng.random::<u64>();
    let decided = decide_everywhere(system, claim, seed, &UNINTERRUPTED);
    Ok(match decided.map_err(|why| why + &on_the_box(system, claim))? {
        Everywhere::Proved { cases: (cases, empty), minors, examples, beside, log2_error } => {
            let engine = format!("{ENGINE}, in {cases} cases, {empty} of them empty");
            let mut evidence = Vec::new();
            if claim.with_examples && claim.may_be_greater {
                evidence.push(Evidence::Unchecked(BOUNDS_ARE_NOT_CHECKED.to_owned()));
            } else if claim.with_examples {
                evidence.extend(minors.iter().map(|minor| identity(system, minor, log2_error, rng)));
                evidence.extend(on_the_cases(system, claim, examples, rng));
            }
            DecidedEverywhere { verdict: Verdict::Proved { engine, log2_error }, evidence, beside }
        }
        Everywhere::Refuted { state, found, set, log2_error } => {
            let rows = rows(system, claim);
            let certified = ranks_at(system, claim, rows, std::slice::from_ref(&state), rng);
            let certified = certified.map_err(|why| why.to_string())?;
            let finding = certified.check(&Effort::new(WORK), &UNINTERRUPTED);
            if !matches!(finding, Finding::Confirmed { .. }) {
                return Err(format!(
                    "the rank is found to be {found} where {}, which the checker does not confirm",
                    set.join(", ")
                ));
            }
            let witness = Witness {
                state: state.describe(system),
                left: found.to_string(),
                right: claim.in_words(),
                entry: None,
                refutation: None,
            };
            let engine = match set.is_empty() {
                true => "exact elimination".to_owned(),
                false => format!("exact elimination; rank-deficient where {}", set.join(", ")),
            };
            let engine = match log2_error.is_finite() && claim.matrix.is_none() {
                true => {
                    format!("{engine}, which no field leaves, so that higher Lie derivatives do not raise it")
                }
                false => engine,
            };
            let evidence = vec![Evidence::Rank(certified)];
            DecidedEverywhere { verdict: Verdict::Refuted { engine, witness }, evidence, beside: Vec::new() }
        }
        Everywhere::RefutedAt { state, at_most, set, log2_error } => {
            let left = if at_most == 0 { "0".to_owned() } else { format!("at most {at_most}") };
            let right = claim.in_words();
            let witness = Witness { state, left, right, entry: None, refutation: None };
            let chance = match log2_error.is_finite() {
                true => format!(" (error probability below 2^{:.0})", log2_error.ceil()),
                false => String::new(),
            };
            let engine = format!("exact elimination; rank-deficient where {}{chance}", set.join(", "));
            let why = "the state is irrational, which no verdict file can hold";
            let evidence = vec![Evidence::Unchecked(why.to_owned())];
            DecidedEverywhere { verdict: Verdict::Refuted { engine, witness }, evidence, beside: Vec::new() }
        }
        Everywhere::Open(why) => {
            let verdict = Verdict::undecided(why + &on_the_box(system, claim));
            DecidedEverywhere { verdict, evidence: Vec::new(), beside: Vec::new() }
        }
    })
}

/// What interval certificates say of the sample box where a rank at all states is open, as the end of a sentence.
fn on_the_box(system: &mut System, claim: &ClaimedEverywhere) -> String {
    let is_full = claim.matrix.is_none() && claim.rank == system.unknown_count();
    if !is_full || !claim.conditions.is_empty() {
        return String::new();
    }
    match share_of_the_box(system, &UNINTERRUPTED) {
        Ok(share) if share.proved > 0.0 => {
            let (percent, rank) = (share.percent(), claim.rank);
            format!("; on {percent} % of the sample box the rank is {rank}, by interval certificates")
        }
        _ => String::new(),
    }
}

/// A minor and its product of factors, as an identity that the checker tries.
fn identity(system: &System, minor: &MinorIdentity, log2_error: f64, rng: &mut impl Rng) -> Evidence {
    let graph = &system.graph;
    let sides = [minor.minor, minor.product];
    let mentioned = sides.iter().copied().chain(minor.guards.iter().map(|guard| guard.node));
    let symbols = graph.symbols_of(mentioned);
    let mut why = "no state was found at which all of it is defined".to_owned();
    for _ in 0..STATES {
        let mut state = State::default();
        for symbol in &symbols {
            let value = RBig::from(rng.random_range(1..=12i64)) / RBig::from(rng.random_range(1..=5i64));
            state.values.insert(*symbol, Coordinate::Number(value));
        }
        let stated: Result<StatedIdentity, Missing> = StatementAt {
            graph,
            sides: &sides,
            relations: &[],
            within: None,
            conditions: &[],
            guards: &minor.guards,
            state: &state,
            terms: &[],
        }
        .identity(ENGINE, log2_error, None);
        match stated {
            Ok(stated) => match stated.check(1, &Effort::new(WORK)) {
                Finding::NotConfirmed(doubt) if doubt != palmistry_checker::Doubt::Differ => {
                    why = format!("the checker cannot decide: {doubt}");
                }
                _ => return Evidence::Proved(stated),
            },
            Err(missing) => return Evidence::Unchecked(format!("it could not be written down: {missing}")),
        }
    }
    Evidence::Unchecked(why)
}

/// The rank at a state of each case, for the checker: small sets are where a mistake in a factor would show.
fn on_the_cases(
    system: &mut System,
    claim: &ClaimedEverywhere,
    examples: StatesOfCases,
    rng: &mut impl Rng,
) -> Option<Evidence> {
    let (_, width, _, columns) = match &claim.matrix {
        Some(_) => rows(system, claim),
        None => (Vec::new(), system.unknown_count(), Vec::new(), system.column_names()),
    };
    let StatesOfCases { row_names: words, entries, states } = examples;
    let mut found = match ranks_at(system, claim, (entries, width, words, columns), &states, rng) {
        Ok(found) => found,
        Err(missing) => return Some(Evidence::Unchecked(format!("it could not be written down: {missing}"))),
    };
    // a state that meets the equations of a case may lie in a smaller one, for which other rows are meant
    found.states.retain(|state| state.rank == claim.rank);
    (!found.states.is_empty()).then_some(Evidence::Rank(found))
}

/// Rows, their number of entries, what they are of, and what their columns are.
type NamedRows = (Vec<NodeId>, usize, Vec<String>, Vec<String>);

/// The rank at some states, with its minor and its kernel.
fn ranks_at(
    system: &mut System,
    claim: &ClaimedEverywhere,
    (entries, width, words, columns): NamedRows,
    states: &[State],
    rng: &mut impl Rng,
) -> Result<CertifiedRank, Missing> {
    let is_angle = &system.angle_test();
    let expanded = expand_angles(&mut system.graph, &entries, is_angle);
    let program = Program::new(&system.graph, &expanded, is_angle);
    let mut ranked = Vec::new();
    for state in states {
        let minor = largest_minor(&program, width, state, PrimeField::random(rng)).unwrap_or_default();
        let exact = Rationals { bits: BITS };
        let values = state
            .inputs(&program, &exact)
            .ok()
            .and_then(|inputs| program.load(exact).ok()?.run(&inputs, &mut Vec::new()).ok())
            .unwrap_or_default();
        let matrix: Vec<Vec<RBig>> = values.chunks(width.max(1)).map(<[RBig]>::to_vec).collect();
        let unobservable = kernel(&Rationals { bits: BITS }, matrix, width).unwrap_or_default();
        ranked.push(RankedState {
            state: exact_state(&system.graph, state),
            rank: minor.rows.len(),
            minor,
            kernel: unobservable.into_iter().map(|v| v.into_iter().map(Ratio).collect()).collect(),
        });
    }
    let graph = &system.graph;
    let mut lowering = Lowering::new(graph);
    let mut places = Vec::new();
    for row in entries.chunks(width.max(1)) {
        places.push(row.iter().map(|entry| lowering.place(*entry)).collect::<Result<Vec<_>, _>>()?);
    }
    let conditions = claim.conditions.iter().map(|condition| lowering.vanishing(*condition));
    let conditions = conditions.collect::<Result<_, _>>()?;
    let requirements = claim.guards.iter().map(|guard| lowering.requirement(*guard));
    let requirements = requirements.collect::<Result<_, _>>()?;
    Ok(CertifiedRank {
        columns,
        row_names: words,
        rows: places,
        conditions,
        requirements,
        listing: lowering.finish(),
        states: ranked,
    })
}

/// All rows of the matrix, or those of the Lie derivatives that were taken.
fn rows(system: &mut System, claim: &ClaimedEverywhere) -> NamedRows {
    let numbered = |what: &str, count: usize| (1..=count).map(|n| format!("{what} {n}")).collect();
    match &claim.matrix {
        Some((entries, width)) => {
            let height = entries.len() / (*width).max(1);
            (entries.clone(), *width, numbered("row", height), numbered("column", *width))
        }
        None => {
            let (names, entries) = crate::drops::rows_up_to(system, claim.rank);
            (entries, system.unknown_count(), names, system.column_names())
        }
    }
}
