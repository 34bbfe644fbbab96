//! Every mistake is marked at its place, and none makes the reader panic.

use super::*;
use proptest::prelude::*;

#[test]
fn every_value_is_checked_and_its_place_marked() {
    let mut otherwise = Vec::new();
    for (from, to, message, marked, help) in [
        ("window = 60", "windw = 60", "unknown key 'windw'", "windw", "perhaps you meant 'window'"),
        ("mass = 1.0", "masse = 1.0", "unknown key 'masse'", "masse", "'mass'"),
        ("mean = 1.0", "meen = 1.0", "unknown key 'meen'", "meen", "'mean'"),
        ("phase = 0.2", "fase = 0.2", "unknown key 'fase'", "fase", "phase"),
        ("[sensor]", "[sensors]", "unknown key 'sensors'", "sensors", "'sensor'"),
        ("prior = 0.2", "priors = 0.2", "unknown key 'priors'", "priors", "'prior'"),
        ("\"newton\"", "\"newtons\"", "'newtons' is not known", "\"newtons\"", "'newton'"),
        ("\"harmonics\"", "\"ellips\"", "'ellips' is not known", "\"ellips\"", "'ellipse'"),
        ("\"hold\"", "\"stay\"", "'stay' is not known", "\"stay\"", "integrate, hold"),
        ("mass = 1.0", "mass = \"1 kg\"", "expected a number", "\"1 kg\"", "write mass = 1, in kg"),
        ("mass = 1.0", "mass = -1.0", "'mass' has to be positive, and is -1", "-1.0", "in kg"),
        ("mass = 1.0", "", "the key 'mass' is missing", "[body]", "mass = 1.0, in kg"),
        ("samples = 401", "samples = 1", "'samples' cannot be 1", "1", "from 2"),
        ("samples = 401", "samples = 2.5", "expected a whole number", "2.5", "as in samples = 401"),
        ("samples = 401", "samples = -3", "expected a whole number", "-3", "as in samples = 401"),
        ("samples = 401", "samples = 401\nrate = 9", "both 'samples' and 'rate'", "rate", "leave one out"),
        ("samples = 401", "", "without 'samples' or 'rate'", "duration", "samples = 400"),
        ("samples = 401", "rate = 0.1", "0.1 Hz", "0.1", "samples"),
        ("duration = 1.4", "duration = inf", "'duration' has to be positive, and is inf", "inf", "in s"),
        ("duration = 1.4", "", "without 'duration'", "samples", "duration = 1.4"),
        ("orientation = 0.3", "orientation = nan", "'orientation' is NaN", "nan", "finite"),
        ("[0.0, 0.1]", "[0.0, -inf]", "'centre_of_mass' is -inf", "-inf", "finite"),
        ("[0.0, 0.1]", "[0.0]", "expected", "[0.0]", "centre_of_mass is a list of length 2"),
        ("[0.02, -0.03]", "[0.02, nan]", "'harmonics' is NaN", "nan", "finite"),
        ("[0.5, 0.4]", "[0.5, 0]", "'inertia' has to be positive, and is 0", "0", "kg m^2"),
        (
            "[0.5, 0.4]",
            "[0.5, 0.4]\nradii = [4, 0.0]",
            "a palm cannot have the radius 0",
            "0.0",
            "inf for a flat one",
        ),
        ("[0.5, 0.4]", "[0.5, 0.4]\nradii = [nan, 4]", "the radius NaN", "nan", "above zero"),
        (
            "[0.5, 0.4]",
            "[0.5, 0.4]\nradii = 4.0",
            "expected",
            "4.0",
            "write a list of length 2, as in radii = [",
        ),
        ("frequency = 1.0", "frequency = 0.0", "'frequency' has to be positive", "0.0", "Hz"),
        ("{ start = 1.6 }", "{ start = 3.2 }", "do not form a V", "3.2", "between 0 and pi"),
        ("  { start = 1.6 },\n", "", "expected", "[\n", "prescribed is a list of length 2"),
        (
            "[sensor]",
            "torques = [{ angle = 1, torque = 1 }, { angle = 1, torque = 1 }]\n[sensor]",
            "both",
            "torques",
            "",
        ),
        ("noise = 1e-5", "noise = -1e-5", "'noise' must not be negative", "-1e-5", "in m"),
        // errors whose squares are no numbers would count as none
        ("noise = 1e-5", "noise = 1e-320", "square is beyond any number", "1e-320", "1e-150 to 1e150, in m"),
        ("noise = 1e-5", "noise = 1e-200", "'noise' is 1e-200", "1e-200", "zero where none is stated"),
        ("noise = 1e-5", "noise = 1e200", "'noise' is 1e200", "1e200", "1e-150 to 1e150"),
        ("resolution = 1e-4", "resolution = 1e-320", "square is beyond any number", "1e-320", "in m"),
        ("jitter = 0.001", "tau1 = { noise = 1e-320 }", "beyond any number", "1e-320", "unit of the column"),
        ("levels = [1e-5, 1e-4]", "levels = [1e-5, 1e-320]", "beyond any number", "1e-320", "in m"),
        ("jitter = 0.001", "jitter = 0.01", "jitter of 0.01 s is too much", "0.01", "at most 0.8"),
        ("jitter = 0.001", "jiter = 0.001", "unknown key 'jiter'", "jiter", "perhaps you meant 'jitter'"),
        ("jitter = 0.001", "tau1 = \"loud\"", "unknown key 'tau1'", "tau1", "known here"),
        ("jitter = 0.001", "tau1 = { nois = 1 }", "unknown key 'nois'", "nois", "perhaps you meant 'noise'"),
        (
            "jitter = 0.001",
            "tau1 = { noise = -1 }",
            "'noise' must not be negative",
            "-1",
            "unit of the column",
        ),
        ("jitter = 0.001", "tau1 = { gain = 0.0 }", "a gain of zero", "0.0", "not zero"),
        ("jitter = 0.001", "tau1 = { gain = \"x\" }", "expected a number", "\"x\"", "as in gain = "),
        ("jitter = 0.001", "tau1 = { bias = nan }", "'bias' is NaN", "nan", "finite"),
        ("jitter = 0.001", "s1 = { delay = 0.1 }", "a delay of 0.1 s is too much", "0.1", "at most 4 steps"),
        ("jitter = 0.001", "s1 = { delay = -0.1 }", "'delay' must not be negative", "-0.1", "in s"),
        ("spike = 6.0", "spike = 0", "'spike' has to be positive", "0", "usual departures"),
        ("on_fault = \"skip\"", "on_fault = 3", "expected", "3", ""),
        ("\"kalman\",", "\"newton\",", "'newton' is there twice", "\"newton\"", "leave one out"),
        ("\"r2\", \"omega0\"]", "\"r1\", \"omega0\"]", "'r1' is there twice", "\"r1\"", "leave one out"),
        ("clamp = [\"omega0\"]", "clamp = [\"omega\"]", "'omega' is not in 'estimate'", "clamp", "'omega0'"),
        (
            "clamp = [\"omega0\"]",
            "clamp = [\"r1\", \"r2\", \"omega0\"]",
            "all estimated states are clamped",
            "[",
            "",
        ),
        ("{ rho = 0.6 }", "{ r1 = 0.6 }", "'r1' is both known and estimated", "r1", "leave it out"),
        ("{ rho = 0.6 }", "{ rho = nan }", "'rho' is NaN", "nan", "finite"),
        ("r2 = 2.0, omega0 = 0 }", "omega0 = 0 }", "no first guess of 'r2'", "{ r1", "add r2"),
        ("omega0 = 0 }", "omega0 = 0, mass = 1 }", "'mass' is not in 'estimate'", "mass", "estimated: "),
        (
            "steps = 4",
            "steps = 4\nguess_off = 1",
            "both 'guess' and 'guess_off'",
            "guess_off",
            "leave one out",
        ),
        ("guess = {", "guess_off = 10 # {", "'guess_off' is a fraction", "10", "10 % is guess_off = 0.1"),
        ("window = 60", "window = 402", "'window' cannot be 402", "402", "from 2 to 401"),
        ("steps = 4", "steps = 0", "'steps' cannot be 0", "0", "from 1"),
        (
            "unobservable_above = 0.5",
            "unobservable_above = 0",
            "'unobservable_above' has to be positive",
            "0",
            "",
        ),
        ("gain = 30", "gain = -1", "'gain' has to be positive", "-1", "1/s"),
        ("levels = [1e-5, 1e-4]", "levels = []", "no level of noise", "[]", "in m"),
        (
            "levels = [1e-5, 1e-4]",
            "levels = [1e-5, nan]",
            "'levels' must not be negative, and is NaN",
            "nan",
            "",
        ),
        ("r1 = [0.5, 3.0]", "r1 = [3.0, 0.5]", "the range of 'r1' is empty", "[3.0, 0.5]", "least"),
        ("r1 = [0.5, 3.0]", "r3 = [0.5, 3.0]", "'r3' is not in 'estimate'", "r3", "'r1'"),
        ("points = 21", "points = 9999", "too many", "9999", "at most"),
        ("points = 21", "", "the key 'points' is missing", "[study.basin]", "points = 21"),
        (
            "title = \"Both palms turn at one constant rate\"",
            "title = \" \"",
            "title is empty",
            "\" \"",
            "in a line",
        ),
        (
            "title = \"Both palms turn at one constant rate\"\n",
            "",
            "the key 'title' is missing",
            "m",
            "title =",
        ),
        ("inertia = [0.5, 0.4]", "", "the key 'inertia' is missing", "[palms]", "kg m^2"),
        ("{ start = 1.6 }", "{ }", "the key 'start' is missing", "{ }", "in rad"),
        ("mean = 1.0, ", "", "the key 'mean' is missing", "{ kind", "in m"),
        ("mean = 1.0", "mean = true", "expected a number", "{ kind", "kind"),
        ("shape = {", "shape = 3 #", "expected", "3", "kind"),
        ("seed = 7", "seed = 7\nseed = 8", "duplicate", "seed", "TOML"),
        ("seed = 7", "seed = = 7", "", "=", "TOML"),
        ("[data]", "[data]\nrecord = \"a.csv\"", "both simulated and recorded", "record", "leave out"),
    ] {
        let (said, at, advice) = error(&with(from, to));
        if !(said.contains(message) && at.starts_with(marked) && advice.contains(help)) {
            otherwise.push(format!("{to}: {said}: marked {at:?}: {advice}"));
        }
    }
    assert!(otherwise.is_empty(), "{}", otherwise.join("\n"));
}

