//! The same of entries, by what newcomers wrote: each mistake is refused with the advice for it.

use palmistry::System;
use std::path::Path;

/// A right file, to which entries are added.
const RIGHT: &str = "system \"s\"\nstate x, y\nparam k = 2\nparam a, b unknown\nknown u(t)\ndrift f\n  x' = y + u\n  y' = -k*x - a*y + b\noutput x\n";

/// A right file, of which parts are replaced.
const PENDULUM: &str = "system \"s\"\nstate phi, omega\nparam k = 2\nangle phi\ndrift f\n  phi' = omega\n  omega' = -k*sin(phi)\noutput phi\n";

/// An entry at the end of the file, and words of the advice.
#[rustfmt::skip]
const ENTRIES: &[(&str, &str)] = &[
    ("claim 1 rank = 3", "a claim has a name of one word and a colon, as in claim energy_balance: ..."),
    ("claim : rank = 4", "a claim has a name and a colon, as in claim 1: rank = 3"),
    ("claim: rank = 4", "a claim has a name and a colon, as in claim 1: rank = 3"),
    ("claim 1: rank is 4", "write '=', as in rank = 4"),
    ("claim 1: rank(f) = 4", "a field stands first in L(f, x) and bracket(f, g)"),
    ("claim 1: rank(x, y) = 2", "as in rank([d(x)"),
    ("claim 1: rank f = 4", "the rank of the system is rank = 4, that of a matrix rank([d(x)"),
    ("claim 1: rank = -1", "as in rank = 3 or solutions(a) = 1"),
    ("claim 1: rank != 3", "a rank that is not 3 is smaller, rank < 3, or greater, rank > 3"),
    ("claim 1: rank = 4 at {x = 0}", "a sum is taken at a point in brackets, as in (x + 3) at {x = 2}"),
    ("claim 1: rank = 4 when x = 0", "conditions stand behind 'where', as in rank = 4 where x = 0"),
    ("claim 1: rank = 4 for x != 0", "a claim is about all states: leave it out"),
    ("claim 1: rank = 4 for all x", "a claim is about all states: leave it out"),
    ("claim 1: rank = 4 except when x = 0", "conditions stand behind 'where', as in rank = 4 where x = 0"),
    ("claim 1: rank = 4 almost everywhere", "a rank is the generic one, without a word for it"),
    ("claim 1: rank = 4 generically", "a rank is the generic one, without a word for it"),
    ("claim 1: rank = 4 on sample", "leave 'on sample' out: it stands behind a comparison of numbers, as in x^2 >="),
    ("claim 1: rank = 4 where x ~= 0", "unequal is written '!=', as in x != 0"),
    ("claim 1: rank = 4 where x <> 0", "unequal is written '!=', as in x != 0"),
    ("claim 1: rank = 4 where x = 0 || y = 0", "of several statements each is a claim of its own"),
    ("claim 1: rank = 4 where {x = 0}", "conditions stand without brackets, as in where x = 0, y = 0"),
    ("claim 1: rank = 4 where (x = 0)", "each equation by itself, as in x = 0, y = 0"),
    ("claim 1: rank = 4 where x = y = 0", "each equation by itself, as in x = 0, y = 0"),
    ("claim 1: rank = 4 where x, y = 0", "each condition has its own two sides, as in where x = 0, y = 0"),
    ("claim 1: rank = 4, where x = 0", "leave ',' out before 'where'"),
    ("claim 1: full rank", "full rank is the number of unknowns, as in rank = 3"),
    ("claim 1: observable", "the unknowns stand in brackets, as in observable(x, y)"),
    ("claim 1: observable(all)", "name the unknowns, as in observable(x, y)"),
    ("claim 1: not observable(x)", "what is not so is written unobservable(x), unidentifiable(a) or x != 0"),
    ("claim 1: not identifiable(a)", "what is not so is written unobservable(x), unidentifiable(a) or x != 0"),
    ("claim 1: isobservable(x)", "it is called 'observable', as in observable(x, y)"),
    ("claim 1: Observable(x)", "it is called 'observable', as in observable(x, y)"),
    ("claim 1: identifiable(k)", "what is to be identified is declared as 'param k unknown'"),
    ("claim 1: observable(k)", "what is to be identified is declared as 'param k unknown'"),
    ("claim 1: observable(f)", "a field stands first in L(f, x) and bracket(f, g)"),
    ("claim 1: controllable(x)", "accessibility is decided by 'palmistry rank --accessible'"),
    ("claim 1: detectable(x)", "stability and detectability are no statements of the language"),
    ("claim 1: stable", "stability and detectability are no statements of the language"),
    ("claim 1: nonidentifiable(a)", "write unidentifiable(a)"),
    ("claim 1: globally identifiable(a)", "globally identifiable is written solutions(a) = 1"),
    ("claim 1: locally observable(x)", "a statement is a local and generic one, without a word for it, as in"),
    ("claim 1: solutions(a) = \u{221e}", "it is called 'infinity'"),
    ("claim 1: L_f x = y + u", "a Lie derivative is written L(f, x), the second one L(f, f, x)"),
    ("claim 1: L(f)(x) = y + u", "a Lie derivative is written L(f, x), the second one L(f, f, x)"),
    ("claim 1: L(x, f) = y + u", "the field stands first, as in L(f, x)"),
    ("claim 1: f(x) = y + u", "'f' is a field: its component of x is the Lie derivative L(f, x)"),
    ("claim 1: d(x)/d(y) = 0", "matrices have fitting numbers of rows and columns, as in [a"),
    ("claim 1: diff(x^2, x) = 2*x", "a differential is written d(e, x), the row of all derivatives d(e), a"),
    ("claim 1: \u{2202}x/\u{2202}y = 0", "a differential is written d(e, x), the row of all derivatives d(e), a"),
    ("claim 1: d(x) = [1, 0]", "a row d(e) has an entry for each unknown: x, y, a, b"),
    ("claim 1: ad(f, f) = 0", "the Lie bracket is written bracket(f, g)"),
    ("claim 1: det([1 2; 3 4]) = -2", "entries of a row and the ends of a range have ',' between them, rows of a"),
    ("claim 1: det([[1, 2], [3, 4]]) = -2", "rows have ';' between them, as in [a, b"),
    ("claim 1: det(Matrix([[1,2],[3,4]])) = -2", "rows have ';' between them, as in [a, b"),
    ("claim 1: det([1, 2; 3]) = 2", "all rows have as many entries, as in [a, b"),
    ("claim 1: [1, 2; 3, 4]' = [1, 3; 2, 4]", "a transpose is written transpose(M)"),
    ("claim 1: [1, 2; 3, 4]^T = [1, 3; 2, 4]", "numbers stand in lists, as in output x, y, or with a name of their own"),
    ("claim 1: [1, 2; 3, 4]^-1 = [1, 3; 2, 4]", "an inverse is written inverse(M), a product M*M, a transpose transpose(M)"),
    ("claim 1: [1, 2; 3, 4]^2 = [7, 10; 15, 22]", "an inverse is written inverse(M), a product M*M, a transpose transpose(M)"),
    ("claim 1: inv([1, 2; 3, 4]) = [-2, 1; 3/2, -1/2]", "an inverse is written inverse(M)"),
    ("claim 1: [1, 2; 3, 4].*[1, 2; 3, 4] = 0", "write '*', '/' and '^' without the dot"),
    ("claim 1: trace([1, 2; 3, 4]) = 5", "there is no such function of matrices: write the matrix, as in [1, 0"),
    ("claim 1: eye(2) = [1, 0; 0, 1]", "there is no such function of matrices: write the matrix, as in [1, 0"),
    ("claim 1: {1, 2} = {1, 2}", "brackets are ( and )"),
    ("claim 1: (1, 2) = (1, 2)", "a matrix has square brackets, as in [1, 2]"),
    ("claim 1: [1, 2] = [1; 2]", "both sides have as many rows and columns, as in [x"),
    ("claim 1: [x; y] = 0", "both sides have as many rows and columns, as in [x"),
    ("claim 1: [1, 2] + 1 = [2, 3]", "matrices have fitting numbers of rows and columns, as in [a"),
    ("claim 1: sqrt(2) \u{2248} 1.414", "write '=': approximately is said by 'within', as in x = 2 within 0.1"),
    ("claim 1: sqrt(2) ~ 1.414", "write '=': approximately is said by 'within', as in x = 2 within 0.1"),
    ("claim 1: sqrt(2) = 1.414 within 1%", "a percentage is written as a fraction, as in 0.5 for 50%"),
    ("claim 1: x > 0 implies x^2 > 0", "what is implied is the claim, and its conditions stand behind 'where', as in"),
    ("claim 1: x in [0, infinity]", "there is no infinite number: a bound on one side is x >= 0"),
    ("claim 1: x^2 >= 0 on samples", "write 'on sample' behind a comparison of numbers"),
    ("claim 1: x^2 >= 0 in sample", "write 'on sample', or conditions behind 'where', as in rank = 4 where x in"),
    ("claim 1: \u{2200}x: x^2 >= 0", "a claim is about all states and values for which its terms exist: leave it out"),
    ("claim 1: \u{2203}x: x = 0", "a claim is about all states and values for which its terms exist: leave it out"),
    ("claim 1: exists x: x = 0", "a claim is about all states and values for which its terms exist: leave"),
    ("claim 1: x is real", "a statement has two sides, as in x = 0: all numbers are real"),
    ("claim 1: x = y iff y = x", "what is implied is the claim, and its conditions stand behind 'where', as in"),
    ("claim 1: x \u{2261} x", "an equation has one '=', as in x = y"),
    ("claim 1: x^2 - x^2", "a statement has two sides, as in x = 0, or is one like observable(x)"),
    ("claim 1: \"x is fine\"", "words stand in an entry of their own, as in definition 1: \"...\" or undecided"),
    ("claim 1: x = x remark", "a remark is a text in double quotation marks, as in claim 1: x = x \"remark\""),
    ("claim 1: x = x \"a\" \"b\"", "a remark is one text in double quotation marks, without such marks inside"),
    ("claim 1: x = x 'remark'", "a remark stands in double quotation marks"),
    ("claim a b: x = x", "a claim has a name of one word and a colon, as in claim energy_balance: ..."),
    ("claim \"a\": x = x", "a name of a claim has letters, digits, '.', '_' and '-', as in energy_balance"),
    ("claim (4.17): x = x", "a name of a claim has letters, digits, '.', '_' and '-', as in energy_balance"),
    ("claim a: x = x\nclaim a: y = y", "each claim has its own number or name"),
    ("claim a: x = x, y = y", "each statement is a claim of its own, with its own name"),
    ("claim a: x = y = x", "an equation has one '=' and stands without brackets, as in x = y"),
    ("prove x = x", "it is called 'claim', as in claim 1: rank = 2"),
    ("proof a: x = x", "it is called 'claim', as in claim 1: rank = 2"),
    ("claim a expect false: x = y", "the verdict stands behind 'expect', as in claim a expect refuted: x = y"),
    ("claim a expects refuted: x = y", "it is called 'expect', as in claim a expect refuted: x = y"),
    ("claim a expected refuted: x = y", "it is called 'expect', as in claim a expect refuted: x = y"),
    ("claim a: expect refuted x = y", "the verdict stands behind the name, as in claim a expect refuted: x = y"),
    ("claim a: x = y expect refuted", "the verdict stands behind the name, as in claim a expect refuted: x = y"),
    ("claim a refuted: x = y", "the verdict stands behind 'expect', as in claim a expect refuted: x = y"),
    ("claim a: x at {x: 1} = 1", "the value at a point is written x at {x = 1, y = 2}"),
    ("claim a: x at {x = 1; y = 2} = 1", "the value at a point is written x at {x = 1, y = 2}"),
    ("claim a: rank(O(2)) = 4", "the rank of the system is rank = 4, of its first Lie derivatives"),
    ("claim a: det(codistribution(3)) != 0", "a row d(e) has an entry for each unknown: x, y, a, b"),
    ("claim a: codistribution(1)[1,1] = 1", "an entry of a matrix has no name: it is [1, 0]*M*[1"),
    ("sample x [0,1]", "a range is written x in [0, 1], each symbol with its own, as in sample x in"),
    ("sample x in [0 1]", "the ends of a range have ',' between them, as in [0, 1]"),
    ("sample x in [0; 1]", "the ends of a range have ',' between them, as in [0, 1]"),
    ("sample x in [0..1]", "a range is written x in [0, 1], each symbol with its own, as in sample x in"),
    ("sample x in [0, 1)", "a range is written x in [0, 1], with square brackets and a ','"),
    ("sample x in {0, 1}", "a range has square brackets, as in x in [0, 1]"),
    ("sample x in [1, 0]", "the low end comes first, as in [0, 1]"),
    ("sample x in [0,5, 1,5]", "a range has two ends, as in [0, 1]"),
    ("sample x ~ U(0,1)", "a range is written x in [0, 1], as in sample x in [0, 1]"),
    ("sample z in [0, 1]", "declare it above: 'state z' or 'param z'"),
    ("sample x in [0,1]\nsample x in [0,2]", "leave one of the two out"),
    ("sample x in [0,1] avoid x != 0", "'avoid' has expressions that keep away from zero, with ',' between them, as"),
    ("sample x in [0,1] avoid x < 0", "'avoid' has expressions that keep away from zero, with ',' between them, as"),
    ("avoid x", "ranges stand behind 'sample', as in sample x in [0, 1] avoid x - 1"),
    ("sample x in [0,1] except x", "points are left out with 'avoid', as in sample x in [0, 1] avoid x - 1"),
    ("sample x in [0:0.1:1]", "a range is written x in [0, 1], with square brackets and a ','"),
    ("sample x \u{2208} [0, 1]", "a range is written with 'in', as in x in [0, 1]"),
    ("sample x in [0 m, 1 m]", "numbers have no units here: leave it out"),
    ("sample x in [0, 1]; y in [0, 1]", "ranges stand one behind the other, as in sample x in [0, 1], y in [0, 2]"),
    ("range x in [0,1]", "ranges stand behind 'sample', as in sample x in [0, 1] avoid x - 1"),
    ("assume k is positive", "what is assumed is an inequality, as in assume k > 0"),
    ("assume k positive", "what is assumed is an inequality, as in assume k > 0"),
    ("assume k > 0; a > 0", "assumptions stand with ',' between them, as in assume k > 0, a > 0"),
    ("assume k \u{2208} \u{211d}", "a range is written with 'in', as in x in [0, 1]"),
    ("assume k > 0, k < 0\nclaim 1: 1 = 2", "give the constants other values, or leave their values out"),
    ("assume k > 0 where x > 0", "each assumption holds by itself, as in assume k > 0, a > 0"),
    ("assumption k > 0", "what is assumed is an entry of its own, as in assume k > 0, a > 0"),
    ("assume \"k is positive\"", "a remark here is a comment: # ..."),
    ("assume k >> 1", "write '<' or '>' once: nothing is much greater here"),
    ("assume |k| < 1", "an absolute value is written abs(x), as in abs(omega)"),
    ("require k > 0", "what is assumed is an entry of its own, as in assume k > 0, a > 0"),
    ("assume k > 0 \"gravity\"", "a remark here is a comment: # ..."),
    ("initial x := 1", "write '=' alone"),
    ("initial k = 1", "a constant has neither a rate nor an initial condition, but a value, as in"),
    ("initial u = 1", "leave it out"),
    ("initial x, y = 0, 1", "each state has its own value, as in initial x = 1, y = 2"),
    ("initial (x, y) = (0, 1)", "names stand without brackets, with ',' between them, as in initial x, y"),
    ("initial [x; y] = [0; 1]", "names stand without brackets, with ',' between them, as in initial x, y"),
    ("initial state x = 1", "the name stands behind 'initial', as in initial x = 1, y known"),
    ("initial condition x = 1", "the name stands behind 'initial', as in initial x = 1, y known"),
    ("initial x = 1 known", "a value is known: leave 'known' out, as in initial x = 1"),
    ("init x = 1", "it is called 'initial', as in initial x = 1, y known"),
    ("ic x = 1", "it is called 'initial', as in initial x = 1, y known"),
    ("experiments: 2", "leave ':' out, as in experiments 2"),
    ("known u", "a signal is one of time, as in known u(t)"),
    ("known u, v(t)", "a signal is one of time, as in known u(t)"),
    ("known v(t) = sin(t)", "declare it above the field 'f', in front of line 6: move this line up"),
    ("known v(t) order 2", "of a known signal as many derivatives are taken as the file mentions"),
    ("signal v(t)", "a signal is declared as in known u(t) or unknown w(t)"),
    ("input v(t)", "a signal that drives the system is declared, as in known v(t)"),
    ("disturbance w(t)", "a signal is declared as in known u(t) or unknown w(t)"),
    ("known v(t), v(t)", "declare it above the field 'f', in front of line 6: move this line up"),
    ("known x(t)", "choose another name, or leave one of the two out"),
    ("input g = [1; 0]", "a field has a rate for each state below its name, as in input g  x' = ..."),
    ("input u in [0,1]", "a field has a name, and below it a rate for each state, as in input f  x' = v"),
    ("known input v(t)", "the names of signals stand behind the word, as in known u(t)"),
    ("measured v(t)", "an output is written 'output', as in output x"),
    ("param p[1..3] = [1,2,3]", "numbers stand in lists, as in output x, y, or with a name of their own"),
    ("param p[1..3] = 1, 2, 3", "each constant has its own value, as in param k = 2, m = 3"),
    ("let e x^2", "a definition is one expression of a name, as in let e = x^2"),
    ("let e(x) = x^2", "functions are not defined: a definition is one expression of a name, as in"),
    ("let e(x, y) = x + y\nclaim 1: e(1, 2) = 3", "functions are not defined: a definition is one expression of a name, as in"),
    ("let e = x^2 where k = 1", "a definition has no condition: write the value in its place, as in e at {k ="),
    ("let x = y", "choose another name, or leave one of the two out"),
    ("let e = x, g = y", "each definition is an entry of its own, as in let e = x^2"),
    ("let e = x = y", "each definition is an entry of its own, as in let e = x^2"),
    ("let 2e = x", "a name begins with a letter, as in x1"),
    ("let e = {x, y}", "brackets are ( and )"),
    ("e := x^2", "an abbreviation is written let e = ..."),
    ("define e = x^2", "it is called 'let', as in let e = x^2: a definition is one expression, and no"),
    ("function e(x) = x^2", "it is called 'let', as in let e = x^2: a definition is one expression, and no"),
    ("let e = \"text\"", "numbers stand without quotation marks"),
    ("let e =", "a definition is one expression of a name, as in let e = x^2"),
    ("let M = [x y; y x]", "entries of a row and the ends of a range have ',' between them, rows of a"),
    ("erratum 1: printed x = y corrected x = x follows 2", "'follows' stands behind the name, as in erratum 2 follows 1 at \"page 57\": ..."),
    ("erratum 1: printed y = x + y corrected \"x = x\"", "here stands a statement without quotation marks, as in x = y"),
    ("erratum: printed x = y corrected x = x", "the entry has a name, as in erratum 1: ..."),
    ("typo 1: printed x = y corrected x = x", "it is called 'erratum', as in erratum 1: printed x = y corrected x = x"),
    ("misprint 1: printed x = y corrected x = x", "it is called 'erratum', as in erratum 1: printed x = y corrected x = x"),
    ("definition 1: x", "the words stand in quotation marks, as in definition 1: \"text\""),
    ("definition 1: text here", "the words stand in quotation marks, as in definition 1: \"text\""),
    ("definition: \"text\"", "the entry has a name, as in definition 1: ..."),
    ("set \"rest\": x = 0; y = 0", "conditions stand with ',' between them, as in set \"rest\": x = 0, y = 0"),
    ("set \"rest\": {x = 0}", "conditions stand without brackets, as in set \"rest\": x = 0, y = 0"),
    ("set \"a\": x = 0\nset \"a\": y = 0", "choose another title"),
    ("map \"m\": x in [0,1], y in [0,1] of z", "declare it above: 'state z' or 'param z'"),
    ("map \"m\": x in [0,1], y in [0,1] where a = 1", "values of other symbols stand in braces, as in map \"title\": x in [0, 1], y in"),
    ("map \"m\": x in [0,1], y in [0,1] with a = 1", "values of other symbols stand in braces, as in map \"title\": x in [0, 1], y in"),
    ("map \"m\": x in [0,1], x in [0,1]", "a map has two, as in x in [0, 1], y in [0, 2]"),
    ("map \"m\": x in [1,0], y in [0,1]", "the low end comes first, as in [0, 1]"),
    ("simulate x", "simulations stand in a scene ('palmistry observe'): leave it out"),
    ("from base import f", "it is called 'use', as in use p = \"other.proof\""),
    ("title \"x\"", "a file begins with its title, as in system \"a pendulum\""),
    ("cite \"x\"", "a source stands behind the title, as in system \"a pendulum\" cite \"a textbook\""),
    ("author \"x\"", "a source stands behind the title, as in system \"a pendulum\" cite \"a textbook\""),
    ("angle x : degree", "angles are in radians: leave it out, as in angle x"),
    ("angle x in degrees", "angles are in radians: leave it out, as in angle x"),
    ("degrees x", "angles are in radians, as in angle x"),
    ("end", "an entry ends by itself: leave 'end' out"),
    ("end system", "an entry ends by itself: leave 'end' out"),
    ("/* claims */", "a comment begins with '#'"),
    ("! claims", "a comment begins with '#'"),
    ("drift", "a field has a name, and below it a rate for each state, as in drift f  x' = v"),
    ("field w = [1; 0]", "a field has a rate for each state below its name, as in field w  x' = ..."),
    ("vector field w", "it is called 'field', as in field g, and a rate for each state below it"),
    ("solver rk4", "simulations stand in a scene ('palmistry observe'): leave it out"),
    ("experiments 2\nclaim a: k@2 = k", "the state in the second experiment is k@2, below 'experiments 2'"),
];

