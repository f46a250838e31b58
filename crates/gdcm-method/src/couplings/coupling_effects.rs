//! Effects of mixing and feedback (M16.4): the size of their entries in pilot units (percent of
//! stick, degrees of swashplate phase), the distance of the loop from ringing, its action above the
//! band, and the poles of a physics model that they move.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::{ConditionId, Pair, PairTable, StateSpace};
use gdcm_model::response::eigenvalues::ModesError;
use gdcm_model::response::{FrequencyResponse, modes};
use gdcm_model::units::ratio_to_db;

use super::coupling_matrices::{CoupledModelError, CouplingMatrices};
use super::problem::CouplingProblem;
use crate::correction::Pade;
use crate::fidelity::{ModeTrack, mode_tracks};

/// Peak share of the stick used by an entry of `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackShare {
    /// The input that receives the feedback.
    pub input: usize,
    /// The output that is fed back.
    pub output: usize,
    /// `K_input,output`, in input units per output unit.
    pub entry: f64,
    /// `|K_ij| |R'_jl|`, over 1: units of this input per unit of the input `moved`.
    pub share: f64,
    /// The moved input `l` with the largest share.
    pub moved: usize,
    /// The condition with the largest share.
    pub condition: ConditionId,
    /// The frequency with the largest share \[rad/s\].
    pub omega_rad_s: f64,
}

/// Returns the share of every entry of `K`, largest first; no entry for an output without flight
/// data.
pub fn feedback_shares(
    problem: &CouplingProblem,
    couplings: &CouplingMatrices,
) -> Vec<FeedbackShare> {
    let largest: Vec<_> = (0..problem.outputs())
        .map(|output| largest_response(problem, output))
        .collect();
    let inputs = problem.inputs();
    let feedback = couplings.feedback();
    let share = |(input, output): (usize, usize)| {
        let (magnitude, moved, condition, omega_rad_s) = largest[output]?;
        let entry = feedback[(input, output)];
        Some(FeedbackShare {
            input,
            output,
            entry,
            share: entry.abs() * magnitude,
            moved,
            condition,
            omega_rad_s,
        })
    };
    let entries =
        (0..inputs).flat_map(|input| (0..largest.len()).map(move |output| (input, output)));
    let mut shares: Vec<FeedbackShare> = entries.filter_map(share).collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    shares
}

/// Returns the largest `|R'_jl|` of one output over all inputs, conditions and frequencies, with
/// the first input, condition and frequency \[rad/s\] that attain it.
fn largest_response(
    problem: &CouplingProblem,
    output: usize,
) -> Option<(f64, usize, ConditionId, f64)> {
    let mut largest: Option<(f64, usize, ConditionId, f64)> = None;
    for condition in &problem.conditions {
        for moved in
            (0..problem.inputs()).filter(|&input| condition.usable[Pair::new(output, input)])
        {
            for (value, &omega_rad_s) in condition
                .flight
                .curve(Pair::new(output, moved))
                .iter()
                .zip(&*problem.omega)
            {
                let magnitude = value.norm();
                if magnitude.is_finite() && largest.is_none_or(|(most, ..)| magnitude > most) {
                    largest = Some((magnitude, moved, condition.id, omega_rad_s));
                }
            }
        }
    }
    largest
}

/// An off-diagonal entry of `M~`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixingShare {
    /// The input that receives the share.
    pub to: usize,
    /// The input that the share comes from.
    pub from: usize,
    /// `M~_to,from`, over 1.
    pub share: f64,
    /// `atan M~_to,from` \[deg\] where both inputs are cyclic.
    pub swashplate_phase_deg: Option<f64>,
}

