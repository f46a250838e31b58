//! Corrected model `M_O H M_I` in matrix form (M10): the model `H` in series with a gain and a
//! delay or lead filter on each input (`M_I`) and output channel (`M_O`). In continuous time its
//! delays are approximated by rational functions.

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::limits::MOST_STATES;
use gdcm_model::dataset::state_space::{StateSpaceError, Timing};
use gdcm_model::response::LeadFilter;
use gdcm_model::units::number;

use super::channel_correction::ChannelCorrection;
use super::channel_model::ChannelModel;
use super::channels::{Channel, Channels};
use super::pade::Pade;
use super::series_connection::Matrices;

/// How far a delay may be from a whole number of samples, in samples: computed delays have rounding
/// errors.
const SAMPLE_TOLERANCE: f64 = 1e-6;

/// Delay \[s\] below which a delay is set to zero, because its states would have enormous matrix
/// entries. At 12 rad/s such a delay changes the phase by less than a millionth of a degree.
const LEAST_DELAY_S: f64 = 1e-9;

/// The corrected model `M_O H M_I`. It has no delays: the correction's delays and the model's own
/// have been converted to states (M10, M2a).
///
/// In continuous time each delayed channel has the states of a Padé approximant; in discrete time
/// the delay is exact, with one state per sample. Gains are exact, and so are lead filters in
/// continuous time (M15.3); in discrete time lead filters are approximated by Tustin's rule. A
/// channel without delay and lead adds no state. The states are ordered along the signal: input
/// leads, input delays, model states, output delays, output leads.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectedModel {
    /// State-space matrices, without delays.
    pub model: StateSpace,
    /// Delay states per channel; those for inputs precede the model's states, those for outputs
    /// follow them.
    pub delay_states: Channels<usize>,
    /// Lead filter states per channel; those for inputs precede all other states, those for outputs
    /// follow all others.
    pub lead_states: Channels<usize>,
    /// Lead filter per channel; empty if the correction has no leads.
    leads: Channels<Option<LeadFilter>>,
    /// `None` in continuous time.
    sample_time_s: Option<f64>,
    /// Delay per channel, correction plus model.
    delays_s: Channels<f64>,
    /// Approximant for the delays in continuous time.
    pade: Pade,
}

/// Reason why a corrected model cannot be represented by matrices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CorrectedModelError {
    /// A discrete-time model's delay is not a whole number of samples.
    #[error(
        "the total delay of {} (model and correction), {} s, is {} samples of {} s: a \
        discrete-time model can only be delayed by whole samples; use a continuous-time model",
        channel.name(&[], &[]),
        number(*delay_s),
        number(samples_of_delay(*delay_s, *sample_time_s)),
        number(*sample_time_s)
    )]
    PartOfSample {
        channel: Channel,
        /// Delay \[s\], correction plus model.
        delay_s: f64,
        sample_time_s: f64,
    },
    /// A lead filter is too fast for the sample time.
    #[error(
        "the sample time of {} s is too long for the lead filters; the maximum is {} s, half of \
        their lag time constant; use a continuous-time model",
        number(*sample_time_s),
        number(*longest_s)
    )]
    SlowSamples {
        sample_time_s: f64,
        /// Maximum admissible sample time \[s\].
        longest_s: f64,
    },
    /// The delays need more states than a model may have.
    #[error(
        "the model with its delays as states needs {states} states; at most {MOST_STATES} are \
        supported"
    )]
    TooManyStates {
        /// State count of the model, or of the first delay that alone exceeds the maximum.
        states: usize,
    },
    /// A matrix in the corrected model is not finite.
    #[error("{0}")]
    Matrices(#[from] StateSpaceError),
}

impl CorrectedModelError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::PartOfSample { .. } => "part-of-a-sample",
            Self::SlowSamples { .. } => "slow-samples",
            Self::TooManyStates { .. } => "too-many-states",
            Self::Matrices(..) => "corrected-matrices",
        }
    }
}

