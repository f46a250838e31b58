//! Data of the coupling fit (M16.1): the entries of mixing and feedback, and the flight response
//! without the delays and leads of its channels, with its uncertainty (M16.2).

use std::f64::consts::LN_10;
use std::sync::Arc;

use nalgebra::Complex;

use gdcm_model::dataset::model::ModelBands;
use gdcm_model::dataset::{ConditionId, Pair, PairTable};
use gdcm_model::progress::Cancelled;
use gdcm_model::response::FrequencyResponse;
use gdcm_model::response::curve_values::interpolate_values;
use gdcm_model::units::{number, telling};

use crate::correction::leads::LeadDesign;
use crate::correction::{Channel, Channels};
use crate::fidelity::CoherenceWeights;
use crate::schedule::Airspeeds;
use crate::uncertainty::spread::Measurement;

/// Couplings applied at the inputs of a physics model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum CouplingKind {
    /// A mixing `M` of the inputs.
    Mixing,
    /// A mixing, and a feedback `K` of outputs to inputs.
    #[default]
    MixingAndFeedback,
}

impl CouplingKind {
    /// Whether outputs are fed back.
    pub fn feeds_back(self) -> bool {
        self == Self::MixingAndFeedback
    }
}

/// One flight condition of the fit: its representatives on the frequencies of the band.
#[derive(Clone, Debug)]
pub struct CouplingCondition {
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// `H`, p x m: the physics representative, not finite where a response is missing.
    pub physics: Arc<FrequencyResponse>,
    /// `R'`, p x m: the identified representative without the channels' delays and leads, see
    /// [`self::without_channels`]; not finite where a response is missing.
    pub flight: FrequencyResponse,
    /// Responses available in both representatives (M6, M6a); the others have weight 0.
    pub usable: PairTable<bool>,
    /// Standard deviation of the identified model's `ln H`, one value per frequency, see
    /// [`self::response_deviation`]; `None` counts as 0.
    pub deviation: Option<PairTable<Vec<f64>>>,
    /// Frequencies and weights by the coherence of the identified representative (M4a); `None`: all
    /// weigh the same.
    pub coherence: Option<PairTable<CoherenceWeights>>,
}

/// The coupling fit's data: the analysed conditions with both representatives, without those
/// reserved for validation.
#[derive(Clone, Debug)]
pub struct CouplingProblem {
    pub kind: CouplingKind,
    /// The common frequencies of all responses \[rad/s\], ascending.
    pub omega: Arc<[f64]>,
    /// The on-axis responses, which weigh twice.
    pub on_axis: PairTable<bool>,
    pub conditions: Vec<CouplingCondition>,
    pub options: CouplingOptions,
}

/// Settings of the coupling fit (M16.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingOptions {
    /// `rho`: strength of the regularisation towards M = I, K = 0, relative to the information in
    /// the responses about each entry.
    pub ridge: f64,
    /// Number of successive linear least-squares problems.
    pub solves: usize,
    /// Highest power of the scaled airspeed in the diagonal of `M`.
    pub degree: usize,
    /// Airspeeds closer than this to the next \[kt\] are treated as equal (M11b).
    pub airspeed_tolerance_kt: f64,
}

impl Default for CouplingOptions {
    fn default() -> Self {
        Self {
            ridge: 1e-3,
            solves: 5,
            degree: 2,
            airspeed_tolerance_kt: 2.0,
        }
    }
}

impl CouplingProblem {
    /// Returns the number of outputs, `p`.
    pub fn outputs(&self) -> usize {
        self.on_axis.outputs()
    }

    /// Returns the number of inputs, `m`.
    pub fn inputs(&self) -> usize {
        self.on_axis.inputs()
    }

    /// Returns the problem without one condition.
    pub fn without(&self, place: usize) -> Self {
        let mut others = self.clone();
        others.conditions.remove(place);
        others
    }

    /// Returns the airspeeds of the conditions, centred and scaled.
    ///
    /// # Errors
    /// [`CouplingError::NothingToFit`] if there is no condition.
    pub(super) fn airspeeds(&self) -> Result<Airspeeds, CouplingError> {
        let airspeeds_kt = self
            .conditions
            .iter()
            .map(|condition| condition.airspeed_kt)
            .collect();
        let airspeeds = Airspeeds::new(airspeeds_kt, self.options.airspeed_tolerance_kt);
        airspeeds.ok_or(CouplingError::NothingToFit { conditions: 0 })
    }

