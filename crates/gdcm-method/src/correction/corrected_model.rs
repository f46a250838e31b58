//! A corrected model as matrices (M10), with delays replaced by rational functions where states are
//! required.

use nalgebra::{Complex, DMatrix, DVector, RowDVector};

use gdcm_model::dataset::StateSpace;
use gdcm_model::dataset::limits::MOST_STATES;
use gdcm_model::dataset::state_space::{StateSpaceError, Timing};
use gdcm_model::response::{LeadFilter, LeadOrder};
use gdcm_model::units::number;

use super::channels::{Channel, ChannelCorrection, Channels};

/// Tolerance, in samples, of a delay from a whole number of samples. Computed delays are rounded.
const SAMPLE_TOLERANCE: f64 = 1e-6;

/// Delay \[s\] below which a delay counts as zero: rounding residues would give states with
/// enormous entries. At 12 rad/s it changes the phase by less than a millionth of a degree.
const LEAST_DELAY_S: f64 = 1e-9;

/// `M_O H M_I` without delays: the delays of the correction and of the model itself have become
/// states (M10, M2a).
///
/// In continuous time each delayed channel has the states of a Pade approximant, in discrete time
/// one state for each sample, exactly. Gains are exact, and so are lead filters in continuous time
/// (M15.3); in discrete time these follow Tustin's rule. A channel without delay and lead adds no
/// state. States of the inputs come first, then the model's, then the outputs'.
#[derive(Clone, Debug, PartialEq)]
pub struct CorrectedModel {
    /// Four matrices; no delays.
    pub model: StateSpace,
    /// Number of delay states of each channel: those of the inputs precede the model's own, those
    /// of the outputs follow them.
    pub delay_states: Channels<usize>,
    /// Number of lead filter states of each channel: those of the inputs precede all others, those
    /// of the outputs follow all others.
    pub lead_states: Channels<usize>,
    leads: Channels<Option<LeadFilter>>,
    sample_time_s: Option<f64>,
    delays_s: Channels<f64>,
    pade: Pade,
}

/// Reason why a corrected model has no matrices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", self.words(&[], &[]))]
pub enum CorrectedModelError {
    /// A delay of a discrete-time model is not a whole number of samples.
    PartOfSample {
        channel: Channel,
        /// Its delay \[s\].
        delay_s: f64,
        /// The sample time \[s\].
        sample_time_s: f64,
    },
    /// A lead filter is too fast for the sample time.
    SlowSamples {
        /// Sample time \[s\].
        sample_time_s: f64,
        /// Longest admissible sample time \[s\].
        longest_s: f64,
    },
    /// The delays need more states than a model may have.
    TooManyStates {
        /// Number of states needed.
        states: usize,
    },
    /// A product is not finite.
    Matrices(#[from] StateSpaceError),
}

impl CorrectedModelError {
    /// Describes the error with these channel names.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        match self {
            Self::PartOfSample {
                channel,
                delay_s,
                sample_time_s,
            } => format!(
                "the delay of {}, {} s, is {} samples of {} s; in discrete time only whole samples are exact",
                channel.name(inputs, outputs),
                number(*delay_s),
                // Enough digits to distinguish it from a whole number, none from rounding.
                number((delay_s / sample_time_s * 1e6).round() / 1e6),
                number(*sample_time_s)
            ),
            Self::SlowSamples {
                sample_time_s,
                longest_s,
            } => format!(
                "its sample time of {} s is too long for the lead filters; at most {} s, half of their lag, is allowed",
                number(*sample_time_s),
                number(*longest_s)
            ),
            Self::TooManyStates { states } => {
                format!(
                    "with its delays as states it would have {states} of them; at most {MOST_STATES} are written"
                )
            }
            Self::Matrices(error) => error.to_string(),
        }
    }
}

