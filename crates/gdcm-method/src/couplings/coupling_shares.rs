//! Mixing and feedback entries in a pilot's units: share of stick, degrees of swashplate phase
//! (M16.4).
//!
//! ```text
//! feedback:  share of K_ij <- |K_ij| max |R'_jl|  over all inputs l, conditions and frequencies
//! mixing:    share of M_ij <- M~_ij;  between the cyclic inputs also as swashplate phase,
//!            atan M~_ij
//! ```
//!
//! `M~` is the normalised input mixing (diagonal 1), `K` the output feedback, `R'` the flight
//! response without its channels' delays and leads.

use nalgebra::DMatrix;

use gdcm_model::dataset::{ConditionId, Pair, PairTable};

use super::coupling_matrices::CouplingMatrices;
use super::problem::CouplingProblem;

/// Peak share of the stick used by an entry in `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackShare {
    /// Input that receives the feedback.
    pub input: usize,
    /// Output that is fed back.
    pub output: usize,
    /// `K_input,output`, in input units per output unit.
    pub entry: f64,
    /// `|K_ij| |R'_jl|` \[-\]: movement in input i per unit of movement in the input `moved`.
    pub share: f64,
    /// Index `l` of the moved input at the peak.
    pub moved: usize,
    /// Condition at the peak.
    pub condition: ConditionId,
    /// Frequency at the peak \[rad/s\].
    pub omega_rad_s: f64,
}

/// Returns the shares for all entries in `K`, largest first; entries for an output without flight
/// data are omitted.
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

/// Maximum `|R'_jl|` for an output j over all inputs l, conditions and frequencies.
struct PeakResponse {
    magnitude: f64,
    /// Input `l`.
    moved: usize,
    condition: ConditionId,
    omega_rad_s: f64,
}

impl PeakResponse {
    /// Searches all inputs, conditions and frequencies. Returns the first peak if several are
    /// equal; `None` if there is no usable response.
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

/// An off-diagonal entry in the normalised mixing `M~`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixingShare {
    /// Input to which the share is added.
    pub to: usize,
    /// Input from which the share is taken.
    pub from: usize,
    /// `M~_to,from` \[-\].
    pub share: f64,
    /// `atan M~_to,from` \[deg\]; `None` unless both inputs are cyclic.
    pub swashplate_phase_deg: Option<f64>,
}

/// Returns a normalised mixing's off-diagonal entries, largest magnitude first; `cyclic` holds the
/// two cyclic inputs' indices, if known.
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

/// Returns the two cyclic inputs' indices: the inputs whose only on-axis response is a rate, as
/// those of a helicopter's cyclic stick are, pitch and roll rate. `None` unless exactly two inputs
/// qualify; a pedal, for example, does not qualify if it also has an on-axis lateral acceleration.
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