/// Converts a delay to samples, rounded to 1e-6: shows the fraction of a sample, but no rounding
/// error.
pub fn samples_of_delay(delay_s: f64, sample_time_s: f64) -> f64 {
    (delay_s / sample_time_s * 1e6).round() / 1e6
}

impl CorrectedModel {
    /// Applies a correction to the model; delays in continuous time are approximated by `pade`.
    ///
    /// ```text
    /// 1  state-space models for the delay and lead filter of each channel
    /// 2  gains on the rows and columns of the model's own matrices
    /// 3  series connection: input leads, input delays, model, output delays, output leads
    /// ```
    ///
    /// # Errors
    /// [`CorrectedModelError`] if a discrete-time delay is not a whole number of samples, a lead
    /// filter is too fast for the sample time, the model would have too many states, or a matrix
    /// entry is not finite.
    pub fn new(
        model: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<Self, CorrectedModelError> {
        let timing = model.timing();
        let sample_time_s = timing.sample_time_s;
        // Step 1
        let delays_s = correction.channels(|channel| delay_s(channel, correction, timing));
        let delays = delays_s
            .try_map(|channel, &delay_s| delay_model(channel, delay_s, sample_time_s, pade))?;
        let leads = match &correction.leads {
            Some(leads) => leads.filters().clone(),
            None => Channels::default(),
        };
        let lead_models = leads.try_map(|_, filter| lead_model(*filter, sample_time_s))?;
        let delay_states = delays.map(|_, model| model.order());
        let lead_states = lead_models.map(|_, model| model.order());
        let states = total(&delay_states) + total(&lead_states) + model.order();
        if states > MOST_STATES {
            return Err(CorrectedModelError::TooManyStates { states });
        }
        // Steps 2 and 3
        let mut whole = Matrices::with_gains(model, correction).between(&delays);
        if correction.leads.is_some() {
            whole = whole.between(&lead_models);
        }
        let timing = Timing {
            sample_time_s,
            ..Timing::default()
        };
        let model = StateSpace::new(whole.a, whole.b, whole.c, whole.d)?.timed(timing)?;
        Ok(Self {
            model,
            delay_states,
            lead_states,
            leads,
            sample_time_s,
            delays_s,
            pade,
        })
    }

    /// Computes the maximum phase error \[rad\] over the model's responses at `omega` \[rad/s\]:
    /// the lag missing from the approximated delays, or the phase lost in lead filters by Tustin's
    /// rule in discrete time.
    ///
    /// A response's error is the sum over its two channels.
    pub fn phase_error(&self, omega: f64) -> f64 {
        match self.sample_time_s {
            Some(sample_time_s) => {
                // `warped`: frequency as mapped by Tustin's rule.
                let warped = (0.5 * omega * sample_time_s).tan() * 2.0 / sample_time_s;
                greatest_warping_error(&self.leads.inputs, omega, warped)
                    + greatest_warping_error(&self.leads.outputs, omega, warped)
            }
            // The phase error increases with the delay, so that the longest delay determines the
            // maximum.
            None => {
                self.pade
                    .phase_error(omega * longest(&self.delays_s.inputs))
                    + self
                        .pade
                        .phase_error(omega * longest(&self.delays_s.outputs))
            }
        }
    }
}

/// Returns the state count over all channels.
fn total(states: &Channels<usize>) -> usize {
    states.iter().map(|(_, states)| states).sum()
}

/// Returns the filters' maximum phase error \[rad\] at `omega`, given the warped frequency; both in
/// rad/s.
fn greatest_warping_error(filters: &[Option<LeadFilter>], omega: f64, warped: f64) -> f64 {
    filters
        .iter()
        .flatten()
        .map(|filter| (filter.phase(warped) - filter.phase(omega)).abs())
        .fold(0.0, f64::max)
}

/// Returns the longest delay \[s\]; 0 for no delays.
fn longest(delays_s: &[f64]) -> f64 {
    delays_s.iter().copied().fold(0.0, f64::max)
}

/// Returns a channel's delay \[s\], the correction's plus the model's own; 0 below
/// [`LEAST_DELAY_S`].
fn delay_s(channel: Channel, correction: &ChannelCorrection, timing: &Timing) -> f64 {
    let (own_delays_s, index) = match channel {
        Channel::Input(index) => (&timing.input_delays_s, index),
        Channel::Output(index) => (&timing.output_delays_s, index),
    };
    let own_s = match own_delays_s {
        Some(own_delays_s) => own_delays_s.get(index).copied().unwrap_or(0.0),
        None => 0.0,
    };
    let delay_s = correction.pure_delay_s(channel) + own_s;
    if delay_s < LEAST_DELAY_S {
        0.0
    } else {
        delay_s
    }
}

/// Creates a state-space model for a channel's delay.
///
/// # Errors
/// [`CorrectedModelError`] if a discrete-time delay is not a whole number of samples, or needs too
/// many states.
fn delay_model(
    channel: Channel,
    delay_s: f64,
    sample_time_s: Option<f64>,
    pade: Pade,
) -> Result<ChannelModel, CorrectedModelError> {
    let Some(sample_time_s) = sample_time_s else {
        return Ok(if delay_s > 0.0 {
            pade.model(delay_s)
        } else {
            ChannelModel::samples(0)
        });
    };
    let samples = (delay_s / sample_time_s).round();
    if (delay_s / sample_time_s - samples).abs() > SAMPLE_TOLERANCE {
        return Err(CorrectedModelError::PartOfSample {
            channel,
            delay_s,
            sample_time_s,
        });
    }
    // Reject a model that is too large before its memory is allocated.
    if samples > MOST_STATES as f64 {
        return Err(CorrectedModelError::TooManyStates {
            states: samples as usize,
        });
    }
    Ok(ChannelModel::samples(samples as usize))
}

/// Creates a state-space model for a channel's lead filter; without a filter, the model `y = u`.
fn lead_model(
    filter: Option<LeadFilter>,
    sample_time_s: Option<f64>,
) -> Result<ChannelModel, CorrectedModelError> {
    let Some(filter) = filter else {
        return Ok(ChannelModel::samples(0));
    };
    let Some(sample_time_s) = sample_time_s else {
        return Ok(ChannelModel::lead(filter));
    };
    let longest_s = 0.5 * filter.lag_s;
    match ChannelModel::sampled_lead(filter, sample_time_s) {
        Some(model) if sample_time_s <= longest_s => Ok(model),
        _ => Err(CorrectedModelError::SlowSamples {
            sample_time_s,
            longest_s,
        }),
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Complex, DMatrix};

    use gdcm_model::dataset::{Band, Dynamics, Pair};
    use gdcm_model::response::{FrequencyGrid, LeadOrder, PreparedModel};

    use super::super::channel_leads::ChannelLeads;
    use super::super::lead_design::{LeadDesign, LeadSettings};
    use super::*;

    /// Returns a model with two inputs, two outputs and three states; poles from 1 to 5 rad/s.
    fn plant() -> StateSpace {
        let a = DMatrix::from_row_slice(3, 3, &[-0.8, 2.0, 0.1, -1.5, -1.0, 0.3, 0.2, -0.4, -5.0]);
        let b = DMatrix::from_row_slice(3, 2, &[1.0, 0.2, 0.0, 1.0, 0.5, -0.3]);
        let c = DMatrix::from_row_slice(2, 3, &[1.0, 0.0, 0.4, 0.0, 2.0, -1.0]);
        StateSpace::new(
            a,
            b,
            c,
            DMatrix::from_row_slice(2, 2, &[0.1, 0.0, 0.0, -0.2]),
        )
        .unwrap()
    }

    fn correction() -> ChannelCorrection {
        ChannelCorrection {
            input_gains: vec![1.3, 0.7],
            output_gains: vec![0.9, -1.1],
            input_delays_s: vec![0.03, 0.0],
            output_delays_s: vec![0.0, 0.011],
            leads: None,
        }
    }

    /// Compares the response of the matrices with the product of the gains, the response of the
    /// model, and the delay factor of each channel.
    fn assert_response(
        corrected: &CorrectedModel,
        plant: &StateSpace,
        delay: impl Fn(f64, f64) -> Complex<f64>,
    ) {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 12);
        let [found, plain] = [&corrected.model, plant]
            .map(|model| PreparedModel::new(&Dynamics::StateSpace(model.clone())).response(&grid));
        let correction = correction();
        for pair in [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(output, input)| Pair { output, input }) {
            let found = found.curve(pair);
            let plain = plain.curve(pair);
            for (at, &omega) in grid.omega().iter().enumerate() {
                let delays = delay(omega, corrected.delays_s.inputs[pair.input])
                    * delay(omega, corrected.delays_s.outputs[pair.output]);
                let expected = plain[at] * delays * correction.net_gain(pair);
                assert!(
                    (found[at] - expected).norm() <= 1e-10 * expected.norm(),
                    "{pair:?} at {omega} rad/s"
                );
            }
        }
    }

