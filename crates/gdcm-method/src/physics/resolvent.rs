//! A model's resolvent `(s I - A)^-1` at many points `s`, multiplied by B and by C, and the
//! response `H = C (s I - A)^-1 B + D`.
//!
//! ```text
//! 1  A = Q F Q',  F upper Hessenberg,  B~ = Q' B,  C~ = C Q           once for all points
//! 2  E (s I - F) = U:  elimination with exchange of neighbouring rows  for each point
//! 3  X~ = U^-1 E B~,  Y~ = C~ U^-1 E,  H = C~ X~ + D
//! 4  X = Q X~,  Y = Y~ Q'                                              all points at once
//! ```
//!
//! `X = (s I - A)^-1 B` and `Y = C (s I - A)^-1` are needed for the response's derivatives
//! (`family`); n, m and p count states, inputs and outputs, N the points. `Q` is orthogonal, `U`
//! upper triangular, and `E` the product of the row operations. Below its diagonal, an upper
//! Hessenberg matrix has only one entry in each column that is not zero, so that step 2 needs about
//! n^2 operations for a point, not n^3.
//!
//! Golub & Van Loan, "Matrix Computations", 4th ed. 2013, 4.3.4 and 7.4.

use nalgebra::linalg::Hessenberg;
use nalgebra::{Complex, DMatrix};

use super::matrices::Matrices;

/// A model's responses, and the state responses from which the derivatives follow.
pub(super) struct ResolventProducts {
    /// `H` at each point: `[(point p + output) m + input]`.
    pub(super) response: Vec<Complex<f64>>,
    /// `X = (s I - A)^-1 B`, n x 2 m N: for each point the real parts of its m columns, then the
    /// imaginary parts.
    pub(super) input_states: DMatrix<f64>,
    /// `Y = C (s I - A)^-1`, 2 p N x n: for each point the real parts of its p rows, then the
    /// imaginary parts.
    pub(super) output_states: DMatrix<f64>,
}

impl ResolventProducts {
    /// Computes the products at the points `s`. Where `s I - A` is singular, or `s` is not finite,
    /// all values are NaN.
    pub(super) fn new(system: &Matrices, s: &[Complex<f64>]) -> Self {
        let n = system.a.nrows();
        let m = system.b.ncols();
        let p = system.c.nrows();
        // Step 1.
        let reduced = ReducedSystem::new(system);
        let mut response = Vec::with_capacity(s.len() * p * m);
        let mut input_states = DMatrix::zeros(n, 2 * m * s.len());
        let mut output_states = DMatrix::zeros(n, 2 * p * s.len());
        let mut point = PointSolution::new(n, m, p);
        for (index, &s) in s.iter().enumerate() {
            // Steps 2 and 3.
            point.solve(&reduced, s);
            point.add_response(&reduced, &system.d, &mut response);
            store(&mut input_states, index, m, &point.input_states);
            store(&mut output_states, index, p, &point.output_states);
        }
        // Step 4.
        if let Some(q) = &reduced.q {
            input_states = q * input_states;
            output_states = q * output_states;
        }
        Self {
            response,
            input_states,
            output_states: output_states.transpose(),
        }
    }
}

/// Stores `count` complex columns, given row by row, as the real columns and imaginary columns of
/// point `index`.
fn store(stack: &mut DMatrix<f64>, index: usize, count: usize, rows: &[Complex<f64>]) {
    for (state, row) in rows.chunks_exact(count.max(1)).enumerate() {
        for (column, value) in row.iter().enumerate() {
            stack[(state, 2 * count * index + column)] = value.re;
            stack[(state, 2 * count * index + count + column)] = value.im;
        }
    }
}

/// A model in Hessenberg coordinates.
struct ReducedSystem {
    /// Orthogonal transformation; `None` for fewer than three states, whose A is Hessenberg.
    q: Option<DMatrix<f64>>,
    /// `F`, n x n.
    f: DMatrix<f64>,
    /// `B~`, n x m.
    b: DMatrix<f64>,
    /// `C~`, p x n.
    c: DMatrix<f64>,
}

