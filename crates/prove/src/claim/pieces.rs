//! The set that a claim about almost all states speaks of, piece by piece: inequalities and domains may reduce a branch to an edge, or to
//! edges beside an open part of it, and what is said of a set is said of each of its components.
//!
//! A piece of fewer dimensions than those around it is no component of its own where it lies in their closure. That is so where the conditions
//! have independent derivatives at almost all of its states: the set is a smooth one there, of as many dimensions as there are symbols less
//! conditions; and where an inequality holds with equality, a direction leads from it to where it holds strictly.

use super::branches::{Asked, DecidedBranch, Size};
use super::evidence::Kept;
use super::identity::OnOneBranch;
use super::verdict::Verdict;
use palmistry_checker::Evidence;
use palmistry_lang::System;
use palmistry_math::expression::{Guard, Need, NodeId};
use palmistry_rank::observability::{Branch, GenericRank, Interior, Solution, generic_rank, interior};
use rand_chacha::ChaCha8Rng;

/// No more pieces are looked at.
const MOST_PIECES: usize = 48;

/// A piece that is still to be looked at.
struct Piece {
    size: Size,
    branch: Branch,
    /// What vanishes on the whole set.
    equations: Vec<NodeId>,
    /// What vanishes on the piece and is positive around it.
    active: Vec<NodeId>,
}

/// What was found of all pieces.
#[derive(Default)]
pub(super) struct DecidedSet {
    pub found: Vec<(Size, Branch, OnOneBranch)>,
    pub evidence: Vec<Evidence>,
    /// Thin pieces that were not looked at, in words.
    pub unsolved: Vec<String>,
}

impl Asked<'_> {
    /// The verdicts on a branch for a claim about all states; where it is open, and inequalities hold with equality only, on the set on which they
    /// do.
    pub fn on_whole_branch(
        &self,
        system: &mut System,
        branch: &Branch,
        kept: Kept,
        rng: &mut ChaCha8Rng,
    ) -> Result<Vec<DecidedBranch>, String> {
        let found = self.on_branch(system, branch, kept, rng)?;
        let is_open = |(_, verdict, _): &DecidedBranch| {
            matches!(verdict, OnOneBranch::Verdict(Verdict::Undecided { .. }, _))
        };
        let guards = self.all_guards(system, branch);
        if !found.iter().any(is_open) || !self.unsolved.is_empty() || !guards.iter().any(is_closed) {
            return Ok(found);
        }
        let Ok(Interior::Flat(vanishing)) = interior(system, branch, &guards) else { return Ok(found) };
        let Ok(Solution { parts, smaller, thinner, unsolved }) = branch.meeting(system, &vanishing) else {
            return Ok(found);
        };
        if !unsolved.is_empty() {
            return Ok(found);
        }
        let mut on_flat = Vec::new();
        for branch in parts.iter().chain(&smaller).chain(&thinner) {
            on_flat.extend(self.on_branch(system, branch, kept, rng)?);
        }
        Ok(on_flat)
    }

    /// The verdicts on all pieces of the set on which the conditions hold, for a claim about almost all of its states.
    pub fn on_pieces(
        &self,
        system: &mut System,
        solution: Solution,
        kept: Kept,
        rng: &mut ChaCha8Rng,
    ) -> Result<DecidedSet, String> {
        let mut decided = DecidedSet::default();
        let mut open = Vec::new();
        add(&mut open, &mut decided, solution, Size::Part, (self.conditions.to_vec(), Vec::new()));
        let mut looked_at = 0;
        while let Some(piece) = open.pop() {
            looked_at += 1;
            if looked_at > MOST_PIECES {
                return Err(format!(
                    "inequalities and domains leave more than {MOST_PIECES} pieces of the set"
                ));
            }
            self.on_piece(system, piece, (&mut open, &mut decided), (kept, &mut *rng))?;
        }
        Ok(decided)
    }

    fn on_piece(
        &self,
        system: &mut System,
        piece: Piece,
        (open, decided): (&mut Vec<Piece>, &mut DecidedSet),
        (kept, rng): (Kept, &mut ChaCha8Rng),
    ) -> Result<(), String> {
        let guards = self.all_guards(system, &piece.branch);
        let left = match guards.iter().any(is_closed) {
            true => interior(system, &piece.branch, &guards)?,
            false => Interior::Open(Vec::new()),
        };
        let edges = match left {
            Interior::Empty(guard) => {
                decided.found.push((piece.size, piece.branch, OnOneBranch::Empty(guard)));
                return Ok(());
            }
            Interior::Flat(vanishing) => {
                match piece.branch.meeting(system, &vanishing) {
                    Ok(solution) => {
                        let mut equations = piece.equations;
                        equations.extend(vanishing);
                        add(open, decided, solution, piece.size, (equations, piece.active));
                    }
                    Err(why) if !why.may_be_met() => {
                        decided.found.push((piece.size, piece.branch, OnOneBranch::Empty(why.to_string())));
                    }
                    Err(why) => {
                        return Err(format!("inequalities hold with equality only, and {why}"));
                    }
                }
                return Ok(());
            }
            Interior::Open(edges) => Some(edges),
            Interior::NotKnown(guards) => {
                let verdict =
                    self.where_nothing_is_open(system, &piece, &guards, (kept, &mut *rng), decided)?;
                decided.found.extend(verdict);
                None
            }
        };
        let Some(edges) = edges else { return Ok(()) };
        if piece.size != Size::Part && piece.size != Size::Smaller && lies_in_the_closure(system, &piece, rng)
        {
            return self.on_edges(system, &piece, edges, (open, decided));
        }
        let mut pieces = self.on_branch(system, &piece.branch, kept, rng)?;
        let is_proved = |(_, verdict, _): &DecidedBranch| {
            matches!(verdict, OnOneBranch::Empty(_) | OnOneBranch::Verdict(Verdict::Proved { .. }, _))
        };
        if piece.size == Size::Smaller
            && !pieces.iter().all(is_proved)
            && lies_in_the_closure(system, &piece, rng)
        {
            pieces.clear();
        }
        for (branch, verdict, evidence) in pieces {
            decided.evidence.extend(evidence);
            decided.found.push((piece.size, branch, verdict));
        }
        self.on_edges(system, &piece, edges, (open, decided))
    }

    /// Where no state is known at which all inequalities hold strictly, a proof at almost all states of the branch is none on the set.
    fn where_nothing_is_open(
        &self,
        system: &mut System,
        piece: &Piece,
        guards: &str,
        (kept, rng): (Kept, &mut ChaCha8Rng),
        decided: &mut DecidedSet,
    ) -> Result<Vec<(Size, Branch, OnOneBranch)>, String> {
        let mut found = Vec::new();
        for (branch, verdict, evidence) in self.on_branch(system, &piece.branch, kept, rng)? {
            let verdict = match verdict {
                OnOneBranch::Verdict(Verdict::Proved { .. }, existence) => {
                    let why = format!(
                        "it is so generically, and it is not known whether inequalities and domains leave thinner parts \
                         of these: {guards}"
                    );
                    OnOneBranch::Verdict(Verdict::undecided(why), existence)
                }
                other => {
                    decided.evidence.extend(evidence);
                    other
                }
            };
            found.push((piece.size, branch, verdict));
        }
        Ok(found)
    }

    /// Notes the sets on which thin parts may lie.
    fn on_edges(
        &self,
        system: &mut System,
        piece: &Piece,
        edges: Vec<Vec<NodeId>>,
        (open, decided): (&mut Vec<Piece>, &mut DecidedSet),
    ) -> Result<(), String> {
        for edge in edges {
            match piece.branch.meeting(system, &edge) {
                Ok(solution) => {
                    let mut active = piece.active.clone();
                    active.extend(&edge);
                    add(open, decided, solution, Size::Edge, (piece.equations.clone(), active));
                }
                Err(why) if !why.may_be_met() => {}
                Err(why) => {
                    let why = format!("an inequality may hold with equality on a part of its own, and {why}");
                    let verdict =
                        OnOneBranch::Verdict(Verdict::undecided(why), super::existence::Existence::Shown);
                    decided.found.push((Size::Edge, piece.branch.clone(), verdict));
                }
            }
        }
        Ok(())
    }
}

