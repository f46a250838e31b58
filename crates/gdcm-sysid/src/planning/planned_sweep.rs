//! A frequency sweep to be flown, and its spectrum.
//!
//! ```text
//! u(t) = A sin theta(t),   d theta/dt = omega_1 + K(t) (omega_2 - omega_1),   0 <= t < T
//! K(t) = C2 (e^(C1 t/T) - 1),   C1 = 4,   C2 = 1/(e^C1 - 1) = 0.0187
//!
//! A amplitude, theta phase, T length, omega_1 and omega_2 ends of the band;  K rises from 0 to 1
//!
//! |U(omega)|^2 ~ pi A^2 / (2 C1 (omega - omega_1 + C2 (omega_2 - omega_1)))
//! ```
//!
//! `U` is scaled as in [`Spectrum`](crate::spectra::spectrum::Spectrum). The power at a line does
//! not depend on the length `T`; the line count in a band is proportional to it.
//!
//! M. B. Tischler and R. K. Remple, "Aircraft and Rotorcraft System Identification", 2nd edition,
//! AIAA, 2012, chapter 5: the exponential sweep, which lasts longest at low frequencies. Its power
//! follows by the method of stationary phase.

use std::f64::consts::PI;

use nalgebra::DMatrix;

use gdcm_model::simulation::Segment;

/// `C1`.
const GROWTH: f64 = 4.0;
/// Number of samples in half a period at the highest frequency.
const SAMPLES: f64 = 12.0;

/// A frequency sweep of an input, flown `repeats` times. The other inputs do not move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedSweep {
    /// Input index, from 0.
    pub input: usize,
    /// `A`, in the input's unit.
    pub amplitude: f64,
    /// `T` \[s\].
    pub length_s: f64,
    /// `omega_1` and `omega_2` \[rad/s\].
    pub band: [f64; 2],
    pub repeats: usize,
}

impl PlannedSweep {
    /// Returns the power `|U|^2` expected at `omega` \[rad/s\], 0 outside the band.
    #[must_use]
    pub fn power(&self, omega: f64) -> f64 {
        let [first, last] = self.band;
        if omega < first || omega > last {
            return 0.0;
        }
        let rate = omega - first + final_share() * (last - first);
        PI * self.amplitude.powi(2) / (2.0 * GROWTH * rate)
    }

    /// Returns the input at time `t` \[s\].
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        self.amplitude * self.angle(t).sin()
    }

    /// Returns `theta(t)` \[rad\].
    fn angle(&self, t: f64) -> f64 {
        let [first, last] = self.band;
        let grown = self.length_s / GROWTH * ((GROWTH * t / self.length_s).exp() - 1.0);
        first * t + (last - first) * final_share() * (grown - t)
    }

    /// Returns a single sweep's samples; the input is divided by `scale`; the other inputs and the
    /// outputs are zero.
    pub(super) fn segment(&self, inputs: usize, outputs: usize, scale: f64) -> Segment {
        let samples = (self.length_s * self.band[1] * SAMPLES / PI)
            .ceil()
            .max(2.0) as usize;
        let sample_time_s = self.length_s / samples as f64;
        let mut segment = Segment {
            record: 0,
            start_s: 0.0,
            sample_time_s,
            inputs: DMatrix::zeros(samples, inputs),
            outputs: DMatrix::zeros(samples, outputs),
        };
        let mut swept = segment.inputs.column_mut(self.input);
        for (k, value) in swept.iter_mut().enumerate() {
            *value = self.at(k as f64 * sample_time_s) / scale;
        }
        segment
    }
}

/// Returns `C2`.
fn final_share() -> f64 {
    1.0 / (GROWTH.exp() - 1.0)
}

#[cfg(test)]
mod tests {
    use gdcm_model::executor::Sequential;

    use super::*;
    use crate::spectra::spectrum::spectra;

    const SWEEP: PlannedSweep = PlannedSweep {
        input: 0,
        amplitude: 3.0,
        length_s: 60.0,
        band: [0.5, 16.0],
        repeats: 1,
    };

    #[test]
    fn the_frequency_rises_exponentially_between_the_ends_of_the_band() {
        // K = (e^2 - 1) / (e^4 - 1) = 0.1192 in the middle of the sweep.
        for (t, expected) in [(0.0, 0.5), (30.0, 0.5 + 0.1192 * 15.5), (60.0, 16.0)] {
            let step = 1e-4;
            let omega = (SWEEP.angle(t + step) - SWEEP.angle(t - step)) / (2.0 * step);
            assert!((omega / expected - 1.0).abs() < 1e-3, "{t} s: {omega}");
        }
    }

    #[test]
    fn the_power_of_its_lines_is_as_stated_on_average() {
        let spectrum = &spectra(&[SWEEP.segment(1, 1, 1.0)], 20.0, &Sequential)[0];
        // The lines of an interval scatter around the stated power.
        for [low, high] in [[0.8, 1.6], [1.6, 3.2], [3.2, 6.4], [6.4, 12.8]] {
            let lines = spectrum.between(low, high);
            let found = lines.inputs.norm_squared();
            let expected: f64 = lines.omega.iter().map(|omega| SWEEP.power(*omega)).sum();
            assert!(
                (found / expected - 1.0).abs() < 0.1,
                "{low} to {high} rad/s: {found} {expected}"
            );
        }
        assert_eq!(SWEEP.power(0.4), 0.0);
    }

    #[test]
    fn a_longer_sweep_has_more_lines_of_the_same_power() {
        let longer = PlannedSweep {
            length_s: 120.0,
            ..SWEEP
        };
        let [once, twice] = [SWEEP, longer].map(|sweep| {
            let spectrum = spectra(&[sweep.segment(1, 1, 1.0)], 20.0, &Sequential).remove(0);
            spectrum.between(1.0, 12.0)
        });
        assert!((twice.omega.len() as f64 / once.omega.len() as f64 - 2.0).abs() < 0.05);
        let mean_power = |lines: &crate::spectra::spectrum::Spectrum| {
            lines.inputs.norm_squared() / lines.omega.len() as f64
        };
        assert!((mean_power(&twice) / mean_power(&once) - 1.0).abs() < 0.05);
    }
}
