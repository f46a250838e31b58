//! Autospectra of a record's inputs.

use std::sync::Arc;

use gdcm_model::executor::Sequential;
use gdcm_model::simulation::{FlightRecord, Segment};
use gdcm_sysid::spectra::spectrum::spectra;

/// Number of adjacent spectral lines averaged into one point.
const SMOOTHED: usize = 5;

/// Autospectrum for each input: frequency \[rad/s\] and level \[dB, relative to the squared unit
/// per Hz\].
pub(super) type Autospectra = Vec<Arc<[[f64; 2]]>>;

/// Computes each input's one-sided power spectral density `G` about its mean, up to twice the upper
/// band edge `highest` \[rad/s\].
///
/// With the input u at the times t, the sample time dt and the record length T \[s\]:
///
/// ```text
/// U(ω) = dt / sqrt(T) Σ u exp(-j ω t)    computed by `spectra`
/// G(ω) = 2 |U(ω)|²                       averaged over SMOOTHED adjacent lines
/// ```
///
/// The integral of `G` over frequency \[Hz\] is the variance (Bendat and Piersol, Random Data,
/// 5.2.2).
///
/// The chart only has to show which frequencies an input excites, so the computation is simplified:
/// the record is treated as uniformly sampled, and a missing sample counts as zero even before the
/// mean is removed, so that a gap becomes a step to minus the mean.
pub(super) fn autospectra(flight: &FlightRecord, highest: f64) -> Autospectra {
    let Some(sample_time_s) = middle_step(&flight.time_s) else {
        return Vec::new();
    };
    let mut inputs = flight.inputs.map(zero_if_missing);
    for mut column in inputs.column_iter_mut() {
        let mean = column.mean();
        column.add_scalar_mut(-mean);
    }
    // `spectra` also transforms the outputs, which are not used here.
    let whole_record = Segment {
        record: 0,
        start_s: 0.0,
        sample_time_s,
        inputs,
        outputs: flight.outputs.map(zero_if_missing),
    };
    let found = spectra(&[whole_record], 2.0 * highest, &Sequential);
    let Some(spectrum) = found.first() else {
        return Vec::new();
    };
    let mut autospectra = Vec::new();
    for input in 0..flight.inputs.ncols() {
        let mut densities = Vec::new();
        for (line, omega) in spectrum.omega.iter().enumerate() {
            densities.push([*omega, 2.0 * spectrum.inputs[(input, line)].norm_sqr()]);
        }
        autospectra.push(densities.chunks(SMOOTHED).map(smoothed_level).collect());
    }
    autospectra
}

/// Returns the time step in the middle of the record \[s\], which is the sample time if sampling is
/// uniform; skips steps that are not positive. `None` without positive steps.
fn middle_step(time_s: &[f64]) -> Option<f64> {
    let steps: Vec<f64> = time_s
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step| *step > 0.0)
        .collect();
    steps.get(steps.len() / 2).copied()
}

fn zero_if_missing(value: f64) -> f64 {
    if value.is_finite() { value } else { 0.0 }
}

/// Averages spectral lines `[frequency, density]`: geometric mean of the frequencies \[rad/s\], and
/// mean density as a level \[dB\].
fn smoothed_level(lines: &[[f64; 2]]) -> [f64; 2] {
    let count = lines.len() as f64;
    let mut log_omega = 0.0;
    let mut density = 0.0;
    for line in lines {
        log_omega += line[0].ln();
        density += line[1];
    }
    [
        (log_omega / count).exp(),
        10.0 * (density / count).max(f64::MIN_POSITIVE).log10(),
    ]
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    #[test]
    fn the_integral_of_an_autospectrum_is_the_variance() {
        // 500 lines below half the sampling frequency: 100 complete groups.
        let samples = 1001;
        let input: Vec<f64> = (0..samples)
            .map(|n| (0.7 * (n * n) as f64).sin() + 3.0)
            .collect();
        let flight = FlightRecord {
            name: "record".to_owned(),
            time_s: (0..samples).map(|n| 0.02 * n as f64).collect(),
            inputs: DMatrix::from_column_slice(samples, 1, &input),
            outputs: DMatrix::from_column_slice(samples, 1, &input),
        };
        let autospectrum = autospectra(&flight, 1e6)[0].clone();
        let step_hz = SMOOTHED as f64 / (0.02 * samples as f64);
        let mean = input.iter().sum::<f64>() / samples as f64;
        let integral: f64 = autospectrum
            .iter()
            .map(|[_, db]| 10f64.powf(0.1 * db) * step_hz)
            .sum();
        let variance = input.iter().map(|u| (u - mean).powi(2)).sum::<f64>() / samples as f64;
        // Parseval's theorem, up to rounding in a thousand terms.
        assert!(
            (integral / variance - 1.0).abs() < 1e-9,
            "{integral} {variance}"
        );
    }
}
