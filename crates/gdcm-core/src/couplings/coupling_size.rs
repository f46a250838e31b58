//! How large the entries of mixing and feedback are in what the pilot knows: percent of a stick, degrees of swashplate phase (M16.4).

use nalgebra::DMatrix;

use super::{CouplingMatrices, CouplingProblem};
use crate::dataset::{ConditionId, Pair, PairTable};

/// What an entry of `K` takes of the stick, where it takes most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedbackShare {
    /// The input that takes.
    pub input: usize,
    /// The output that is fed back.
    pub output: usize,
    /// `K_input,output`: units of the input for each unit of the output.
    pub entry: f64,
    /// `|K_ij| |R'_jl|`, over 1: how much of the input one unit of the input `moved` makes.
    pub share: f64,
    /// The input `l` that is moved where the share is largest.
    pub moved: usize,
    /// The condition where it is largest.
    pub condition: ConditionId,
    /// The frequency where it is largest \[rad/s\].
    pub omega_rad_s: f64,
}

/// The largest `|R'_jl|` of one output.
#[derive(Clone, Copy)]
struct Peak {
    magnitude: f64,
    moved: usize,
    condition: ConditionId,
    omega_rad_s: f64,
}

/// The share of every entry of `K`, the largest first; none of an output of which flight tells nothing.
pub fn feedback_shares(problem: &CouplingProblem, couplings: &CouplingMatrices) -> Vec<FeedbackShare> {
    let peaks: Vec<Option<Peak>> = (0..problem.outputs()).map(|output| largest_response(problem, output)).collect();
    let (inputs, feedback) = (problem.inputs(), couplings.feedback());
    let share = |(input, output): (usize, usize)| {
        let Peak { magnitude, moved, condition, omega_rad_s } = peaks[output]?;
        let entry = feedback[(input, output)];
        Some(FeedbackShare { input, output, entry, share: entry.abs() * magnitude, moved, condition, omega_rad_s })
    };
    let entries = (0..inputs).flat_map(|input| (0..peaks.len()).map(move |output| (input, output)));
    let mut shares: Vec<FeedbackShare> = entries.filter_map(share).collect();
    shares.sort_by(|a, b| b.share.total_cmp(&a.share));
    shares
}

/// Over all inputs, conditions and frequencies.
fn largest_response(problem: &CouplingProblem, output: usize) -> Option<Peak> {
    let mut largest: Option<Peak> = None;
    for condition in &problem.conditions {
        for moved in (0..problem.inputs()).filter(|&input| condition.usable[Pair::new(output, input)]) {
            for (value, &omega_rad_s) in condition.flight.curve(Pair::new(output, moved)).iter().zip(&*problem.omega) {
                let magnitude = value.norm();
                if magnitude.is_finite() && largest.is_none_or(|peak| magnitude > peak.magnitude) {
                    largest = Some(Peak { magnitude, moved, condition: condition.id, omega_rad_s });
                }
            }
        }
    }
    largest
}

/// One entry of `M~` off its diagonal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixingShare {
    /// The input that takes.
    pub to: usize,
    /// The input that is taken of.
    pub from: usize,
    /// `M~_to,from`, over 1.
    pub share: f64,
    /// `atan M~_to,from` \[deg\], where both are cyclic inputs.
    pub swashplate_phase_deg: Option<f64>,
}

/// The entries of a normalised mixing off its diagonal, the largest first; `cyclic` are the two cyclic inputs.
pub fn mixing_shares(normalised_mixing: &DMatrix<f64>, cyclic: Option<[usize; 2]>) -> Vec<MixingShare> {
    let inputs = normalised_mixing.nrows();
    let entries = (0..inputs).flat_map(|to| (0..inputs).map(move |from| (to, from)));
    let share = |(to, from): (usize, usize)| {
        let share = normalised_mixing[(to, from)];
        let is_cyclic = cyclic.is_some_and(|pair| pair.contains(&to) && pair.contains(&from));
        MixingShare { to, from, share, swashplate_phase_deg: is_cyclic.then(|| share.atan().to_degrees()) }
    };
    let mut shares: Vec<MixingShare> = entries.filter(|(to, from)| to != from).map(share).collect();
    shares.sort_by(|a, b| b.share.abs().total_cmp(&a.share.abs()));
    shares
}

/// The two cyclic inputs: those whose only on-axis response is that of a rate; none where they are not two. A pedal has a lateral
/// acceleration beside its rate, or is a third: then nothing is told of a swashplate.
pub fn cyclic_inputs(on_axis: &PairTable<bool>, is_rate: impl Fn(usize) -> bool) -> Option<[usize; 2]> {
    let is_cyclic = |input: &usize| {
        let outputs: Vec<usize> =
            on_axis.marked().filter(|pair| pair.input == *input).map(|pair| pair.output).collect();
        matches!(outputs[..], [output] if is_rate(output))
    };
    let found: Vec<usize> = (0..on_axis.inputs()).filter(is_cyclic).collect();
    found.try_into().ok()
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
            PairTable::from_fn(4, 3, |Pair { output, input }| axes.contains(&(output, input)))
        };
        assert_eq!(cyclic_inputs(&table(&axes), |output| output < 3), Some([0, 1]));
        assert_eq!(
            cyclic_inputs(&table(&axes[..3]), |output| output < 3),
            None,
            "a pedal without an acceleration is a third"
        );
        assert_eq!(cyclic_inputs(&table(&axes), |output| output == 0), None);
    }

    #[test]
    fn only_cyclic_inputs_have_a_swashplate_phase() {
        let shares = mixing_shares(&dmatrix![1.0, -0.02, 0.03; 0.047, 1.0, 0.0; 0.0, 0.1, 1.0], Some([0, 1]));
        assert_eq!((shares.len(), shares[0].to, shares[0].from, shares[0].swashplate_phase_deg), (6, 2, 1, None));
        // M16.4: 4.7 % are 2.7 degrees.
        assert!((shares[1].swashplate_phase_deg.unwrap() - 2.7).abs() < 0.05 && shares[1].share == 0.047);
    }
}
