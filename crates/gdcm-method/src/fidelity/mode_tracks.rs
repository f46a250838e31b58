//! A mode followed across the models of a bundle, and the models at which it jumps.
//!
//! The modes are matched by an assignment with minimum total cost.
//!
//! ```text
//! 1  row potentials u_i, column potentials v_j, with u_i + v_j <= c_ij, equal where i goes with j
//! 2  for each row i in turn: grow a column tree from i by the least reduced cost c_ij - u_i - v_j (Dijkstra),
//!    moving the potentials with it, until a column is free
//! 3  shift the assignments along the path from i to that column
//! ```
//!
//! Kuhn, "The Hungarian method for the assignment problem", Naval Research Logistics Quarterly 2,
//! 1955, with shortest augmenting paths: Jonker & Volgenant, Computing 38, 1987. O(rows^2 columns).

use nalgebra::Complex;

use gdcm_model::response::Mode;
use gdcm_model::statistics::median;

/// Minimum distance of a jump from the centre, in track spreads: a smooth track over perturbations
/// in both directions ends at two to three spreads.
const JUMP_SPREADS: f64 = 5.0;
/// Minimum distance \[rad/s\] that counts as a jump: a smaller shift of a helicopter's slowest mode
/// does not change the response within any band.
const LEAST_JUMP_RAD_S: f64 = 0.05;

/// A mode in the reference model and its matches in the other models.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeTrack {
    /// Index of the mode in the reference model.
    pub reference: usize,
    /// The matched mode's index in each model; `None` if the model has fewer poles.
    pub modes: Vec<Option<usize>>,
    /// The poles' centre \[rad/s\]: median real part and median imaginary part.
    pub centre: Complex<f64>,
    /// Median distance of the poles from the centre \[rad/s\].
    pub spread_rad_s: f64,
    /// Models whose pole is more than 5 spreads and more than 0.05 rad/s from the centre.
    pub jumps: Vec<usize>,
}

/// Returns the track of each mode of `models[reference]`, in its order; a conjugate pair has one
/// track, unless a model matches it with two poles that are not a pair.
///
/// The poles of each model are matched to the poles of the reference with the minimum sum of
/// s-plane distances (an assignment problem). No tracks if the reference has no modes.
pub fn mode_tracks(models: &[&[Mode]], reference: usize) -> Vec<ModeTrack> {
    let Some(reference_modes) = models.get(reference).copied() else {
        return Vec::new();
    };
    let matches: Vec<Vec<Option<usize>>> = models
        .iter()
        .map(|model| matched(reference_modes, model))
        .collect();
    let mut tracks = Vec::new();
    for (mode, reference_mode) in reference_modes.iter().enumerate() {
        let modes: Vec<Option<usize>> = matches.iter().map(|matched| matched[mode]).collect();
        let poles: Vec<Option<Complex<f64>>> = models
            .iter()
            .zip(&modes)
            .map(|(model, mode)| mode.map(|mode| model[mode].pole))
            .collect();
        // The track of the conjugate mode covers both.
        let is_mirror =
            reference_mode.pole.im < 0.0 && poles.iter().flatten().all(|pole| pole.im < 0.0);
        if !is_mirror {
            tracks.push(track(mode, modes, &poles));
        }
    }
    tracks
}

/// Computes the track of a reference mode from its match in each model.
fn track(reference: usize, modes: Vec<Option<usize>>, poles: &[Option<Complex<f64>>]) -> ModeTrack {
    let known: Vec<Complex<f64>> = poles.iter().flatten().copied().collect();
    let mut real_parts: Vec<f64> = known.iter().map(|pole| pole.re).collect();
    let mut imaginary_parts: Vec<f64> = known.iter().map(|pole| pole.im).collect();
    let centre = Complex::new(median(&mut real_parts), median(&mut imaginary_parts));
    let mut distances: Vec<f64> = known.iter().map(|pole| (pole - centre).norm()).collect();
    let spread_rad_s = median(&mut distances);
    let far_rad_s = (JUMP_SPREADS * spread_rad_s).max(LEAST_JUMP_RAD_S);
    let mut jumps = Vec::new();
    for (model, pole) in poles.iter().enumerate() {
        if let Some(pole) = pole
            && (pole - centre).norm() > far_rad_s
        {
            jumps.push(model);
        }
    }
    ModeTrack {
        reference,
        modes,
        centre,
        spread_rad_s,
        jumps,
    }
}