    #[test]
    fn the_response_is_the_gain_the_approximant_and_the_models_own() {
        for order in [1, 2, 3, 8] {
            let pade = Pade::new(order).unwrap();
            let corrected = CorrectedModel::new(&plant(), &correction(), pade).unwrap();
            let states = (
                corrected.delay_states.inputs.as_slice(),
                corrected.delay_states.outputs.as_slice(),
            );
            assert_eq!(states, ([order, 0].as_slice(), [0, order].as_slice()));
            assert_eq!(corrected.model.order(), 3 + 2 * order);
            // Magnitude 1; the lag is that of the delay less the error of the approximant.
            let delay = |omega: f64, delay_s: f64| {
                let angle = omega * delay_s;
                Complex::new(0.0, pade.phase_error(angle) - angle).exp()
            };
            assert_response(&corrected, &plant(), delay);
            let expected = pade.phase_error(12.0 * 0.03) + pade.phase_error(12.0 * 0.011);
            assert_eq!(corrected.phase_error(12.0), expected);
        }
    }

    #[test]
    fn delays_of_the_model_itself_become_states_with_the_corrections() {
        let own = Timing {
            input_delays_s: Some(vec![0.02, 0.0]),
            ..Timing::default()
        };
        let pade = Pade::new(2).unwrap();
        let corrected =
            CorrectedModel::new(&plant().timed(own).unwrap(), &correction(), pade).unwrap();
        assert_eq!(
            (corrected.delays_s.inputs.clone(), corrected.model.order()),
            (vec![0.05, 0.0], 7)
        );
        assert!(corrected.model.timing().is_plain());
    }