/// Returns the off-diagonal entries of a normalised mixing, largest first; `cyclic` are the two
/// cyclic inputs.
pub fn mixing_shares(
    normalised_mixing: &DMatrix<f64>,
    cyclic: Option<[usize; 2]>,
) -> Vec<MixingShare> {
    let inputs = normalised_mixing.nrows();
    let entries = (0..inputs).flat_map(|to| (0..inputs).map(move |from| (to, from)));
    let share = |(to, from): (usize, usize)| {
        let share = normalised_mixing[(to, from)];
        let is_cyclic = cyclic.is_some_and(|pair| pair.contains(&to) && pair.contains(&from));
        MixingShare {
            to,
            from,
            share,
            swashplate_phase_deg: is_cyclic.then(|| share.atan().to_degrees()),
        }
    };
    let mut shares: Vec<MixingShare> = entries.filter(|(to, from)| to != from).map(share).collect();
    shares.sort_by(|a, b| b.share.abs().total_cmp(&a.share.abs()));
    shares
}

/// Returns the two cyclic inputs: those whose only on-axis response is a rate. `None` unless
/// exactly two qualify: a pedal has an on-axis lateral acceleration beside its rate, or would be
/// the third; no swashplate phase is reported then.
pub fn cyclic_inputs(
    on_axis: &PairTable<bool>,
    is_rate: impl Fn(usize) -> bool,
) -> Option<[usize; 2]> {
    let is_cyclic = |input: &usize| {
        let outputs: Vec<usize> = on_axis
            .marked()
            .filter(|pair| pair.input == *input)
            .map(|pair| pair.output)
            .collect();
        matches!(outputs[..], [output] if is_rate(output))
    };
    let found: Vec<usize> = (0..on_axis.inputs()).filter(is_cyclic).collect();
    found.try_into().ok()
}

/// The smallest singular value of `I - K H` over a set of frequencies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargin {
    /// The smallest singular value: 1 without feedback, 0 where a closed-loop pole is at `j omega`.
    pub least: f64,
    /// Its frequency \[rad/s\].
    pub omega_rad_s: f64,
}

impl LoopMargin {
    /// Threshold below which the loop is close to ringing.
    pub const CAUTION: f64 = 0.5;

    /// Returns the smallest of these singular values at `omega` \[rad/s\]; `None` if no value is
    /// finite.
    pub fn of(singular_values: &[f64], omega: &[f64]) -> Option<Self> {
        let known = singular_values
            .iter()
            .zip(omega)
            .filter(|(least, _)| least.is_finite());
        let (&least, &omega_rad_s) = known.min_by(|a, b| a.0.total_cmp(b.0))?;
        Some(Self { least, omega_rad_s })
    }

    /// Whether the margin deserves a caution.
    pub fn is_close_to_ringing(&self) -> bool {
        self.least < Self::CAUTION
    }
}

impl CouplingMatrices {
    /// Returns the smallest singular value of `I - K H` (m x m, at the inputs, where all channels
    /// share one unit) at each frequency of `H`; NaN where `H` lacks a response of an output that
    /// is fed back.
    pub fn least_singular_values(&self, physics: &FrequencyResponse) -> Vec<f64> {
        let points = physics.curve(Pair::new(0, 0)).len();
        (0..points)
            .map(|k| self.least_singular_value(physics, k))
            .collect()
    }

    fn least_singular_value(&self, physics: &FrequencyResponse, k: usize) -> f64 {
        let (inputs, outputs) = self.feedback().shape();
        let fed = |input: usize, of: usize| -> Complex<f64> {
            let terms = (0..outputs).map(|output| (self.feedback()[(input, output)], output));
            // A response that is not fed back may be missing.
            let terms = terms.filter(|(entry, _)| *entry != 0.0);
            terms
                .map(|(entry, output)| physics.curve(Pair::new(output, of))[k] * entry)
                .sum()
        };
        let unit = |input: usize, of: usize| if input == of { 1.0 } else { 0.0 };
        let difference = DMatrix::from_fn(inputs, inputs, |input, of| {
            -fed(input, of) + unit(input, of)
        });
        if !difference.iter().all(|entry| entry.is_finite()) {
            return f64::NAN;
        }
        difference.singular_values().min()
    }
}

