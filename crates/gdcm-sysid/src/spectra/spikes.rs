//! Finds spikes: single wrong samples, as after a faulty transmission (M14.24).
//!
//! ```text
//! 1  samples without repetitions in stairs (`fresh_samples`)
//! 2  roughness of single samples, |x_k - (x_{k-1} + x_{k+1}) / 2|; usual: 95 % quantile
//! 3  from each sample on, the longest candidate: at most 3 consecutive samples, at most 0.1 s (a
//!    single sample always), on one side of the straight line between their neighbours
//!       even      the nearest is at least half as far from the line as the farthest
//!       returned  the neighbours differ by at most half of the nearest distance
//!       abrupt    each neighbour differs from the sample beyond it by at most a quarter of it
//! 4  keep rare ones: nearest distance >= 6 usual roughnesses, and >= 6 times the 90 % quantile of
//!    the roughness of 25 samples on each side
//! 5  keep large ones: nearest distance >= 3 logging steps and >= 1 standard deviation of the other
//!    samples
//! 6  no spikes if they take more than 2 % of the samples: the channel moves in pulses
//! ```
//!
//! A step does not return, a test pulse lasts longer, a controller's kick rises and falls over
//! several samples, and in vibration or in a binary sequence the neighbourhood is as rough as the
//! candidate. False and missed spikes are counted in M14.24 of `docs/identification.md`.

use gdcm_model::statistics::quantile;

use super::finite_samples::Sample;
use super::fresh_samples::FreshSamples;

/// Maximum number of samples in a spike.
const MOST_SAMPLES: usize = 3;
/// Longest spike with several samples \[s\].
const LONGEST_S: f64 = 0.1;
/// Minimum nearest distance relative to the farthest (*even* in step 3).
const EVEN: f64 = 0.5;
/// Largest difference between the neighbours, relative to the nearest distance (*returned*).
const RETURNED: f64 = 0.5;
/// Largest difference between a neighbour and the sample beyond it, relative to the nearest
/// distance (*abrupt*).
const ABRUPT: f64 = 0.25;
/// Quantile for the usual roughness in the record.
const USUAL_QUANTILE: f64 = 0.95;
/// Quantile for the roughness nearby.
const NEARBY_QUANTILE: f64 = 0.9;
/// Number of samples on each side that are nearby.
const NEARBY: usize = 25;
/// Minimum nearest distance relative to the roughness (step 4).
const RARE: f64 = 6.0;
/// Minimum nearest distance, in standard deviations of the other samples (step 5).
const LEAST_DEVIATIONS: f64 = 1.0;
/// Minimum nearest distance, in logging steps (step 5).
const LEAST_LOG_STEPS: f64 = 3.0;
/// Largest share of samples in spikes (step 6).
const MOST_SHARE: f64 = 0.02;
/// A candidate's neighbours are at most this far apart, in sample times, beyond its sample count;
/// otherwise there is a gap between them.
const GAP_TOLERANCE: f64 = 1.5;

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
    /// Finds spikes among a channel's samples in a record (steps 1 to 6); `None` if there are none,
    /// or so many that the channel moves in pulses.
    pub(crate) fn find(samples: Vec<Sample>) -> Option<Self> {
        // Step 1.
        let fresh = FreshSamples::new(samples);
        let samples = &fresh.samples;
        // Steps 2 to 4.
        let mut spikes = rare_candidates(&fresh);
        // Step 5.
        let deviation = deviation_without(samples, &spikes);
        let log_step = fresh.log_step();
        spikes.retain(|spike| {
            spike.nearest >= LEAST_DEVIATIONS * deviation
                && spike.nearest >= LEAST_LOG_STEPS * log_step
        });
        // Step 6.
        let count: usize = spikes.iter().map(|spike| spike.count).sum();
        if spikes.is_empty() || count as f64 > MOST_SHARE * samples.len() as f64 {
            return None;
        }
        Some(Self::from_candidates(&spikes, samples))
    }

    fn from_candidates(spikes: &[Candidate], samples: &[Sample]) -> Self {
        let deviation = deviation_without(samples, spikes);
        let farthest = spikes
            .iter()
            .map(|spike| spike.farthest)
            .fold(0.0, f64::max);
        let mut times_s = Vec::with_capacity(spikes.len());
        let mut spans_s = Vec::with_capacity(spikes.len());
        for spike in spikes {
            let first_s = samples[spike.first].time_s;
            let next_s = samples[spike.first + spike.count].time_s;
            times_s.push(first_s);
            spans_s.push([first_s, next_s]);
        }
        Self {
            times_s,
            deviations: farthest / deviation,
            spans_s,
        }
    }

    /// Returns whether a stamp \[s\] is in a spike.
    pub(crate) fn contain(&self, time_s: f64) -> bool {
        self.spans_s
            .iter()
            .any(|[first, next]| (*first..*next).contains(&time_s))
    }
}

