//! Settings for validation in the time domain, and the windows into which they divide a segment.

use super::flight_record::Segment;
use crate::dataset::StateSpace;
use crate::response::mode::poles;

/// Default maximum window length \[s\].
const LONGEST_WINDOW_S: f64 = 10.0;
/// Maximum window length for an unstable model, in time constants of its fastest diverging mode
/// (M14.6).
pub(super) const TIME_CONSTANTS: f64 = 3.0;
/// Minimum ratio of output samples to unknowns (initial state and offsets) in a window.
const SAMPLES_PER_UNKNOWN: usize = 3;
/// A segment's excess over a whole number of windows that is attributed to rounding, in windows.
const WINDOW_SLACK: f64 = 1e-6;

/// Settings for validation in the time domain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValidationSettings {
    /// Maximum window length \[s\].
    pub longest_window_s: f64,
    /// Cut-off frequency for low-pass filtering inputs and outputs \[rad/s\]; `None` compares
    /// unfiltered signals.
    pub low_pass: Option<f64>,
}

impl ValidationSettings {
    /// Returns settings with 10 s windows and with signals low-pass filtered at twice `highest`
    /// \[rad/s\], the highest spectral line in use (M14.6).
    #[must_use]
    pub fn filtered(highest: f64) -> Self {
        Self {
            longest_window_s: LONGEST_WINDOW_S,
            low_pass: Some(2.0 * highest),
        }
    }

    /// Returns settings with 10 s windows and unfiltered signals, for plots.
    #[must_use]
    pub fn unfiltered() -> Self {
        Self {
            longest_window_s: LONGEST_WINDOW_S,
            low_pass: None,
        }
    }

    /// Returns the settings with a maximum window length that suits all models: the shortest of
    /// their window lengths. A model with too few samples in its own windows cannot be compared,
    /// and does not shorten the other models' windows.
    #[must_use]
    pub fn common_to<'m>(
        self,
        models: impl IntoIterator<Item = &'m StateSpace>,
        segments: &[Segment],
    ) -> Self {
        let mut shortest_s = self.longest_window_s;
        for model in models {
            let Some(own_s) = window_length_s(model, self.longest_window_s) else {
                continue;
            };
            let is_compared = segments
                .iter()
                .any(|segment| window_count(model, segment, own_s).is_some());
            if is_compared {
                shortest_s = shortest_s.min(own_s);
            }
        }
        Self {
            longest_window_s: shortest_s,
            ..self
        }
    }
}

/// Returns the window length \[s\]: `longest_s`, or less for an unstable model. `None` if the poles
/// cannot be computed.
pub(super) fn window_length_s(model: &StateSpace, longest_s: f64) -> Option<f64> {
    let fastest = poles(model)?.iter().map(|pole| pole.re).fold(0.0, f64::max);
    Some(if fastest > 0.0 {
        longest_s.min(TIME_CONSTANTS / fastest)
    } else {
        longest_s
    })
}

/// Returns the number of equal windows in a segment; `None` if they have too few samples to
/// estimate an initial state.
pub(super) fn window_count(model: &StateSpace, segment: &Segment, window_s: f64) -> Option<usize> {
    let (samples, outputs) = segment.outputs.shape();
    let count = (samples as f64 * segment.sample_time_s / window_s - WINDOW_SLACK)
        .ceil()
        .clamp(1.0, samples.max(1) as f64) as usize;
    if (samples / count) * outputs >= SAMPLES_PER_UNKNOWN * (model.order() + outputs) {
        Some(count)
    } else {
        None
    }
}

/// Returns the first sample's index in window `k`; uses 128 bits because the product may overflow
/// 64 bits.
pub(super) fn window_start(k: usize, count: usize, samples: usize) -> usize {
    (samples as u128 * k as u128 / count as u128) as usize
}
