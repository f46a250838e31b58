//! What couplings are fitted to (M16.1): the entries of the mixing and of the feedback, and the flight response without the delays and
//! leads of its channels, with how well it is known (M16.2).

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

/// Which couplings are put at the inputs of a physics model.
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
    /// Which it is.
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// `H`, p x m: the physics representative, not finite where it has no response.
    pub physics: Arc<FrequencyResponse>,
    /// `R'`, p x m: the identified representative without the channels' delays and leads, see [`self::without_channels`]; not finite
    /// where it has no response.
    pub flight: FrequencyResponse,
    /// The responses that both representatives have (M6, M6a); the others have weight 0.
    pub usable: PairTable<bool>,
    /// Standard deviation of the identified model's `ln H`, one value for each frequency, see [`self::response_deviation`]; none: 0.
    pub deviation: Option<PairTable<Vec<f64>>>,
    /// Frequencies that count by the coherence of the identified representative, and how much (M4a); none: all alike.
    pub coherence: Option<PairTable<CoherenceWeights>>,
}

/// What couplings are fitted to: those conditions that are analysed and not held out, and have both representatives.
#[derive(Clone, Debug)]
pub struct CouplingProblem {
    /// Which couplings.
    pub kind: CouplingKind,
    /// The frequencies of every response \[rad/s\], rising.
    pub omega: Arc<[f64]>,
    /// The on-axis responses, which weigh twice.
    pub on_axis: PairTable<bool>,
    /// The conditions.
    pub conditions: Vec<CouplingCondition>,
    /// How it is fitted.
    pub options: CouplingOptions,
}

/// How couplings are fitted (M16.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingOptions {
    /// `rho`: how strongly the entries are drawn to M = I, K = 0, as a share of what the responses say of each.
    pub ridge: f64,
    /// Number of linear least-squares problems, one after the other.
    pub solves: usize,
    /// Highest power of the scaled airspeed in the diagonal of `M`.
    pub degree: usize,
    /// Airspeeds within this of the next one \[kt\] are one (M11b).
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
    /// Number of outputs, `p`.
    pub fn outputs(&self) -> usize {
        self.on_axis.outputs()
    }

    /// Number of inputs, `m`.
    pub fn inputs(&self) -> usize {
        self.on_axis.inputs()
    }

    /// The same without one condition.
    pub fn without(&self, place: usize) -> Self {
        let mut others = self.clone();
        others.conditions.remove(place);
        others
    }

    /// The airspeeds of the conditions, centred and scaled.
    ///
    /// # Errors
    /// [`CouplingError::NothingToFit`] where there is no condition.
    pub(super) fn airspeeds(&self) -> Result<Airspeeds, CouplingError> {
        let airspeeds_kt = self
            .conditions
            .iter()
            .map(|condition| condition.airspeed_kt)
            .collect();
        let airspeeds = Airspeeds::new(airspeeds_kt, self.options.airspeed_tolerance_kt);
        airspeeds.ok_or(CouplingError::NothingToFit { conditions: 0 })
    }

    /// The outputs of which `K` has a column: all that the feedback can use, none of a mixing alone.
    ///
    /// An input column of the equations needs the flight response of every such output. An output that some input would have at no
    /// frequency of no condition is therefore left out, and so is one that the physics models do not have.
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

    /// Whether flight tells anything of an input.
    fn has_data(&self, input: usize) -> bool {
        (0..self.outputs()).any(|output| self.is_known(Pair::new(output, input)))
    }

    /// Whether a response of flight is known at some frequency at which the physics model has all responses of its output.
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

    /// Whether every table has a value for each response and frequency.
    ///
    /// # Errors
    /// [`CouplingError::Shape`] of the first that has not.
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

/// Outputs, inputs and frequencies of a table: as many of these as `expected` where every curve has them, else as many as the first that
/// has not.
fn shape_of<T>(curves: &PairTable<Vec<T>>, expected: usize) -> [usize; 3] {
    let other = curves
        .iter()
        .map(|(_, curve)| curve.len())
        .find(|&points| points != expected);
    [curves.outputs(), curves.inputs(), other.unwrap_or(expected)]
}

/// One number that is fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Unknown {
    /// Coefficient of `v^power` in `M_to,from`: what of input `from` goes to input `to`.
    Mixing {
        /// The input that takes.
        to: usize,
        /// The input that is taken of.
        from: usize,
        /// Power of the scaled airspeed: 0 off the diagonal.
        power: usize,
    },
    /// `K_input,output`: what of an output goes to an input.
    Feedback {
        /// The input that takes.
        input: usize,
        /// The output that is fed back.
        output: usize,
    },
}

impl Unknown {
    /// What it is without any coupling: M = I, K = 0.
    pub fn uncoupled(self) -> f64 {
        match self {
            Self::Mixing { to, from, power: 0 } if to == from => 1.0,
            _ => 0.0,
        }
    }

    /// Every unknown of a problem, row by row of `M`, then of `K`: the diagonal of `M` is a polynomial of degree
    /// `min(degree, distinct airspeeds - 1)`, everything else a constant (M16.1).
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

/// Why no couplings can be found (M16.2).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CouplingError {
    /// There is no condition, or none has a response that both representatives have.
    #[error(
        "no response of the {conditions} conditions is known of both the physics model and flight"
    )]
    NothingToFit {
        /// Number of conditions.
        conditions: usize,
    },
    /// Too few conditions for what is asked.
    #[error("error bars need at least {needed} conditions, and there are {found}")]
    TooFewConditions {
        /// How many it takes.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// A condition's table has another shape than the others.
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
        /// The condition.
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
        /// The condition.
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
    /// The mixing takes an input away or turns it around.
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
        /// `M_ii` there.
        factor: f64,
    },
    /// The work was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl CouplingError {
    /// Why, in words that name the input.
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

/// The mean signed delay of each channel \[s\] over the conditions; none of no condition.
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

/// `R' = L_o^-1 R L_i^-1`, p x m on `omega` \[rad/s\]: what mixing and feedback are to give.
///
/// `L = e^(-j omega tau)` of a signed delay `tau` \[s\], or of a negative one the lead filter that `design` has for it (M15); without a
/// design the first of any.
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

/// Standard deviation of `ln H` that a model's bands tell, p x m curves on `omega` \[rad/s\]:
/// `sd^2 = 1/2 ((sd_dB ln 10 / 20)^2 + (sd_deg pi / 180)^2)`, linear in `ln omega`, beyond the bands that of their end (M16.2).
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

/// Standard deviation of `ln H` that coherence `gamma^2` tells, p x m curves (M13.2):
/// `C sqrt(1 - gamma^2) / (|gamma| sqrt(2 n_d))`.
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
