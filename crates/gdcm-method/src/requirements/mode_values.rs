//! A mode's period, time to half amplitude and damping ratio, with standard deviations (M17.3).
//!
//! ```text
//! lambda: the mode's pole, Re and Im its parts; sd_Re, sd_Im: their standard deviations
//! period 2 pi / |Im|, time to half amplitude ln 2 / -Re (negative: to double), damping ratio -Re / |lambda|
//! sd of period T: T sd_Im / |Im|;   sd of time to half t: t sd_Re / |Re|;
//! sd of damping ratio: sqrt((Im^2 sd_Re)^2 + (Re Im sd_Im)^2) / |lambda|^3
//! ```

use std::f64::consts::{LN_2, TAU};

use serde::Serialize;

use gdcm_model::response::Mode;
use gdcm_model::response::pole_estimate::PoleEstimate;

/// A mode's compared values, or their standard deviations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModeValues {
    /// Period \[s\]; `None` for a mode that does not oscillate.
    pub period_s: Option<f64>,
    /// Time to half amplitude \[s\], negative for a growing mode: time to double. `None` for a
    /// constant amplitude.
    pub time_to_half_s: Option<f64>,
    /// Damping ratio; `None` for a pole at zero.
    pub damping_ratio: Option<f64>,
}

impl ModeValues {
    /// Computes the values from the mode's pole.
    pub fn new(mode: &Mode) -> Self {
        let period_s = if mode.oscillates() {
            Some(TAU / mode.pole.im.abs())
        } else {
            None
        };
        Self {
            period_s,
            time_to_half_s: mode.time_constant_s.map(|time_s| LN_2 * time_s),
            damping_ratio: mode.damping_ratio,
        }
    }

    /// Computes the standard deviations from those of the pole, to first order (M14.5).
    pub fn deviation(mode: &Mode, pole: &PoleEstimate) -> Self {
        let values = Self::new(mode);
        let re = mode.pole.re.abs();
        let im = mode.pole.im.abs();
        let size = mode.pole.norm();
        let damping = (im * im * pole.sd_re).hypot(re * im * pole.sd_im) / size.powi(3);
        Self {
            period_s: values.period_s.map(|period_s| period_s * pole.sd_im / im),
            time_to_half_s: values
                .time_to_half_s
                .map(|time_s| time_s.abs() * pole.sd_re / re),
            damping_ratio: values.damping_ratio.map(|_| damping),
        }
    }
}
