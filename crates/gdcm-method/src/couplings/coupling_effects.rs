//! Effects of mixing and feedback (M16.4): their entries in pilot units (percent of stick, degrees
//! of swashplate phase), the stability margin of the loop, its effect above the band, and the
//! shifts of the poles.

use nalgebra::{Complex, DMatrix};

use gdcm_model::dataset::{ConditionId, Pair, PairTable, StateSpace};
use gdcm_model::response::mode::ModesError;
use gdcm_model::response::{FrequencyResponse, modes};
use gdcm_model::units::ratio_to_db;

use super::coupling_matrices::{CoupledModelError, CouplingMatrices};
use super::problem::CouplingProblem;
use crate::correction::Pade;
use crate::fidelity::mode_tracks;

/// Peak share of the stick that is used by an entry of `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackShare {
    /// Index of the input that receives the feedback.
    pub input: usize,
    /// Index of the output that is fed back.
    pub output: usize,
    /// `K_input,output`, in input units per output unit.
    pub entry: f64,
    /// `|K_ij| |R'_jl|` \[-\]: movement of input i per unit of movement of the input `moved`.
    pub share: f64,
    /// Index `l` of the moved input at the peak.
    pub moved: usize,
    /// Condition at the peak.
    pub condition: ConditionId,
    /// Frequency at the peak \[rad/s\].
    pub omega_rad_s: f64,
}

/// Returns the shares of all entries of `K` in descending order; entries for an output without
/// flight data are omitted.
pub fn feedback_shares(
    problem: &CouplingProblem,
    couplings: &CouplingMatrices,
) -> Vec<FeedbackShare> {
    let feedback = couplings.feedback();
    let mut shares = Vec::new();
    let peaks: Vec<Option<PeakResponse>> = (0..problem.outputs())
        .map(|output| PeakResponse::find(problem, output))
        .collect();
    for input in 0..problem.inputs() {
        for (output, peak) in peaks.iter().enumerate() {
            let Some(peak) = peak else { continue };
            let entry = feedback[(input, output)];
            shares.push(FeedbackShare {
                input,
                output,
                entry,
                share: entry.abs() * peak.magnitude,
                moved: peak.moved,
                condition: peak.condition,
                omega_rad_s: peak.omega_rad_s,
            });
        }
    }
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    shares
}

/// Maximum of `|R'_jl|` for an output j, over all inputs, conditions and frequencies.
struct PeakResponse {
    magnitude: f64,
    /// Index `l` of the input.
    moved: usize,
    condition: ConditionId,
    omega_rad_s: f64,
}

impl PeakResponse {
    /// Searches all inputs, conditions and frequencies. Returns the first of equal peaks; `None` if
    /// there is no usable response.
    fn find(problem: &CouplingProblem, output: usize) -> Option<Self> {
        let mut peak: Option<Self> = None;
        for condition in &problem.conditions {
            for moved in 0..problem.inputs() {
                let pair = Pair::new(output, moved);
                if !condition.usable[pair] {
                    continue;
                }
                let curve = condition.flight.curve(pair);
                for (value, &omega_rad_s) in curve.iter().zip(&*problem.omega) {
                    let magnitude = value.norm();
                    let is_larger = peak.as_ref().is_none_or(|peak| magnitude > peak.magnitude);
                    if magnitude.is_finite() && is_larger {
                        peak = Some(Self {
                            magnitude,
                            moved,
                            condition: condition.id,
                            omega_rad_s,
                        });
                    }
                }
            }
        }
        peak
    }
}

/// An off-diagonal entry of the normalised mixing `M~`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixingShare {
    /// Index of the input to which the share is added.
    pub to: usize,
    /// Index of the input from which the share is taken.
    pub from: usize,
    /// `M~_to,from` \[-\].
    pub share: f64,
    /// `atan M~_to,from` \[deg\]; `None` unless both inputs are cyclic.
    pub swashplate_phase_deg: Option<f64>,
}

/// Returns the off-diagonal entries of a normalised mixing, largest magnitude first; `cyclic` holds
/// the indices of the two cyclic inputs.
pub fn mixing_shares(
    normalised_mixing: &DMatrix<f64>,
    cyclic: Option<[usize; 2]>,
) -> Vec<MixingShare> {
    let inputs = normalised_mixing.nrows();
    let mut shares = Vec::new();
    for to in 0..inputs {
        for from in (0..inputs).filter(|&from| from != to) {
            let share = normalised_mixing[(to, from)];
            let is_cyclic = cyclic.is_some_and(|pair| pair.contains(&to) && pair.contains(&from));
            let swashplate_phase_deg = if is_cyclic {
                Some(share.atan().to_degrees())
            } else {
                None
            };
            shares.push(MixingShare {
                to,
                from,
                share,
                swashplate_phase_deg,
            });
        }
    }
    shares.sort_by(|a, b| b.share.abs().total_cmp(&a.share.abs()));
    shares
}

/// Returns the indices of the two cyclic inputs: those whose only on-axis response is a rate.
/// `None` unless exactly two inputs qualify; a pedal, for example, does not qualify if it also has
/// an on-axis lateral acceleration.
pub fn cyclic_inputs(
    on_axis: &PairTable<bool>,
    is_rate: impl Fn(usize) -> bool,
) -> Option<[usize; 2]> {
    let mut cyclic = Vec::new();
    for input in 0..on_axis.inputs() {
        let outputs: Vec<usize> = on_axis
            .marked()
            .filter(|pair| pair.input == input)
            .map(|pair| pair.output)
            .collect();
        if let [output] = outputs[..]
            && is_rate(output)
        {
            cyclic.push(input);
        }
    }
    cyclic.try_into().ok()
}

