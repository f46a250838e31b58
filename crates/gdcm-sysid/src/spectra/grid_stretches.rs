//! Reads a record's samples on its uniform grid, and divides them into parts in which missing
//! samples can be estimated (M14.1, M14.21).
//!
//! ```text
//! stretch  grid points between two gaps in the stamps (`record_clock`)
//! row      all channels' values at a grid point
//! hole     consecutive rows in which a value is missing;   run: consecutive rows between holes
//! gap      a channel's missing samples;   hat: an unknown for them (`gap_hat`)
//! l outputs, n lines
//! 1  a part: from the first run to the last
//! 2  no hole in the part, or the hats of all its gaps < 1/10 of the 2 l n real values in its
//!    outputs' lines:   it stays whole
//!    otherwise it is cut at the hole with the most hats, and both parts are examined
//! ```

use std::f64::consts::TAU;
use std::ops::Range;

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;

use super::gap_hat::{ChannelGap, hat_count};
use super::record_clock::Clock;
use super::spectrum::{FIRST_LINE, LineRange};
use super::valid_samples::{ValidSamples, read_row};

/// Missing samples are estimated while a part's lines hold more than this many real values per hat.
const VALUES_A_HAT: usize = 10;

/// Indices of consecutive rows.
pub(crate) type RowRange = Range<usize>;

/// All channels' values at consecutive points on a record's grid.
pub(crate) struct GridRows {
    /// Index `k` at the first grid point, an integer value.
    pub(crate) first: f64,
    /// Number of input channels, which come first.
    inputs: usize,
    /// Number of channels.
    width: usize,
    /// Row after row: channel `c` in row `n` at `n width + c`; `None` where a sample is missing.
    values: Vec<Option<f64>>,
}

/// Reads a record on the grid `k dt`, relative to its first stamp. `inputs` channels come first.
///
/// New [`GridRows`] begin after a gap without stamps that is longer than all stretches with stamps
/// together, so that missing rows cannot fill the memory.
pub(crate) fn grid_rows(clock: &Clock, channels: &[ValidSamples], inputs: usize) -> Vec<GridRows> {
    let grid = clock.grid();
    let stamped_points: usize = grid.iter().map(|stretch| stretch.points).sum();
    let mut readers: Vec<_> = channels.iter().map(ValidSamples::reader).collect();
    let mut row = vec![None; channels.len()];
    let mut found: Vec<GridRows> = Vec::new();
    for stretch in grid {
        let missing_points = match found.last() {
            Some(rows) => stretch.first - rows.first - rows.count() as f64,
            None => f64::INFINITY,
        };
        if missing_points > stamped_points as f64 {
            found.push(GridRows {
                first: stretch.first,
                inputs,
                width: channels.len(),
                values: Vec::new(),
            });
        }
        let Some(rows) = found.last_mut() else {
            continue;
        };
        // Rows without samples up to the stretch.
        let values_before = (stretch.first - rows.first) as usize * channels.len();
        rows.values.resize(values_before, None);
        for k in (0..stretch.points).map(|point| stretch.first + point as f64) {
            read_row(&mut readers, k * clock.sample_time_s, &mut row);
            rows.values.extend_from_slice(&row);
        }
    }
    found
}