impl ReducedSystem {
    fn new(system: &Matrices) -> Self {
        if system.a.nrows() < 3 {
            return Self {
                q: None,
                f: system.a.clone(),
                b: system.b.clone(),
                c: system.c.clone(),
            };
        }
        let (q, f) = Hessenberg::new(system.a.clone()).unpack();
        Self {
            b: q.tr_mul(&system.b),
            c: &system.c * &q,
            q: Some(q),
            f,
        }
    }
}

/// Solution at one point; the memory is reused.
struct PointSolution {
    order: usize,
    input_count: usize,
    output_count: usize,
    /// `U`, row by row.
    upper: Vec<Complex<f64>>,
    /// `E`, row operation by row operation.
    eliminations: Vec<Elimination>,
    /// `X~`, n x m, row by row.
    input_states: Vec<Complex<f64>>,
    /// `Y~` transposed, n x p, row by row.
    output_states: Vec<Complex<f64>>,
}

/// Elimination of a column's entry below the diagonal: the row on the diagonal is exchanged with
/// the next, if that has the larger entry, and then subtracted `factor` times from the next.
#[derive(Clone, Copy)]
struct Elimination {
    is_exchanged: bool,
    factor: Complex<f64>,
}

impl PointSolution {
    fn new(order: usize, input_count: usize, output_count: usize) -> Self {
        let zero = Complex::new(0.0, 0.0);
        Self {
            order,
            input_count,
            output_count,
            upper: vec![zero; order * order],
            eliminations: Vec::with_capacity(order),
            input_states: vec![zero; order * input_count],
            output_states: vec![zero; order * output_count],
        }
    }

    /// Computes `X~` and `Y~` at the point `s` (steps 2 and 3).
    fn solve(&mut self, system: &ReducedSystem, s: Complex<f64>) {
        self.eliminate(system, s);
        self.solve_input_states(system);
        self.solve_output_states(system);
    }

    /// Reduces `s I - F` to `U` (step 2).
    fn eliminate(&mut self, system: &ReducedSystem, s: Complex<f64>) {
        let n = self.order;
        for row in 0..n {
            for column in 0..n {
                self.upper[row * n + column] = Complex::from(-system.f[(row, column)]);
            }
            self.upper[row * n + row] += s;
        }
        self.eliminations.clear();
        for k in 0..n.saturating_sub(1) {
            let (above, below) = self.upper.split_at_mut((k + 1) * n);
            let pivot_row = &mut above[k * n + k..];
            let next_row = &mut below[k..n];
            let is_exchanged = next_row[0].norm_sqr() > pivot_row[0].norm_sqr();
            if is_exchanged {
                pivot_row.swap_with_slice(next_row);
            }
            let factor = if next_row[0] == Complex::new(0.0, 0.0) {
                next_row[0]
            } else {
                next_row[0] / pivot_row[0]
            };
            subtract(next_row, pivot_row, factor);
            self.eliminations.push(Elimination {
                is_exchanged,
                factor,
            });
        }
    }

    /// Computes `X~ = U^-1 E B~`: first `E B~`, then back substitution (step 3).
    fn solve_input_states(&mut self, system: &ReducedSystem) {
        let n = self.order;
        let m = self.input_count;
        for row in 0..n {
            for column in 0..m {
                self.input_states[row * m + column] = Complex::from(system.b[(row, column)]);
            }
        }
        for (k, elimination) in self.eliminations.iter().enumerate() {
            let (above, below) = self.input_states.split_at_mut((k + 1) * m);
            let row = &mut above[k * m..];
            let next = &mut below[..m];
            if elimination.is_exchanged {
                row.swap_with_slice(next);
            }
            subtract(next, row, elimination.factor);
        }
        for k in (0..n).rev() {
            let (above, below) = self.input_states.split_at_mut((k + 1) * m);
            let row = &mut above[k * m..];
            for (later, values) in below.chunks_exact(m).enumerate() {
                subtract(row, values, self.upper[k * n + k + 1 + later]);
            }
            divide(row, self.upper[k * n + k]);
        }
    }

