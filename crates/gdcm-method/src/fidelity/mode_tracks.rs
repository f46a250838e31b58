//! A mode followed across the models of a bundle, and the models at which it jumps.
//!
//! The matching is an assignment problem with the smallest total cost.
//!
//! ```text
//! 1  potentials u_i of the rows, v_j of the columns, with u_i + v_j <= c_ij, equal where i goes with j
//! 2  for each row i in turn: grow a tree of columns from i by the least reduced cost c_ij - u_i - v_j (Dijkstra) ...
//! 3     ... moving the potentials with it, until a column is free
//! 4     along the path back to i each row takes the column that it was reached by
//! ```
//!
//! Kuhn, "The Hungarian method for the assignment problem", Naval Research Logistics Quarterly 2,
//! 1955, with shortest augmenting paths: Jonker & Volgenant, Computing 38, 1987. O(rows^2 columns).

use nalgebra::Complex;

use gdcm_model::response::Mode;
use gdcm_model::statistics::median;

/// Distance of a jump from the centre, in spreads of the track: a smooth track over perturbations
/// to both sides ends at two to three.
const JUMP_SPREADS: f64 = 5.0;
/// Smallest distance of a jump \[rad/s\]: a smaller shift of a helicopter's slowest mode changes
/// the response in no band.
const LEAST_JUMP_RAD_S: f64 = 0.05;

/// A mode of the reference model and its matches in the other models.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeTrack {
    /// Its index among the modes of the reference model.
    pub reference: usize,
    /// Index of the matched mode of each model; `None` if the model has fewer poles.
    pub modes: Vec<Option<usize>>,
    /// Centre of the poles \[rad/s\]: the medians of the real parts and of the imaginary parts.
    pub centre: Complex<f64>,
    /// Median distance from the centre \[rad/s\].
    pub spread_rad_s: f64,
    /// Models whose pole is farther from the centre than 5 spreads and than 0.05 rad/s.
    pub jumps: Vec<usize>,
}

/// Returns the track of each mode of `models[reference]`, in its order; a conjugate pair has one
/// track, unless a model matches it with two poles that are not a pair.
///
/// Each model's poles are matched to those of the reference with the smallest sum of distances in
/// the s-plane (an assignment problem). No tracks if the reference has no modes.
pub fn mode_tracks(models: &[&[Mode]], reference: usize) -> Vec<ModeTrack> {
    let Some(of_reference) = models.get(reference).copied() else {
        return Vec::new();
    };
    let matches: Vec<Vec<Option<usize>>> = models
        .iter()
        .map(|model| matched(of_reference, model))
        .collect();
    let pole =
        |model: usize, track: usize| matches[model][track].map(|mode| models[model][mode].pole);
    let is_mirror = |track: usize| {
        of_reference[track].pole.im < 0.0
            && (0..models.len()).all(|model| pole(model, track).is_none_or(|pole| pole.im < 0.0))
    };
    let tracks = (0..of_reference.len()).filter(|&track| !is_mirror(track));
    tracks
        .map(|track| {
            let poles: Vec<Option<Complex<f64>>> =
                (0..models.len()).map(|model| pole(model, track)).collect();
            let modes = matches.iter().map(|matched| matched[track]).collect();
            let known: Vec<Complex<f64>> = poles.iter().flatten().copied().collect();
            let middle = |part: fn(&Complex<f64>) -> f64| {
                median(&mut known.iter().map(part).collect::<Vec<f64>>())
            };
            let centre = Complex::new(middle(|pole| pole.re), middle(|pole| pole.im));
            let distance = |pole: &Complex<f64>| (pole - centre).norm();
            let spread_rad_s = median(&mut known.iter().map(distance).collect::<Vec<f64>>());
            let far = (JUMP_SPREADS * spread_rad_s).max(LEAST_JUMP_RAD_S);
            let jumps = poles
                .iter()
                .enumerate()
                .filter(|(_, pole)| pole.is_some_and(|pole| distance(&pole) > far));
            ModeTrack {
                reference: track,
                modes,
                centre,
                spread_rad_s,
                jumps: jumps.map(|(model, _)| model).collect(),
            }
        })
        .collect()
}