impl CorrectedModel {
    /// Applies a correction to the model, with continuous-time delays approximated by `pade`.
    ///
    /// # Errors
    /// [`CorrectedModelError`] where a discrete-time delay is not a whole number of samples, or
    /// states or numbers become too many or too large.
    pub fn of(
        model: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<Self, CorrectedModelError> {
        let timing = model.timing();
        let sampling = timing.sample_time_s;
        let delays_s = correction.channels(|channel| delay_s(channel, correction, timing));
        let delays =
            delays_s.try_map(|channel, &delay_s| delay_model(channel, delay_s, sampling, pade))?;
        let leads = correction
            .leads
            .as_ref()
            .map(|leads| leads.filters().clone())
            .unwrap_or_default();
        let lead_models = leads.try_map(|_, filter| lead_model(*filter, sampling))?;
        let [delay_states, lead_states] =
            [&delays, &lead_models].map(|models| models.map(|_, model| model.order()));
        let added = delay_states
            .iter()
            .chain(lead_states.iter())
            .map(|(_, states)| states);
        let states = added.sum::<usize>() + model.order();
        if states > MOST_STATES {
            return Err(CorrectedModelError::TooManyStates { states });
        }
        let between = |models: &Channels<ChannelModel>, inner: &Blocks| {
            Blocks::block_diagonal(&models.inputs)
                .then(inner)
                .then(&Blocks::block_diagonal(&models.outputs))
        };
        let mut whole = between(&delays, &Blocks::of_gained(model, correction));
        if correction.leads.is_some() {
            whole = between(&lead_models, &whole);
        }
        let timing = Timing {
            sample_time_s: sampling,
            ..Timing::default()
        };
        let model = StateSpace::new(whole.a, whole.b, whole.c, whole.d)?.timed(timing)?;
        Ok(Self {
            model,
            delay_states,
            lead_states,
            leads,
            sample_time_s: sampling,
            delays_s,
            pade,
        })
    }

    /// Greatest phase error \[rad\] of its responses at `omega` \[rad/s\]: the missing lag of the
    /// approximated delays, or the phase that Tustin's rule removes from the lead filters of a
    /// discrete-time model.
    pub fn phase_error(&self, omega: f64) -> f64 {
        if let Some(sample_time_s) = self.sample_time_s {
            // Frequency warped by Tustin's rule.
            let warped = (0.5 * omega * sample_time_s).tan() * 2.0 / sample_time_s;
            let error = |filter: &LeadFilter| (filter.phase(warped) - filter.phase(omega)).abs();
            let greatest = |filters: &[Option<LeadFilter>]| {
                filters.iter().flatten().map(error).fold(0.0, f64::max)
            };
            return greatest(&self.leads.inputs) + greatest(&self.leads.outputs);
        }
        // The error grows with the delay, and the error of a response is the sum over its two
        // channels.
        let longest = |delays_s: &[f64]| delays_s.iter().copied().fold(0.0, f64::max);
        let error = |delays_s: &[f64]| self.pade.phase_error(omega * longest(delays_s));
        error(&self.delays_s.inputs) + error(&self.delays_s.outputs)
    }
}

/// Delay of a channel \[s\]: the correction's plus the model's own.
fn delay_s(channel: Channel, correction: &ChannelCorrection, timing: &Timing) -> f64 {
    let (own_s, at) = match channel {
        Channel::Input(at) => (&timing.input_delays_s, at),
        Channel::Output(at) => (&timing.output_delays_s, at),
    };
    let own_s = own_s
        .as_ref()
        .and_then(|own_s| own_s.get(at))
        .copied()
        .unwrap_or(0.0);
    let delay_s = correction.pure_delay_s(channel) + own_s;
    if delay_s < LEAST_DELAY_S {
        0.0
    } else {
        delay_s
    }
}

/// State-space model of a channel's delay.
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
    // Rejected before memory is allocated.
    if samples > MOST_STATES as f64 {
        return Err(CorrectedModelError::TooManyStates {
            states: samples as usize,
        });
    }
    Ok(ChannelModel::samples(samples as usize))
}

/// State-space model of a channel's lead filter.
fn lead_model(
    filter: Option<LeadFilter>,
    sample_time_s: Option<f64>,
) -> Result<ChannelModel, CorrectedModelError> {
    let (Some(filter), Some(sample_time_s)) = (filter, sample_time_s) else {
        return Ok(filter.map_or_else(|| ChannelModel::samples(0), ChannelModel::lead));
    };
    let longest_s = 0.5 * filter.lag_s;
    let sampled =
        ChannelModel::sampled_lead(filter, sample_time_s).filter(|_| sample_time_s <= longest_s);
    sampled.ok_or(CorrectedModelError::SlowSamples {
        sample_time_s,
        longest_s,
    })
}

/// Four matrices, in continuous or discrete time.
struct Blocks {
    a: DMatrix<f64>,
    b: DMatrix<f64>,
    c: DMatrix<f64>,
    d: DMatrix<f64>,
}

