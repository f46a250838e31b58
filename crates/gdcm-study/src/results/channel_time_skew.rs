//! A channel logged late in all records alike, detected against a physics model (section "Limits"
//! in `docs/identification.md`).
//!
//! The records alone cannot distinguish a common delay from dynamics. Comparison with a physics
//! model can, where the responses to or from a channel lag in proportion to frequency and the other
//! responses do not.
//!
//! ```text
//! 0  exit without a finding: no frequencies in the band, or not logarithmically spaced
//! 1  each response that is coherent over half the band:   phi = arg(measured / physics), unwrapped
//!       d = -sum W omega phi / sum W omega^2,   W = 1 / (var phi + (3 deg)^2)
//! 2  each output and each input: its own responses are a row or a column of the response matrix;
//!    skip it unless two or more of them, and more than half, are coherent, and two or more others:
//!       common = median d of all other responses,   s = 1.48 median |d - common| over them
//!       delay = median d of its own responses - common
//! 3  late where |delay| > t and |d - common - delay| <= t for each own response, where
//!    t = max(5 ms, 2.5 * s), and the delay explains four fifths of sum W (phi + omega common)^2
//! 4  among the late channels that explain at least half as much as the best: the one with the
//!    smallest |common|, since a late channel is the same as all others early by a common delay.
//!    For an input the delay is reversed: responses to an input that is logged late appear early
//! ```
//!
//! `common`, the delay that all channels share, cannot be assigned to a channel; it is reported
//! with the leads (M15.6).

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{Band, BundleKind, Condition, Dataset, Dynamics, Pair};
use gdcm_model::response::phase_unwrapping::unwrap;
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};
use gdcm_model::simulation::Signal;
use gdcm_model::statistics::median;
use gdcm_sysid::identification::{ResponseEstimate, TRUSTED_COHERENCE};
use gdcm_sysid::spectra::response_estimate::EstimatePoint;

/// Minimum share of the band's frequencies at which a response must be coherent.
const LEAST_SHOWN: f64 = 0.5;
/// Standard deviation assumed for a physics model's phase \[rad\]; it limits the weight of a
/// frequency that is measured very precisely.
const PHYSICS_SD: f64 = 3.0 * std::f64::consts::PI / 180.0;
/// Minimum delay that is reported \[s\].
const LEAST_S: f64 = 5e-3;
/// Minimum significant delay, as a multiple of the scatter among the other responses: a compromise,
/// since a smaller multiple names channels by chance, and a larger one misses small delays.
const STANDS_OUT: f64 = 2.5;
/// Ratio of standard deviation to median absolute deviation, for a normal distribution.
const SD_OVER_MEDIAN: f64 = 1.4826;
/// Maximum share of the squared phase that a delay may leave unexplained: a physics model that is
/// wrong in another way leaves more.
const MOST_LEFT: f64 = 0.2;
/// Minimum squared phase that a suspect explains, relative to the largest explained by any suspect;
/// among those above it the common delay decides (step 4).
const LEAST_OF_BEST: f64 = 0.5;

/// A channel that appears to be logged late, or early, in all records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelTimeSkew {
    pub role: ChannelSide,
    /// Index of the channel among the inputs or outputs, counted from 0.
    pub index: usize,
    /// Delay \[s\]; negative when the channel is early.
    pub delay_s: f64,
}

impl ChannelTimeSkew {
    /// Finds the channel whose delay explains why the measured responses lag behind a physics model
    /// in a band \[rad/s\] (steps 1 to 4); `None` where no delay is significant.
    pub fn find(measured: &ResponseEstimate, band: [f64; 2], physics: &Dynamics) -> Option<Self> {
        let lags = response_lags(measured, band, physics)?;
        let (outputs, inputs) = measured.points.first()?.response.shape();
        let mut suspects = Vec::new();
        for output in 0..outputs {
            suspects.extend(Suspect::test(&lags, ChannelSide::Output, output, inputs));
        }
        for input in 0..inputs {
            suspects.extend(Suspect::test(&lags, ChannelSide::Input, input, outputs));
        }
        let most = suspects
            .iter()
            .map(|suspect| suspect.explained)
            .fold(0.0, f64::max);
        suspects.retain(|suspect| suspect.explained >= LEAST_OF_BEST * most);
        suspects
            .into_iter()
            .min_by(|a, b| a.common_s.abs().total_cmp(&b.common_s.abs()))
            .map(|suspect| suspect.channel)
    }

    /// Like [`ChannelTimeSkew::find`], with a condition's nominal physics model; `None` also if
    /// that model is missing.
    pub fn of_condition(
        measured: &ResponseEstimate,
        band: [f64; 2],
        condition: &Condition,
    ) -> Option<Self> {
        let models = condition.bundle(BundleKind::Physics);
        let nominal = models.get(condition.nominal())?;
        Self::find(measured, band, &nominal.dynamics)
    }

    /// Returns the channel in a dataset; `None` where it does not exist.
    pub fn signal(&self, dataset: &Dataset) -> Option<Signal> {
        let channels = match self.role {
            ChannelSide::Input => dataset.inputs(),
            ChannelSide::Output => dataset.outputs(),
        };
        let name = channels.get(self.index)?.name.clone();
        Some(Signal {
            role: self.role,
            index: self.index,
            name,
        })
    }
}

/// Phase difference at a frequency, with its weight.
struct PhasePoint {
    /// Frequency \[rad/s\].
    omega: f64,
    /// Phase \[rad\].
    phase: f64,
    weight: f64,
}