    /// Returns the outputs with a column in `K`: all that the feedback can use, none for a mixing
    /// alone.
    ///
    /// An input column of the equations needs the flight response of every such output. An output
    /// that would be missing for some input at all frequencies of all conditions is therefore left
    /// out, and so is an output missing from the physics models.
    pub(super) fn fed_back(&self) -> Vec<usize> {
        if !self.kind.feeds_back() {
            return Vec::new();
        }
        let inputs: Vec<usize> = (0..self.inputs())
            .filter(|&input| self.has_data(input))
            .collect();
        let is_known = |output: usize| {
            inputs
                .iter()
                .all(|&input| self.is_known(Pair::new(output, input)))
        };
        (0..self.outputs())
            .filter(|&output| is_known(output))
            .collect()
    }

    /// Whether flight data exist for an input.
    fn has_data(&self, input: usize) -> bool {
        (0..self.outputs()).any(|output| self.is_known(Pair::new(output, input)))
    }

    /// Whether a flight response is known at some frequency at which the physics model has all
    /// responses of its output.
    fn is_known(&self, pair: Pair) -> bool {
        self.conditions.iter().any(|condition| {
            let has_row = |k: usize| {
                (0..self.inputs()).all(|input| {
                    condition.physics.curve(Pair::new(pair.output, input))[k].is_finite()
                })
            };
            let flight = condition.flight.curve(pair);
            (0..flight.len()).any(|k| flight[k].is_finite() && has_row(k))
        })
    }

    /// Checks that every table has a value for each response and frequency.
    ///
    /// # Errors
    /// [`CouplingError::Shape`] for the first table of another shape.
    pub(super) fn check(&self) -> Result<(), CouplingError> {
        let expected @ [.., points] = [self.outputs(), self.inputs(), self.omega.len()];
        for condition in &self.conditions {
            let usable = &condition.usable;
            let coherence = condition.coherence.as_ref();
            let found = [
                Some(shape_of(condition.physics.curves(), points)),
                Some(shape_of(condition.flight.curves(), points)),
                Some([usable.outputs(), usable.inputs(), points]),
                condition
                    .deviation
                    .as_ref()
                    .map(|deviation| shape_of(deviation, points)),
                coherence.map(|coherence| [coherence.outputs(), coherence.inputs(), points]),
            ];
            if let Some(found) = found.into_iter().flatten().find(|found| *found != expected) {
                return Err(CouplingError::Shape {
                    condition: condition.id,
                    expected,
                    found,
                });
            }
        }
        Ok(())
    }
}

/// Returns outputs, inputs and frequencies of a table: `expected` frequencies if every curve has
/// them, otherwise the number in the first curve that differs.
fn shape_of<T>(curves: &PairTable<Vec<T>>, expected: usize) -> [usize; 3] {
    let other = curves
        .iter()
        .map(|(_, curve)| curve.len())
        .find(|&points| points != expected);
    [curves.outputs(), curves.inputs(), other.unwrap_or(expected)]
}

/// A fitted unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unknown {
    /// Coefficient of `v^power` in `M_to,from`: the share of input `from` that goes to input `to`.
    Mixing {
        /// The receiving input.
        to: usize,
        /// The source input.
        from: usize,
        /// Power of the scaled airspeed: 0 off the diagonal.
        power: usize,
    },
    /// `K_input,output`: feedback from an output to an input.
    Feedback {
        /// The receiving input.
        input: usize,
        /// The output that is fed back.
        output: usize,
    },
}

impl Unknown {
    /// Returns the value without any coupling: M = I, K = 0.
    pub fn uncoupled(self) -> f64 {
        match self {
            Self::Mixing { to, from, power: 0 } if to == from => 1.0,
            _ => 0.0,
        }
    }

    /// Lists every unknown of a problem, row by row of `M`, then of `K`: the diagonal of `M` is a
    /// polynomial of degree `min(degree, distinct airspeeds - 1)`, everything else a constant
    /// (M16.1).
    pub(super) fn all(
        problem: &CouplingProblem,
        airspeeds: &Airspeeds,
        fed_back: &[usize],
    ) -> Vec<Self> {
        let inputs = problem.inputs();
        let degree = problem
            .options
            .degree
            .min(airspeeds.clusters.len().saturating_sub(1));
        let highest = |to: usize, from: usize| if to == from { degree } else { 0 };
        let of_entry =
            |to, from| (0..=highest(to, from)).map(move |power| Self::Mixing { to, from, power });
        let mixing =
            (0..inputs).flat_map(|to| (0..inputs).flat_map(move |from| of_entry(to, from)));
        let feedback = (0..inputs).flat_map(|input| {
            fed_back
                .iter()
                .map(move |&output| Self::Feedback { input, output })
        });
        mixing.chain(feedback).collect()
    }
}

