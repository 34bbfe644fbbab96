//! Shape and motion as a batch estimate of all measurements: the support function whose equilibria fit the contacts best.
//!
//! At known palm angles the body lies where `G = A r_1' + B r_2'` vanishes and grows; of these poses the one is taken in which it lay at the last step of
//! the search. From there the contacts follow, and their derivatives by the coefficients `c` are exact: by the pose's, `d phi0/dc = (A b_1' + B b_2')/(A r_1'' + B r_2'')`
//! with the basis `b`, and by the coefficients' own. The turn of the body's frame is arbitrary; the search does not move it. Levenberg and Marquardt's steps by QR; the
//! inverse of the last normal matrix is the Cramér-Rao bound. Which orders are tried says `orders`.

use super::found::SlowShape;
use super::measurements::{Sampled, SlowMeasurements};
use super::outline::{OF_KINK, Outline};
use super::quadrature::SlowTrack;
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use palmistry_bodies::shape::{Measured, ShapeEstimate, SupportSeries, convex_deviation, deviation_of};
use std::f64::consts::{FRAC_PI_2, PI};

/// Steps for an order.
const STEPS: usize = 40;

/// The last step lowers the sum of squares by less than this fraction.
const SETTLED: f64 = 1e-6;

/// The standard deviation of exact measurements, relative to the mean contact.
const NOMINAL: f64 = 1e-13;

/// The order to which a shape with kinks is expanded.
const EXPANDED: usize = 200;

/// In one step no pose turns by more than this, in radians: it is another pose then.
const LARGEST_TURN: f64 = 0.5;

/// A point of the search.
#[derive(Clone)]
pub(super) struct Point {
    pub coefficients: Vec<f64>,
    pub phi0: Vec<f64>,
    /// The residuals of the contacts, in deviations, and of the convexity prior of the coefficients.
    pub left: DVector<f64>,
    pub cost: f64,
    stiffness: f64,
}

#[derive(Clone)]
pub(super) struct Together<'a> {
    sampled: Vec<Sampled>,
    angles: Vec<[f64; 2]>,
    pub measurements: &'a SlowMeasurements,
    pub sigma: f64,
    /// A mean radius as the unit of the convexity prior.
    pub size: f64,
    /// How many kinks of the curvature the coefficients end with.
    pub kinks: usize,
    /// Samples that are left out for now.
    pub passed_over: Vec<bool>,
    /// Where the potential has a prescribed slope.
    pub held: Vec<Held>,
}

/// A place at which the slope of the potential is prescribed for now, so that the body can lie there at a sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held {
    pub row: usize,
    pub phi0: f64,
    /// The slope and its standard deviation, in m.
    pub slope: f64,
    pub deviation: f64,
}

/// A radius at an angle against the orientation changes by the orientation with this sign.
fn sign_of(order: usize) -> f64 {
    if order % 2 == 1 { -1.0 } else { 1.0 }
}

/// Radius and its derivatives at both contacts.
pub(super) type Touched = [[f64; 4]; 2];

