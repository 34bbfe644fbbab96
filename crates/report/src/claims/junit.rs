//! Outcomes of claims as JUnit XML.

use crate::claims::text::claim_text;
use crate::layout::Layout;
use palmistry_io::foreign::shown;
use palmistry_prove::claim::Outcome;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

/// Outcomes as JUnit XML: a suite a file, a case a claim.
///
/// # Errors
/// Where the XML cannot be built.
pub fn junit(outcomes: &[Outcome]) -> miette::Result<String> {
    let mut report = Report::new("palmistry prove");
    let mut suites: Vec<TestSuite> = Vec::new();
    for outcome in outcomes {
        let status = if outcome.ok {
            TestCaseStatus::success()
        } else {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(format!("{} instead of {}", outcome.word(), outcome.expected_word()));
            status.set_description(claim_text(outcome, &Layout::default()));
            status
        };
        let mut case = TestCase::new(outcome.id.as_str(), status);
        case.set_classname(&*shown(&outcome.file));
        case.set_time(std::time::Duration::from_secs_f64(outcome.seconds));
        // attributes that continuous integration shows beside the name of a case
        let (line, column) = outcome.place;
        let place = [
            ("file", shown(&outcome.file).into_owned()),
            ("line", line.to_string()),
            ("column", column.to_string()),
        ];
        case.extra.extend(place.map(|(name, value)| (name.into(), value.into())));
        case.add_property(("statement", outcome.statement.as_str()));
        if let Some((printed, _)) = &outcome.printed {
            case.add_property(("printed", printed.as_str()));
        }
        match suites.last_mut() {
            Some(suite) if suite.name.as_str() == shown(&outcome.file) => {
                suite.add_test_case(case);
            }
            _ => {
                let mut suite = TestSuite::new(&*shown(&outcome.file));
                suite.add_test_case(case);
                suites.push(suite);
            }
        }
    }
    report.add_test_suites(suites);
    report.to_string().map_err(|error| miette::miette!("the JUnit report could not be written: {error}"))
}
