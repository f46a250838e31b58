//! Follows each mode across the models in a bundle, and finds the models at which it jumps.
//!
//! Each model's modes are matched to a reference model's modes by the assignment with the minimum
//! sum of s-plane distances, so that one close match does not force a distant one.
//!
//! ```text
//! 1  match each model's poles to the reference's poles (assignment)
//! 2  track: the matches of one reference mode; for a conjugate pair, only of the mode with positive
//!    imaginary part, unless a model breaks the pair
//! 3  centre <- median real and imaginary part;  spread <- median distance from the centre
//! 4  jump: a pole more than 5 spreads and more than 0.05 rad/s from the centre
//! ```

use nalgebra::Complex;

use gdcm_model::response::Mode;
use gdcm_model::statistics::median;

use super::assignment::cheapest_assignment;

/// Minimum distance from the centre that counts as a jump, in track spreads: a smooth track over
/// perturbations in both directions ends at two to three spreads.
const JUMP_SPREADS: f64 = 5.0;
/// Minimum distance \[rad/s\] that counts as a jump: a smaller shift of a helicopter's slowest mode
/// does not change the response within any band.
const LEAST_JUMP_RAD_S: f64 = 0.05;

/// A mode in the reference model and its matches in the other models.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeTrack {
    /// The mode's index in the reference model.
    pub reference: usize,
    /// The matched mode's index in each model; `None` if the model has fewer poles than the
    /// reference, and none for this mode.
    pub modes: Vec<Option<usize>>,
    /// The poles' centre \[rad/s\]: median real part and median imaginary part.
    pub centre: Complex<f64>,
    /// Median distance between the poles and the centre \[rad/s\].
    pub spread_rad_s: f64,
    /// Models whose pole is more than 5 spreads and more than 0.05 rad/s from the centre.
    pub jumps: Vec<usize>,
}

/// Returns a track for each mode in `models[reference]`, in that model's mode order; a conjugate
/// pair has one track, unless a model matches it with two poles that are not a pair.
///
/// Each model's poles are matched to the reference's poles with the minimum sum of s-plane
/// distances (an assignment problem). No tracks if the reference has no modes.
pub fn mode_tracks(models: &[&[Mode]], reference: usize) -> Vec<ModeTrack> {
    let Some(reference_modes) = models.get(reference).copied() else {
        return Vec::new();
    };
    // Step 1
    let matches: Vec<Vec<Option<usize>>> = models
        .iter()
        .map(|model| match_modes(reference_modes, model))
        .collect();
    let mut tracks = Vec::new();
    for (index, reference_mode) in reference_modes.iter().enumerate() {
        let modes: Vec<Option<usize>> = matches.iter().map(|matches| matches[index]).collect();
        let poles: Vec<Option<Complex<f64>>> = models
            .iter()
            .zip(&modes)
            .map(|(model, mode)| mode.map(|mode| model[mode].pole))
            .collect();
        // Step 2: the conjugate mode's track covers both.
        let is_mirror =
            reference_mode.pole.im < 0.0 && poles.iter().flatten().all(|pole| pole.im < 0.0);
        if !is_mirror {
            tracks.push(track(index, modes, &poles));
        }
    }
    tracks
}

/// Computes a reference mode's track from its match in each model (steps 3 and 4).
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

/// Step 1: returns the match in `model` for each mode in `reference`; `None` for a mode without a
/// match in a smaller model. The assignment's rows are the smaller model's modes.
fn match_modes(reference: &[Mode], model: &[Mode]) -> Vec<Option<usize>> {
    let mut matches = vec![None; reference.len()];
    if reference.len() <= model.len() {
        let columns = cheapest_assignment(reference.len(), model.len(), |row, column| {
            (reference[row].pole - model[column].pole).norm()
        });
        for (reference_mode, mode) in columns.into_iter().enumerate() {
            matches[reference_mode] = Some(mode);
        }
    } else {
        let columns = cheapest_assignment(model.len(), reference.len(), |row, column| {
            (reference[column].pole - model[row].pole).norm()
        });
        for (mode, reference_mode) in columns.into_iter().enumerate() {
            matches[reference_mode] = Some(mode);
        }
    }
    matches
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