/// Finds the candidates that are rare among the samples (steps 2 to 4); they do not overlap.
fn rare_candidates(fresh: &FreshSamples) -> Vec<Candidate> {
    let roughness = roughness(&fresh.samples);
    let usual = quantile(&mut roughness.clone(), USUAL_QUANTILE);
    let mut found: Vec<Candidate> = Vec::new();
    let mut first = 1;
    while first + 1 < fresh.samples.len() {
        match longest_candidate(fresh, first) {
            Some(candidate) if candidate.is_rare(&roughness, usual) => {
                first += candidate.count;
                found.push(candidate);
            }
            _ => first += 1,
        }
    }
    found
}

/// Returns each sample's distance from the mean of its neighbours (step 2); 0 at the ends.
fn roughness(samples: &[Sample]) -> Vec<f64> {
    let mut distances = vec![0.0; samples.len()];
    for (k, near) in samples.windows(3).enumerate() {
        distances[k + 1] = (near[1].value - 0.5 * (near[0].value + near[2].value)).abs();
    }
    distances
}

/// Returns the longest candidate that begins at a sample (step 3).
fn longest_candidate(fresh: &FreshSamples, first: usize) -> Option<Candidate> {
    (1..=MOST_SAMPLES)
        .rev()
        .find_map(|count| candidate(fresh, first, count))
}

/// Returns the candidate with this first sample and sample count; `None` if the samples do not meet
/// the conditions in step 3.
fn candidate(fresh: &FreshSamples, first: usize, count: usize) -> Option<Candidate> {
    let samples = &fresh.samples;
    let before = samples[first - 1];
    let after = *samples.get(first + count)?;
    let between_s = after.time_s - before.time_s;
    let is_short = count == 1 || count as f64 * fresh.sample_time_s <= LONGEST_S;
    let has_gap = between_s > (count as f64 + GAP_TOLERANCE) * fresh.sample_time_s;
    if !is_short || has_gap || between_s <= 0.0 {
        return None;
    }
    let mut nearest = f64::INFINITY;
    let mut farthest = 0.0_f64;
    let side = (samples[first].value - before.value).signum();
    for sample in &samples[first..first + count] {
        let share = (sample.time_s - before.time_s) / between_s;
        let line = before.value + share * (after.value - before.value);
        let distance = side * (sample.value - line);
        nearest = nearest.min(distance);
        farthest = farthest.max(distance);
    }
    let is_on_one_side = nearest > 0.0;
    let is_even = nearest >= EVEN * farthest;
    let has_returned = (after.value - before.value).abs() <= RETURNED * nearest;
    let is_abrupt = outer_step(samples, first, count) <= ABRUPT * nearest;
    if is_on_one_side && is_even && has_returned && is_abrupt {
        Some(Candidate {
            first,
            count,
            nearest,
            farthest,
        })
    } else {
        None
    }
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
    /// Returns whether the nearest distance is far above the roughness in the record and nearby
    /// (step 4).
    fn is_rare(&self, roughness: &[f64], usual: f64) -> bool {
        if self.nearest < RARE * usual {
            return false;
        }
        // The candidate's neighbours are left out: they are rough only because of the candidate.
        let before = &roughness[(self.first - 1).saturating_sub(NEARBY)..self.first - 1];
        let last = (self.first + self.count + 1).min(roughness.len());
        let after = &roughness[last..(last + NEARBY).min(roughness.len())];
        let mut nearby = [before, after].concat();
        nearby.is_empty() || self.nearest >= RARE * quantile(&mut nearby, NEARBY_QUANTILE)
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