    #[test]
    fn whole_samples_are_exact_and_parts_of_one_are_refused() {
        let sampled = |sample_time_s| {
            let a =
                DMatrix::from_row_slice(3, 3, &[0.9, 0.02, 0.0, -0.01, 0.95, 0.0, 0.1, 0.0, 0.8]);
            let plant = plant();
            let model = StateSpace::new(a, plant.b().clone(), plant.c().clone(), plant.d().clone())
                .unwrap();
            model
                .timed(Timing {
                    sample_time_s: Some(sample_time_s),
                    ..Timing::default()
                })
                .unwrap()
        };
        let pade = Pade::new(2).unwrap();
        let corrected = CorrectedModel::new(&sampled(0.001), &correction(), pade).unwrap();
        assert_eq!(
            (corrected.model.order(), corrected.phase_error(12.0)),
            (3 + 30 + 11, 0.0)
        );
        assert_eq!(corrected.model.timing().sample_time_s, Some(0.001));
        assert_response(&corrected, &sampled(0.001), |omega, delay_s| {
            Complex::new(0.0, -omega * delay_s).exp()
        });
        let refused = CorrectedModel::new(&sampled(0.01), &correction(), pade).unwrap_err();
        assert_eq!(
            refused,
            CorrectedModelError::PartOfSample {
                channel: Channel::Output(1),
                delay_s: 0.011,
                sample_time_s: 0.01
            }
        );
        let refused = CorrectedModel::new(&sampled(1e-5), &correction(), pade).unwrap_err();
        assert!(
            matches!(refused, CorrectedModelError::TooManyStates { .. }),
            "{refused}"
        );
    }