/// Returns the match in `model` for each mode in `reference`; `None` for a mode without a match in
/// a smaller model.
fn matched(reference: &[Mode], model: &[Mode]) -> Vec<Option<usize>> {
    let mut matches = vec![None; reference.len()];
    if reference.len() <= model.len() {
        let columns = least_total(reference.len(), model.len(), |row, column| {
            (reference[row].pole - model[column].pole).norm()
        });
        for (place, mode) in columns.into_iter().enumerate() {
            matches[place] = Some(mode);
        }
    } else {
        let columns = least_total(model.len(), reference.len(), |row, column| {
            (reference[column].pole - model[row].pole).norm()
        });
        for (mode, place) in columns.into_iter().enumerate() {
            matches[place] = Some(mode);
        }
    }
    matches
}

/// Assigns a different column to each row with the smallest total cost; needs at least as many
/// columns as rows, and finite costs.
pub(crate) fn least_total(
    rows: usize,
    columns: usize,
    cost: impl Fn(usize, usize) -> f64,
) -> Vec<usize> {
    let mut assignment = Assignment {
        row_potentials: vec![0.0; rows],
        column_potentials: vec![0.0; columns],
        row_of: vec![None; columns],
    };
    for row in 0..rows {
        assignment.augment(row, &cost);
    }
    let mut column_of = vec![0; rows];
    for (column, row) in assignment.row_of.into_iter().enumerate() {
        if let Some(row) = row {
            column_of[row] = column;
        }
    }
    column_of
}

/// A partial assignment of minimum cost.
struct Assignment {
    /// `u`, by row.
    row_potentials: Vec<f64>,
    /// `v`, by column.
    column_potentials: Vec<f64>,
    /// Each column's row; `None` for a free column.
    row_of: Vec<Option<usize>>,
}

impl Assignment {
    /// Assigns a column to the row `new`, and reassigns earlier rows where that costs less (steps 2
    /// and 3).
    fn augment(&mut self, new: usize, cost: &impl Fn(usize, usize) -> f64) {
        let columns = self.row_of.len();
        let mut distance = vec![f64::INFINITY; columns];
        // The previous column on the path from the new row; `None` at the row itself.
        let mut before: Vec<Option<usize>> = vec![None; columns];
        let mut in_tree = vec![false; columns];
        let mut last = None;
        let mut row = new;
        loop {
            for column in 0..columns {
                if in_tree[column] {
                    continue;
                }
                let reduced =
                    cost(row, column) - self.row_potentials[row] - self.column_potentials[column];
                if reduced < distance[column] {
                    distance[column] = reduced;
                    before[column] = last;
                }
            }
            let open = (0..columns).filter(|&column| !in_tree[column]);
            let Some(next) = open.min_by(|&a, &b| distance[a].total_cmp(&distance[b])) else {
                return;
            };
            self.shift_potentials(new, &in_tree, &mut distance, next);
            in_tree[next] = true;
            last = Some(next);
            match self.row_of[next] {
                Some(owner) => row = owner,
                None => break,
            }
        }
        self.shift_assignments(new, &before, last);
    }

    /// Moves the tree's potentials so that the reduced cost to `next` becomes zero.
    fn shift_potentials(
        &mut self,
        new: usize,
        in_tree: &[bool],
        distance: &mut [f64],
        next: usize,
    ) {
        let step = distance[next];
        self.row_potentials[new] += step;
        for (column, owner) in self.row_of.iter().enumerate() {
            match owner {
                Some(owner) if in_tree[column] => {
                    self.row_potentials[*owner] += step;
                    self.column_potentials[column] -= step;
                }
                _ => distance[column] -= step,
            }
        }
    }