impl Blocks {
    /// The model with the channels' gains, without any delay.
    fn of_gained(model: &StateSpace, correction: &ChannelCorrection) -> Self {
        let mut blocks = Self {
            a: model.a().clone(),
            b: model.b().clone(),
            c: model.c().clone(),
            d: model.d().clone(),
        };
        for (input, &gain) in correction.input_gains.iter().enumerate() {
            blocks.b.column_mut(input).scale_mut(gain);
            blocks.d.column_mut(input).scale_mut(gain);
        }
        for (output, &gain) in correction.output_gains.iter().enumerate() {
            blocks.c.row_mut(output).scale_mut(gain);
            blocks.d.row_mut(output).scale_mut(gain);
        }
        blocks
    }

    /// Parallel channels as one block-diagonal system, each with its own delay.
    fn block_diagonal(channels: &[ChannelModel]) -> Self {
        let states = channels.iter().map(ChannelModel::order).sum();
        let count = channels.len();
        let mut blocks = Self {
            a: DMatrix::zeros(states, states),
            b: DMatrix::zeros(states, count),
            c: DMatrix::zeros(count, states),
            d: DMatrix::zeros(count, count),
        };
        let mut at = 0;
        for (channel, delay) in channels.iter().enumerate() {
            let order = delay.order();
            blocks
                .a
                .view_mut((at, at), (order, order))
                .copy_from(&delay.a);
            blocks
                .b
                .view_mut((at, channel), (order, 1))
                .copy_from(&delay.b);
            blocks
                .c
                .view_mut((channel, at), (1, order))
                .copy_from(&delay.c);
            blocks.d[(channel, channel)] = delay.d;
            at += order;
        }
        blocks
    }

    /// Series connection: the outputs of this system drive `next`. The states of this system come
    /// first.
    fn then(&self, next: &Self) -> Self {
        let first = self.a.nrows();
        let second = next.a.nrows();
        let states = first + second;
        let mut a = DMatrix::zeros(states, states);
        a.view_mut((0, 0), (first, first)).copy_from(&self.a);
        a.view_mut((first, 0), (second, first))
            .copy_from(&(&next.b * &self.c));
        a.view_mut((first, first), (second, second))
            .copy_from(&next.a);
        let mut b = DMatrix::zeros(states, self.b.ncols());
        b.rows_mut(0, first).copy_from(&self.b);
        b.rows_mut(first, second).copy_from(&(&next.b * &self.d));
        let mut c = DMatrix::zeros(next.c.nrows(), states);
        c.columns_mut(0, first).copy_from(&(&next.d * &self.c));
        c.columns_mut(first, second).copy_from(&next.c);
        Self {
            a,
            b,
            c,
            d: &next.d * &self.d,
        }
    }
}

/// Highest order of approximation offered.
pub const HIGHEST_PADE_ORDER: usize = 8;

/// Pade approximant `[N/N]` of `e^(-tau s)`: among all rational functions of this order it agrees
/// in the most derivatives at `s = 0`. Its magnitude is 1 at every frequency; its error is in the
/// phase only.
///
/// With `z = tau s / 2` it is `(1 - t) / (1 + t)`, where `t` is the N-th convergent of Lambert's
/// continued fraction `tanh z = z / (1 + z^2 / (3 + z^2 / (5 + ...)))`. The fraction, read as a
/// ladder of integrators, is a state-space model whose controllability and observability Gramians
/// are both the identity, whatever the order and the delay, so its entries are of similar
/// magnitude.
///
/// Source: NIST Digital Library of Mathematical Functions, 4.39.1 (Lambert's fraction).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pade {
    order: usize,
}

impl Default for Pade {
    /// Second order: at `omega tau = 1` the phase error is less than a tenth of a degree.
    fn default() -> Self {
        Self { order: 2 }
    }
}

impl Pade {
    /// Returns the approximant of this order, if it is from 1 to [`HIGHEST_PADE_ORDER`].
    pub fn new(order: usize) -> Option<Self> {
        (1..=HIGHEST_PADE_ORDER)
            .contains(&order)
            .then_some(Self { order })
    }

    /// Order `N`, the number of states.
    pub fn order(self) -> usize {
        self.order
    }