/// A rate of change in the place of `-k*sin(phi)`, and words of the advice.
#[rustfmt::skip]
const RATES: &[(&str, &str)] = &[
    ("k*(sin(phi)", "a bracket is open: each '(' needs its ')'"),
    ("k.*sin(phi)", "write '*', '/' and '^' without the dot"),
    ("sin[phi]", "a function has round brackets, as in sin(phi)"),
    ("Sin[phi]", "a function has round brackets, as in sin(phi)"),
    ("sin{phi}", "a function has its argument in brackets at once, as in sin(x)^2"),
    ("exp^phi", "a function has its argument in brackets at once, as in exp(x)^2"),
    ("cbrt(phi)", "a root is a power, as in x^(1/3)"),
    ("root(phi,3)", "a root is a power, as in x^(1/3)"),
    ("(sin phi)^2", "a function has its argument in brackets, as in sin(phi)"),
    ("angle(phi)", "'angle' is a word of the language: choose another name, as in angle_1"),
    ("arg(phi)", "the angle of the point (x, y) is atan2(y, x)"),
    ("\u{2016}phi\u{2016}", "a norm is written sqrt(dot(v, v))"),
    ("norm(phi)", "a norm is written sqrt(dot(v, v))"),
    ("sat(phi)", "limits are written max(0, min(1, x))"),
    ("saturate(phi)", "limits are written max(0, min(1, x))"),
    ("erf(phi)", "there is no such function"),
    ("gamma(phi)", "there is no such function"),
    ("integral(phi)", "an integral is a state of its own, as in z' = x"),
    ("int(phi,t)", "an integral is a state of its own, as in z' = x"),
    ("phi \u{f7} omega", "a quotient is written with '/'"),
    ("phi : omega", "a rate has the dimension of its state over time: leave it out"),
    ("phi\u{207b}\u{b9}", "a power is written with '^', as in x^2 or x^(-1)"),
    ("sin(30\u{b0})", "angles are in radians: write sin(x*pi/180)"),
    ("sin(30 deg)", "a product is written with '*'"),
    ("phi\u{b0}", "angles are in radians: write sin(x*pi/180)"),
    ("phi*", "something is missing behind the sign '*'"),
    ("1.5.2", "a number has one decimal point, as in 1.5"),
    ("1,000*phi", "a decimal point is written '.', as in 0.5"),
    ("\u{bd}*phi", "write 1/2"),
    ("1/0", "write what it is to be: all numbers are real and finite"),
    ("phi/0", "write what it is to be: all numbers are real and finite"),
    ("phi ? 1 : 2", "there is no 'if': write max(a, b), min(a, b), abs(a) or sign(a), or a claim"),
    ("phi > 0", "a comparison is no number, and there is no 'if': write max(a, b), min(a, b),"),
    ("(phi > 0)*omega", "a comparison is no number, and there is no 'if': write max(a, b), min(a, b),"),
    ("piecewise((1,phi>0),(2,True))", "brackets hold one expression: a matrix is written [a"),
    ("prod(phi)", "it is called 'product', as in product(i in 1..3, x[i])"),
    ("$k$", "formulas stand without '$'"),
    ("$k*phi$", "formulas stand without '$'"),
    ("...", "a formula goes on in the next line by itself: leave '...' out"),
    ("phi + ...\n  omega", "a formula goes on in the next line by itself: leave '...' out"),
    ("phi\u{ff0b}omega", "type it with the plain keyboard: letters and signs of full width are others"),
    ("\u{ff4b}", "type it with the plain keyboard: letters and signs of full width are others"),
    ("\u{3c6}\u{307}", "this character belongs to no name: names have the letters a-z, Greek letters,"),
];

