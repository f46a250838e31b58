//! A channel's finite samples, which are searched for faults such as spikes and clipping.

use gdcm_model::simulation::{FlightRecord, Signal};

/// A channel's value with its stamp.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) time_s: f64,
    pub(crate) value: f64,
}

/// Returns a channel's samples that have a finite stamp and a finite value.
pub(crate) fn finite_samples(record: &FlightRecord, signal: &Signal) -> Vec<Sample> {
    let values = record.channel(signal);
    let mut samples = Vec::new();
    for (&time_s, &value) in record.time_s.iter().zip(values.iter()) {
        if time_s.is_finite() && value.is_finite() {
            samples.push(Sample { time_s, value });
        }
    }
    samples
}

/// Returns a channel's finite values.
pub(crate) fn finite_values(record: &FlightRecord, signal: &Signal) -> Vec<f64> {
    record
        .channel(signal)
        .iter()
        .copied()
        .filter(|x| x.is_finite())
        .collect()
}
