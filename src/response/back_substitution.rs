//! Triangular solution for several right-hand sides and many frequencies at once.

use pulp::Simd;

use super::complex_lanes::ComplexLanes;
use super::hessenberg_form::HessenbergForm;
use super::lane_elimination::{Elimination, TriangleRow};

/// `R` complex numbers, one for each right-hand side, in each lane.
pub type Sides<S, const R: usize> = [ComplexLanes<S>; R];

/// Solves `(F - j omega I) Y = B` for the `R` columns of B from `first` on; `y` has a row for each state.
///
/// For each entry of the triangle 4 R fused operations where its row is complex and 2 R where it is real: n^2 R to 2 n^2 R,
/// most of all the work.
#[inline(always)]
pub fn substitute_back<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    elimination: &Elimination<S>,
    first: usize,
    y: &mut [Sides<S, R>],
) {
    for row in (0..y.len()).rev() {
        let (above, known) = y.split_at_mut(row + 1);
        let mut sum = [ComplexLanes::real(simd, 0.0); R];
        match elimination.row(form, row) {
            TriangleRow::Real(entries) => {
                let (entries, sides) = entries.split_at(known.len());
                for (sum, side) in sum.iter_mut().zip(&sides[first..]) {
                    sum.re = simd.splat_f64s(*side);
                }
                subtract_real_product(simd, &mut sum, entries, known);
                // Rounded before it is added, as in a complex row: a lane's bits must not depend on its neighbours.
                for (sum, y) in sum.iter_mut().zip(&known[0]) {
                    let product = y.scaled(simd, elimination.omega());
                    sum.re = simd.sub_f64s(sum.re, product.im);
                    sum.im = simd.add_f64s(sum.im, product.re);
                }
            }
            TriangleRow::Complex(entries) => {
                let (entries, sides) = entries.split_at(known.len());
                sum.copy_from_slice(&sides[first..first + R]);
                subtract_product(simd, &mut sum, entries, known);
            }
        }
        let reciprocal = elimination.reciprocal(row);
        for (y, sum) in above[row].iter_mut().zip(&sum) {
            *y = sum.product(simd, reciprocal);
        }
    }
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

/// [`subtract_product`] for `G` right-hand sides. Products with real and with imaginary parts are summed apart: twice as many
/// independent sums keep the multipliers busy.
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