/// Lag of a measured response behind the physics model's.
struct Lag {
    pair: Pair,
    delay_s: f64,
    points: Vec<PhasePoint>,
}

impl Lag {
    /// Fits a response's delay d (step 1); `None` where it is coherent at too few frequencies.
    fn fit(points: &[&EstimatePoint], physics: &FrequencyResponse, pair: Pair) -> Option<Self> {
        let at = (pair.output, pair.input);
        let mut angles = Vec::new();
        let mut weighted = Vec::new();
        for (point, modelled) in points.iter().zip(physics.curve(pair)) {
            let measured = point.response[at];
            let is_trusted = point.partial_coherence[at] >= TRUSTED_COHERENCE;
            if !(is_trusted && modelled.norm() > 0.0 && measured.norm() > 0.0) {
                continue;
            }
            angles.push((measured / modelled).arg());
            // Variance of the phase, to first order.
            let variance = 0.5 * point.variance[at] / measured.norm_sqr();
            weighted.push((point.omega, 1.0 / (variance + PHYSICS_SD * PHYSICS_SD)));
        }
        if (angles.len() as f64) < LEAST_SHOWN * points.len() as f64 {
            return None;
        }
        unwrap(&mut angles);
        let points: Vec<PhasePoint> = angles
            .into_iter()
            .zip(weighted)
            .map(|(phase, (omega, weight))| PhasePoint {
                omega,
                phase,
                weight,
            })
            .collect();
        let numerator: f64 = points
            .iter()
            .map(|point| point.weight * point.omega * point.phase)
            .sum();
        let denominator: f64 = points
            .iter()
            .map(|point| point.weight * point.omega * point.omega)
            .sum();
        let delay_s = -numerator / denominator;
        if !delay_s.is_finite() {
            return None;
        }
        Some(Self {
            pair,
            delay_s,
            points,
        })
    }

    /// Returns `sum W (phi + omega d)^2`.
    fn squared_phase(&self, delay_s: f64) -> f64 {
        self.points
            .iter()
            .map(|point| point.weight * (point.phase + point.omega * delay_s).powi(2))
            .sum()
    }
}

/// Computes the lags for the responses that are coherent over half the band (step 1); `None`
/// without frequencies in the band, or if they are not logarithmically spaced (step 0).
fn response_lags(
    measured: &ResponseEstimate,
    band: [f64; 2],
    physics: &Dynamics,
) -> Option<Vec<Lag>> {
    let points: Vec<&EstimatePoint> = measured
        .points
        .iter()
        .filter(|point| (band[0]..=band[1]).contains(&point.omega))
        .collect();
    let first = points.first()?;
    let last = points.last()?;
    let grid = FrequencyGrid::logarithmic(Band::new(first.omega, last.omega).ok()?, points.len());
    let is_same_grid = grid.len() == points.len()
        && grid
            .omega()
            .iter()
            .zip(&points)
            .all(|(omega, point)| (omega / point.omega - 1.0).abs() < 1e-9);
    if !is_same_grid {
        return None;
    }
    let physics = FrequencyResponse::from_dynamics(physics, &grid);
    let (outputs, inputs) = first.response.shape();
    let mut lags = Vec::new();
    for output in 0..outputs {
        for input in 0..inputs {
            lags.extend(Lag::fit(&points, &physics, Pair { output, input }));
        }
    }
    Some(lags)
}

/// A channel with a significant delay.
struct Suspect {
    channel: ChannelTimeSkew,
    /// Median delay in the other responses \[s\].
    common_s: f64,
    /// Decrease in the weighted squared phase due to the channel's delay.
    explained: f64,
}

impl Suspect {
    /// Tests whether a channel with this number of responses has a significant delay (steps 2 and
    /// 3).
    fn test(lags: &[Lag], role: ChannelSide, index: usize, responses: usize) -> Option<Self> {
        let (own, others): (Vec<&Lag>, Vec<&Lag>) = lags.iter().partition(|lag| match role {
            ChannelSide::Output => lag.pair.output == index,
            ChannelSide::Input => lag.pair.input == index,
        });
        if own.len() < 2 || 2 * own.len() <= responses || others.len() < 2 {
            return None;
        }
        let common_s = median_of(others.iter().map(|lag| lag.delay_s));
        let deviations_s = others.iter().map(|lag| (lag.delay_s - common_s).abs());
        let scatter_s = SD_OVER_MEDIAN * median_of(deviations_s);
        let own_delay_s = median_of(own.iter().map(|lag| lag.delay_s)) - common_s;
        let tolerance_s = LEAST_S.max(STANDS_OUT * scatter_s);
        let agrees = own
            .iter()
            .all(|lag| (lag.delay_s - common_s - own_delay_s).abs() <= tolerance_s);
        let before: f64 = own.iter().map(|lag| lag.squared_phase(common_s)).sum();
        let after: f64 = own
            .iter()
            .map(|lag| lag.squared_phase(common_s + own_delay_s))
            .sum();
        let is_significant =
            own_delay_s.abs() > tolerance_s && agrees && after <= MOST_LEFT * before;
        if !is_significant {
            return None;
        }
        // If an input is logged late, the responses to it appear early.
        let delay_s = match role {
            ChannelSide::Output => own_delay_s,
            ChannelSide::Input => -own_delay_s,
        };
        Some(Self {
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

fn median_of(values: impl Iterator<Item = f64>) -> f64 {
    median(&mut values.collect::<Vec<f64>>())
}