impl GridRows {
    /// Returns the row count.
    fn count(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    fn rows(&self, range: RowRange) -> &[Option<f64>] {
        &self.values[range.start * self.width..range.end * self.width]
    }

    /// Returns the inputs in a range, with 0 for missing samples.
    pub(crate) fn inputs(&self, range: RowRange) -> DMatrix<f64> {
        let rows = self.rows(range.clone());
        DMatrix::from_fn(range.len(), self.inputs, |n, i| {
            rows[n * self.width + i].unwrap_or(0.0)
        })
    }

    /// Returns the outputs in a range, with 0 for missing samples.
    pub(crate) fn outputs(&self, range: RowRange) -> DMatrix<f64> {
        let rows = self.rows(range.clone());
        DMatrix::from_fn(range.len(), self.width - self.inputs, |n, o| {
            rows[n * self.width + self.inputs + o].unwrap_or(0.0)
        })
    }

    /// Returns the runs of complete rows in a range: every channel has a value.
    pub(crate) fn runs(&self, range: RowRange) -> Vec<RowRange> {
        let mut runs = Vec::new();
        let mut start = None;
        for n in range.clone() {
            let is_complete = self.rows(n..n + 1).iter().all(Option::is_some);
            match start {
                None if is_complete => start = Some(n),
                Some(first) if !is_complete => {
                    runs.push(first..n);
                    start = None;
                }
                _ => {}
            }
        }
        if let Some(first) = start {
            runs.push(first..range.end);
        }
        runs
    }

    /// Returns every channel's missing samples in a range, counted from its first row.
    pub(crate) fn gaps(&self, range: RowRange) -> Vec<ChannelGap> {
        let mut gaps: Vec<ChannelGap> = Vec::new();
        let rows = self.rows(range.clone());
        for channel in 0..self.width {
            let mut from = 0;
            let values: Vec<bool> = rows
                .iter()
                .skip(channel)
                .step_by(self.width)
                .map(Option::is_some)
                .collect();
            for run in values.chunk_by(|a, b| a == b) {
                if !run[0] {
                    gaps.push(self.channel_gap(channel, from..from + run.len()));
                }
                from += run.len();
            }
        }
        gaps
    }

    fn channel_gap(&self, channel: usize, samples: RowRange) -> ChannelGap {
        if channel < self.inputs {
            ChannelGap {
                side: ChannelSide::Input,
                channel,
                samples,
            }
        } else {
            ChannelGap {
                side: ChannelSide::Output,
                channel: channel - self.inputs,
                samples,
            }
        }
    }

    /// Divides the rows into parts (steps 1 and 2); without `lines`, at every hole.
    pub(crate) fn parts(&self, lines: Option<LineRange>, sample_time_s: f64) -> Vec<RowRange> {
        // Step 1.
        let runs = self.runs(0..self.count());
        let Some(lines) = lines else {
            return runs;
        };
        // Number of hats that the hole after each run needs.
        let mut hats_after = Vec::with_capacity(runs.len());
        for pair in runs.windows(2) {
            let mut hats = 0;
            for gap in self.gaps(pair[0].end..pair[1].start) {
                hats += hat_count(gap.samples.len(), sample_time_s, lines.highest);
            }
            hats_after.push(hats);
        }
        let outputs = self.width - self.inputs;
        let mut parts = Vec::new();
        // Parts that are still to be examined, as ranges of runs, the earliest last.
        let mut to_examine = Vec::new();
        if !runs.is_empty() {
            to_examine.push(0..runs.len());
        }
        // Step 2.
        while let Some(range) = to_examine.pop() {
            let rows = runs[range.start].start..runs[range.end - 1].end;
            // A hole has the number of the run before it.
            let holes = range.start..range.end - 1;
            let hats: usize = hats_after[holes.clone()].iter().sum();
            let values = 2 * outputs * line_count(lines, sample_time_s * rows.len() as f64);
            let worst = holes.max_by_key(|&run| hats_after[run]);
            match worst {
                Some(worst) if VALUES_A_HAT * hats >= values => {
                    to_examine.push(worst + 1..range.end);
                    to_examine.push(range.start..worst + 1);
                }
                _ => parts.push(rows),
            }
        }
        parts
    }
}

/// Counts a segment's lines in a range.
fn line_count(lines: LineRange, duration_s: f64) -> usize {
    let lowest = (lines.lowest * duration_s / TAU).max(FIRST_LINE).ceil();
    let highest = (lines.highest * duration_s / TAU).floor();
    (highest - lowest + 1.0).max(0.0) as usize
}