    #[test]
    fn without_delays_there_are_no_states_besides_the_models() {
        let none = ChannelCorrection {
            input_delays_s: vec![0.0; 2],
            output_delays_s: vec![0.0; 2],
            ..correction()
        };
        let corrected = CorrectedModel::new(&plant(), &none, Pade::new(4).unwrap()).unwrap();
        assert_eq!(
            (corrected.model.a(), corrected.phase_error(12.0)),
            (plant().a(), 0.0)
        );
    }

    /// Returns the correction of the plant with 30 ms lead on the first input and 50 ms on the
    /// second output.
    fn led(order: LeadOrder) -> ChannelCorrection {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 50);
        let design = LeadDesign::new(
            LeadSettings {
                order,
                ..LeadSettings::default()
            },
            grid.omega().into(),
        );
        let leads = ChannelLeads::new(
            design.into(),
            Channels {
                inputs: vec![-0.03, 0.0],
                outputs: vec![0.0, -0.05],
            },
        );
        let none = || vec![0.0; 2];
        ChannelCorrection {
            input_delays_s: none(),
            output_delays_s: none(),
            leads: Some(leads),
            ..correction()
        }
    }

    #[test]
    fn lead_filters_are_exact_states_of_which_the_gain_at_infinity_is_direct() {
        for (order, states) in [(LeadOrder::First, 1), (LeadOrder::Second, 2)] {
            let correction = led(order);
            let corrected = CorrectedModel::new(&plant(), &correction, Pade::default()).unwrap();
            assert_eq!(
                (
                    corrected.lead_states.inputs.as_slice(),
                    corrected.lead_states.outputs.as_slice()
                ),
                (&[states, 0][..], &[0, states][..])
            );
            let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 12);
            let [found, plain] = [&corrected.model, &plant()].map(|model| {
                PreparedModel::new(&Dynamics::StateSpace(model.clone())).response(&grid)
            });
            for pair in
                [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(output, input)| Pair { output, input })
            {
                let filters = [Channel::Output(pair.output), Channel::Input(pair.input)];
                for (at, &omega) in grid.omega().iter().enumerate() {
                    let filters = filters
                        .iter()
                        .filter_map(|channel| correction.lead(*channel));
                    let lead: Complex<f64> = filters.map(|filter| filter.at(omega)).product();
                    let expected = plain.curve(pair)[at] * lead * correction.net_gain(pair);
                    assert!(
                        (found.curve(pair)[at] - expected).norm() <= 1e-12 * expected.norm(),
                        "{pair:?}"
                    );
                }
            }
            let r = correction
                .lead(Channel::Input(0))
                .unwrap()
                .gain_at_infinity();
            assert!((corrected.model.d()[(0, 0)] / (0.1 * 1.3 * 0.9) - r).abs() < 1e-12);
            assert_eq!(corrected.phase_error(12.0), 0.0);
        }
    }

    #[test]
    fn lead_filters_of_a_sampled_model_follow_tustins_rule_and_say_how_far_off_they_are() {
        let sampled = |sample_time_s: f64| {
            plant()
                .timed(Timing {
                    sample_time_s: Some(sample_time_s),
                    ..Timing::default()
                })
                .unwrap()
        };
        let correction = led(LeadOrder::Second);
        let corrected = CorrectedModel::new(&sampled(0.01), &correction, Pade::default()).unwrap();
        // Servo bandwidth 36 rad/s, sample time 10 ms: less than 0.25 degrees for each channel at
        // 12 rad/s.
        assert!(
            (0.01..0.5).contains(&corrected.phase_error(12.0).to_degrees()),
            "{}",
            corrected.phase_error(12.0)
        );
        let refused =
            CorrectedModel::new(&sampled(0.02), &correction, Pade::default()).unwrap_err();
        assert!(
            matches!(refused, CorrectedModelError::SlowSamples { .. }),
            "{refused}"
        );
    }
}
