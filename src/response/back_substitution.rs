//! Triangular solution for several right-hand sides and many frequencies at once.

use pulp::Simd;

use super::active_row::Across;
use super::complex_lanes::ComplexLanes;
use super::hessenberg_form::HessenbergForm;
use super::lane_elimination::Elimination;

/// `R` complex numbers, one for each right-hand side, in each lane.
pub type Sides<S, const R: usize> = [ComplexLanes<S>; R];

/// The rows up to the one to be solved for, which is the last of them, and those below, which are known.
type Parts<'a, S, const R: usize> = (&'a mut [Sides<S, R>], &'a mut [Sides<S, R>]);

/// Solves `(F - j omega I) Y = B` for the `R` columns of B from `first` on, in one vector of a group; `y` has a row for
/// each state.
///
/// For each entry of the triangle 4 R fused operations where its row is complex and 2 R where it is real: n^2 R to 2
/// n^2 R, most of all the work.
#[inline(always)]
pub fn substitute_back<S: Simd, const R: usize, const V: usize>(
    simd: S,
    form: &HessenbergForm,
    elimination: &Elimination<S, V>,
    vector: usize,
    first: usize,
    y: &mut [Sides<S, R>],
) {
    let Some(mut unknown) = y.len().checked_sub(1) else { return };
    for (side, last) in (first..).zip(&mut y[unknown]) {
        *last = elimination.last(form, vector, side);
    }
    let omega = elimination.omega(vector);
    while let Some(row) = unknown.checked_sub(1) {
        unknown = row;
        let parts = y.split_at_mut(row + 1);
        if row > 1 && elimination.are_real(row - 2..row + 1) {
            unknown = row - 2;
            substitute_three_real(simd, form, omega, row, first, parts);
        } else if row > 0 && elimination.are_real(row - 1..row + 1) {
            unknown = row - 1;
            substitute_two_real(simd, form, omega, row, first, parts);
        } else if elimination.are_real(row..row + 1) {
            substitute_real(simd, form, omega, row, first, parts);
        } else {
            let (entries, sides) = elimination.complex_row(form, vector, row);
            substitute_complex(simd, entries, &sides[first..first + R], vector % V, parts);
        }
    }
}

/// Solves three real rows, which share what is read of the known ones: `row` and the two above.
#[inline(always)]
fn substitute_three_real<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    omega: S::f64s,
    row: usize,
    first: usize,
    (unknown, known): Parts<S, R>,
) {
    let ([.., highest, above, here], Some(below)) = (unknown, known.first()) else { return };
    let (entries_here, sides_here) = form.unit_row(row);
    let (entries_above, sides_above) = form.unit_row(row - 1);
    let (entries_highest, sides_highest) = form.unit_row(row - 2);
    let Some(([next], entries_above)) = entries_above.split_first_chunk() else { return };
    let Some(([near, far], entries_highest)) = entries_highest.split_first_chunk() else { return };
    let mut sums = [
        real_sides(simd, sides_here, first),
        real_sides(simd, sides_above, first),
        real_sides(simd, sides_highest, first),
    ];
    subtract_three_real_products(simd, &mut sums, [entries_here, entries_above, entries_highest], known);
    let (next, near, far) = (simd.splat_f64s(*next), simd.splat_f64s(*near), simd.splat_f64s(*far));
    let shift_here = shift(simd, form, omega, row);
    let shift_above = shift(simd, form, omega, row - 1);
    let shift_highest = shift(simd, form, omega, row - 2);
    for side in 0..R {
        here[side] = sums[0][side].plus_imaginary_product(simd, below[side], shift_here);
        let sum = sums[1][side].minus_real_product(simd, here[side], next);
        above[side] = sum.plus_imaginary_product(simd, here[side], shift_above);
        let sum = sums[2][side].minus_real_product(simd, here[side], far);
        let sum = sum.minus_real_product(simd, above[side], near);
        highest[side] = sum.plus_imaginary_product(simd, above[side], shift_highest);
    }
}

/// Solves two real rows, which share what is read of the known ones: `row` and the one above.
#[inline(always)]
fn substitute_two_real<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    omega: S::f64s,
    row: usize,
    first: usize,
    (unknown, known): Parts<S, R>,
) {
    let ([.., above, here], Some(below)) = (unknown, known.first()) else { return };
    let (entries_here, sides_here) = form.unit_row(row);
    let (entries_above, sides_above) = form.unit_row(row - 1);
    let Some(([next], entries_above)) = entries_above.split_first_chunk() else { return };
    let mut sums = [real_sides(simd, sides_here, first), real_sides(simd, sides_above, first)];
    subtract_two_real_products(simd, &mut sums, [entries_here, entries_above], known);
    let next = simd.splat_f64s(*next);
    let (shift_here, shift_above) = (shift(simd, form, omega, row), shift(simd, form, omega, row - 1));
    for side in 0..R {
        here[side] = sums[0][side].plus_imaginary_product(simd, below[side], shift_here);
        let sum = sums[1][side].minus_real_product(simd, here[side], next);
        above[side] = sum.plus_imaginary_product(simd, here[side], shift_above);
    }
}