    /// Gives each column on the path back from `last` the previous column's row, and the first
    /// column the row `new`.
    fn shift_assignments(&mut self, new: usize, before: &[Option<usize>], last: Option<usize>) {
        let mut at = last;
        while let Some(column) = at {
            at = before[column];
            self.row_of[column] = match at {
                Some(previous) => self.row_of[previous],
                None => Some(new),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};

    use gdcm_model::dataset::StateSpace;
    use gdcm_model::response::modes;

    use super::*;

    /// Modes of the system matrix `a`.
    fn modes_of(a: DMatrix<f64>) -> Vec<Mode> {
        let n = a.nrows();
        let b = DMatrix::zeros(n, 1);
        let c = DMatrix::zeros(1, n);
        let d = DMatrix::zeros(1, 1);
        modes(&StateSpace::new(a, b, c, d).unwrap()).unwrap()
    }

    /// A lag with `rate` and an oscillator with `frequency` and damping 0.2.
    fn lag_and_oscillator(rate: f64, frequency: f64) -> Vec<Mode> {
        let stiffness = -frequency * frequency;
        let damping = -0.4 * frequency;
        modes_of(dmatrix![-rate, 0.0, 0.0; 0.0, 0.0, 1.0; 0.0, stiffness, damping])
    }

    #[test]
    fn a_mode_that_jumps_at_one_trim_is_seen_and_the_others_are_not() {
        // The lag exceeds the oscillator in modulus: matching by modulus alone would confuse them.
        let bundle: Vec<Vec<Mode>> = (0..9)
            .map(|k| {
                let step = f64::from(k - 4);
                let frequency = if k == 7 { 2.6 } else { 2.0 + 0.01 * step };
                lag_and_oscillator(2.0 + 0.02 * step, frequency)
            })
            .collect();
        let models: Vec<&[Mode]> = bundle.iter().map(Vec::as_slice).collect();
        let tracks = mode_tracks(&models, 4);
        assert_eq!(tracks.len(), 2, "the pair is one track");
        for track in &tracks {
            let poles: Vec<Complex<f64>> = track
                .modes
                .iter()
                .zip(&bundle)
                .map(|(mode, modes)| modes[mode.unwrap()].pole)
                .collect();
            let oscillates = bundle[4][track.reference].oscillates();
            assert!(
                poles.iter().all(|pole| (pole.im > 1.0) == oscillates),
                "{poles:?}"
            );
            assert_eq!(track.jumps, if oscillates { vec![7] } else { vec![] });
            assert!(track.spread_rad_s < 0.05);
        }
    }

    #[test]
    fn a_pair_that_meets_the_real_axis_in_one_model_is_two_tracks() {
        let [pair, two] = [3.0, 5.0].map(|damping| modes_of(dmatrix![0.0, 1.0; -4.0, -damping]));
        let tracks = mode_tracks(&[&pair, &two], 0);
        let places: Vec<Option<usize>> = tracks.iter().map(|track| track.modes[1]).collect();
        assert_eq!(places.len(), 2);
        assert!(places.contains(&Some(0)) && places.contains(&Some(1)));
    }

    #[test]
    fn models_of_other_orders_leave_gaps() {
        let small = modes_of(dmatrix![-1.0]);
        let large = modes_of(dmatrix![-9.0, 0.0; 0.0, -1.1]);
        assert_eq!(
            mode_tracks(&[&small, &large], 0)[0].modes,
            [Some(0), Some(0)]
        );
        let from_large = mode_tracks(&[&small, &large], 1);
        assert_eq!(
            from_large
                .iter()
                .map(|track| track.modes[0])
                .collect::<Vec<_>>(),
            [Some(0), None]
        );
        assert_eq!(mode_tracks(&[&[], &large], 0), []);
    }
}

#[cfg(test)]
mod assignment_tests {
    use proptest::prelude::*;

    use super::*;

    /// Minimum total over all assignments, by exhaustive search.
    fn tried_out(costs: &[Vec<f64>], row: usize, taken: &mut Vec<usize>) -> f64 {
        if row == costs.len() {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        for column in 0..costs[row].len() {
            if !taken.contains(&column) {
                taken.push(column);
                least = least.min(costs[row][column] + tried_out(costs, row + 1, taken));
                taken.pop();
            }
        }
        least
    }

    #[test]
    fn the_nearest_is_not_taken_where_the_total_suffers() {
        // Column 0 is the cheapest for both rows, and the only cheap column for row 1.
        let costs = [[1.0, 2.0, 9.0], [1.0, 9.0, 9.0]];
        assert_eq!(least_total(2, 3, |row, column| costs[row][column]), [1, 0]);
        assert_eq!(least_total(0, 3, |_, _| 0.0), [0; 0]);
    }

    proptest! {
        #[test]
        fn no_assignment_costs_less(entries in prop::collection::vec(0.0_f64..10.0, 25), rows in 1_usize..=5) {
            let costs: Vec<Vec<f64>> = (0..rows).map(|row| entries[5 * row..5 * row + 5].to_vec()).collect();
            let columns = least_total(rows, 5, |row, column| costs[row][column]);
            let mut distinct = columns.clone();
            distinct.sort_unstable();
            distinct.dedup();
            prop_assert_eq!(distinct.len(), rows);
            let total: f64 = columns.iter().enumerate().map(|(row, &column)| costs[row][column]).sum();
            // Sums of five terms are rounded in another order.
            prop_assert!((total - tried_out(&costs, 0, &mut Vec::new())).abs() < 1e-13);
        }
    }
}