/// Returns `20 log10 |H~ - H| / |H|` of each response at the `k`-th frequency, p x m; `None` where
/// a value is not finite or `H` is zero, minus infinity where nothing changes.
pub fn relative_change_db(
    physics: &FrequencyResponse,
    coupled: &FrequencyResponse,
    k: usize,
) -> PairTable<Option<f64>> {
    physics.curves().map(|pair, curve| {
        let before = curve.get(k)?;
        let after = coupled.curve(pair).get(k)?;
        let ratio = (after - before).norm() / before.norm();
        ratio.is_finite().then(|| ratio_to_db(ratio))
    })
}

/// A pole of the coupled model and its match in the physics model; one entry per conjugate pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleShift {
    /// Pole of the physics model \[rad/s\]; `None` for the extra states of the coupled model (the
    /// delays inside its loop).
    pub before: Option<Complex<f64>>,
    /// Pole of the coupled model \[rad/s\].
    pub after: Complex<f64>,
}

/// Reasons why the poles of a coupled model are unavailable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoleShiftError {
    #[error(transparent)]
    Model(#[from] CoupledModelError),
    #[error(transparent)]
    Modes(#[from] ModesError),
}

impl PoleShift {
    /// Returns the distance between the two poles \[rad/s\].
    pub fn distance_rad_s(&self) -> Option<f64> {
        self.before.map(|before| (self.after - before).norm())
    }

    /// Whether coupling moved the pole into the right half-plane.
    pub fn is_newly_unstable(&self) -> bool {
        self.after.re > 0.0 && self.before.is_none_or(|before| before.re <= 0.0)
    }
}

impl CouplingMatrices {
    /// Returns every pole of a physics model with mixing and feedback, in ascending `|lambda|`,
    /// matched to the poles without coupling so that the sum of distances is smallest.
    /// Discrete-time poles are converted by `s = ln z / T`.
    ///
    /// # Errors
    /// [`PoleShiftError`] if there is no coupled model or no eigenvalues.
    pub fn pole_shifts(
        &self,
        physics: &StateSpace,
        airspeed_kt: f64,
        pade: Pade,
    ) -> Result<Vec<PoleShift>, PoleShiftError> {
        let before = modes(physics)?;
        let after = modes(&self.model(physics, airspeed_kt, pade)?)?;
        let tracks = mode_tracks(&[&before, &after], 1);
        let shift = |track: ModeTrack| PoleShift {
            before: track.modes[0].map(|mode| before[mode].pole),
            after: after[track.reference].pole,
        };
        Ok(tracks.into_iter().map(shift).collect())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;

    #[test]
    fn the_cyclic_inputs_are_the_two_whose_only_axis_is_a_rate() {
        // Outputs P, Q, R, NY; inputs LON, LAT, PED.
        let axes = [(1, 0), (0, 1), (2, 2), (3, 2)];
        let table = |axes: &[(usize, usize)]| {
            PairTable::from_fn(4, 3, |Pair { output, input }| {
                axes.contains(&(output, input))
            })
        };
        assert_eq!(
            cyclic_inputs(&table(&axes), |output| output < 3),
            Some([0, 1])
        );
        assert_eq!(
            cyclic_inputs(&table(&axes[..3]), |output| output < 3),
            None,
            "a pedal without an acceleration is a third"
        );
        assert_eq!(cyclic_inputs(&table(&axes), |output| output == 0), None);
    }

    #[test]
    fn only_cyclic_inputs_have_a_swashplate_phase() {
        let shares = mixing_shares(
            &dmatrix![1.0, -0.02, 0.03; 0.047, 1.0, 0.0; 0.0, 0.1, 1.0],
            Some([0, 1]),
        );
        assert_eq!(
            (
                shares.len(),
                shares[0].to,
                shares[0].from,
                shares[0].swashplate_phase_deg
            ),
            (6, 2, 1, None)
        );
        // M16.4: 4.7 % corresponds to 2.7 degrees.
        assert!(
            (shares[1].swashplate_phase_deg.unwrap() - 2.7).abs() < 0.05
                && shares[1].share == 0.047
        );
    }
}
