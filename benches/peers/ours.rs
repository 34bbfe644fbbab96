//! Our side of `benches/compare`: one job on given states, in the protocol of `benches/peers/worker.py`.
//!
//! `ours JOB STATES RESULTS` prepares (from the text of the proof file to a program that is ready to run), says `prepared SECONDS`,
//! and obeys the lines `run` and `write` on standard input.

use palmistry::System;
use palmistry::expression::{NodeId, Program, Symbol, expand_angles, gradient};
use palmistry::number::Floats;
use palmistry::observability::{
    Reduction, equilibrate, float_inputs, lie_derivative_by_series, singular_values,
};
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
                for value in work.checkable()? {
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
    /// Where the program's symbols have their values from.
    symbols: HashMap<Symbol, Source>,
    states: Vec<f64>,
    dimension: usize,
    /// For a verdict, the shape of what is left when the unit rows are eliminated.
    columns: Option<usize>,
    results: Vec<f64>,
}

#[derive(Clone, Copy)]
enum Source {
    State(usize),
    Parameter(f64),
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
        Ok(Work { program, symbols, states: states.to_vec(), dimension, columns, results: Vec::new() })
    }

    /// Fills `results`: the entries, or for a verdict the singular values, of every state.
    fn evaluate(&mut self) -> Outcome<()> {
        let mut results = std::mem::take(&mut self.results);
        results.clear();
        self.each(|entries, columns| {
            match columns {
                None => results.extend(entries),
                Some(columns) => {
                    let spectrum = singular_values(&entries, &vec![0.0; entries.len()], columns);
                    results.extend(spectrum.ok_or("a value is not finite")?.values);
                }
            }
            Ok(())
        })?;
        self.results = results;
        Ok(())
    }

    /// The results, and for a verdict with each state's singular values the scaled matrix whose they are.
    fn checkable(&self) -> Outcome<Vec<f64>> {
        let Some(columns) = self.columns else { return Ok(self.results.clone()) };
        let mut all = Vec::new();
        let mut singular = self.results.chunks_exact(columns);
        self.each(|mut entries, _| {
            equilibrate(&mut entries, &mut [0.0; 16], columns);
            all.extend(entries);
            all.extend(singular.next().ok_or("singular values are missing")?);
            Ok(())
        })?;
        Ok(all)
    }

    /// Hands over the entries state by state.
    fn each(&self, mut take: impl FnMut(Vec<f64>, Option<usize>) -> Outcome<()>) -> Outcome<()> {
        let loaded = self.program.load(Floats).map_err(|refusal| format!("{refusal:?}"))?;
        let mut registers = Vec::new();
        for state in self.states.chunks_exact(self.dimension) {
            let inputs = float_inputs(&self.program, |symbol| match self.symbols[&symbol] {
                Source::State(place) => state[place],
                Source::Parameter(value) => value,
            });
            take(
                loaded.run(&inputs, &mut registers).map_err(|failure| format!("{failure:?}"))?,
                self.columns,
            )?;
        }
        Ok(())
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
