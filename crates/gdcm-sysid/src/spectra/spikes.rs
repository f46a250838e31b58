//! Finds spikes: single wrong samples, as after a faulty transmission (M14.24).
//!
//! ```text
//! samples    without repetitions in stairs (`fresh_samples`)
//! candidate  at most 3 consecutive samples, at most 0.1 s (a single sample always), on one side of
//!            the straight line between their neighbours, the nearest at least half as far as the
//!            farthest; the neighbours differ by at most half of the nearest distance, and each
//!            differs from the sample beyond it by at most a quarter
//! scale      of single samples, |x_k - (x_{k-1} + x_{k+1}) / 2|: the larger of the 95 % quantile of
//!            the record and the 90 % quantile of 25 samples on each side
//! spike      the longest candidate from a sample on, with a nearest distance >= 6 scales,
//!            >= 3 steps of the log and >= 1 standard deviation of the other samples
//! no spikes  more than 2 % of the samples: the channel moves in pulses
//! ```
//!
//! A step does not return, a test pulse lasts longer, a controller's kick rises and falls over
//! several samples, and in vibration or in a binary sequence the neighbourhood is as rough as the
//! candidate.

use gdcm_model::statistics::quantile;

use super::finite_samples::Sample;
use super::fresh_samples::FreshSamples;

/// Maximum number of samples in a spike.
const MOST_SAMPLES: usize = 3;
/// Longest spike with several samples \[s\].
const LONGEST_S: f64 = 0.1;
/// A spike's nearest sample is at least this far from the line, relative to its farthest.
const EVEN: f64 = 0.5;
/// Largest difference between the neighbours, relative to the nearest distance.
const RETURNED: f64 = 0.5;
/// The usual distance in the record is this quantile over single samples.
const USUAL: f64 = 0.95;
/// The usual distance nearby is this quantile over single samples.
const USUAL_NEARBY: f64 = 0.9;
/// Number of samples on each side that are nearby.
const NEARBY: usize = 25;
/// Minimum distance at which a sample is a spike, relative to the usual distance.
const OVER_USUAL: f64 = 6.0;
/// Minimum distance at which a sample is a spike, in standard deviations of the other samples.
const LEAST_DEVIATIONS: f64 = 1.0;
/// Minimum distance at which a sample is a spike, in logging steps.
const LEAST_STEPS: f64 = 3.0;
/// Largest difference between a neighbour and the sample beyond it, relative to the nearest
/// distance.
const ABRUPT: f64 = 0.25;
/// Largest share of samples in spikes; a channel with more moves in pulses.
const MOST_SHARE: f64 = 0.02;
/// A spike's neighbours are at most this far apart, in sample times, beyond its sample count.
const SLACK: f64 = 1.5;

/// A channel's spikes in a record.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spikes {
    /// Each spike's first stamp \[s\], ascending.
    pub(crate) times_s: Vec<f64>,
    /// The largest spike's distance from the line between its neighbours, in standard deviations of
    /// the other samples.
    pub(crate) deviations: f64,
    /// Each spike's first stamp and the first stamp after it \[s\].
    spans_s: Vec<[f64; 2]>,
}

/// Consecutive samples on one side of the line between their neighbours.
struct Candidate {
    first: usize,
    count: usize,
    /// Smallest distance from the line.
    nearest: f64,
    /// Largest distance from the line.
    farthest: f64,
}

impl Spikes {
    /// Finds spikes among a channel's samples in a record; `None` if there are none, or so many
    /// that the channel moves in pulses.
    pub(crate) fn find(samples: Vec<Sample>) -> Option<Self> {
        let fresh = FreshSamples::new(samples);
        let samples = &fresh.samples;
        let distances = single_distances(samples);
        let usual = quantile(&mut distances.clone(), USUAL);
        let log_step = fresh.log_step();
        let mut found: Vec<Candidate> = Vec::new();
        let mut first = 1;
        while first + 1 < samples.len() {
            match candidate(&fresh, first) {
                Some(candidate) if candidate.is_rare(&distances, usual) => {
                    first += candidate.count;
                    found.push(candidate);
                }
                _ => first += 1,
            }
        }
        let deviation = deviation_without(samples, &found);
        found.retain(|spike| {
            spike.nearest >= LEAST_DEVIATIONS * deviation && spike.nearest >= LEAST_STEPS * log_step
        });
        let spoilt: usize = found.iter().map(|spike| spike.count).sum();
        if found.is_empty() || spoilt as f64 > MOST_SHARE * samples.len() as f64 {
            return None;
        }
        let deviation = deviation_without(samples, &found);
        let farthest = found.iter().map(|spike| spike.farthest).fold(0.0, f64::max);
        Some(Self {
            times_s: found
                .iter()
                .map(|spike| samples[spike.first].time_s)
                .collect(),
            deviations: farthest / deviation,
            spans_s: found
                .iter()
                .map(|spike| {
                    let next = samples[spike.first + spike.count].time_s;
                    [samples[spike.first].time_s, next]
                })
                .collect(),
        })
    }

