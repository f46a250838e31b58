//! The parts of a record that an identification uses, its gaps, and its inputs at their limit.

use gdcm_model::simulation::{FlightRecord, Signal};

use super::gap::{Gap, Treatment};

/// The parts used from a record, and its gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordUse {
    pub record: String,
    /// Median sample time \[s\], 0 for fewer than two stamps.
    pub sample_time_s: f64,
    /// Time between the first and the last stamp \[s\].
    pub logged_s: f64,
    /// Total length of the filled segments \[s\], estimated samples included.
    pub used_s: f64,
    /// Gaps, sorted by their start.
    pub gaps: Vec<Gap>,
    /// Inputs with an excessive share of samples at an end of their range, each with this share
    /// \[%\]. They need no caution: a saturated actuator position is a valid input.
    pub inputs_at_limit: Vec<(Signal, f64)>,
}

impl RecordUse {
    /// Returns the start and the end of each part between gaps that are cut out \[s\], on the clock
    /// of `record`, which must be this record.
    pub fn spans(&self, record: &FlightRecord) -> Vec<[f64; 2]> {
        let mut stamps = record
            .time_s
            .iter()
            .copied()
            .filter(|time| time.is_finite());
        let Some(first) = stamps.next() else {
            return Vec::new();
        };
        let last = stamps.next_back().unwrap_or(first);
        let mut spans = Vec::new();
        let mut start = first;
        for gap in &self.gaps {
            if gap.treatment == Treatment::CutOut {
                spans.push([start, gap.start_s]);
                start = gap.end_s;
            }
        }
        spans.push([start, last]);
        spans.retain(|[start, end]| start < end);
        spans
    }
}
