//! Our side of `benches/compare`: one job on given states, in the protocol of `benches/peers/worker.py`.
//!
//! `ours VARIANT JOB STATES RESULTS` (VARIANT: `computed`, or `certified` for verdicts that are proved)
//! prepares (from the text of the proof file to a program that is ready to run), says
//! `prepared SECONDS`, and obeys the lines `run` and `write` on standard input.

use palmistry::System;
use palmistry::expression::{BlockProgram, Input, NodeId, expand_angles, gradient};
use palmistry::observability::{Locus, lie_derivative_by_series, solve_conditions};
use palmistry::sweep::{Certainty, StateVerdict, Stream, Verdicts};
use palmistry::system::Value;
use std::collections::BTreeMap;
use std::io::{BufRead, Write};
use std::path::Path;
use std::time::{Duration, Instant};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

/// What is evaluated over and over before a time is given.
const ENOUGH: Duration = Duration::from_millis(20);

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let [variant, job, states, results] = arguments.as_slice() else {
        println!("this is one of the workers of benches/compare; run that");
        return Ok(());
    };
    let states: Vec<f64> =
        std::fs::read(states)?.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();

    let begin = Instant::now();
    let mut work = Work::prepare(variant, job, &states)?;
    println!("prepared {}", begin.elapsed().as_secs_f64());
    work.evaluate()?;

    for line in std::io::stdin().lock().lines() {
        match line?.trim() {
            "run" => {
                let (mut count, begin) = (0, Instant::now());
                while begin.elapsed() < ENOUGH {
                    work.evaluate()?;
                    count += 1;
                }
                println!("took {}", begin.elapsed().as_secs_f64() / f64::from(count));
            }
            "write" => {
                let mut file = std::io::BufWriter::new(std::fs::File::create(results)?);
                for value in work.checkable() {
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
enum Work {
    /// Entries alone.
    Entries {
        program: BlockProgram,
        /// For every input of the program, its values at all states.
        inputs: Vec<Vec<f64>>,
        /// For every entry, its values at all states.
        entries: Vec<Vec<f64>>,
    },
    /// Entries and what they say of the rank: the engine of `palmistry rank`, at the states handed over.
    Verdicts { stream: Box<Stream>, inputs: Vec<Vec<f64>>, wanted: Certainty, found: Verdicts },
}

impl Work {
    fn prepare(variant: &str, job: &str, states: &[f64]) -> Outcome<Work> {
        let file = if job == "same_rate" { "same_rate.proof" } else { "general.proof" };
        let mut system =
            System::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(file))?;
        let order = system.states.clone();
        let dimension = order.len();
        let of = |symbol| -> Outcome<Vec<f64>> {
            let place = order.iter().position(|state| *state == symbol).ok_or("not a state")?;
            Ok(states.iter().skip(place).step_by(dimension).copied().collect())
        };
        let entries = match job {
            "order8" => order8(&mut system)?,
            "matrix" | "same_rate" => rows(&system)?[system.outputs.len() * dimension..].to_vec(),
            "block" | "whole" => {
                let rows = rows(&system)?;
                let branch = solve_conditions(&mut system, &[])?.remove(0);
                let locus = Locus::new(&mut system, &branch, &BTreeMap::new(), &rows)?;
                let stream = Stream::new(&mut system, &locus, &rows).ok_or("an angle outside of sines")?;
                let inputs = stream.coordinates().map(of).collect::<Outcome<_>>()?;
                let wanted = if variant == "certified" { Certainty::Certified } else { Certainty::Computed };
                return Ok(Work::Verdicts {
                    stream: Box::new(stream),
                    inputs,
                    wanted,
                    found: Verdicts::default(),
                });
            }
            _ => return Err(format!("there is no job '{job}'").into()),
        };
        let is_angle = &system.angle_test();
        let roots = expand_angles(&mut system.graph, &entries, is_angle);
        let default = |input| match input {
            Input::Plain(symbol) => system.symbol_info(symbol).and_then(|info| info.default.clone()),
            _ => None,
        };
        let program = BlockProgram::new(&system.graph, &roots, &[], |_| false, default);
        let mut inputs = Vec::new();
        for input in program.inputs() {
            let Input::Plain(symbol) = input else { return Err("sines are computed".into()) };
            inputs.push(of(*symbol)?);
        }
        let entries = vec![vec![0.0; states.len() / dimension]; roots.len()];
        Ok(Work::Entries { program, inputs, entries })
    }

    /// The entries, or the verdicts and singular values, of every state.
    fn evaluate(&mut self) -> Outcome<()> {
        match self {
            Work::Entries { program, inputs, entries } => {
                let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
                let mut entries: Vec<&mut [f64]> = entries.iter_mut().map(Vec::as_mut_slice).collect();
                if !program.evaluate(&inputs, &mut entries).is_empty() {
                    return Err("a value is not finite".into());
                }
            }
            Work::Verdicts { stream, inputs, wanted, found } => {
                let inputs: Vec<&[f64]> = inputs.iter().map(Vec::as_slice).collect();
                stream.verdicts(&inputs, *wanted, found)?;
                if found.verdicts.contains(&StateVerdict::NotFinite) {
                    return Err("a value is not finite".into());
                }
            }
        }
        Ok(())
    }

    /// The results, state by state: the entries, or by how much rows and columns were scaled and the singular values
    /// that are then found.
    fn checkable(&self) -> Vec<f64> {
        let arrays: Vec<&Vec<f64>> = match self {
            Work::Entries { entries, .. } => entries.iter().collect(),
            Work::Verdicts { found, .. } => {
                [&found.row_factors, &found.column_factors, &found.singular_values]
                    .into_iter()
                    .flatten()
                    .collect()
            }
        };
        let count = arrays.first().map_or(0, |array| array.len());
        (0..count).flat_map(|state| arrays.iter().map(move |array| array[state])).collect()
    }
}

/// The entries of the thesis's own rows; its first rows are the outputs.
fn rows(system: &System) -> Outcome<Vec<NodeId>> {
    match system.definition("rows") {
        Some(Value::Matrix(rows)) => Ok(rows.entries.clone()),
        _ => Err("there are no rows".into()),
    }
}

/// The gradient, by the reverse mode, of `L_g1` applied eight times to `s1`, by series.
fn order8(system: &mut System) -> Outcome<Vec<NodeId>> {
    let field = system.fields.iter().position(|field| field.name == "g1").ok_or("there is no g1")?;
    let output = system.outputs[0].1;
    let value =
        lie_derivative_by_series(system, &[field; 8], output).map_err(|failure| format!("{failure:?}"))?;
    let states = system.states.clone();
    Ok(gradient(&mut system.graph, value, &states))
}