/// Reasons why no couplings can be fitted (M16.2).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// There is no condition, or no response is available in both representatives.
    #[error(
        "no response of the {conditions} conditions is known of both the physics model and flight"
    )]
    NothingToFit {
        /// Number of conditions.
        conditions: usize,
    },
    /// Too few conditions for the request.
    #[error("error bars need at least {needed} conditions, and there are {found}")]
    TooFewConditions {
        /// Smallest sufficient number of conditions.
        needed: usize,
        found: usize,
    },
    /// A table of a condition has another shape than expected.
    #[error(
        "condition {condition}: expected {} x {} responses at {} frequencies in every table, found {} x {} at {}",
        expected[0],
        expected[1],
        expected[2],
        found[0],
        found[1],
        found[2]
    )]
    Shape {
        condition: ConditionId,
        /// Outputs, inputs and frequencies expected.
        expected: [usize; 3],
        /// Outputs, inputs and frequencies found.
        found: [usize; 3],
    },
    /// The loop of a pass cannot be closed: `I - K H` is singular.
    #[error(
        "the feedback makes the loop of condition {condition} singular at {} rad/s",
        number(*omega_rad_s)
    )]
    SingularLoop {
        condition: ConditionId,
        /// The frequency \[rad/s\].
        omega_rad_s: f64,
    },
    /// The normal matrix has no Cholesky factors.
    #[error(
        "the responses do not tell the {unknowns} entries of the mixing and the feedback apart"
    )]
    SingularNormalMatrix {
        /// Number of unknowns.
        unknowns: usize,
    },
    /// The mixing removes an input or reverses its sign.
    #[error(
        "the mixing multiplies input {input} by {} at {} kt, and only a positive number is a correction",
        telling(*factor, 3),
        number(*airspeed_kt)
    )]
    ReversedInput {
        /// The input, counted from 1.
        input: usize,
        /// The airspeed \[kt\].
        airspeed_kt: f64,
        /// `M_ii` at that airspeed.
        factor: f64,
    },
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CouplingError {
    /// Returns the reason with the name of the input.
    pub fn words(&self, inputs: &[String]) -> String {
        match self {
            Self::ReversedInput { input, .. } => {
                let name = inputs.get(input - 1).map_or("", String::as_str);
                self.to_string()
                    .replace(&format!("input {input}"), &format!("input {name}"))
            }
            other => other.to_string(),
        }
    }
}

/// Returns the mean signed delay of each channel \[s\] over the conditions; `None` without
/// conditions.
pub fn mean_delays_s(conditions: &[Channels<f64>]) -> Option<Channels<f64>> {
    let count = conditions.len() as f64;
    let sum_s = |channel: Channel| {
        conditions
            .iter()
            .filter_map(|delays_s| delays_s.get(channel))
            .sum::<f64>()
    };
    Some(conditions.first()?.map(|channel, _| sum_s(channel) / count))
}

/// Computes `R' = L_o^-1 R L_i^-1`, p x m on `omega` \[rad/s\]: the response that mixing and
/// feedback have to reproduce.
///
/// `L = e^(-j omega tau)` for a signed delay `tau` \[s\], or the lead filter that `design` provides
/// for a negative one (M15); without a design the exponential for any delay.
#[must_use]
pub fn without_channels(
    flight: &FrequencyResponse,
    omega: &[f64],
    delays_s: &Channels<f64>,
    design: Option<&LeadDesign>,
) -> FrequencyResponse {
    let of_channel = |tau_s: f64| -> Vec<Complex<f64>> {
        match design.and_then(|design| design.filter(tau_s)) {
            Some(filter) => omega.iter().map(|&omega| filter.at(omega)).collect(),
            None => omega
                .iter()
                .map(|omega| Complex::from_polar(1.0, -omega * tau_s))
                .collect(),
        }
    };
    let channels = delays_s.map(|_, &tau_s| of_channel(tau_s));
    FrequencyResponse::new(flight.curves().map(|pair, curve| {
        let output = &channels.outputs[pair.output];
        let input = &channels.inputs[pair.input];
        curve
            .iter()
            .zip(output.iter().zip(input))
            .map(|(value, (output, input))| value / (output * input))
            .collect()
    }))
}