/// A part of the file, what stands in its place, and words of the advice.
#[rustfmt::skip]
const PARTS: &[(&str, &str, &str)] = &[
    ("state phi, omega", "state x, in", "'in' is a word of the language: choose another name, as in in_1"),
    ("state phi, omega", "state phi, omega, at", "'at' is a word of the language: choose another name, as in at_1"),
    ("state phi, omega", "state phi, omega, output", "'output' is a word of the language: choose another name, as in output_1"),
    ("state phi, omega", "state 1x, phi, omega", "a name begins with a letter, as in x1"),
    ("state phi, omega", "state phi, omega, x-y", "a name has letters, digits and '_', as in x_y"),
    ("state phi, omega", "state phi; omega", "names stand with ',' between them, as in state x, y"),
    ("state phi, omega", "state phi [rad], omega [rad/s]", "a unit stands behind a colon, as in state x : m"),
    ("state phi, omega", "state phi in rad, omega", "a range is an entry of its own, as in sample phi in [0, 1]"),
    ("state phi, omega", "state phi in [0,1], omega", "a range is an entry of its own, as in sample phi in [0, 1]"),
    ("state phi, omega", "STATE phi, omega", "perhaps you meant 'state'"),
    ("state phi, omega", "state phi, omega known", "a known initial condition is an entry of its own, as in initial omega known"),
    ("state phi, omega", "state phi, omega unknown", "a known initial condition is an entry of its own, as in initial omega known"),
    ("state phi, omega", "variables phi, omega", "it is called 'state', as in state x, y"),
    ("state phi, omega", "Real phi, omega", "it is called 'state', as in state x, y"),
    ("state phi, omega", "state phi, omega, x[1:3]", "a component of a vector is written x[3], a range of them x[1..3]"),
    ("state phi, omega", "state phi, omega, \u{1e8b}", "this character belongs to no name: names have the letters a-z, Greek letters,"),
    ("state phi, omega", "state phi, omega, x\u{2081}", "an index is written x_1, or x[1] for the component of a vector"),
    ("state phi, omega", "state phi, omega, \\theta", "write functions and Greek letters without the backslash, as in sin(phi)"),
    ("state phi, omega", "state phi, omega, x1..x3", "a vector is declared by its range, as in state x[1..3]"),
    ("state phi, omega", "state phi, omega, \"x\"", "names stand without quotation marks"),
    ("drift f\n  phi' = omega\n  omega' = -k*sin(phi)", "drift phi' = omega omega' = -k*sin(phi)", "a field has a name: write drift f, and the rates below it"),
    ("drift f", "drift", "a field has a name: write drift f, and the rates below it"),
    ("drift f\n  phi' = omega\n  omega' = -k*sin(phi)", "drift f { phi' = omega omega' = -k*sin(phi) }", "a field has no brackets: leave '{' and '}' out"),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  phi'(t) = omega\n  omega'(t) = -k*sin(phi)", "a rate is written without (t), as in x' = ..."),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  der(phi) = omega\n  der(omega) = -k*sin(phi)", "a rate of change is written with a prime, as in phi' = ..."),
    ("  phi' = omega", "  diff(phi,t) = omega", "a rate of change is written with a prime, as in phi' = ..."),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  phi' ~ omega", "write '='"),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  phi'=omega omega'=-k*sin(phi) phi'=0", "leave one of the two out"),
    ("  omega' = -k*sin(phi)", "  k*omega' = -sin(phi)", "a rate stands alone on the left, as in omega' = ..."),
    ("  omega' = -k*sin(phi)", "  omega' + k*sin(phi) = 0", "a rate stands alone on the left, as in omega' = ..."),
    ("  omega' = -k*sin(phi)", "  other' = 0", "perhaps you meant 'others'"),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  phi(t+1) = omega\n  omega(t+1) = phi", "the value after one step is written phi+ = ..."),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  phi[k+1] = omega[k]\n  omega[k+1] = phi[k]", "the value after one step is written phi+ = ..."),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  phi += omega\n  omega += phi", "'+=' adds elsewhere: the value after a step is phi+ = v, and what adds v is"),
    ("  phi' = omega\n  omega' = -k*sin(phi)", "  phi+ = phi+1\n  omega+ = phi+", "something is missing behind the sign '+'"),
    ("drift f\n  phi' = omega\n  omega' = -k*sin(phi)", "drift f  phi' = omega  omega' = -k*sin(phi) : 1/s^2", "a rate has the dimension of its state over time: leave it out"),
    ("param k = 2", "param k = 2 \u{b1} 0.1", "a value is one number: a tolerance stands behind 'within', a range in an"),
    ("param k = 2", "param k = 2 +- 0.1", "a value is one number: a tolerance stands behind 'within', a range in an"),
    ("param k = 2", "param k = 2d-3", "an exponent is written with 'e', as in 2e-3"),
    ("param k = 2", "param k = 1_000", "a number is written in decimal digits without separators, as in 1000"),
    ("param k = 2", "param k = 1.000,5", "a decimal point is written '.', as in 0.5"),
    ("param k = 2", "param k = 2 m/s", "a unit stands behind a colon, as in param k = 2 : m/s"),
    ("param k = 2", "param 0 < k < 1", "what is assumed is an inequality in an entry of its own, as in assume k > 0"),
    ("param k = 2", "param k positive", "what is assumed is an inequality in an entry of its own, as in assume k > 0"),
    ("param k = 2", "param real k = 2", "a constant has no type: leave 'real' out"),
    ("param k = 2", "param double k = 2", "a constant has no type: leave 'double' out"),
    ("param k = 2", "param k = ?", "a constant without a value is declared as in param k unknown"),
    ("param k = 2", "param k unknown = 2", "the value stands before the word, as in param k = 2 unknown"),
    ("param k = 2", "param k = 2 unkown", "perhaps you meant 'unknown'"),
    ("param k = 2", "param unknown k", "without ',' before it, it says that the constant is unknown, as in param a"),
    ("param k = 2", "unknown param k", "the word stands behind the name, as in param k unknown"),
    ("param k = 2", "known param k = 2", "the word stands behind the name, as in param k known"),
    ("param k = 2", "param k known = 2", "the value stands before the word, as in param k = 2 known"),
    ("param k = 2", "param k, m = 2, 3", "each constant has its own value, as in param k = 2, m = 3"),
    ("param k = 2", "param k = 2; m = 3", "constants stand with ',' between them, as in param k = 2, m = 3"),
    ("param k = 2", "param k = 2i", "there are no complex numbers"),
    ("param k = 2", "param k = \"2\"", "numbers stand without quotation marks"),
    ("param k = 2", "param k = 0x10", "a number is written in decimal digits without separators, as in 1000"),
    ("param k = 2", "param k = 50%", "a percentage is written as a fraction, as in 0.5 for 50%"),
    ("output phi", "output h(x)", "functions are not defined: an expression has a name by let h = ..., and is"),
    ("output phi", "output h(phi)", "functions are not defined: an expression has a name by let h = ..., and is"),
    ("output phi", "output phi; omega", "outputs stand with ',' between them, as in output x, y"),
    ("output phi", "output (phi, omega)", "outputs stand without brackets, with ',' between them, as in output x, y"),
    ("output phi", "output {phi, omega}", "outputs stand without brackets, with ',' between them, as in output x, y"),
    ("output phi", "output phi as y", "an output is an expression: name it by a definition, as in let y = x^2, and"),
    ("output phi", "output phi [rad]", "a dimension stands behind a colon, as in output x : rad"),
    ("output phi", "output phi @ 10 Hz", "when it is measured stands in a scene, as in rate = 10"),
    ("output phi", "output phi every 0.1", "when it is measured stands in a scene, as in rate = 10"),
    ("output phi", "output g(phi) = phi", "functions are not defined: an expression has a name by let g = ..., and is"),
    ("output phi", "output phi known", "an output is what is measured: leave 'known' out"),
];

