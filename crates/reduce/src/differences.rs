//! What an expression changes by where some of its parts change, written so that nothing cancels.

use palmistry_math::expression::{Graph, Node, NodeId};
use palmistry_math::number::Function;
use std::collections::HashMap;

/// The difference of higher powers is taken as it is.
const HIGHEST: i32 = 8;

/// What an operation is with all summands, less what it is without some: by the differences of its operands, so that nothing cancels.
pub(crate) fn difference(
    graph: &mut Graph,
    node: Node,
    image: &HashMap<NodeId, [NodeId; 3]>,
    [whole, smaller]: [NodeId; 2],
) -> NodeId {
    match node {
        Node::Constant(_) | Node::Pi | Node::Symbol(_) => graph.integer(0),
        Node::Add(a, b) => graph.add(image[&a][2], image[&b][2]),
        Node::Sub(a, b) => graph.sub(image[&a][2], image[&b][2]),
        Node::Neg(a) => graph.neg(image[&a][2]),
        Node::Mul(a, b) => {
            let ([_, less, by_a], [more, _, by_b]) = (image[&a], image[&b]);
            let (left, right) = (graph.mul(by_a, more), graph.mul(less, by_b));
            graph.add(left, right)
        }
        Node::Div(a, b) => {
            // a/b - a'/b' = ((a - a') b' - a' (b - b')) / (b b')
            let ([_, above, by_a], [more, less, by_b]) = (image[&a], image[&b]);
            let (left, right) = (graph.mul(by_a, less), graph.mul(above, by_b));
            let (above, below) = (graph.sub(left, right), graph.mul(more, less));
            graph.div(above, below)
        }
        Node::Power(_, power) if power.abs() > HIGHEST => graph.sub(whole, smaller),
        Node::Power(a, power) => {
            // a^n - a'^n = (a - a') (a^(n-1) + a^(n-2) a' + ... + a'^(n-1)), and for a negative power with the sign and the divisors of 1/a^n - 1/a'^n
            let [more, less, by] = image[&a];
            let degree = power.unsigned_abs() as i32;
            let terms: Vec<NodeId> = (0..degree)
                .map(|i| {
                    let (left, right) = (graph.power(more, degree - 1 - i), graph.power(less, i));
                    graph.mul(left, right)
                })
                .collect();
            let sum = graph.sum(terms);
            let found = graph.mul(by, sum);
            if power > 0 {
                return found;
            }
            let product = graph.mul(more, less);
            let below = graph.power(product, degree);
            let found = graph.div(found, below);
            graph.neg(found)
        }
        Node::Apply(function, a) => {
            let [more, less, by] = image[&a];
            let two = graph.integer(2);
            match function {
                Function::Sqrt => {
                    let below = graph.add(whole, smaller);
                    graph.div(by, below)
                }
                Function::Log => {
                    let (part, one) = (graph.div(by, less), graph.integer(1));
                    let inner = graph.add(one, part);
                    graph.apply(Function::Log, inner)
                }
                Function::Sin | Function::Cos => {
                    let (sum, half) = (graph.add(more, less), graph.div(by, two));
                    let mean = graph.div(sum, two);
                    let other = if function == Function::Sin { Function::Cos } else { Function::Sin };
                    let (of_mean, of_half) = (graph.apply(other, mean), graph.apply(Function::Sin, half));
                    let product = graph.mul(of_mean, of_half);
                    let found = graph.mul(two, product);
                    if function == Function::Sin { found } else { graph.neg(found) }
                }
                Function::Exp => {
                    let (grown, one) = (graph.apply(Function::Exp, by), graph.integer(1));
                    let part = graph.sub(grown, one);
                    graph.mul(smaller, part)
                }
                Function::Asin | Function::Acos | Function::Atan => graph.sub(whole, smaller),
            }
        }
    }
}
