//! Channels at their limit, stuck or coarse (M14.18).
//!
//! ```text
//! flat: consecutive |dx| <= 1e-3 mean |dx|;  a run is a stretch of flat samples, or one sample
//! at its limit: the share of samples in runs of at least max(5, 3 q) whose mean lies in the outer 5 % of the range,
//!               q the 90 % quantile of the flat runs elsewhere;  caution above 0.5 %, or 10 % where flat runs elsewhere hold 20 % of the samples
//! coarse: the least step between two values is over half the standard deviation
//! ```

use super::*;

/// Step over the mean step up to which two samples are flat.
const FLAT: f64 = 1e-3;
/// The shortest run at a limit, and the same over the quantile of the runs elsewhere.
const SHORTEST: f64 = 5.0;
const OVER_USUAL: f64 = 3.0;
const USUAL: f64 = 0.9;
/// Share of the range at each end in which a limit lies.
const OUTER: f64 = 0.05;
/// Share of the samples at a limit that is too much, of a smooth channel and of a coarse or held one, and what tells these apart.
const TOO_MANY: (f64, f64) = (0.005, 0.1);
const HELD_SHARE: f64 = 0.2;
/// Least step between values over the standard deviation above which a channel is coarse.
const COARSE: f64 = 0.5;

/// How often a channel is at its limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Clipping {
    /// Share of the samples.
    pub(super) share: f64,
    /// The share that is too much.
    pub(super) most: f64,
}

/// How often the samples of a channel are at its limit.
pub(super) fn clipping(samples: &[f64]) -> Clipping {
    let steps = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let flat = FLAT * steps.sum::<f64>() / samples.len().saturating_sub(1).max(1) as f64;
    let (least, greatest) = samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let outer = OUTER * (greatest - least);
    let runs: Vec<&[f64]> = samples.chunk_by(|a, b| (b - a).abs() <= flat).collect();
    let is_outer = |run: &[f64]| {
        let mean = run.iter().sum::<f64>() / run.len() as f64;
        mean >= greatest - outer || mean <= least + outer
    };
    let (at_ends, elsewhere): (Vec<&[f64]>, Vec<&[f64]>) = runs.into_iter().partition(|run| is_outer(run));
    let mut lengths: Vec<f64> = elsewhere.iter().filter(|run| run.len() > 1).map(|run| run.len() as f64).collect();
    let usual = if lengths.is_empty() { 1.0 } else { quantile(&mut lengths, USUAL) };
    let shortest = SHORTEST.max(OVER_USUAL * usual);
    let share = |count: usize| count as f64 / samples.len().max(1) as f64;
    let at_limit = at_ends.iter().filter(|run| run.len() as f64 >= shortest).map(|run| run.len()).sum();
    let held = share(elsewhere.iter().filter(|run| run.len() > 1).map(|run| run.len()).sum());
    Clipping { share: share(at_limit), most: if held > HELD_SHARE { TOO_MANY.1 } else { TOO_MANY.0 } }
}

/// Whether a channel has so few values that to stand still is nothing unusual.
pub(super) fn is_coarse(samples: &[f64]) -> bool {
    coarseness(samples).is_some_and(|steps| steps > COARSE)
}

/// The least step between two values over the standard deviation; none where nothing moves.
fn coarseness(samples: &[f64]) -> Option<f64> {
    let mean = samples.iter().sum::<f64>() / samples.len().max(1) as f64;
    let deviation = (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / samples.len().max(1) as f64).sqrt();
    let mut values = samples.to_vec();
    values.sort_by(f64::total_cmp);
    let steps = values.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > FLAT * deviation);
    let least = steps.fold(f64::INFINITY, f64::min);
    let even = values.windows(2).all(|pair| pair[1] - pair[0] <= FLAT * deviation || pair[1] - pair[0] >= least);
    (deviation > 0.0 && least.is_finite() && even).then_some(least / deviation)
}

/// The samples of a channel that are numbers.
pub(super) fn finite(record: &FlightRecord, signal: &Signal) -> Vec<f64> {
    record.channel(signal).iter().copied().filter(|x| x.is_finite()).collect()
}

/// The inputs of a record that stand at their limit, and for which share of it \[%\].
pub(super) fn inputs_at_limit(record: &FlightRecord, preparation: &Preparation) -> Vec<(Signal, f64)> {
    let inputs = preparation.channels().filter(|(signal, _)| signal.role == ChannelSide::Input);
    let clipped = inputs.map(|(signal, _)| {
        let found = clipping(&finite(record, &signal));
        (signal, found)
    });
    clipped.filter(|(_, found)| found.share > found.most).map(|(signal, found)| (signal, 100.0 * found.share)).collect()
}

/// What is wrong with the outputs as they were logged, one caution a channel: of the record in which it is worst.
pub(super) fn output_cautions(records: &[FlightRecord], preparation: &Preparation) -> Vec<RecordCaution> {
    let mut cautions = Vec::new();
    for (signal, _) in preparation.channels().filter(|(signal, _)| signal.role == ChannelSide::Output) {
        let of_records: Vec<(&FlightRecord, Vec<f64>)> =
            records.iter().map(|record| (record, finite(record, &signal))).collect();
        let clipped = of_records.iter().map(|(record, samples)| (record, clipping(samples)));
        let clipped = clipped.filter(|(_, clipping)| clipping.share > clipping.most);
        let count = clipped.clone().count();
        if let Some((record, clipping)) = clipped.max_by(|a, b| a.1.share.total_cmp(&b.1.share)) {
            let (record, percent) = (record.name.clone(), 100.0 * clipping.share);
            cautions.push(RecordCaution::AtLimit { record, signal: signal.clone(), percent, records: count });
        }
        let all: Vec<f64> = of_records.into_iter().flat_map(|(_, samples)| samples).collect();
        if let Some(steps) = coarseness(&all).filter(|steps| *steps > COARSE) {
            cautions.push(RecordCaution::Coarse { signal, steps });
        }
    }
    cautions
}