/// Solves one real row.
#[inline(always)]
fn substitute_real<S: Simd, const R: usize>(
    simd: S,
    form: &HessenbergForm,
    omega: S::f64s,
    row: usize,
    first: usize,
    (unknown, known): Parts<S, R>,
) {
    let Some(here) = unknown.last_mut() else { return };
    let (entries, sides) = form.unit_row(row);
    let mut sum = real_sides(simd, sides, first);
    subtract_real_product(simd, &mut sum, entries, known);
    let shift = shift(simd, form, omega, row);
    for side in 0..R {
        here[side] = sum[side].plus_imaginary_product(simd, known[0][side], shift);
    }
}

/// Solves one complex row, in one of `V` vectors.
#[inline(always)]
fn substitute_complex<S: Simd, const R: usize, const V: usize>(
    simd: S,
    entries: &[Across<S, V>],
    sides: &[Across<S, V>],
    vector: usize,
    (unknown, known): Parts<S, R>,
) {
    let (Some(here), Some((reciprocal, entries))) = (unknown.last_mut(), entries.split_first()) else { return };
    let mut sum = [ComplexLanes::real(simd, 0.0); R];
    for side in 0..R {
        sum[side] = sides[side][vector];
    }
    subtract_product(simd, &mut sum, entries, vector, known);
    for side in 0..R {
        here[side] = sum[side].product(simd, reciprocal[vector]);
    }
}

/// The imaginary part of the first entry of a real row, with its sign changed.
#[inline(always)]
fn shift<S: Simd>(simd: S, form: &HessenbergForm, omega: S::f64s, row: usize) -> S::f64s {
    simd.mul_f64s(omega, simd.splat_f64s(form.subdiagonals()[row].reciprocal))
}

/// Real right-hand sides from `first` on.
#[inline(always)]
fn real_sides<S: Simd, const R: usize>(simd: S, sides: &[f64], first: usize) -> Sides<S, R> {
    let sides = &sides[first..first + R];
    let mut lanes = [ComplexLanes::real(simd, 0.0); R];
    for side in 0..R {
        lanes[side].re = simd.splat_f64s(sides[side]);
    }
    lanes
}

/// `sum -= row y` for a real row, from the last entry to the first: the first `y` is the last to become known.
#[inline(always)]
fn subtract_real_product<S: Simd, const R: usize>(simd: S, sum: &mut Sides<S, R>, row: &[f64], y: &[Sides<S, R>]) {
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
fn subtract_two_real_products<S: Simd, const R: usize>(
    simd: S,
    sums: &mut [Sides<S, R>; 2],
    rows: [&[f64]; 2],
    y: &[Sides<S, R>],
) {
    let [mut first, mut second] = *sums;
    for ((a, b), y) in rows[0].iter().zip(rows[1]).zip(y).rev() {
        let (a, b) = (simd.splat_f64s(*a), simd.splat_f64s(*b));
        for side in 0..R {
            first[side] = first[side].minus_real_product(simd, y[side], a);
            second[side] = second[side].minus_real_product(simd, y[side], b);
        }
    }
    *sums = [first, second];
}

/// [`subtract_real_product`] for three rows, which share what is read of `y`.
#[inline(always)]
pub fn subtract_three_real_products<S: Simd, const R: usize>(
    simd: S,
    sums: &mut [Sides<S, R>; 3],
    rows: [&[f64]; 3],
    y: &[Sides<S, R>],
) {
    let [mut first, mut second, mut third] = *sums;
    for (((a, b), c), y) in rows[0].iter().zip(rows[1]).zip(rows[2]).zip(y).rev() {
        let (a, b, c) = (simd.splat_f64s(*a), simd.splat_f64s(*b), simd.splat_f64s(*c));
        // In this order sixteen registers hold twelve sums, three entries and one part of y.
        for side in 0..R {
            let y = y[side];
            first[side].re = simd.negate_mul_add_e_f64s(y.re, a, first[side].re);
            second[side].re = simd.negate_mul_add_e_f64s(y.re, b, second[side].re);
            third[side].re = simd.negate_mul_add_e_f64s(y.re, c, third[side].re);
            first[side].im = simd.negate_mul_add_e_f64s(y.im, a, first[side].im);
            second[side].im = simd.negate_mul_add_e_f64s(y.im, b, second[side].im);
            third[side].im = simd.negate_mul_add_e_f64s(y.im, c, third[side].im);
        }
    }
    *sums = [first, second, third];
}

/// `sum -= row y`, in the same order, in one of `V` vectors. Products with real and with imaginary parts are summed apart:
/// twice as many independent sums keep the multipliers busy.
#[inline(always)]
fn subtract_product<S: Simd, const R: usize, const V: usize>(
    simd: S,
    sum: &mut Sides<S, R>,
    row: &[Across<S, V>],
    vector: usize,
    y: &[Sides<S, R>],
) {
    let (mut direct, mut crossed) = (*sum, [ComplexLanes::real(simd, 0.0); R]);
    for (entry, y) in row.iter().zip(y).rev() {
        let entry = entry[vector];
        for side in 0..R {
            direct[side] = direct[side].minus_real_product(simd, y[side], entry.re);
            crossed[side] = crossed[side].minus_real_product(simd, y[side], entry.im);
        }
    }
    for side in 0..R {
        sum[side] = ComplexLanes {
            re: simd.sub_f64s(direct[side].re, crossed[side].im),
            im: simd.add_f64s(direct[side].im, crossed[side].re),
        };
    }
}
