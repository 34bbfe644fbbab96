//! How much do the verdicts hang on every sign? Each sign of each claim of the thesis's files is turned round, one at a
//! time, and the claim decided again. A mutant that is still proved has survived, and is named.

use palmistry::expression::syntax::{Expr, ExprKind};
use palmistry::system::{ClaimBody, ClaimSyntax, Statement};
use palmistry::{System, decide};
use rayon::prelude::*;
use serde_json::json;
use std::path::Path;

/// Turns round the sign of the term of a number, counted through the expression; true when it was found.
fn flip(expr: &mut Expr, number: &mut usize) -> bool {
    match &mut expr.kind {
        ExprKind::Number(_) | ExprKind::Name(_) | ExprKind::Indexed(_) => false,
        ExprKind::Sum(terms) => {
            for (negative, term) in terms {
                if *number == 0 {
                    *negative = !*negative;
                    return true;
                }
                *number -= 1;
                if flip(term, number) {
                    return true;
                }
            }
            false
        }
        ExprKind::Product(factors) => factors.iter_mut().any(|(_, factor)| flip(factor, number)),
        ExprKind::Call(_, arguments) => arguments.iter_mut().any(|argument| flip(argument, number)),
        ExprKind::Matrix(rows) => rows.iter_mut().flatten().any(|entry| flip(entry, number)),
        // the point at which something is taken is a condition, and not what is claimed
        ExprKind::Power(inner, _) | ExprKind::At(inner, _) => flip(inner, number),
        ExprKind::RealPower(base, exponent) => flip(base, number) || flip(exponent, number),
    }
}

/// The statement that has to be proved.
fn statement(body: &mut ClaimBody) -> Option<&mut Statement> {
    match body {
        ClaimBody::Claim { statement, .. } | ClaimBody::Scan { repaired: statement, .. } => Some(statement),
        ClaimBody::Erratum { corrected, .. } => Some(corrected),
        ClaimBody::Definition { .. } | ClaimBody::Open { .. } => None,
    }
}

/// All claims with one sign turned round, and which one.
fn mutants(claim: &ClaimSyntax) -> Vec<(usize, ClaimSyntax)> {
    (0..)
        .map_while(|number| {
            let mut mutant = claim.clone();
            let equation = &mut statement(&mut mutant.body)?.equation;
            let mut count = number;
            let found = flip(&mut equation.left, &mut count) || flip(&mut equation.right, &mut count);
            // an erratum's printed form plays no part in this
            if let (true, ClaimBody::Erratum { corrected, .. }) = (found, mutant.body.clone()) {
                mutant.body = ClaimBody::Claim {
                    statement: corrected,
                    expected: palmistry::system::Expectation::Proved,
                };
            }
            found.then_some((number, mutant))
        })
        .collect()
}

fn systems() -> Vec<System> {
    let folder = Path::new("proofs/moll2002");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "proof"));
    files.sort();
    files.iter().map(|file| System::read(file).unwrap()).collect()
}

/// Every sign of every claim. The survivors are in the snapshot, each by its claim and the number of its sign, with what
/// they have in common.
#[test]
fn a_wrong_sign_is_refuted() {
    let mut counts = [0usize; 3];
    let mut survivors = Vec::new();
    let mut undecided = Vec::new();
    for system in &systems() {
        let mutants: Vec<(usize, ClaimSyntax)> = system.claims.iter().flat_map(mutants).collect();
        let name = Path::new(&system.name).file_name().unwrap().to_string_lossy().into_owned();
        let words: Vec<&str> =
            mutants.par_iter().map(|(_, claim)| decide(system, claim, 1).verdict.word()).collect();
        for ((number, claim), word) in mutants.iter().zip(words) {
            let label = format!("{name} {} sign {}", claim.id, number + 1);
            match word {
                "refuted" => counts[0] += 1,
                "undecided" => {
                    counts[1] += 1;
                    undecided.push(label);
                }
                _ => {
                    counts[2] += 1;
                    survivors.push(label);
                }
            }
        }
    }
    let all = counts.iter().sum::<usize>();
    assert!(all > 1000, "only {all} mutants");
    let reason = "Each surviving sign stands before something that is zero (a field that does not move the state, a \
                  product that vanishes), is squared, scales what is free (an unobservable direction, a rank), or is in a \
                  number that is not the least of some.";
    insta::with_settings!({ description => reason }, {
        insta::assert_json_snapshot!(
            "survivors",
            json!({
                "mutants": all,
                "refuted": counts[0],
                "undecided": undecided,
                "still_proved": survivors,
            })
        );
    });
}
