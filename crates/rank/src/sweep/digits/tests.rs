use super::*;

/// A matrix of rationals, given by numerators.
struct Fixed(Vec<Vec<RBig>>);

impl Matrices for Fixed {
    fn entries<A: Arithmetic + Copy>(&self, on: A) -> Result<Vec<Vec<A::Number>>, NoEntries> {
        let row = |row: &Vec<RBig>| row.iter().map(|entry| on.rational(entry)).collect();
        self.0.iter().map(row).collect::<Result<_, _>>().map_err(NoEntries::Refused)
    }
}

fn integers<const N: usize>(rows: &[[i64; N]]) -> Fixed {
    Fixed(rows.iter().map(|row| row.map(RBig::from).to_vec()).collect())
}

/// mpmath 1.3, mp.dps = 70: rows and columns scaled to length one in turn, four thousand times, then `svd_r`.
#[test]
fn digits_are_those_of_the_limit_of_scaling() {
    let found = digits_of(&integers(&[[1, 2, 3], [4, -5, 7], [8, 1, 6]]), 40, Certainty::Certified).unwrap();
    assert_eq!(
        found.values,
        [
            "1.366838253730106604723275916206370216091",
            "0.9973557373965795551327966757220668837358",
            "0.3701820109380759200656853153428474805734"
        ]
    );
    assert_eq!(found.condition, "3.692341100709919235347155813511582841515");
    assert_eq!((found.certainty, found.number_type), (Certainty::Certified, NumberType::Enclosures(204)));
    // more rows than columns
    let found = digits_of(&integers(&[[1, 2], [3, 5], [7, -11]]), 40, Certainty::Certified).unwrap();
    assert_eq!(
        found.values,
        ["1.153865027398659042314633725285263322824", "0.8176768912879290962558399071029221865942"]
    );
    assert_eq!(found.condition, "1.411150345194661736797962478017954915039");
}

/// Squares of [4 1; 1 1] become [4/5 1/5; 1/5 4/5], as `x/(1 - x) = |a d|/|b c|`; the matrix of the roots is symmetric with
/// eigenvalues `3/sqrt(5)` and `1/sqrt(5)`, and its condition is 3.
#[test]
fn two_by_two_in_closed_form_by_the_cheapest_numbers() {
    let matrix = integers(&[[4, 1], [1, 1]]);
    for (digits, wanted, certainty, number_type, climbed) in [
        (12, Certainty::Computed, Certainty::Computed, NumberType::DoubleDoubles, 0),
        (12, Certainty::Certified, Certainty::Certified, NumberType::Intervals, 0),
        (30, Certainty::Computed, Certainty::Certified, NumberType::Enclosures(169), 0),
        (30, Certainty::Certified, Certainty::Certified, NumberType::Enclosures(169), 0),
    ] {
        let found = digits_of(&matrix, digits, wanted).unwrap();
        assert_eq!(
            (found.certainty, found.number_type, found.climbed),
            (certainty, number_type, climbed),
            "{digits}"
        );
        let root = parse("1.341640786499873817845504201238765741264");
        assert_eq!(found.values[0], round_to_decimal(&root, digits)); // mpmath
        assert_eq!(found.values[1], round_to_decimal(&(root / RBig::from(3)), digits));
        assert_eq!(found.condition.parse::<f64>(), Ok(3.0));
    }
    // what doubles cannot fix is escalated: fifteen digits are too many for intervals of doubles
    let found = digits_of(&matrix, 15, Certainty::Certified).unwrap();
    assert_eq!((found.number_type, found.climbed), (NumberType::Enclosures(116), 1));
}

fn parse(text: &str) -> RBig {
    palmistry_math::number::parse_decimal(text).unwrap()
}

/// A rotation by atan(4/3), in other units: both singular values are one.
#[test]
fn equal_singular_values_come_out_equal_whatever_the_units() {
    let (a, b) = (RBig::from(7), parse("1e-9"));
    let entry = |numerator: i64, row: &RBig, column: &RBig| {
        RBig::from(numerator) / RBig::from(5) * row.clone() * column.clone()
    };
    let (p, q) = (parse("3.15e13"), parse("1/3"));
    let matrix =
        Fixed(vec![vec![entry(3, &a, &p), entry(-4, &a, &q)], vec![entry(4, &b, &p), entry(3, &b, &q)]]);
    let found = digits_of(&matrix, 25, Certainty::Certified).unwrap();
    assert_eq!(found.condition.parse::<f64>(), Ok(1.0));
    assert!(found.values.iter().all(|value| value.parse() == Ok(1.0)), "{found:?}");
}

/// Parts that have nothing to do with each other, rows of zeros between: each is scaled by itself.
#[test]
fn parts_are_scaled_one_by_one() {
    let matrix = integers(&[[4, 0, 1], [0, 0, 0], [0, 9, 0], [1, 0, 1]]);
    let found = digits_of(&matrix, 20, Certainty::Certified).unwrap();
    let values: Vec<f64> = found.values.iter().map(|value| value.parse().unwrap()).collect();
    let root = 5f64.sqrt();
    assert!((values[0] - 3.0 / root).abs() < 1e-15 && (values[2] - 1.0 / root).abs() < 1e-15, "{values:?}");
    assert_eq!(values[1], 1.0);
}

#[test]
fn what_cannot_be_had_says_why() {
    // a triangular matrix has no equilibrium: its corner would have to vanish
    let found = digits_of(&integers(&[[1, 1], [0, 1]]), 20, Certainty::Certified);
    assert!(matches!(found, Err(NoDigits::NoEquilibrium | NoDigits::Refused { .. })), "{found:?}");
    // a column of zeros: there is no condition
    assert_eq!(digits_of(&integers(&[[1, 0], [2, 0]]), 5, Certainty::Computed), Err(NoDigits::NoEquilibrium));
    // rank one: the smallest singular value is zero, and has no significant digit
    assert!(matches!(
        digits_of(&integers(&[[1, 2], [2, 4]]), 5, Certainty::Certified),
        Err(NoDigits::Refused { .. })
    ));
}

/// Nothing remains where all rows are unit rows.
#[test]
fn nothing_has_the_condition_one() {
    let found = digits_of(&Fixed(Vec::new()), 5, Certainty::Certified).unwrap();
    assert_eq!((found.values.len(), found.condition.as_str()), (0, "1"));
}
