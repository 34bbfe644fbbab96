//! A unicycle that measures its distance to beacons: with one beacon one direction of the state space is unobservable, the
//! turn of everything about the beacon, `(-y, x, 1)`; with a second one all states are observable. With `cargo run --example unicycle`:
//!
//! ```text
//! 1 beacon(s): rank 2 of 3 generically, whatever is driven
//!   by q0, Ldrive q0
//!   at drawn states {2: 5000}, 5000 certified
//!   unobservable at x = 0.296, y = -0.585, theta = 2.908: 0.5851 x + 0.2963 y + theta
//! 2 beacon(s): rank 3 of 3 generically, whatever is driven
//!   by q0, q1, Ldrive q0
//!   at drawn states {3: 5000}, 5000 certified
//! ```

use palmistry::{RankQuestion, System, answer_rank};

/// A robot with odometry and beacons at known places, of which it measures half the square of the distance.
fn robot(beacons: &[(i32, i32)]) -> Result<System, palmistry::ReadError> {
    let outputs: String = beacons
        .iter()
        .enumerate()
        .map(|(i, (x, y))| format!("let q{i} = ((x - ({x}))^2 + (y - ({y}))^2)/2\noutput q{i}\n"))
        .collect();
    format!(
        "
system \"A unicycle that measures ranges\"
state x, y, theta
angle theta
{outputs}
input drive
  x'     = cos(theta)
  y'     = sin(theta)
  theta' = 0
input turn
  x'     = 0
  y'     = 0
  theta' = 1
sample
  x     in [-3, 3]
  y     in [-3, 3]
  theta in [-3, 3]
"
    )
    .parse()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for beacons in [&[(0, 0)][..], &[(0, 0), (1, 0)]] {
        let answer =
            answer_rank(&mut robot(beacons)?, &RankQuestion { samples: 5000, ..RankQuestion::default() })?;
        let found = &answer.branches[0];
        println!(
            "{} beacon(s): rank {} of {} generically{}",
            beacons.len(),
            found.generic_rank,
            answer.dimension,
            if found.is_final { ", whatever is driven" } else { "" }
        );
        println!("  by {}", found.lie_derivatives.join(", "));
        println!("  at drawn states {:?}, {} certified", found.full.rank_histogram, found.full.certified);
        for direction in &found.full.unobservable {
            let at: Vec<String> =
                direction.at.iter().map(|at| format!("{} = {:.3}", at.name, at.value)).collect();
            println!("  unobservable at {}: {}", at.join(", "), direction.example);
        }
    }
    Ok(())
}
