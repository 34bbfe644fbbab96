//! Our side of `benches/compare`: one job on given states, in the protocol of `benches/peers/worker.py`.
//!
//! `ours JOB STATES RESULTS` prepares (from the text of the proof file to a program that is ready to run), says
//! `prepared SECONDS`, and obeys the lines `run` and `write` on standard input.

use palmistry::System;
use palmistry::expression::{BlockProgram, Input, NodeId, expand_angles, gradient};
use palmistry::observability::{Reduction, equilibrate, lie_derivative_by_series, singular_values};
use palmistry::system::Value;
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
struct Work {
    program: BlockProgram,
    /// For every input of the program, its values at all states.
    inputs: Vec<Vec<f64>>,
    /// For every entry, its values at all states.
    entries: Vec<Vec<f64>>,
    /// For a verdict, the number of columns of what is left when the unit rows are eliminated, and the singular values,
    /// state by state.
    columns: Option<usize>,
    singular: Vec<f64>,
}

impl Work {
    fn prepare(job: &str, states: &[f64]) -> Outcome<Work> {
        let file = if job == "same_rate" { "same_rate.proof" } else { "general.proof" };
        let mut system =
            System::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("proofs/moll2002").join(file))?;
        let dimension = system.states.len();
        let mut columns = None;
        let entries = match job {
            "order8" => order8(&mut system)?,
            "matrix" | "same_rate" => rows(&system)?[system.outputs.len() * dimension..].to_vec(),
            "block" | "whole" => {
                let reduction = Reduction::new(&system.graph, &rows(&system)?, dimension);
                columns = Some(reduction.columns.len());
                reduction.entries
            }
            _ => return Err(format!("there is no job '{job}'").into()),
        };
        let angles = system.angles();
        let roots = expand_angles(&mut system.graph, &entries, |symbol| angles.contains(&symbol));
        let default = |input| match input {
            Input::Plain(symbol) => system.symbol_info(symbol).and_then(|info| info.default.clone()),
            _ => None,
        };
        let program = BlockProgram::new(&system.graph, &roots, &[], |_| false, default);
        let mut inputs = Vec::new();
        for input in program.inputs() {
            let Input::Plain(symbol) = input else { return Err("sines are computed".into()) };
            let place = system.states.iter().position(|state| state == symbol).ok_or("not a state")?;
            inputs.push(states.iter().skip(place).step_by(dimension).copied().collect());
        }
        let count = states.len() / dimension;
        let entries = vec![vec![0.0; count]; roots.len()];
        Ok(Work { program, inputs, entries, columns, singular: Vec::new() })
    }

    /// The entries, and for a verdict the singular values, of every state.
    fn evaluate(&mut self) -> Outcome<()> {
        let inputs: Vec<&[f64]> = self.inputs.iter().map(Vec::as_slice).collect();
        let mut entries: Vec<&mut [f64]> = self.entries.iter_mut().map(Vec::as_mut_slice).collect();
        if !self.program.evaluate(&inputs, &mut entries).is_empty() {
            return Err("a value is not finite".into());
        }
        if let Some(columns) = self.columns {
            self.singular.clear();
            for state in 0..self.entries[0].len() {
                let matrix = self.at(state);
                let spectrum = singular_values(&matrix, &vec![0.0; matrix.len()], columns);
                self.singular.extend(spectrum.ok_or("a value is not finite")?.values);
            }
        }
        Ok(())
    }

    /// The entries of one state.
    fn at(&self, state: usize) -> Vec<f64> {
        self.entries.iter().map(|values| values[state]).collect()
    }

    /// The results, and for a verdict with each state's singular values the scaled matrix whose they are.
    fn checkable(&self) -> Vec<f64> {
        let mut all = Vec::new();
        for state in 0..self.entries[0].len() {
            let mut entries = self.at(state);
            if let Some(columns) = self.columns {
                let mut errors = vec![0.0; entries.len()];
                equilibrate(&mut entries, &mut errors, columns);
                entries.extend(&self.singular[state * columns..][..columns]);
            }
            all.extend(entries);
        }
        all
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