/// An entry at the end of the file, followed by another one, and the line and column of what is wrong with it.
const PLACES: [(&str, (usize, usize)); 9] = [
    ("known v", (10, 8)),
    ("param c, in", (10, 10)),
    ("let e = k*(x + y", (10, 17)),
    ("let e = x*", (10, 11)),
    ("claim a: stable", (10, 16)),
    ("claim a: observable(x,)", (10, 23)),
    ("param c known unknown", (10, 15)),
    ("initial x,", (10, 10)),
    ("assume k > 0, > 1 # so", (10, 15)),
];

/// What is wrong first in a file, as `check` says it.
fn first_problem(text: &str) -> Option<palmistry::ReadError> {
    System::examine_text("s.proof", text, Path::new(""), 100).problems.into_iter().next()
}

#[test]
fn mistakes_in_entries_have_their_advice() {
    assert!(first_problem(RIGHT).is_none() && first_problem(PENDULUM).is_none());
    let added = ENTRIES.iter().map(|(entry, advice)| (*entry, format!("{RIGHT}{entry}\n"), *advice));
    let rates =
        RATES.iter().map(|(rate, advice)| (*rate, PENDULUM.replacen("-k*sin(phi)", rate, 1), *advice));
    let parts =
        PARTS.iter().map(|(right, wrong, advice)| (*wrong, PENDULUM.replacen(right, wrong, 1), *advice));
    let mut unlike = Vec::new();
    for (mistake, text, advice) in added.chain(rates).chain(parts) {
        match first_problem(&text) {
            None => unlike.push(format!("{mistake}: is none")),
            Some(error) if error.help.as_ref().is_some_and(|help| help.contains(advice)) => {}
            Some(error) => unlike.push(format!("{mistake}: {}, {:?}", error.message, error.help)),
        }
    }
    assert!(unlike.is_empty(), "{}", unlike.join("\n"));
}