    /// Returns whether a stamp \[s\] is in a spike.
    pub(crate) fn contain(&self, time_s: f64) -> bool {
        self.spans_s
            .iter()
            .any(|[first, next]| (*first..*next).contains(&time_s))
    }
}

/// Returns each sample's distance from the mean of its neighbours; 0 at the ends.
fn single_distances(samples: &[Sample]) -> Vec<f64> {
    let mut distances = vec![0.0; samples.len()];
    for (k, near) in samples.windows(3).enumerate() {
        distances[k + 1] = (near[1].value - 0.5 * (near[0].value + near[2].value)).abs();
    }
    distances
}

/// Returns the longest candidate that begins at a sample.
fn candidate(fresh: &FreshSamples, first: usize) -> Option<Candidate> {
    let samples = &fresh.samples;
    for count in (1..=MOST_SAMPLES).rev() {
        if first + count >= samples.len() {
            continue;
        }
        let before = samples[first - 1];
        let after = samples[first + count];
        let lasts_s = after.time_s - before.time_s;
        let is_short = count == 1 || count as f64 * fresh.sample_time_s <= LONGEST_S;
        let has_gap = lasts_s > (count as f64 + SLACK) * fresh.sample_time_s;
        if !is_short || has_gap || lasts_s <= 0.0 {
            continue;
        }
        let mut nearest = f64::INFINITY;
        let mut farthest = 0.0_f64;
        let side = (samples[first].value - before.value).signum();
        for sample in &samples[first..first + count] {
            let share = (sample.time_s - before.time_s) / lasts_s;
            let line = before.value + share * (after.value - before.value);
            let distance = side * (sample.value - line);
            nearest = nearest.min(distance);
            farthest = farthest.max(distance);
        }
        let has_returned = (after.value - before.value).abs() <= RETURNED * nearest;
        let is_abrupt = outer_step(samples, first, count) <= ABRUPT * nearest;
        if nearest > 0.0 && nearest >= EVEN * farthest && has_returned && is_abrupt {
            return Some(Candidate {
                first,
                count,
                nearest,
                farthest,
            });
        }
    }
    None
}

/// Returns the larger difference between a candidate's neighbour and the sample beyond it.
fn outer_step(samples: &[Sample], first: usize, count: usize) -> f64 {
    let mut largest = 0.0;
    if first >= 2 {
        largest = (samples[first - 1].value - samples[first - 2].value).abs();
    }
    if let Some(beyond) = samples.get(first + count + 1) {
        largest = (beyond.value - samples[first + count].value)
            .abs()
            .max(largest);
    }
    largest
}

impl Candidate {
    /// Returns whether the distance is far above the usual distances in the record and nearby.
    fn is_rare(&self, distances: &[f64], usual: f64) -> bool {
        if self.nearest < OVER_USUAL * usual {
            return false;
        }
        // A spike's neighbours are left out: they too are far from the mean of theirs.
        let before = &distances[(self.first - 1).saturating_sub(NEARBY)..self.first - 1];
        let last = (self.first + self.count + 1).min(distances.len());
        let after = &distances[last..(last + NEARBY).min(distances.len())];
        let mut nearby = [before, after].concat();
        nearby.is_empty() || self.nearest >= OVER_USUAL * quantile(&mut nearby, USUAL_NEARBY)
    }
}

/// Returns the standard deviation of the samples outside the candidates.
fn deviation_without(samples: &[Sample], candidates: &[Candidate]) -> f64 {
    let mut is_kept = vec![true; samples.len()];
    for candidate in candidates {
        is_kept[candidate.first..candidate.first + candidate.count].fill(false);
    }
    let kept: Vec<f64> = samples
        .iter()
        .zip(&is_kept)
        .filter(|(_, is_kept)| **is_kept)
        .map(|(sample, _)| sample.value)
        .collect();
    let count = kept.len().max(1) as f64;
    let mean = kept.iter().sum::<f64>() / count;
    (kept.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count).sqrt()
}