/// Whether a guard may hold with equality.
fn is_closed(guard: &Guard) -> bool {
    matches!(guard.need, Need::NotNegative | Need::WithinOne)
}

/// Notes the branches of a solution as pieces that are to be looked at, the first ones last, since the last is taken first.
fn add(
    open: &mut Vec<Piece>,
    decided: &mut DecidedSet,
    solution: Solution,
    size: Size,
    (equations, active): (Vec<NodeId>, Vec<NodeId>),
) {
    decided.unsolved.extend(solution.unsolved.into_iter().map(|unsolved| unsolved.text));
    let of =
        |size: Size, branch| Piece { size, branch, equations: equations.clone(), active: active.clone() };
    let smaller = |of_set: Size| if size == Size::Part { of_set } else { size };
    let thinner = solution.thinner.into_iter().map(|branch| of(smaller(Size::Thinner), branch));
    let smaller = solution.smaller.into_iter().map(|branch| of(smaller(Size::Smaller), branch));
    let parts = solution.parts.into_iter().map(|branch| of(size, branch));
    let all: Vec<Piece> = parts.chain(smaller).chain(thinner).collect();
    open.extend(all.into_iter().rev());
}

/// Whether almost all states of a piece, and so all, lie in the closure of the rest of the set.
fn lies_in_the_closure(system: &mut System, piece: &Piece, rng: &mut ChaCha8Rng) -> bool {
    // what ties outputs to zero holds with all derivatives along the drift, which are not among the equations
    let is_thinner = piece.branch.values.len() > piece.equations.len();
    if piece.active.is_empty() && !is_thinner || !system.zero_outputs().is_empty() {
        return false;
    }
    let nodes: Vec<NodeId> = piece.equations.iter().chain(&piece.active).copied().collect();
    let symbols = system.graph.symbols_of(nodes.iter().copied());
    let mut entries = Vec::new();
    for node in &nodes {
        entries.extend(symbols.iter().map(|symbol| system.partial(*node, *symbol)).collect::<Vec<_>>());
    }
    let Ok(there) = piece.branch.put_in(system, &entries) else { return false };
    let is_angle = system.angle_test();
    let found = generic_rank(&mut system.graph, &there, symbols.len(), is_angle, rng);
    matches!(found, GenericRank::Rank { rank, .. } if rank == nodes.len())
}