/// Returns the match in `model` of each mode of `reference`.
fn matched(reference: &[Mode], model: &[Mode]) -> Vec<Option<usize>> {
    let distance = |a: usize, b: usize| (reference[a].pole - model[b].pole).norm();
    if reference.len() <= model.len() {
        return least_total(reference.len(), model.len(), distance)
            .into_iter()
            .map(Some)
            .collect();
    }
    let mut places = vec![None; reference.len()];
    for (mode, place) in least_total(model.len(), reference.len(), |b, a| distance(a, b))
        .into_iter()
        .enumerate()
    {
        places[place] = Some(mode);
    }
    places
}

/// Assigns a different column to each row with the smallest total cost; needs at least as many
/// columns as rows, and finite costs.
pub(crate) fn least_total(
    rows: usize,
    columns: usize,
    cost: impl Fn(usize, usize) -> f64,
) -> Vec<usize> {
    let mut potentials = (vec![0.0; rows], vec![0.0; columns]);
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    for row in 0..rows {
        augment(row, &cost, &mut potentials, &mut row_of);
    }
    let mut column_of = vec![0; rows];
    for (column, row) in row_of.into_iter().enumerate() {
        if let Some(row) = row {
            column_of[row] = column;
        }
    }
    column_of
}

/// Assigns a column to `new`, and reassigns earlier rows where that costs less.
fn augment(
    new: usize,
    cost: &impl Fn(usize, usize) -> f64,
    (of_row, of_column): &mut (Vec<f64>, Vec<f64>),
    row_of: &mut [Option<usize>],
) {
    let columns = row_of.len();
    let mut distance = vec![f64::INFINITY; columns];
    // The previous column on the path from the new row; `None` at the row itself.
    let mut before: Vec<Option<usize>> = vec![None; columns];
    let mut in_tree = vec![false; columns];
    let mut at = None;
    let mut row = new;
    loop {
        for column in (0..columns).filter(|&column| !in_tree[column]) {
            let reduced = cost(row, column) - of_row[row] - of_column[column];
            if reduced < distance[column] {
                (distance[column], before[column]) = (reduced, at);
            }
        }
        let open = (0..columns).filter(|&column| !in_tree[column]);
        let Some(next) = open.min_by(|&a, &b| distance[a].total_cmp(&distance[b])) else {
            return;
        };
        let step = distance[next];
        of_row[new] += step;
        for (column, owner) in row_of.iter().enumerate() {
            match owner {
                Some(owner) if in_tree[column] => {
                    of_row[*owner] += step;
                    of_column[column] -= step;
                }
                _ => distance[column] -= step,
            }
        }
        in_tree[next] = true;
        at = Some(next);
        match row_of[next] {
            Some(owner) => row = owner,
            None => break,
        }
    }
    while let Some(column) = at {
        at = before[column];
        row_of[column] = at.map_or(Some(new), |previous| row_of[previous]);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};

    use gdcm_model::dataset::StateSpace;
    use gdcm_model::response::modes;

    use super::*;

    fn of(a: DMatrix<f64>) -> Vec<Mode> {
        let n = a.nrows();
        modes(
            &StateSpace::new(
                a,
                DMatrix::zeros(n, 1),
                DMatrix::zeros(1, n),
                DMatrix::zeros(1, 1),
            )
            .unwrap(),
        )
        .unwrap()
    }

    /// A lag with `rate` and an oscillator with `frequency` and damping 0.2.
    fn lag_and_oscillator(rate: f64, frequency: f64) -> Vec<Mode> {
        let stiffness = -frequency * frequency;
        let damping = -0.4 * frequency;
        of(dmatrix![-rate, 0.0, 0.0; 0.0, 0.0, 1.0; 0.0, stiffness, damping])
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
                .map(|(mode, of)| of[mode.unwrap()].pole)
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
        let [pair, two] = [3.0, 5.0].map(|damping| of(dmatrix![0.0, 1.0; -4.0, -damping]));
        let tracks = mode_tracks(&[&pair, &two], 0);
        let places: Vec<Option<usize>> = tracks.iter().map(|track| track.modes[1]).collect();
        assert_eq!(places.len(), 2);
        assert!(places.contains(&Some(0)) && places.contains(&Some(1)));
    }

    #[test]
    fn models_of_other_orders_leave_gaps() {
        let small = of(dmatrix![-1.0]);
        let large = of(dmatrix![-9.0, 0.0; 0.0, -1.1]);
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

    /// The smallest total over every assignment, by exhaustive search.
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
        // Both rows are nearest to column 0, and row 1 has no other column nearby.
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
            // Sums of five terms in another order.
            prop_assert!((total - tried_out(&costs, 0, &mut Vec::new())).abs() < 1e-13);
        }
    }
}