    /// Computes `Y~ = C~ U^-1 E`, transposed: first `U^-T C~^T` by forward substitution, then
    /// `E^T`, its row operations in reverse order (step 3).
    fn solve_output_states(&mut self, system: &ReducedSystem) {
        let n = self.order;
        let p = self.output_count;
        for row in 0..n {
            for column in 0..p {
                self.output_states[row * p + column] = Complex::from(system.c[(column, row)]);
            }
        }
        for k in 0..n {
            let (above, below) = self.output_states.split_at_mut((k + 1) * p);
            let row = &mut above[k * p..];
            divide(row, self.upper[k * n + k]);
            for (later, values) in below.chunks_exact_mut(p).enumerate() {
                subtract(values, row, self.upper[k * n + k + 1 + later]);
            }
        }
        for (k, elimination) in self.eliminations.iter().enumerate().rev() {
            let (above, below) = self.output_states.split_at_mut((k + 1) * p);
            let row = &mut above[k * p..];
            let next = &mut below[..p];
            subtract(row, next, elimination.factor);
            if elimination.is_exchanged {
                row.swap_with_slice(next);
            }
        }
    }

    /// Appends `H = C~ X~ + D` (step 3).
    fn add_response(
        &self,
        system: &ReducedSystem,
        feed_through: &DMatrix<f64>,
        response: &mut Vec<Complex<f64>>,
    ) {
        for output in 0..self.output_count {
            for input in 0..self.input_count {
                let mut value = Complex::from(feed_through[(output, input)]);
                for state in 0..self.order {
                    let factor = system.c[(output, state)];
                    value += self.input_states[state * self.input_count + input] * factor;
                }
                response.push(value);
            }
        }
    }
}

/// Subtracts `factor` times `other` from `row`.
fn subtract(row: &mut [Complex<f64>], other: &[Complex<f64>], factor: Complex<f64>) {
    for (value, other) in row.iter_mut().zip(other) {
        *value -= other * factor;
    }
}

fn divide(row: &mut [Complex<f64>], divisor: Complex<f64>) {
    let reciprocal = divisor.inv();
    for value in row {
        *value *= reciprocal;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(seed: f64) -> impl Fn(usize, usize) -> f64 {
        move |row, column| {
            (seed + 7.3 * row as f64 + 2.9 * column as f64 * (1.0 + row as f64)).sin()
        }
    }

    #[test]
    fn the_products_agree_with_a_dense_solution() {
        for order in [1, 2, 3, 8, 21] {
            let system = Matrices {
                a: DMatrix::from_fn(order, order, noise(1.0)),
                b: DMatrix::from_fn(order, 3, noise(2.0)),
                c: DMatrix::from_fn(2, order, noise(3.0)),
                d: DMatrix::from_fn(2, 3, noise(4.0)),
            };
            let s = [Complex::new(0.0, 0.7), Complex::new(0.1, 9.0)];
            let found = ResolventProducts::new(&system, &s);
            for (point, &s) in s.iter().enumerate() {
                let complex = |matrix: &DMatrix<f64>| matrix.map(Complex::from);
                let resolvent = (DMatrix::from_diagonal_element(order, order, s)
                    - complex(&system.a))
                .try_inverse()
                .unwrap();
                let x = &resolvent * complex(&system.b);
                let y = complex(&system.c) * &resolvent;
                let h = complex(&system.c) * &x + complex(&system.d);
                for state in 0..order {
                    for input in 0..3 {
                        let column = 6 * point + input;
                        let value = Complex::new(
                            found.input_states[(state, column)],
                            found.input_states[(state, column + 3)],
                        );
                        assert!((value - x[(state, input)]).norm() < 1e-11);
                    }
                    for output in 0..2 {
                        let row = 4 * point + output;
                        let value = Complex::new(
                            found.output_states[(row, state)],
                            found.output_states[(row + 2, state)],
                        );
                        assert!((value - y[(output, state)]).norm() < 1e-11);
                    }
                }
                for output in 0..2 {
                    for input in 0..3 {
                        let value = found.response[(point * 2 + output) * 3 + input];
                        assert!((value - h[(output, input)]).norm() < 1e-11);
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_on_a_pole_has_no_finite_response() {
        let system = Matrices {
            a: DMatrix::zeros(1, 1),
            b: DMatrix::identity(1, 1),
            c: DMatrix::identity(1, 1),
            d: DMatrix::zeros(1, 1),
        };
        let found = ResolventProducts::new(&system, &[Complex::new(0.0, 0.0)]);
        assert!(!found.response[0].is_finite());
    }
}
