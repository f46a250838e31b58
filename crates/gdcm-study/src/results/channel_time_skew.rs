//! A channel logged late in all records alike, detected against a physics model (M14, section 10).
//!
//! The records alone cannot distinguish a delay common to all of them from dynamics. Comparison
//! with a physics model can, where the responses of one channel lag in proportion to frequency and
//! those of the other channels do not.
//!
//! ```text
//! 1  of each response that is coherent over half of the band:   phi = arg(measured / physics), unwrapped
//!       d = -sum W omega phi / sum W omega^2,   W = 1 / (var phi + (3 deg)^2)
//! 2  of each output (a row of responses) and input (a column):
//!       common = median of d over all other responses,   s = 1.48 median |d - common| over them
//!       delay = median of d over its own - common
//! 3  it is late where |delay| > t and |d - common - delay| <= t for each of its own, t = max(5 ms, 2.5 s),
//!    and the delay explains four fifths of sum W (phi + omega common)^2
//! 4  of two channels each is late where the other is early: the one with the least |common| is named
//! ```
//!
//! `common`, the delay that all channels share, cannot be assigned to one channel: the leads report
//! it (M15, section 6).

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{Band, BundleKind, Condition, Dataset, Dynamics, Pair};
use gdcm_model::response::curve_values::unwrap;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, median};
use gdcm_model::simulation::Signal;
use gdcm_sysid::identification::{ResponseEstimate, TRUSTED_COHERENCE};

/// Least share of the points in the band at which a response must be coherent.
const LEAST_SHOWN: f64 = 0.5;
/// Lower bound on the standard deviation of a physics model's phase \[rad\].
const PHYSICS_SD: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// Least delay that is reported \[s\].
const LEAST_S: f64 = 5e-3;
/// Multiple of the scatter of the other responses beyond which a delay is significant.
const STANDS_OUT: f64 = 2.5;
/// Ratio of the standard deviation to the median modulus of a normal scatter.
const OF_MEDIAN: f64 = 1.4826;
/// Greatest share of the squared phase that a delay may leave unexplained.
const MOST_LEFT: f64 = 0.2;

/// A channel that appears to be logged late, or early, in all records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelTimeSkew {
    pub role: ChannelSide,
    /// Index, counted from 0.
    pub index: usize,
    /// Delay \[s\]; negative when the channel is early.
    pub delay_s: f64,
}

impl ChannelTimeSkew {
    /// Finds the channel whose delay explains the lag of a measured response against a physics
    /// model; `None` where no delay is significant.
    pub fn of(measured: &ResponseEstimate, band: [f64; 2], physics: &Dynamics) -> Option<Self> {
        let lags = lags(measured, band, physics)?;
        let (outputs, inputs) = measured.points.first()?.response.shape();
        let rows = (0..outputs).map(|index| (ChannelSide::Output, index, inputs));
        let columns = (0..inputs).map(|index| (ChannelSide::Input, index, outputs));
        let suspects: Vec<Suspect> = rows
            .chain(columns)
            .filter_map(|of| Suspect::of(&lags, of))
            .collect();
        let most = suspects
            .iter()
            .map(|suspect| suspect.explained)
            .fold(0.0, f64::max);
        let suspects = suspects
            .into_iter()
            .filter(|suspect| suspect.explained >= 0.5 * most);
        suspects
            .min_by(|a, b| a.common_s.abs().total_cmp(&b.common_s.abs()))
            .map(|suspect| suspect.channel)
    }

    /// Finds the channel against the nominal physics model of a condition.
    pub fn of_condition(
        measured: &ResponseEstimate,
        band: [f64; 2],
        condition: &Condition,
    ) -> Option<Self> {
        let nominal = condition
            .bundle(BundleKind::Physics)
            .get(condition.nominal())?;
        Self::of(measured, band, &nominal.dynamics)
    }

    /// Returns the channel of a dataset.
    pub fn signal(&self, dataset: &Dataset) -> Option<Signal> {
        let channels = if self.role == ChannelSide::Input {
            dataset.inputs()
        } else {
            dataset.outputs()
        };
        let name = channels.get(self.index)?.name.clone();
        Some(Signal {
            role: self.role,
            index: self.index,
            name,
        })
    }
}

/// Lag of one response against that of a physics model.
struct Lag {
    pair: Pair,
    delay_s: f64,
    /// Frequency \[rad/s\], phase \[rad\] and weight.
    phase: Vec<[f64; 3]>,
}

impl Lag {
    /// Returns `sum W (phi + omega d)^2`.
    fn left(&self, delay_s: f64) -> f64 {
        self.phase
            .iter()
            .map(|[omega, phase, weight]| weight * (phase + omega * delay_s).powi(2))
            .sum()
    }
}

