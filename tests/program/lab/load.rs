//! A reading group: a hundred clients at once.

use super::Lab;
use serde_json::json;
use std::time::Instant;

const CLIENTS: usize = 100;
const QUESTIONS: usize = 5;

/// Each of a hundred clients writes a system of its own and asks for its verdicts: all answers come, and each is to its own question.
#[test]
fn a_hundred_clients_lose_nothing() {
    let lab = Lab::begin(&["--public", "127.0.0.1:0"]);
    let begin = Instant::now();
    let times: Vec<f64> = std::thread::scope(|scope| {
        let client = |client: usize| {
            let lab = &lab;
            move || -> Vec<f64> {
                let question = |number: usize| {
                    // true for even numbers alone
                    let side = 3 + client + number % 2;
                    let text = format!(
                        "system \"{client}\"\nstate x\ndrift f x' = {}*x\noutput x\nclaim c{client}: L(f, x) = {side}*x\n",
                        3 + client
                    );
                    let begin = Instant::now();
                    let lines = lab.ask(
                        "answer",
                        &json!({ "ask": "claims", "text": text, "only": [format!("c{client}")] }),
                    );
                    assert_eq!(lines.len(), 2, "{lines:?}");
                    let claim = &lines[0]["claim"];
                    assert_eq!(claim["id"], format!("c{client}"));
                    assert_eq!(claim["ok"], number.is_multiple_of(2), "{claim}");
                    begin.elapsed().as_secs_f64()
                };
                (0..QUESTIONS).map(question).collect()
            }
        };
        let threads: Vec<_> = (0..CLIENTS).map(|number| scope.spawn(client(number))).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("all answers are right")).collect()
    });
    let mut sorted = times;
    sorted.sort_by(f64::total_cmp);
    println!(
        "{} answers to {CLIENTS} clients in {:.2} s; median {:.3} s, longest {:.3} s",
        sorted.len(),
        begin.elapsed().as_secs_f64(),
        sorted[sorted.len() / 2],
        sorted[sorted.len() - 1]
    );
    assert_eq!(sorted.len(), CLIENTS * QUESTIONS);
}
