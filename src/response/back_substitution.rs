//! Triangular solution for several right-hand sides and many frequencies at once.

use pulp::Simd;

use super::complex_lanes::ComplexLanes;
use super::hessenberg_form::HessenbergForm;
use super::lane_elimination::{Elimination, TriangleRow};

/// `R` complex numbers, one for each right-hand side, in each lane.
pub type Sides<S, const R: usize> = [ComplexLanes<S>; R];

/// The rows up to the one to be solved for, which is the last of them, and those below, which are known.
type Parts<'a, S, const R: usize> = (&'a mut [Sides<S, R>], &'a mut [Sides<S, R>]);

/// Solves `(F - j omega I) Y = B` for the `R` columns of B from `first` on; `y` has a row for each state.
///
/// For each entry of the triangle 4 R fused operations where its row is complex and 2 R where it is real: n^2 R to 2
/// n^2 R, most of all the work.
#[inline(always)]
pub fn substitute_back<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    elimination: &Elimination<S>,
    first: usize,
    y: &mut [Sides<S, R>],
) {
    let mut unknown = y.len();
    while let Some(row) = unknown.checked_sub(1) {
        unknown = row;
        let lower = elimination.row(form, row);
        match (lower, row.checked_sub(1).map(|upper| elimination.row(form, upper))) {
            (TriangleRow::Real(here, lower), Some(TriangleRow::Real(above, upper))) => {
                unknown = row - 1;
                substitute_real_pair(
                    simd,
                    elimination.omega(),
                    [above, here],
                    [upper, lower],
                    first,
                    y.split_at_mut(row + 1),
                );
            }
            (TriangleRow::Real(reciprocal, entries), _) => {
                substitute_real(simd, elimination.omega(), reciprocal, entries, first, y.split_at_mut(row + 1));
            }
            (TriangleRow::Complex(reciprocal, entries), _) => {
                substitute_complex(simd, reciprocal, entries, first, y.split_at_mut(row + 1));
            }
        }
    }
}

/// Solves two real rows, which share what is read of the known ones: the upper one is given first.
#[inline(always)]
fn substitute_real_pair<S: Simd, const R: usize>(
    simd: S,
    omega: S::f64s,
    reciprocals: [f64; 2],
    [upper, lower]: [&[f64]; 2],
    first: usize,
    (unknown, known): Parts<S, R>,
) {
    let [.., above, here] = unknown else { return };
    let (next, upper) = upper.split_at(1);
    let sides = known.len() + first;
    let mut sums = [real_sides(simd, &upper[sides..]), real_sides(simd, &lower[sides..])];
    subtract_real_products(simd, &mut sums, [upper, lower], known);
    for side in 0..R {
        let sum = sums[1][side].plus_imaginary_product(simd, known[0][side], omega);
        here[side] = sum.scaled(simd, simd.splat_f64s(reciprocals[1]));
        let sum = sums[0][side].minus_real_product(simd, here[side], simd.splat_f64s(next[0]));
        let sum = sum.plus_imaginary_product(simd, here[side], omega);
        above[side] = sum.scaled(simd, simd.splat_f64s(reciprocals[0]));
    }
}

/// Solves one real row.
#[inline(always)]
fn substitute_real<S: Simd, const R: usize>(
    simd: S,
    omega: S::f64s,
    reciprocal: f64,
    entries: &[f64],
    first: usize,
    (unknown, known): Parts<S, R>,
) {
    let Some(here) = unknown.last_mut() else { return };
    let mut sum = real_sides(simd, &entries[known.len() + first..]);
    subtract_real_product(simd, &mut sum, entries, known);
    for side in 0..R {
        let sum = sum[side].plus_imaginary_product(simd, known[0][side], omega);
        here[side] = sum.scaled(simd, simd.splat_f64s(reciprocal));
    }
}

/// Solves one complex row.
#[inline(always)]
fn substitute_complex<S: Simd, const R: usize>(
    simd: S,
    reciprocal: ComplexLanes<S>,
    entries: &[ComplexLanes<S>],
    first: usize,
    (unknown, known): Parts<S, R>,
) {
    let (entries, sides) = entries.split_at(known.len());
    let mut sum = [ComplexLanes::real(simd, 0.0); R];
    sum.copy_from_slice(&sides[first..first + R]);
    if let (Some((next, entries)), Some((y, known))) = (entries.split_first(), known.split_first()) {
        subtract_product(simd, &mut sum, entries, known);
        // The order of a real row, which some lanes may have here: a lane's bits must not depend on its neighbours.
        for (sum, y) in sum.iter_mut().zip(y) {
            let part = sum.minus_real_product(simd, *y, next.re);
            *sum = part.plus_imaginary_product(simd, *y, simd.neg_f64s(next.im));
        }
    }
    let Some(here) = unknown.last_mut() else { return };
    for (y, sum) in here.iter_mut().zip(&sum) {
        *y = sum.product(simd, reciprocal);
    }
}