/// Computes the lags of the responses that are coherent over half of the band; `None` where the
/// physics model has no response at these frequencies.
fn lags(measured: &ResponseEstimate, band: [f64; 2], physics: &Dynamics) -> Option<Vec<Lag>> {
    let points: Vec<_> = measured
        .points
        .iter()
        .filter(|point| (band[0]..=band[1]).contains(&point.omega))
        .collect();
    let first = points.first()?;
    let last = points.last()?;
    let grid = FrequencyGrid::logarithmic(Band::new(first.omega, last.omega).ok()?, points.len());
    let same = grid.len() == points.len()
        && grid
            .omega()
            .iter()
            .zip(&points)
            .all(|(omega, point)| (omega / point.omega - 1.0).abs() < 1e-9);
    let physics = Some(FrequencyResponse::of(physics, &grid)).filter(|_| same)?;
    let (outputs, inputs) = first.response.shape();
    let lag = |pair: Pair| {
        let at = (pair.output, pair.input);
        let modelled = physics.curve(pair);
        let trusted = points.iter().zip(modelled).filter(|(point, value)| {
            point.partial_coherence[at] >= TRUSTED_COHERENCE
                && value.norm() > 0.0
                && point.response[at].norm() > 0.0
        });
        let mut angles = Vec::new();
        let mut others = Vec::new();
        for (point, value) in trusted {
            angles.push((point.response[at] / value).arg());
            let variance = 0.5 * point.variance[at] / point.response[at].norm_sqr();
            others.push((point.omega, 1.0 / (variance + PHYSICS_SD * PHYSICS_SD)));
        }
        if (angles.len() as f64) < LEAST_SHOWN * points.len() as f64 {
            return None;
        }
        unwrap(&mut angles);
        let phase: Vec<[f64; 3]> = angles
            .iter()
            .zip(&others)
            .map(|(phase, (omega, weight))| [*omega, *phase, *weight])
            .collect();
        let sum = |of: fn(&[f64; 3]) -> f64| phase.iter().map(of).sum::<f64>();
        let delay_s = -sum(|[omega, phase, weight]| weight * omega * phase)
            / sum(|[omega, _, weight]| weight * omega * omega);
        delay_s.is_finite().then_some(Lag {
            pair,
            delay_s,
            phase,
        })
    };
    let pairs =
        (0..outputs).flat_map(|output| (0..inputs).map(move |input| Pair { output, input }));
    Some(pairs.filter_map(lag).collect())
}

/// A channel with a significant delay.
struct Suspect {
    channel: ChannelTimeSkew,
    /// Delay common to the others \[s\].
    common_s: f64,
    /// Squared phase explained by its delay.
    explained: f64,
}

impl Suspect {
    /// Tests a channel with this many responses for a delay.
    fn of(lags: &[Lag], (role, index, responses): (ChannelSide, usize, usize)) -> Option<Self> {
        let is_own = |lag: &&Lag| match role {
            ChannelSide::Output => lag.pair.output == index,
            ChannelSide::Input => lag.pair.input == index,
        };
        let (own, others): (Vec<&Lag>, Vec<&Lag>) = lags.iter().partition(is_own);
        if own.len() < 2 || 2 * own.len() <= responses || others.len() < 2 {
            return None;
        }
        let middle = |of: &mut dyn Iterator<Item = f64>| median(&mut of.collect::<Vec<f64>>());
        let common_s = middle(&mut others.iter().map(|lag| lag.delay_s));
        let scatter_s =
            OF_MEDIAN * middle(&mut others.iter().map(|lag| (lag.delay_s - common_s).abs()));
        let delay_s = middle(&mut own.iter().map(|lag| lag.delay_s)) - common_s;
        let tolerance_s = LEAST_S.max(STANDS_OUT * scatter_s);
        let agree = own
            .iter()
            .all(|lag| (lag.delay_s - common_s - delay_s).abs() <= tolerance_s);
        let left = |delay_s: f64| own.iter().map(|lag| lag.left(delay_s)).sum::<f64>();
        let before = left(common_s);
        let after = left(common_s + delay_s);
        let is_late = delay_s.abs() > tolerance_s && agree && after <= MOST_LEFT * before;
        // The responses to an input that is logged late are early.
        let delay_s = if role == ChannelSide::Output {
            delay_s
        } else {
            -delay_s
        };
        is_late.then_some(Self {
            channel: ChannelTimeSkew {
                role,
                index,
                delay_s,
            },
            common_s,
            explained: before - after,
        })
    }
}