    /// Returns the state-space model of the approximant of a positive delay \[s\].
    ///
    /// The ladder is `t = e_1' (L/z + S)^-1 e_1` with `L = diag(1, 3, 5, ...)` and `S` with 1 above
    /// and -1 below the diagonal. With `R = S + e_1 e_1'` and `K = L^(-1/2) R L^(-1/2)` this gives
    /// `A = -(2/tau) K^-1`, `B = 2/sqrt(tau) K^-1 e_1`, `C = 2/sqrt(tau) e_1' K^-1`, `D = (-1)^N`.
    pub fn model(self, delay_s: f64) -> ChannelModel {
        let root = |place: usize| ((2 * place + 1) as f64).sqrt();
        let inverse =
            |row: usize, column: usize| root(row) * root(column) * self.ladder_inverse(row, column);
        let gain = 2.0 / delay_s.sqrt();
        ChannelModel {
            a: DMatrix::from_fn(self.order, self.order, |row, column| {
                -2.0 / delay_s * inverse(row, column)
            }),
            b: DVector::from_fn(self.order, |row, _| gain * inverse(row, 0)),
            c: RowDVector::from_fn(self.order, |_, column| gain * inverse(0, column)),
            d: if self.order.is_multiple_of(2) {
                1.0
            } else {
                -1.0
            },
        }
    }

    /// Entry of `R^-1`, which is 1, 0 or -1: R is solved from its ends inwards.
    fn ladder_inverse(self, row: usize, column: usize) -> f64 {
        // Whether a place, counted from 1, has the parity of the order.
        let is_of_order = |place: usize| (place + 1) % 2 == self.order % 2;
        match (is_of_order(row), is_of_order(column)) {
            (true, true) => 1.0,
            (true, false) if column < row => 1.0,
            (false, true) if column > row => -1.0,
            _ => 0.0,
        }
    }

    /// Missing lag \[rad\] of the approximant at `angle = omega tau`: `angle - 2 arg theta_N(j
    /// angle / 2)`.
    ///
    /// The denominators are the reverse Bessel polynomials, `theta_n = (2n - 1) theta_(n-1) + z^2
    /// theta_(n-2)`. The ratio of two consecutive polynomials lies above the real axis, so that
    /// their angles add up without an extra turn.
    pub fn phase_error(self, angle: f64) -> f64 {
        let z = Complex::new(0.0, 0.5 * angle);
        let mut ratio = 1.0 + z;
        let mut lag = ratio.arg();
        for n in 2..=self.order {
            ratio = (2 * n - 1) as f64 + z * z / ratio;
            lag += ratio.arg();
        }
        angle - 2.0 * lag
    }
}

/// A delay or a lead filter of one channel as a state-space model with one input and one output.
#[derive(Clone, Debug, PartialEq)]
pub struct ChannelModel {
    /// System matrix, n x n.
    pub a: DMatrix<f64>,
    /// Input column, n values.
    pub b: DVector<f64>,
    /// Output row, n values.
    pub c: RowDVector<f64>,
    pub d: f64,
}

impl ChannelModel {
    /// `z^-count`, exactly: `count` states, each of which delays the previous state by one sample.
    /// With `count = 0` it is `y = u`.
    pub fn samples(count: usize) -> Self {
        Self {
            a: DMatrix::from_fn(count, count, |row, column| f64::from(row == column + 1)),
            b: DVector::from_fn(count, |row, _| f64::from(row == 0)),
            c: RowDVector::from_fn(count, |_, column| f64::from(column + 1 == count)),
            d: f64::from(count == 0),
        }
    }

