//! Simulated values and parameters as the tables of a PEtab problem.

use super::JointObserved;
use palmistry_fit::SimulatedExperiments;
use std::fmt::Write;

/// A cell of a table: no tab or end of line in it.
fn cell(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// The simulation at the best parameters, else at the nominal ones, as a table of PEtab; none where nothing could be simulated.
pub fn joint_simulation(observed: &JointObserved<'_>) -> Option<String> {
    let simulated: &SimulatedExperiments = match (&observed.answer.fit, &observed.answer.nominal) {
        (Some(Ok(fit)), _) => &fit.simulated,
        (_, Some(nominal)) => nominal.simulated.as_ref().ok()?,
        _ => return None,
    };
    let problem = observed.experiments.problem();
    let mut out =
        "observableId\tpreequilibrationConditionId\tsimulationConditionId\ttime\tsimulation\n".to_owned();
    for (row, one) in problem.measurements.iter().enumerate() {
        let name = &problem.experiments[one.experiment].name;
        let (condition, before) = name.split_once(" after ").unwrap_or((name, ""));
        let time = if one.time.is_infinite() { "inf".to_owned() } else { format!("{:?}", one.time) };
        let _ = writeln!(
            out,
            "{}\t{}\t{}\t{time}\t{:?}",
            cell(&one.output),
            cell(before),
            cell(condition),
            simulated.expected[row]
        );
    }
    Some(out)
}

/// The parameters with the best values as nominal ones, as a table of PEtab; none where nothing was found.
pub fn joint_parameters(observed: &JointObserved<'_>) -> Option<String> {
    let Some(Ok(fit)) = &observed.answer.fit else { return None };
    let problem = observed.experiments.problem();
    let mut out = "parameterId\tparameterScale\tlowerBound\tupperBound\tnominalValue\testimate\n".to_owned();
    for (one, value) in problem.parameters.iter().zip(problem.values(&fit.best().found)) {
        let scale = match one.scale {
            palmistry_fit::ParameterScale::Linear => "lin",
            palmistry_fit::ParameterScale::Log => "log",
            palmistry_fit::ParameterScale::Log10 => "log10",
        };
        let [low, high] = one.bounds;
        let _ = writeln!(out, "{}\t{scale}\t{low:?}\t{high:?}\t{value:?}\t1", cell(&one.name));
    }
    Some(out)
}
