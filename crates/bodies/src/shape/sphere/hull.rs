//! The convex hull of points in space, by exact signs: the algorithm of C. Barber, D. Dobkin and H. Huhdanpaa, The quickhull algorithm for convex hulls,
//! ACM Transactions on Mathematical Software 22, 1996.
//!
//! Facets are triangles; where more than three points lie in one plane they are several in that plane. A facet is visible only from strictly beyond it, so that
//! no facet is ever a line. A point is beyond a facet where the determinant of the point and the facet's corners, counterclockwise, is positive. [`Hull::is_proved`] looks at the result without knowing how it was found.
//!
//! Why no crate: hulls in doubles of nearly coplanar contacts do not always pass that look, and half-spaces are points whose quotients no double holds.

use super::side::{Point, about, side, sign_of_whole, whole};
use dashu::integer::IBig;
use std::cmp::Ordering;
use std::collections::{HashMap, HashSet};

/// The facets of a convex hull: places in the list of points, counterclockwise as seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Hull {
    pub facets: Vec<[usize; 3]>,
}

/// Why points have no hull with a volume: all of them are combinations of three rows, points among them as far as these are independent.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Flat {
    pub rows: [Point; 3],
}

struct Facet {
    corners: [usize; 3],
    /// Beyond the edges from corner 0 to 1, 1 to 2, 2 to 0.
    neighbours: [usize; 3],
    /// Points strictly beyond it that no other facet has.
    beyond: Vec<usize>,
    gone: bool,
}

impl Hull {
    /// The hull of finite homogeneous points.
    ///
    /// # Errors
    /// Where all of them lie in one plane.
    pub fn of(points: &[Point]) -> Result<Hull, Flat> {
        let start = simplex(points)?;
        let mut facets: Vec<Facet> = Vec::new();
        for skip in 0..4 {
            let [a, b, c] = [1, 2, 3].map(|i| start[(skip + i) % 4]);
            // the fourth one is inside
            let inside = side([&points[start[skip]], &points[a], &points[b], &points[c]]) == Ordering::Less;
            let corners = if inside { [a, b, c] } else { [a, c, b] };
            facets.push(Facet { corners, neighbours: [0; 3], beyond: Vec::new(), gone: false });
        }
        let edges: HashMap<(usize, usize), usize> = facets
            .iter()
            .enumerate()
            .flat_map(|(k, f)| edges(f.corners).map(move |edge| (edge, k)))
            .collect();
        for facet in &mut facets {
            facet.neighbours = edges_of(facet.corners).map(|(from, to)| edges[&(to, from)]);
        }
        let all: Vec<usize> = (0..points.len()).filter(|i| !start.contains(i)).collect();
        share_out(points, &mut facets, 0, all);

        let mut open: Vec<usize> = (0..4).collect();
        while let Some(place) = open.pop() {
            if facets[place].gone {
                continue;
            }
            let [a, b, c] = facets[place].corners.map(|i| &points[i]);
            let distance = |i: &usize| about([&points[*i], a, b, c]) / points[*i][3];
            let farthest =
                facets[place].beyond.iter().copied().max_by(|i, j| distance(i).total_cmp(&distance(j)));
            let Some(point) = farthest else { continue };
            let first = facets.len();
            let left = attach(points, &mut facets, place, point);
            share_out(points, &mut facets, first, left);
            open.extend(first..facets.len());
        }
        let facets = facets.into_iter().filter(|facet| !facet.gone).map(|facet| facet.corners).collect();
        Ok(Hull { facets })
    }

    /// Whether these facets are the surface of the hull of these points: no point is beyond any of them, exactly; each edge is passed once in either
    /// direction; and a ray from inside, through the middle of the first facet, passes no other, so that the surface goes round once (K. Mehlhorn et al., Checking geometric
    /// programs, Computational Geometry 12, 1999).
    pub fn is_proved(&self, points: &[Point]) -> bool {
        let mut passed = HashSet::new();
        for facet in &self.facets {
            let [a, b, c] = facet.map(|i| &points[i]);
            if points.iter().any(|point| side([point, a, b, c]) == Ordering::Greater) {
                return false;
            }
            if !edges_of(*facet).into_iter().all(|edge| passed.insert(edge)) {
                return false;
            }
        }
        if self.facets.is_empty() || passed.iter().any(|(from, to)| !passed.contains(&(*to, *from))) {
            return false;
        }
        let exact: Vec<[IBig; 4]> = points.iter().map(whole).collect();
        let sum = |places: &mut dyn Iterator<Item = usize>| -> [IBig; 4] {
            places.fold(std::array::from_fn(|_| IBig::ZERO), |mut sum, i| {
                sum.iter_mut().zip(&exact[i]).for_each(|(sum, value)| *sum += value);
                sum
            })
        };
        let inside = sum(&mut self.facets.iter().flatten().copied());
        let through = sum(&mut self.facets[0].into_iter());
        let sign =
            |a: &[IBig; 4], i: usize, j: usize, d: &[IBig; 4]| sign_of_whole([a, &exact[i], &exact[j], d]);
        self.facets.iter().enumerate().all(|(k, facet)| {
            let [a, b, c] = *facet;
            // strictly outward of what is inside
            let outward = sign_of_whole([&inside, &exact[a], &exact[b], &exact[c]]) == Ordering::Less;
            let passed =
                edges_of(*facet).into_iter().all(|(i, j)| sign(&inside, i, j, &through) != Ordering::Greater);
            outward && (passed == (k == 0))
        })
    }
}