    /// State-space model of a lead filter in continuous time, exactly (M15.3). With `w1 = 1 / a`,
    /// `w2 = 1 / b`, the second order has `A = [0 1; -w2^2 -sqrt(2) w2]`, `B = [0; 1]`, `C = [R
    /// (w1^2 - w2^2)  R sqrt(2) (w1 - w2)]`, `D = R`; the first order has `A = -w2`, `B = 1`, `C =
    /// R (w1 - w2)`, `D = R`.
    pub fn lead(filter: LeadFilter) -> Self {
        const ROOT: f64 = std::f64::consts::SQRT_2;
        let w1 = filter.zero_rad_s();
        let w2 = filter.lag_rad_s();
        let r = filter.gain_at_infinity();
        match filter.order {
            LeadOrder::First => Self {
                a: DMatrix::from_element(1, 1, -w2),
                b: DVector::from_element(1, 1.0),
                c: RowDVector::from_element(1, r * (w1 - w2)),
                d: r,
            },
            LeadOrder::Second => Self {
                a: DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -w2 * w2, -ROOT * w2]),
                b: DVector::from_column_slice(&[0.0, 1.0]),
                c: RowDVector::from_row_slice(&[r * (w1 * w1 - w2 * w2), r * ROOT * (w1 - w2)]),
                d: r,
            },
        }
    }

    /// State-space model of the lead filter in discrete time with this sample time \[s\], by
    /// Tustin's rule `s = 2 (z - 1) / (T (z + 1))`: with `M = (I - A T/2)^-1` it is `M (I + A
    /// T/2)`, `T M B`, `C M`, `D + C M B T/2`. `None` where `T` puts a pole of the filter on the
    /// pole of the rule.
    pub fn sampled_lead(filter: LeadFilter, sample_time_s: f64) -> Option<Self> {
        let Self { a, b, c, d } = Self::lead(filter);
        let one = DMatrix::identity(a.nrows(), a.nrows());
        let half = 0.5 * sample_time_s * &a;
        let inverse = (&one - &half).try_inverse()?;
        let direct = (&c * &inverse * &b).sum() * 0.5 * sample_time_s;
        Some(Self {
            a: &inverse * (&one + &half),
            b: sample_time_s * &inverse * b,
            c: &c * inverse,
            d: d + direct,
        })
    }

    /// Number of states.
    pub fn order(&self) -> usize {
        self.b.len()
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::{Band, Dynamics, Pair};
    use gdcm_model::response::{FrequencyGrid, PreparedModel};

    use super::super::leads::{ChannelLeads, LeadDesign, LeadSettings};
    use super::*;

    /// Two inputs, two outputs, three states; poles from 1 to 5 rad/s.
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

    /// Compares the matrices with the product of the gains, the model's response and a factor for
    /// the delays of each channel.
    fn assert_response(
        corrected: &CorrectedModel,
        plant: &StateSpace,
        delay: impl Fn(f64, f64) -> Complex<f64>,
    ) {
        let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 12);
        let [found, plain] = [&corrected.model, plant]
            .map(|model| PreparedModel::of(&Dynamics::StateSpace(model.clone())).response(&grid));
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
            let corrected = CorrectedModel::of(&plant(), &correction(), pade).unwrap();
            let states = (
                corrected.delay_states.inputs.as_slice(),
                corrected.delay_states.outputs.as_slice(),
            );
            assert_eq!(states, ([order, 0].as_slice(), [0, order].as_slice()));
            assert_eq!(corrected.model.order(), 3 + 2 * order);
            // Magnitude 1; the lag is the delay's less the error.
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
            CorrectedModel::of(&plant().timed(own).unwrap(), &correction(), pade).unwrap();
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
        let corrected = CorrectedModel::of(&sampled(0.001), &correction(), pade).unwrap();
        assert_eq!(
            (corrected.model.order(), corrected.phase_error(12.0)),
            (3 + 30 + 11, 0.0)
        );
        assert_eq!(corrected.model.timing().sample_time_s, Some(0.001));
        assert_response(&corrected, &sampled(0.001), |omega, delay_s| {
            Complex::new(0.0, -omega * delay_s).exp()
        });
        let refused = CorrectedModel::of(&sampled(0.01), &correction(), pade).unwrap_err();
        assert_eq!(
            refused,
            CorrectedModelError::PartOfSample {
                channel: Channel::Output(1),
                delay_s: 0.011,
                sample_time_s: 0.01
            }
        );
        let refused = CorrectedModel::of(&sampled(1e-5), &correction(), pade).unwrap_err();
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
        let corrected = CorrectedModel::of(&plant(), &none, Pade::new(4).unwrap()).unwrap();
        assert_eq!(
            (corrected.model.a(), corrected.phase_error(12.0)),
            (plant().a(), 0.0)
        );
    }

    /// The plant's correction with a lead of 30 ms on the first input and 50 ms on the second
    /// output.
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
            let corrected = CorrectedModel::of(&plant(), &correction, Pade::default()).unwrap();
            assert_eq!(
                (
                    corrected.lead_states.inputs.as_slice(),
                    corrected.lead_states.outputs.as_slice()
                ),
                (&[states, 0][..], &[0, states][..])
            );
            let grid = FrequencyGrid::logarithmic(Band::new(0.5, 12.0).unwrap(), 12);
            let [found, plain] = [&corrected.model, &plant()].map(|model| {
                PreparedModel::of(&Dynamics::StateSpace(model.clone())).response(&grid)
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
        let corrected = CorrectedModel::of(&sampled(0.01), &correction, Pade::default()).unwrap();
        // 36 rad/s and a step of 10 ms: less than a quarter of a degree for each channel at 12
        // rad/s.
        assert!(
            (0.01..0.5).contains(&corrected.phase_error(12.0).to_degrees()),
            "{}",
            corrected.phase_error(12.0)
        );
        let refused = CorrectedModel::of(&sampled(0.02), &correction, Pade::default()).unwrap_err();
        assert!(
            matches!(refused, CorrectedModelError::SlowSamples { .. }),
            "{refused}"
        );
    }

    /// The approximant by its polynomials: `P(-x) / P(x)`, `P(x) = sum of (2N - k)! / (k! (N - k)!)
    /// x^k`.
    fn by_polynomials(order: usize, x: Complex<f64>) -> Complex<f64> {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let coefficient =
            |k: usize| factorial(2 * order - k) / (factorial(k) * factorial(order - k));
        let value = |x: Complex<f64>| {
            (0..=order)
                .rev()
                .fold(Complex::from(0.0), |sum, k| sum * x + coefficient(k))
        };
        value(-x) / value(x)
    }

    fn response(model: &ChannelModel, s: Complex<f64>) -> Complex<f64> {
        let n = model.order();
        let pencil = DMatrix::from_fn(n, n, |row, column| {
            let a = Complex::from(model.a[(row, column)]);
            if row == column { s - a } else { -a }
        });
        let state = pencil.lu().solve(&model.b.map(Complex::from)).unwrap();
        (model.c.map(Complex::from) * state)[0] + model.d
    }

    #[test]
    fn the_states_are_the_polynomials() {
        for order in 1..=HIGHEST_PADE_ORDER {
            for delay_s in [1e-4, 0.02, 3.0, 60.0] {
                let model = Pade::new(order).unwrap().model(delay_s);
                for angle in [1e-3, 0.3, 1.0, 4.0, 15.0, 80.0] {
                    let s = Complex::new(0.0, angle / delay_s);
                    let found = response(&model, s);
                    let expected = by_polynomials(order, s * delay_s);
                    assert!(
                        (found - expected).norm() < 1e-12,
                        "{order}, {delay_s} s, {angle}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn both_gramians_are_the_identity() {
        for order in 1..=HIGHEST_PADE_ORDER {
            let model = Pade::new(order).unwrap().model(0.07);
            let scale = model.a.amax();
            let left = &model.a + model.a.transpose();
            assert!(
                (&left + &model.b * model.b.transpose()).amax() < 1e-14 * scale,
                "{order}"
            );
            assert!(
                (&left + model.c.transpose() * &model.c).amax() < 1e-14 * scale,
                "{order}"
            );
        }
    }

    #[test]
    fn the_phase_error_is_that_of_the_response_followed_over_frequency() {
        for order in 1..=HIGHEST_PADE_ORDER {
            let pade = Pade::new(order).unwrap();
            let mut followed = 0.0;
            let mut before = Complex::from(1.0);
            // Steps far below half a turn, up to where the approximant has long stopped lagging.
            for step in 1..=4000 {
                let angle = f64::from(step) * 0.01;
                let error = by_polynomials(order, Complex::new(0.0, angle))
                    * Complex::new(0.0, angle).exp();
                followed += (error / before).arg();
                before = error;
                assert!(
                    (pade.phase_error(angle) - followed).abs() < 1e-10,
                    "{order}, {angle}"
                );
            }
        }
        assert_eq!((Pade::new(0), Pade::new(9)), (None, None));
    }

    #[test]
    fn samples_come_out_as_many_steps_later() {
        for count in 0..4 {
            let model = ChannelModel::samples(count);
            assert_eq!(model.order(), count);
            let mut x = DVector::zeros(count);
            let mut out = Vec::new();
            for u in [1.0, 2.0, 3.0, 4.0, 5.0] {
                out.push((&model.c * &x).sum() + model.d * u);
                x = &model.a * &x + &model.b * u;
            }
            let delayed: Vec<f64> =
                [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0][3 - count..][..5].to_vec();
            assert_eq!(out, delayed, "{count} samples");
        }
    }
}