/// Returns the standard deviation of `ln H` from a model's bands, p x m curves on `omega`
/// \[rad/s\]: `sd^2 = 1/2 ((sd_dB ln 10 / 20)^2 + (sd_deg pi / 180)^2)`, linear in `ln omega`,
/// constant beyond the ends of the bands (M16.2).
pub fn response_deviation(bands: &ModelBands, omega: &[f64]) -> PairTable<Vec<f64>> {
    let on_grid = |values: &[f64]| interpolate_values(bands.omega(), values, omega);
    bands.sd_db().map(|pair, sd_db| {
        let sd_db = on_grid(sd_db);
        let sd_deg = on_grid(&bands.sd_deg()[pair]);
        let both = |(db, deg): (&f64, &f64)| {
            (0.5 * ((db * LN_10 / 20.0).powi(2) + deg.to_radians().powi(2))).sqrt()
        };
        sd_db.iter().zip(&sd_deg).map(both).collect()
    })
}

/// Returns the standard deviation of `ln H` from the coherence `gamma^2`, p x m curves (M13.2): `C
/// sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))`.
pub fn coherence_deviation(
    coherence: &PairTable<Vec<f64>>,
    measurement: &Measurement,
) -> PairTable<Vec<f64>> {
    coherence.map(|_, curve| {
        curve
            .iter()
            .map(|&coherence| measurement.deviation(coherence))
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::correction::leads::LeadSettings;

    #[test]
    fn an_input_that_is_turned_around_is_named() {
        let error = CouplingError::ReversedInput {
            input: 2,
            airspeed_kt: 40.0,
            factor: -0.598_742_4,
        };
        let words = error.words(&["LON".to_owned(), "LAT".to_owned()]);
        assert!(
            words.starts_with("the mixing multiplies input LAT by -0.599 at 40 kt"),
            "{words}"
        );
    }

    fn signed_delays() -> Channels<f64> {
        Channels {
            inputs: vec![0.04, -0.03],
            outputs: vec![-0.02],
        }
    }

    #[test]
    fn the_mean_delay_of_each_channel_is_over_the_conditions() {
        let other = Channels {
            inputs: vec![0.0, -0.05],
            outputs: vec![0.02],
        };
        let mean = mean_delays_s(&[signed_delays(), other]).unwrap();
        assert_eq!((mean.inputs, mean.outputs), (vec![0.02, -0.04], vec![0.0]));
        assert_eq!(mean_delays_s(&[]), None);
    }

    #[test]
    fn what_is_left_has_no_delay_and_no_filter_of_its_channels() {
        let omega = [0.5, 2.0, 12.0];
        let design = LeadDesign::new(LeadSettings::default(), Arc::from(omega));
        let [second, output] = [-0.03, -0.02].map(|tau_s| design.filter(tau_s).unwrap());
        let delayed = |omega: f64| Complex::from_polar(1.0, -0.04 * omega);
        let flight = PairTable::from_fn(1, 2, |pair| {
            let input = |omega| {
                if pair.input == 0 {
                    delayed(omega)
                } else {
                    second.at(omega)
                }
            };
            omega
                .iter()
                .map(|&omega| 3.0 * input(omega) * output.at(omega))
                .collect()
        });
        let left = without_channels(
            &FrequencyResponse::new(flight),
            &omega,
            &signed_delays(),
            Some(&design),
        );
        for (_, curve) in left.curves().iter() {
            assert!(
                curve.iter().all(|value| (value - 3.0).norm() < 1e-14),
                "{curve:?}"
            );
        }
        let ones = FrequencyResponse::new(PairTable::filled(1, 2, vec![Complex::from(1.0); 3]));
        let turned = without_channels(&ones, &omega, &signed_delays(), None);
        let expected = Complex::from_polar(1.0, -0.05 * omega[2]);
        assert!(
            (turned.curve(Pair::new(0, 1))[2] - expected).norm() < 1e-15,
            "pure delays where there is no design"
        );
    }

    #[test]
    fn a_deviation_is_the_mean_square_of_its_magnitude_and_its_phase() {
        let table = |value: f64| PairTable::filled(1, 1, vec![value; 2]);
        let bands = ModelBands::new(
            vec![1.0, 10.0],
            table(20.0 / LN_10 * 0.03),
            table(0.04_f64.to_degrees()),
        )
        .unwrap();
        let deviation = &response_deviation(&bands, &[0.5, 3.0])[Pair::new(0, 0)];
        assert!(
            deviation
                .iter()
                .all(|sd| (sd - (0.5 * (0.0009_f64 + 0.0016)).sqrt()).abs() < 1e-15)
        );
        let measurement = Measurement {
            averages: 8.0,
            window_s: None,
            factor: 1.0,
        };
        let deviation = coherence_deviation(&PairTable::filled(1, 1, vec![0.5, 1.0]), &measurement);
        assert_eq!(deviation[Pair::new(0, 0)], [0.25, 0.0]);
    }
}