impl<'a> Together<'a> {
    pub fn of(measurements: &'a SlowMeasurements) -> Together<'a> {
        let angle = |p: &[f64; 2]| [p[0] - FRAC_PI_2, p[0] + p[1] - 3.0 * FRAC_PI_2];
        let scale = measurements.scale();
        Together {
            sampled: (0..measurements.rows()).map(|row| measurements.sampled(row)).collect(),
            angles: measurements.palms.iter().map(angle).collect(),
            measurements,
            sigma: measurements.sigma.max(NOMINAL * scale),
            size: scale,
            kinks: 0,
            passed_over: vec![false; measurements.rows()],
            held: Vec::new(),
        }
    }

    pub fn outline(&self, coefficients: &[f64]) -> Outline {
        Outline::of(coefficients, self.kinks)
    }

    pub fn touched(&self, row: usize, phi0: f64, series: &Outline) -> Touched {
        self.angles[row].map(|angle| series.support(angle - phi0))
    }

    /// The stable pose next to a given one, downhill, by Newton's steps while they stay near and halved brackets else.
    pub fn pose(&self, row: usize, start: f64, series: &Outline, farthest: f64) -> Option<(f64, f64)> {
        let (a, b) = (self.sampled[row].second[0], self.sampled[row].first[0]);
        let slope = |phi0: f64| {
            let [first, second] = self.touched(row, phi0, series);
            [-(a * first[1] + b * second[1]), a * first[2] + b * second[2]]
        };
        let mut here = slope(start);
        let mut phi0 = start;
        for _ in 0..6 {
            if here[1] <= 0.0 {
                break;
            }
            let step = here[0] / here[1];
            if step.abs() > 0.2 {
                break;
            }
            phi0 -= step;
            let next = slope(phi0);
            if step.abs() < 1e-15
                || (next[0] == 0.0 && next[1] > 0.0)
                || (step.abs() < 1e-11 && next[1] > 0.0)
            {
                return ((phi0 - start).abs() <= farthest && next[1] > 0.0).then_some((phi0, next[1]));
            }
            if next[0].abs() > 0.9 * here[0].abs() {
                break;
            }
            here = next;
        }
        // downhill in small steps, then by halves
        let direction = if slope(start)[0] > 0.0 { -1.0 } else { 1.0 };
        let (mut low, mut high) = (start, start);
        loop {
            high += direction * 0.01;
            if (high - start).abs() > farthest {
                return None;
            }
            if direction * slope(high)[0] >= 0.0 {
                break;
            }
            low = high;
        }
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if direction * slope(middle)[0] < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let stiffness = slope(high)[1];
        (stiffness > 0.0).then_some((high, stiffness))
    }

    /// The first and the second derivative of the potential by the orientation at a sample, in m, with their deviations by the covariance of the outline's coefficients.
    pub fn bent(&self, row: usize, phi0: f64, series: &Outline, covariance: &DMatrix<f64>) -> [Measured; 2] {
        let (a, b) = (self.sampled[row].second[0], self.sampled[row].first[0]);
        let [first, second] = self.touched(row, phi0, series);
        [1, 2].map(|order: usize| Measured {
            value: sign_of(order) * (a * first[order] + b * second[order]),
            deviation: deviation_of(covariance, &self.by_potential(order, row, phi0, series)),
        })
    }

    /// The slope of the potential by the orientation, in m.
    pub fn slope(&self, row: usize, phi0: f64, series: &Outline) -> f64 {
        let (a, b) = (self.sampled[row].second[0], self.sampled[row].first[0]);
        let [first, second] = self.touched(row, phi0, series);
        sign_of(1) * (a * first[1] + b * second[1])
    }

    /// The derivatives by the coefficients of the potential's first or second derivative by the orientation, which is fixed.
    fn by_potential(&self, order: usize, row: usize, phi0: f64, series: &Outline) -> Vec<f64> {
        let (a, b) = (self.sampled[row].second[0], self.sampled[row].first[0]);
        let [one, two] = self.angles[row].map(|angle| series.basis(angle - phi0));
        one.iter().zip(&two).map(|(one, two)| sign_of(order) * (a * one[order] + b * two[order])).collect()
    }

    pub fn contacts(&self, row: usize, [first, second]: &Touched) -> [f64; 2] {
        let [sine, cosine] = self.sampled[row].opening;
        [
            (first[0] * cosine + second[0]) / sine + first[1],
            (second[0] * cosine + first[0]) / sine - second[1],
        ]
    }

    /// The chi-square of the contacts of a pose: by the measurements' errors of `sigma`, in m, and the covariance of the outline's coefficients.
    pub fn surprise(
        &self,
        row: usize,
        phi0: f64,
        series: &Outline,
        covariance: &DMatrix<f64>,
        sigma: f64,
    ) -> f64 {
        let contacts = self.contacts(row, &self.touched(row, phi0, series));
        let forms = self.by_coefficients(row, phi0, series);
        let off = Vector2::from_fn(|i, _| self.measurements.contacts[row][i] - contacts[i]);
        let mut spread = Matrix2::identity() * (sigma * sigma);
        // without a finite covariance the shape is taken as exact
        if covariance.iter().all(|entry| entry.is_finite()) {
            let forms = DMatrix::from_fn(forms[0].len(), 2, |k, i| forms[i][k]);
            let open = forms.transpose() * covariance * &forms;
            spread += Matrix2::from_fn(|i, j| open[(i, j)]);
        }
        spread.cholesky().map_or(f64::INFINITY, |spread| off.dot(&spread.solve(&off)))
    }

    /// The same where the body lay at an orientation that is no stable pose of this outline: the contacts there, and the slope of the potential in deviations.
    pub fn surprise_if_it_lay(
        &self,
        row: usize,
        phi0: f64,
        series: &Outline,
        covariance: &DMatrix<f64>,
        sigma: f64,
    ) -> f64 {
        let contacts = self.contacts(row, &self.touched(row, phi0, series));
        let off =
            (0..2).map(|i| ((self.measurements.contacts[row][i] - contacts[i]) / sigma).powi(2)).sum::<f64>();
        let [slope, _] = self.bent(row, phi0, series, covariance);
        let steep = (slope.value / slope.deviation).powi(2);
        if steep.is_nan() || slope.deviation.is_infinite() { f64::INFINITY } else { off + steep }
    }

    /// The derivatives of both contacts by the coefficients, the pose's own turn among them, in m.
    fn by_coefficients(&self, row: usize, phi0: f64, series: &Outline) -> [Vec<f64>; 2] {
        let sampled = &self.sampled[row];
        let (a, b) = (sampled.second[0], sampled.first[0]);
        let [sine, cosine] = sampled.opening;
        let [first, second] = self.touched(row, phi0, series);
        let [ones, twos] = self.angles[row].map(|angle| series.basis(angle - phi0));
        let stiffness = a * first[2] + b * second[2];
        let by_turn = [
            -(first[1] * cosine + second[1]) / sine - first[2],
            -(second[1] * cosine + first[1]) / sine + second[2],
        ];
        let mut forms = [Vec::with_capacity(ones.len()), Vec::with_capacity(ones.len())];
        for (one, two) in ones.iter().zip(&twos) {
            let turn = (a * one[1] + b * two[1]) / stiffness;
            let own =
                [(one[0] * cosine + two[0]) / sine + one[1], (two[0] * cosine + one[0]) / sine - two[1]];
            forms.iter_mut().zip(own).zip(by_turn).for_each(|((form, own), by)| form.push(own + by * turn));
        }
        forms
    }

    /// The root mean square residual of the contacts at a shape, each pose the stable one next to the given one, in m.
    pub fn left_at(&self, support: &SupportSeries, near: &[f64]) -> Option<f64> {
        let rows = 2 * self.sampled.len();
        let at = self.settled(support.coefficients(), near, LARGEST_TURN)?;
        Some((at.left.rows(0, rows).norm_squared() / rows as f64).sqrt() * self.sigma)
    }

    /// A point at coefficients, every pose the stable one next to the given one.
    pub fn point(&self, coefficients: Vec<f64>, near: &[f64]) -> Option<Point> {
        self.settled(coefficients, near, LARGEST_TURN)
    }

    /// An initial point: the poses next to those of a track, however far, or those to which the palms lead the body from the first one, whichever explain more.
    pub fn begin(&self, coefficients: &[f64], near: &[f64]) -> Option<Point> {
        let series = self.outline(coefficients);
        let mut led = Vec::with_capacity(near.len());
        for row in 0..near.len() {
            let from = led.last().copied().unwrap_or(near[0]);
            led.push(self.pose(row, from, &series, PI)?.0);
        }
        let both = [near, &led].map(|near| self.settled(coefficients.to_vec(), near, PI));
        both.into_iter().flatten().min_by(|a, b| a.cost.total_cmp(&b.cost))
    }

    fn settled(&self, coefficients: Vec<f64>, near: &[f64], farthest: f64) -> Option<Point> {
        let series = self.outline(&coefficients);
        let rows = self.sampled.len();
        let mut left = DVector::zeros(2 * rows + coefficients.len() + self.held.len());
        let mut phi0 = Vec::with_capacity(rows);
        let mut least = f64::INFINITY;
        for row in 0..rows {
            if self.passed_over[row] {
                phi0.push(near[row]);
                continue;
            }
            let (pose, stiffness) = self.pose(row, near[row], &series, farthest)?;
            least = least.min(stiffness);
            phi0.push(pose);
            let s = self.contacts(row, &self.touched(row, pose, &series));
            for i in 0..2 {
                left[2 * row + i] = (self.measurements.contacts[row][i] - s[i]) / self.sigma;
            }
        }
        for (place, coefficient) in coefficients.iter().enumerate().take(1 + 2 * series.order()).skip(1) {
            left[2 * rows + place] = -coefficient / convex_deviation(self.size, place.div_ceil(2));
        }
        for (place, held) in self.held.iter().enumerate() {
            let slope = self.slope(held.row, held.phi0, &series);
            left[2 * rows + coefficients.len() + place] = (held.slope - slope) / held.deviation;
        }
        let cost = left.norm_squared();
        cost.is_finite().then_some(Point { coefficients, phi0, left, cost, stiffness: least })
    }

    /// The derivatives of the residuals by the coefficients, negative.
    fn rows(&self, at: &Point) -> DMatrix<f64> {
        let (rows, p) = (self.sampled.len(), at.coefficients.len());
        let series = self.outline(&at.coefficients);
        // column by column in memory: a row of the transpose is written at once
        let mut transposed = DMatrix::zeros(p, 2 * rows + p + self.held.len());
        for row in (0..rows).filter(|row| !self.passed_over[*row]) {
            let forms = self.by_coefficients(row, at.phi0[row], &series);
            for (i, form) in forms.iter().enumerate() {
                form.iter().enumerate().for_each(|(k, by)| transposed[(k, 2 * row + i)] = by / self.sigma);
            }
        }
        for k in 1..=2 * series.order() {
            transposed[(k, 2 * rows + k)] = 1.0 / convex_deviation(self.size, k.div_ceil(2));
        }
        for (place, held) in self.held.iter().enumerate() {
            let form = self.by_potential(1, held.row, held.phi0, &series);
            (0..p).for_each(|k| transposed[(k, 2 * rows + p + place)] = form[k] / held.deviation);
        }
        transposed.transpose()
    }

    /// The direction in which the body's frame alone turns.
    fn turning(&self, coefficients: &[f64]) -> DVector<f64> {
        let harmonics = coefficients.len() - OF_KINK * self.kinks;
        let mut direction = DVector::zeros(coefficients.len());
        for (k, pair) in coefficients[1..harmonics].chunks_exact(2).enumerate() {
            let times = (k + 1) as f64;
            direction[2 * k + 1] = -times * pair[1];
            direction[2 * k + 2] = times * pair[0];
        }
        (0..self.kinks).for_each(|kink| direction[harmonics + OF_KINK * (kink + 1) - 1] = 1.0);
        let length = direction.norm();
        if length > 0.0 { direction / length } else { direction }
    }

    /// The triangle of the rows, and the rotated right-hand side, with a row that fixes the frame.
    fn triangle(&self, at: &Point) -> (DMatrix<f64>, DVector<f64>) {
        let rows = self.rows(at);
        let (m, p) = rows.shape();
        let mut all = DMatrix::zeros(m + 1, p + 1);
        all.view_mut((0, 0), (m, p)).copy_from(&rows);
        all.view_mut((0, p), (m, 1)).copy_from(&at.left);
        let hold = rows.norm() / (p as f64).sqrt();
        let turning = self.turning(&at.coefficients);
        for k in 0..p {
            all[(m, k)] = hold * turning[k];
        }
        let r = all.qr().r();
        let side = r.view((0, p), (p, 1)).column(0).into_owned();
        (r.view((0, 0), (p, p)).into_owned(), side)
    }

    /// Levenberg and Marquardt's way down from a point.
    pub fn down(&self, at: Point, interrupt: &dyn Fn() -> bool) -> Point {
        self.down_by(STEPS, at, interrupt)
    }

    /// The same in so many steps at most.
    pub fn down_by(&self, steps: usize, mut at: Point, interrupt: &dyn Fn() -> bool) -> Point {
        let mut damping = 1e-6;
        for _ in 0..steps {
            if interrupt() {
                break;
            }
            let (triangle, side) = self.triangle(&at);
            let p = triangle.ncols();
            let sizes: Vec<f64> = (0..p).map(|k| triangle.column(k).norm().max(f64::MIN_POSITIVE)).collect();
            let mut gained = None;
            for _ in 0..8 {
                let mut damped = DMatrix::zeros(2 * p, p + 1);
                damped.view_mut((0, 0), (p, p)).copy_from(&triangle);
                damped.view_mut((0, p), (p, 1)).copy_from(&side);
                (0..p).for_each(|k| damped[(p + k, k)] = damping * sizes[k]);
                let r = damped.qr().r();
                let step = r
                    .view((0, 0), (p, p))
                    .into_owned()
                    .solve_upper_triangular(&r.view((0, p), (p, 1)).column(0).into_owned());
                let next = step.and_then(|step| {
                    let moved = at.coefficients.iter().zip(step.iter()).map(|(c, step)| c + step).collect();
                    self.point(moved, &at.phi0)
                });
                match next {
                    Some(next) if next.cost < at.cost => {
                        gained = Some(1.0 - next.cost / at.cost);
                        at = next;
                        damping = (damping * 0.1).max(1e-14);
                        break;
                    }
                    _ => damping = (damping * 10.0).max(1e-7),
                }
            }
            if gained.is_none_or(|part| part < SETTLED) {
                break;
            }
        }
        at
    }

    pub fn shape(&self, at: &Point) -> SlowShape {
        let rows = self.sampled.len();
        let p = at.coefficients.len();
        let (triangle, _) = self.triangle(at);
        let inverse = triangle
            .solve_upper_triangular(&DMatrix::identity(p, p))
            .unwrap_or_else(|| DMatrix::from_element(p, p, f64::INFINITY));
        let chi_square = at.left.rows(0, 2 * rows).norm_squared();
        let degrees = (2 * rows).saturating_sub(p).max(1);
        let widened = (chi_square / degrees as f64).max(1.0).sqrt();
        let outline = self.outline(&at.coefficients);
        let radii: Vec<[f64; 2]> =
            (0..rows).map(|row| self.touched(row, at.phi0[row], &outline).map(|r| r[0])).collect();
        // with kinks the shape has the harmonics of their tails as well
        let expanded = if self.kinks > 0 { EXPANDED } else { outline.order() };
        let support = outline.expanded(expanded);
        let inverse = if self.kinks > 0 { outline.by_own(expanded) * inverse } else { inverse };
        let height = self.sampled.iter().zip(&radii).map(|(sampled, radii)| sampled.height(*radii));
        SlowShape {
            track: SlowTrack { height: height.collect(), phi0: at.phi0.clone(), radii },
            rms_residual: (chi_square / (2 * rows) as f64).sqrt() * self.sigma,
            sigma: self.sigma,
            stiffness: at.stiffness / support.mean,
            order: outline.order(),
            kinks: outline.kinks,
            shape: ShapeEstimate {
                covariance: &inverse * inverse.transpose() * (widened * widened),
                support: support.into(),
                others: Vec::new(),
                samples: 2 * rows,
                chi_square,
                degrees,
                widened,
            },
        }
    }
}