/// What is missing at the end of an entry is missed there, and not where the next one begins.
#[test]
fn mistakes_are_shown_where_they_are() {
    for (entry, place) in PLACES {
        let text = format!("{RIGHT}{entry}\nclaim 1: x = x\n");
        let error = first_problem(&text).unwrap_or_else(|| panic!("{entry}"));
        assert_eq!(error.line_and_column(), place, "{entry}: {}", error.message);
    }
}

/// What was accepted with another meaning than the one it was written with.
#[test]
fn mistakes_with_another_meaning_are_refused() {
    let refused = [
        ("claim a: x = 2 +- 0.1", "one sign"),
        ("claim a: rank = -1", "never negative"),
        ("claim a: solutions(x) in [1, 2]", "compared with one number"),
        ("claim a: observable(1)", "is a number"),
        ("claim a: observable(k)", "made of known constants"),
        ("claim a: rank = 4 at {x = 0}", "'at' belongs to the number before it"),
        ("claim a: rank([[x, 0], [0, y]]) = 1", "rows have ';' between them"),
        ("claim a: rank([1 -2; 3 -4]) = 2", "',' or ']'"),
        ("claim a: rank = 3 within 1", "are exact"),
        ("assume k > 3", "do not meet k > 3"),
        ("assume a > 0, a < 0", "no value of 'a'"),
        ("let codistribution = 2", "a word of the language"),
        ("param everywhere", "a word of the language"),
    ];
    for (entry, message) in refused {
        let error = first_problem(&format!("{RIGHT}{entry}\n")).unwrap_or_else(|| panic!("{entry}"));
        let said = format!("{} {}", error.message, error.help.unwrap_or_default());
        assert!(said.contains(message), "{entry}: {said}");
    }
    for rate in ["1/0", "phi/0", "phi/(2 - 2)", "sin(phi + 1/0)", "0/0", "sqrt(-1)", "log(0)*phi", "asin(2)"]
    {
        let error =
            first_problem(&PENDULUM.replacen("-k*sin(phi)", rate, 1)).unwrap_or_else(|| panic!("{rate}"));
        assert!(error.message.contains("has a value in no state"), "{rate}: {}", error.message);
    }
    // what is written with names exists nowhere, and the claims say so
    for rate in ["phi/(k - k)", "(phi - (0))*k", "0*(phi - (1 - 1))"] {
        let named = first_problem(&PENDULUM.replacen("-k*sin(phi)", rate, 1));
        assert!(named.is_none(), "{named:?}");
    }
    // a matrix in a product is no number
    let product = "let M = [x, u; u, x; 1, x]\noutput [1, 0, 0]*M*[1; 0]";
    let read = first_problem(&format!("{RIGHT}{product}\n"));
    assert!(read.is_none(), "{read:?}");
    let text = format!("{RIGHT}claim a: rank = infinity\n");
    let infinite = System::examine_text("s.proof", &text, Path::new(""), 100).problems;
    assert_eq!(infinite.len(), 1, "{infinite:?}");
    // and what means what it says is read
    for entry in [
        "claim a: x = 2+-0.1",
        "let e = 1 + -2",
        "let e = (3) at {x = 0}",
        "assume k > 1, a > 0, a < 1",
        "output u",
        "let e = [2]^2",
        "param t, w : 1",
    ] {
        let error = first_problem(&format!("{RIGHT}{entry}\n"));
        assert!(error.is_none(), "{entry}: {error:?}");
    }
}
