//! A system written as text: its claims are decided, and its observability is shown in three ways. With
//! `cargo run --example pendulum` it prints what follows; one of the three claims is wrong, since friction takes energy.
//!
//! ```text
//! acceleration: proved
//! energy: refuted
//!   at phi = sin = 24/145, cos = -143/145, omega = -1, k = 3, c = 1/10: -1/10 is not 0
//! observable: proved
//! phi = phi
//! Lf phi = omega
//! rank {2: 1000}, 1000 certified
//! full rank is proved on 1 of the sample box
//! ```

use palmistry::observability::{Codistribution, Length};
use palmistry::{RankQuestion, System, answer_rank, certify, prove};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut system: System = "
        system \"A damped pendulum whose angle is measured\"
        state  phi, omega                    # rad, rad/s
        param  k = 2                         # 1/s^2
        param  c = 1/10                      # 1/s
        angle  phi

        drift f
          phi'   = omega
          omega' = -k*sin(phi) - c*omega

        output phi

        sample
          phi   in [-3, 3]
          omega in [-2, 2]
          k     in [1, 3]

        claim acceleration: L(f, f, phi) = -k*sin(phi) - c*omega
        claim energy: L(f, omega^2/2 - k*cos(phi)) = 0
        claim observable: rank = 2
    "
    .parse()?;

    // the claims, each with its verdict
    for outcome in prove(&system) {
        println!("{}: {}", outcome.id, outcome.word());
        if let palmistry::Verdict::Refuted { witness, .. } = &outcome.verdict {
            let state: Vec<String> =
                witness.state.iter().map(|at| format!("{} = {}", at.name, at.exact)).collect();
            println!("  at {}: {} is not {}", state.join(", "), witness.left, witness.right);
        }
    }

    // the words of Lie derivatives whose differentials span the state space, and what they are
    let words = Codistribution::new(&mut system, &Default::default(), Length::UntilItStops)?;
    for index in &words.needed {
        println!(
            "{} = {}",
            words.lie_derivatives[*index].text(&system),
            system.graph.text(words.values[*index])
        );
    }

    // the rank at a thousand drawn states, each proved at that very state
    let answer = answer_rank(&mut system, &RankQuestion::default())?;
    for branch in &answer.branches {
        println!("rank {:?}, {} certified", branch.full.rank_histogram, branch.full.certified);
    }

    // and on which part of all states
    println!("full rank is proved on {} of the sample box", certify(&mut system, 1000)?.proved);
    Ok(())
}