/// Real right-hand sides.
#[inline(always)]
fn real_sides<S: Simd, const R: usize>(simd: S, sides: &[f64]) -> Sides<S, R> {
    let mut lanes = [ComplexLanes::real(simd, 0.0); R];
    for (lanes, side) in lanes.iter_mut().zip(sides) {
        lanes.re = simd.splat_f64s(*side);
    }
    lanes
}

/// `sum -= row y` for a real row, from the last entry to the first: the first `y` is the last to become known.
#[inline(always)]
pub fn subtract_real_product<S: Simd, const R: usize>(simd: S, sum: &mut Sides<S, R>, row: &[f64], y: &[Sides<S, R>]) {
    let mut part = *sum;
    for (entry, y) in row.iter().zip(y).rev() {
        let entry = simd.splat_f64s(*entry);
        for side in 0..R {
            part[side] = part[side].minus_real_product(simd, y[side], entry);
        }
    }
    *sum = part;
}

/// [`subtract_real_product`] for two rows, which share what is read of `y`.
#[inline(always)]
pub fn subtract_real_products<S: Simd, const R: usize>(
    simd: S,
    sums: &mut [Sides<S, R>; 2],
    rows: [&[f64]; 2],
    y: &[Sides<S, R>],
) {
    if S::REGISTER_COUNT >= 32 || R % 2 == 1 {
        subtract_real_products_from::<S, R, R>(simd, sums, rows, y, 0);
    } else {
        for first in (0..R).step_by(2) {
            subtract_real_products_from::<S, R, 2>(simd, sums, rows, y, first);
        }
    }
}

/// [`subtract_real_products`] for `G` right-hand sides.
#[inline(always)]
fn subtract_real_products_from<S: Simd, const R: usize, const G: usize>(
    simd: S,
    sums: &mut [Sides<S, R>; 2],
    rows: [&[f64]; 2],
    y: &[Sides<S, R>],
    first: usize,
) {
    let mut parts = [[ComplexLanes::real(simd, 0.0); G]; 2];
    parts[0].copy_from_slice(&sums[0][first..first + G]);
    parts[1].copy_from_slice(&sums[1][first..first + G]);
    for ((upper, lower), y) in rows[0].iter().zip(rows[1]).zip(y).rev() {
        let (upper, lower) = (simd.splat_f64s(*upper), simd.splat_f64s(*lower));
        for side in 0..G {
            let y = y[first + side];
            parts[0][side] = parts[0][side].minus_real_product(simd, y, upper);
            parts[1][side] = parts[1][side].minus_real_product(simd, y, lower);
        }
    }
    sums[0][first..first + G].copy_from_slice(&parts[0]);
    sums[1][first..first + G].copy_from_slice(&parts[1]);
}

/// `sum -= row y`, in the same order.
#[inline(always)]
fn subtract_product<S: Simd, const R: usize>(
    simd: S,
    sum: &mut Sides<S, R>,
    row: &[ComplexLanes<S>],
    y: &[Sides<S, R>],
) {
    // Four registers for each side: thirty-two registers hold four sides at once, sixteen hold two.
    if S::REGISTER_COUNT >= 32 || R % 2 == 1 {
        subtract_product_from::<S, R, R>(simd, sum, row, y, 0);
    } else {
        for first in (0..R).step_by(2) {
            subtract_product_from::<S, R, 2>(simd, sum, row, y, first);
        }
    }
}

/// [`subtract_product`] for `G` right-hand sides. Products with real and with imaginary parts are summed apart: twice
/// as many independent sums keep the multipliers busy.
#[inline(always)]
fn subtract_product_from<S: Simd, const R: usize, const G: usize>(
    simd: S,
    sum: &mut Sides<S, R>,
    row: &[ComplexLanes<S>],
    y: &[Sides<S, R>],
    first: usize,
) {
    let zero = ComplexLanes::real(simd, 0.0);
    let (mut direct, mut crossed) = ([zero; G], [zero; G]);
    direct.copy_from_slice(&sum[first..first + G]);
    for (entry, y) in row.iter().zip(y).rev() {
        for side in 0..G {
            let y = y[first + side];
            direct[side] = direct[side].minus_real_product(simd, y, entry.re);
            crossed[side] = crossed[side].minus_real_product(simd, y, entry.im);
        }
    }
    for side in 0..G {
        sum[first + side] = ComplexLanes {
            re: simd.sub_f64s(direct[side].re, crossed[side].im),
            im: simd.add_f64s(direct[side].im, crossed[side].re),
        };
    }
}