/// Stability margin of the loop: the minimum over several frequencies of the smallest singular
/// value of `I - K H`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopMargin {
    /// Minimum singular value: 1 without feedback, 0 if a closed-loop pole is at `j omega`.
    pub least: f64,
    pub omega_rad_s: f64,
}

impl LoopMargin {
    /// Margin below which the loop is reported as close to ringing.
    pub const CAUTION: f64 = 0.5;

    /// Returns the minimum of singular values, given at `omega` \[rad/s\]; `None` if none is
    /// finite.
    pub fn of(singular_values: &[f64], omega: &[f64]) -> Option<Self> {
        let mut margin: Option<Self> = None;
        for (&least, &omega_rad_s) in singular_values.iter().zip(omega) {
            let is_smaller = margin.is_none_or(|margin| least < margin.least);
            if least.is_finite() && is_smaller {
                margin = Some(Self { least, omega_rad_s });
            }
        }
        margin
    }

    /// Returns whether the margin is below [`Self::CAUTION`].
    pub fn is_close_to_ringing(&self) -> bool {
        self.least < Self::CAUTION
    }
}

impl CouplingMatrices {
    /// Returns the smallest singular value of `I - K H` at each frequency; NaN if `H` lacks a
    /// fed-back response. The matrix is m x m, at the inputs, where all channels have the same
    /// unit.
    pub fn least_singular_values(&self, physics: &FrequencyResponse) -> Vec<f64> {
        let points = physics.curve(Pair::new(0, 0)).len();
        (0..points)
            .map(|k| self.least_singular_value(physics, k))
            .collect()
    }

    /// Returns the smallest singular value of `I - K H` at frequency index `k`.
    fn least_singular_value(&self, physics: &FrequencyResponse, k: usize) -> f64 {
        let (inputs, outputs) = self.feedback().shape();
        let difference = DMatrix::from_fn(inputs, inputs, |to, from| {
            // Skip responses that are not fed back, since they may be missing.
            let fed: Complex<f64> = (0..outputs)
                .filter(|&output| self.feedback()[(to, output)] != 0.0)
                .map(|output| {
                    physics.curve(Pair::new(output, from))[k] * self.feedback()[(to, output)]
                })
                .sum();
            let unit = if to == from { 1.0 } else { 0.0 };
            -fed + unit
        });
        if difference.iter().any(|entry| !entry.is_finite()) {
            return f64::NAN;
        }
        difference.singular_values().min()
    }
}

/// Returns `20 log10 |H~ - H| / |H|` of every response at frequency index `k`, p x m; `None` if a
/// value is not finite or `H` is zero, minus infinity if nothing changes.
pub fn relative_change_db(
    physics: &FrequencyResponse,
    coupled: &FrequencyResponse,
    k: usize,
) -> PairTable<Option<f64>> {
    physics.curves().map(|pair, curve| {
        let before = curve.get(k)?;
        let after = coupled.curve(pair).get(k)?;
        let ratio = (after - before).norm() / before.norm();
        if ratio.is_finite() {
            Some(ratio_to_db(ratio))
        } else {
            None
        }
    })
}

/// A pole of a coupled model and its counterpart in the physics model; conjugate pairs are counted
/// once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleShift {
    /// Pole without coupling \[rad/s\]; `None` for an additional state (delays inside the loop).
    pub before: Option<Complex<f64>>,
    /// Pole with coupling \[rad/s\].
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
    /// Returns the distance between both poles \[rad/s\]; `None` for an additional state.
    pub fn distance_rad_s(&self) -> Option<f64> {
        Some((self.after - self.before?).norm())
    }

    /// Returns whether coupling moved the pole into the right half-plane.
    pub fn is_newly_unstable(&self) -> bool {
        let was_unstable = self.before.is_some_and(|before| before.re > 0.0);
        self.after.re > 0.0 && !was_unstable
    }
}

impl CouplingMatrices {
    /// Returns the poles of a physics model with mixing and feedback, in ascending `|lambda|`. They
    /// are matched to the poles without coupling so that the sum of distances is minimal.
    /// Discrete-time poles are converted by `s = ln z / T`.
    ///
    /// # Errors
    /// [`PoleShiftError`] if the coupled model or its eigenvalues are unavailable.
    pub fn pole_shifts(
        &self,
        physics: &StateSpace,
        airspeed_kt: f64,
        pade: Pade,
    ) -> Result<Vec<PoleShift>, PoleShiftError> {
        let before = modes(physics)?;
        let after = modes(&self.model(physics, airspeed_kt, pade)?)?;
        let tracks = mode_tracks(&[&before, &after], 1);
        let shifts = tracks
            .into_iter()
            .map(|track| PoleShift {
                before: track.modes[0].map(|mode| before[mode].pole),
                after: after[track.reference].pole,
            })
            .collect();
        Ok(shifts)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;

    #[test]
    fn the_cyclic_inputs_are_the_two_whose_only_axis_is_a_rate() {
        // Outputs P, Q, R, NY; inputs LON, LAT, PED.
        let axes = [(1, 0), (0, 1), (2, 2), (3, 2)].map(|(output, input)| Pair::new(output, input));
        let on_axis = PairTable::from_fn(4, 3, |pair| axes.contains(&pair));
        assert_eq!(cyclic_inputs(&on_axis, |output| output < 3), Some([0, 1]));
        assert_eq!(cyclic_inputs(&on_axis, |output| output == 0), None);
        let without_acceleration = PairTable::from_fn(4, 3, |pair| axes[..3].contains(&pair));
        assert_eq!(
            cyclic_inputs(&without_acceleration, |output| output < 3),
            None,
            "a pedal without an acceleration is a third"
        );
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
