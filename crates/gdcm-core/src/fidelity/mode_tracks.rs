//! A mode followed from model to model of a bundle, and the models at which it jumps.

use nalgebra::Complex;

use crate::response::{Mode, median};

use super::assignment::least_total;

/// How many times the spread of its track a pole has to be from the middle to jump: a smooth track over perturbations to both
/// sides ends at two to three.
const JUMP_SPREADS: f64 = 5.0;
/// Least distance of a jump \[rad/s\]: below it the slowest mode of a helicopter does not change the response in any band.
const LEAST_JUMP_RAD_S: f64 = 0.05;

/// One mode of the reference model and the modes that the other models have in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeTrack {
    /// Its index among the modes of the reference model.
    pub reference: usize,
    /// The mode of each model in its place, by index among that model's; none where the model has fewer poles.
    pub modes: Vec<Option<usize>>,
    /// The middle of the poles \[rad/s\]: the median of the real parts and that of the imaginary parts.
    pub centre: Complex<f64>,
    /// Median of the distances from the middle \[rad/s\].
    pub spread_rad_s: f64,
    /// The models whose pole is farther from the middle than 5 spreads, and than 0.05 rad/s.
    pub jumps: Vec<usize>,
}

/// The track of each mode of `models[reference]`, in its order; of a conjugate pair one, unless a model has two poles that are
/// no pair in its place.
///
/// Each model's poles are matched to those of the reference so that the sum of the distances in the s-plane is least
/// (an assignment problem). There are none where the reference has no modes.
pub fn mode_tracks(models: &[&[Mode]], reference: usize) -> Vec<ModeTrack> {
    let Some(of_reference) = models.get(reference).copied() else { return Vec::new() };
    let matches: Vec<Vec<Option<usize>>> = models.iter().map(|model| matched(of_reference, model)).collect();
    let pole = |model: usize, track: usize| matches[model][track].map(|mode| models[model][mode].pole);
    let is_mirror = |track: usize| {
        of_reference[track].pole.im < 0.0
            && (0..models.len()).all(|model| pole(model, track).is_none_or(|pole| pole.im < 0.0))
    };
    let tracks = (0..of_reference.len()).filter(|&track| !is_mirror(track));
    tracks
        .map(|track| {
            let poles: Vec<Option<Complex<f64>>> = (0..models.len()).map(|model| pole(model, track)).collect();
            let modes = matches.iter().map(|matched| matched[track]).collect();
            let known: Vec<Complex<f64>> = poles.iter().flatten().copied().collect();
            let middle = |part: fn(&Complex<f64>) -> f64| median(&mut known.iter().map(part).collect::<Vec<f64>>());
            let centre = Complex::new(middle(|pole| pole.re), middle(|pole| pole.im));
            let distance = |pole: &Complex<f64>| (pole - centre).norm();
            let spread_rad_s = median(&mut known.iter().map(distance).collect::<Vec<f64>>());
            let far = (JUMP_SPREADS * spread_rad_s).max(LEAST_JUMP_RAD_S);
            let jumps = poles.iter().enumerate().filter(|(_, pole)| pole.is_some_and(|pole| distance(&pole) > far));
            ModeTrack { reference: track, modes, centre, spread_rad_s, jumps: jumps.map(|(model, _)| model).collect() }
        })
        .collect()
}

/// The mode of `model` in the place of each of `reference`.
fn matched(reference: &[Mode], model: &[Mode]) -> Vec<Option<usize>> {
    let distance = |a: usize, b: usize| (reference[a].pole - model[b].pole).norm();
    if reference.len() <= model.len() {
        return least_total(reference.len(), model.len(), distance).into_iter().map(Some).collect();
    }
    let mut places = vec![None; reference.len()];
    for (mode, place) in least_total(model.len(), reference.len(), |b, a| distance(a, b)).into_iter().enumerate() {
        places[place] = Some(mode);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dataset::StateSpace;
    use crate::response::modes;
    use nalgebra::{DMatrix, dmatrix};

    fn of(a: DMatrix<f64>) -> Vec<Mode> {
        let n = a.nrows();
        modes(&StateSpace::new(a, DMatrix::zeros(n, 1), DMatrix::zeros(1, n), DMatrix::zeros(1, 1)).unwrap()).unwrap()
    }

    /// A lag of `rate` and an oscillator of `frequency` damped 0.2.
    fn lag_and_oscillator(rate: f64, frequency: f64) -> Vec<Mode> {
        let (stiffness, damping) = (-frequency * frequency, -0.4 * frequency);
        of(dmatrix![-rate, 0.0, 0.0; 0.0, 0.0, 1.0; 0.0, stiffness, damping])
    }

    #[test]
    fn a_mode_that_jumps_at_one_trim_is_seen_and_the_others_are_not() {
        // The lag passes the oscillator in size: by size alone they would be taken for one another.
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
            let poles: Vec<Complex<f64>> =
                track.modes.iter().zip(&bundle).map(|(mode, of)| of[mode.unwrap()].pole).collect();
            let oscillates = bundle[4][track.reference].oscillates();
            assert!(poles.iter().all(|pole| (pole.im > 1.0) == oscillates), "{poles:?}");
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
        let (small, large) = (of(dmatrix![-1.0]), of(dmatrix![-9.0, 0.0; 0.0, -1.1]));
        assert_eq!(mode_tracks(&[&small, &large], 0)[0].modes, [Some(0), Some(0)]);
        let from_large = mode_tracks(&[&small, &large], 1);
        assert_eq!(from_large.iter().map(|track| track.modes[0]).collect::<Vec<_>>(), [Some(0), None]);
        assert_eq!(mode_tracks(&[&[], &large], 0), []);
    }
}