fn edges_of([a, b, c]: [usize; 3]) -> [(usize, usize); 3] {
    [(a, b), (b, c), (c, a)]
}

fn edges(corners: [usize; 3]) -> impl Iterator<Item = (usize, usize)> {
    edges_of(corners).into_iter()
}

/// Four points that are not in one plane.
fn simplex(points: &[Point]) -> Result<[usize; 4], Flat> {
    // units beside the points that were found: a sign other than zero for some of them is independence
    let units: [Point; 4] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let mut found: Vec<usize> = Vec::new();
    let mut filled: Vec<Point> = units.to_vec();
    for (place, point) in points.iter().enumerate() {
        // a row of units is exchanged for the point where the rows stay independent
        for slot in found.len()..4 {
            let mut rows: [&Point; 4] = std::array::from_fn(|i| &filled[i]);
            rows[slot] = point;
            if side(rows) != Ordering::Equal {
                filled[slot] = *point;
                filled.swap(slot, found.len());
                found.push(place);
                break;
            }
        }
        if let [a, b, c, d] = found[..] {
            return Ok([a, b, c, d]);
        }
    }
    Err(Flat { rows: [filled[0], filled[1], filled[2]] })
}

/// Gives points to facets from a place on that they are strictly beyond; the rest are inside.
fn share_out(points: &[Point], facets: &mut [Facet], first: usize, left: Vec<usize>) {
    for point in left {
        let sees = |facet: &&mut Facet| {
            let [a, b, c] = facet.corners.map(|i| &points[i]);
            side([&points[point], a, b, c]) == Ordering::Greater
        };
        if let Some(facet) = facets[first..].iter_mut().find(sees) {
            facet.beyond.push(point);
        }
    }
}

/// Takes away the facets that a point is strictly beyond, one of which is given, and puts a cone from it in their place. Returned are the
/// points that those had.
fn attach(points: &[Point], facets: &mut Vec<Facet>, from: usize, point: usize) -> Vec<usize> {
    let mut left = Vec::new();
    let mut rim: Vec<([usize; 2], usize)> = Vec::new();
    let mut seen = vec![from];
    let mut known: HashMap<usize, bool> = HashMap::from([(from, true)]);
    while let Some(place) = seen.pop() {
        facets[place].gone = true;
        left.append(&mut facets[place].beyond);
        let Facet { corners, neighbours, .. } = facets[place];
        for ((start, end), neighbour) in edges(corners).zip(neighbours) {
            let sees = match known.get(&neighbour) {
                Some(sees) => *sees,
                None => {
                    let [a, b, c] = facets[neighbour].corners.map(|i| &points[i]);
                    let sees = side([&points[point], a, b, c]) == Ordering::Greater;
                    known.insert(neighbour, sees);
                    if sees {
                        seen.push(neighbour);
                    }
                    sees
                }
            };
            if !sees {
                rim.push(([start, end], neighbour));
            }
        }
    }
    left.retain(|i| *i != point);
    let first = facets.len();
    let begins: HashMap<usize, usize> = (first..).zip(&rim).map(|(k, ([start, _], _))| (*start, k)).collect();
    let ends: HashMap<usize, usize> = (first..).zip(&rim).map(|(k, ([_, end], _))| (*end, k)).collect();
    for (place, ([start, end], neighbour)) in (first..).zip(rim) {
        let across = edges_of(facets[neighbour].corners).iter().position(|edge| *edge == (end, start));
        if let Some(across) = across {
            facets[neighbour].neighbours[across] = place;
        }
        facets.push(Facet {
            corners: [start, end, point],
            neighbours: [neighbour, begins[&end], ends[&start]],
            beyond: Vec::new(),
            gone: false,
        });
    }
    left
}
