//! Our side of `benches/compare`: one job on given states, in the protocol of `benches/peers/worker.py`.
//!
//! `ours JOB STATES RESULTS` prepares (from the text of the proof file to a program that is ready to run), says `prepared SECONDS`,
//! and obeys the lines `run` and `write` on standard input.

use palmistry::System;
use palmistry::expression::{NodeId, Program, Symbol, expand_angles};
use palmistry::number::Floats;
use palmistry::observability::{float_inputs, singular_values};
use palmistry::system::Value;
use std::collections::HashMap;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::{Duration, Instant};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// What is evaluated over and over before a time is given.
const ENOUGH: Duration = Duration::from_millis(20);

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let [job, states, results] = arguments.as_slice() else {
        println!("this is one of the workers of benches/compare; run that");
        return Ok(());
    };
    let states: Vec<f64> =
        std::fs::read(states)?.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();

    let begin = Instant::now();
    let mut work = Work::prepare(job, &states)?;
    println!("prepared {}", begin.elapsed().as_secs_f64());
    work.evaluate();

    for line in std::io::stdin().lock().lines() {
        match line?.trim() {
            "run" => {
                let (mut count, begin) = (0, Instant::now());
                while begin.elapsed() < ENOUGH {
                    work.evaluate();
                    count += 1;
                }
                println!("took {}", begin.elapsed().as_secs_f64() / f64::from(count));
            }
            "write" => {
                let mut file = std::io::BufWriter::new(std::fs::File::create(results)?);
                for value in &work.results {
                    file.write_all(&value.to_le_bytes())?;
                }
                file.flush()?;
                println!("written");
            }
            _ => {}
        }
    }
    Ok(())
}

/// A job on its states.
struct Work {
    program: Program,
    /// For every state, what the program has to be given, but for its sines and cosines: the states in order and then
    /// the parameters at their default values.
    symbols: HashMap<Symbol, Source>,
    states: Vec<f64>,
    dimension: usize,
    singular: Option<Singular>,
    results: Vec<f64>,
}

#[derive(Clone, Copy)]
enum Source {
    State(usize),
    Parameter(f64),
}

/// The singular values that are asked for.
#[derive(Clone, Copy)]
enum Singular {
    /// Those of what the unit rows leave.
    Block,
    /// Those of the square matrix.
    Whole,
}

impl Work {
    fn prepare(job: &str, states: &[f64]) -> Outcome<Work> {
        let file = if job == "same_rate" { "same_rate.proof" } else { "general.proof" };
        let mut system =
            System::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(file))?;
        let singular = match job {
            "block" => Some(Singular::Block),
            "whole" => Some(Singular::Whole),
            _ => None,
        };
        let rows = if job == "order8" { order8(&mut system)? } else { rows(&system, singular)? };
        let angles = system.angles();
        let roots = expand_angles(&mut system.graph, &rows, |symbol| angles.contains(&symbol));
        let program = Program::new(&system.graph, &roots, |symbol| angles.contains(&symbol), false);
        let mut symbols = HashMap::new();
        for (symbol, info) in system.symbols() {
            if let Some(default) = &info.default {
                symbols.insert(symbol, Source::Parameter(default.to_f64().value()));
            }
        }
        for (place, symbol) in system.states.iter().enumerate() {
            symbols.insert(*symbol, Source::State(place));
        }
        let dimension = system.states.len();
        Ok(Work { program, symbols, states: states.to_vec(), dimension, singular, results: Vec::new() })
    }

    fn evaluate(&mut self) {
        let Ok(loaded) = self.program.load(Floats) else { return };
        let mut registers = Vec::new();
        self.results.clear();
        for state in self.states.chunks_exact(self.dimension) {
            let inputs = float_inputs(&self.program, |symbol| match self.symbols[&symbol] {
                Source::State(place) => state[place],
                Source::Parameter(value) => value,
            });
            let Ok(entries) = loaded.run(&inputs, &mut registers) else { continue };
            match self.singular {
                None => self.results.extend(entries),
                Some(singular) => {
                    let columns = if matches!(singular, Singular::Block) { 4 } else { self.dimension };
                    self.results.extend(
                        singular_values(&entries, &vec![0.0; entries.len()], columns)
                            .map_or(vec![], |s| s.values),
                    );
                }
            }
        }
    }
}

/// The rows of the file that are no unit rows, or what is needed of them.
fn rows(system: &System, singular: Option<Singular>) -> Outcome<Vec<NodeId>> {
    let Some(Value::Matrix(rows)) = system.definition("rows") else { return Err("there are no rows".into()) };
    let outputs = system.outputs.len();
    let seen: Vec<Symbol> =
        system.outputs.iter().filter_map(|(_, node)| system.graph.as_symbol(*node)).collect();
    Ok(match singular {
        Some(Singular::Whole) => rows.entries.clone(),
        None => rows.entries[outputs * rows.columns..].to_vec(),
        Some(Singular::Block) => (outputs..rows.rows)
            .flat_map(|row| (0..rows.columns).map(move |column| (row, column)))
            .filter(|(_, column)| !seen.contains(&system.states[*column]))
            .map(|(row, column)| rows.at(row, column))
            .collect(),
    })
}

/// The gradient of `L_g1` applied eight times to `s1`.
fn order8(system: &mut System) -> Outcome<Vec<NodeId>> {
    let field = system.fields.iter().position(|field| field.name == "g1").ok_or("there is no g1")?;
    let mut value = system.outputs[0].1;
    for _ in 0..8 {
        value = system.lie_derivative(field, value);
    }
    Ok(system.differential(value))
}