proptest! {
    /// A scene with something put in, taken out or written over is read or refused; what is marked lies in the text.
    #[test]
    fn no_change_makes_the_reader_panic(
        at in any::<prop::sample::Index>(),
        length in 0usize..12,
        put in "[0-9a-z=\\[\\]{}\".,\n# é-]{0,6}",
    ) {
        let floor = |mut at: usize| {
            while !WHOLE.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let from = floor(at.index(WHOLE.len()));
        let to = floor((from + length).min(WHOLE.len()));
        let text = format!("{}{put}{}", &WHOLE[..from], &WHOLE[to..]);
        if let Err(error) = Scene::parse("file.toml", &text) {
            prop_assert!(text.get(error.span.offset()..error.span.offset() + error.span.len()).is_some());
            prop_assert!(!error.message.is_empty());
        }
    }

    /// Whole lines in another order, twice, or not at all.
    #[test]
    fn no_order_of_lines_makes_the_reader_panic(
        lines in proptest::collection::vec(any::<prop::sample::Index>(), 0..60),
    ) {
        let all: Vec<&str> = WHOLE.lines().collect();
        let text: Vec<&str> = lines.iter().map(|line| all[line.index(all.len())]).collect();
        let _ = Scene::parse("file.toml", &text.join("\n"));
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in any::<String>()) {
        prop_assert!(Scene::parse("file.toml", &text).is_err());
    }
}
