//! A segment whose longer gaps are filled by straight lines, but remain unknown (M14.21).
//!
//! Short gaps are bridged before (`valid_samples`), and the bridge counts as measured. Here a
//! straight line is only the beginning: *hats*, triangles in the gap (`gap_hat`), are added to it,
//! whose heights are estimated together with each model.

use nalgebra::DVectorViewMut;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::{Executor, each};
use gdcm_model::simulation::Segment;

use super::gap_hat::{ChannelGap, HatGrid};
use super::spectrum::{LineRange, Spectrum, spectra_of};

/// A segment with straight lines in its channels' gaps.
#[derive(Clone, Debug, PartialEq)]
pub struct FilledSegment {
    /// The samples; finite also in the gaps.
    pub segment: Segment,
    /// Missing samples in each channel.
    pub gaps: Vec<ChannelGap>,
}

impl FilledSegment {
    /// Fills a segment's gaps. A gap has a sample before it and after it.
    pub(crate) fn new(mut segment: Segment, gaps: Vec<ChannelGap>) -> Self {
        for gap in &gaps {
            let samples = match gap.side {
                ChannelSide::Input => &mut segment.inputs,
                ChannelSide::Output => &mut segment.outputs,
            };
            fill(samples.column_mut(gap.channel), gap);
        }
        Self { segment, gaps }
    }
}

/// Draws a straight line between the samples before and after a gap.
fn fill(mut samples: DVectorViewMut<'_, f64>, gap: &ChannelGap) {
    let before = samples[gap.samples.start - 1];
    let after = samples[gap.samples.end];
    let interval = (gap.samples.len() + 1) as f64;
    for sample in gap.samples.clone() {
        let share = (sample + 1 - gap.samples.start) as f64 / interval;
        samples[sample] = before + share * (after - before);
    }
}

impl LineRange {
    /// Transforms segments as [`LineRange::spectra`] does, with a hat for each unknown in their
    /// gaps.
    pub(crate) fn filled_spectra(
        self,
        filled: &[FilledSegment],
        executor: &dyn Executor,
    ) -> Vec<Spectrum> {
        let segments: Vec<&Segment> = filled.iter().map(|part| &part.segment).collect();
        let transformed = spectra_of(&segments, self.highest, executor);
        let with_hats = each(
            executor,
            filled.iter().zip(transformed),
            |(part, spectrum)| {
                let mut spectrum = self.used_lines(&spectrum);
                let grid = HatGrid {
                    sample_time_s: part.segment.sample_time_s,
                    duration_s: spectrum.duration_s,
                    highest: self.highest,
                };
                for gap in &part.gaps {
                    spectrum.hats.extend(gap.hats(grid, &spectrum.omega));
                }
                spectrum
            },
        );
        let mut used = Vec::with_capacity(with_hats.len());
        for spectrum in with_hats {
            if !spectrum.omega.is_empty() {
                used.push(spectrum);
            }
        }
        used
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use gdcm_model::executor::Sequential;
    use gdcm_model::simulation::FlightRecord;

    use super::*;
    use crate::spectra::gap::Treatment;
    use crate::spectra::preparation::{Prepared, prepare_filled};
    use crate::spectra::preparation_settings::Preparation;

    const LINES: LineRange = LineRange {
        lowest: 0.25,
        highest: 16.0,
    };

    /// Returns 66 s at 25 Hz: two inputs and two outputs without equal consecutive samples.
    fn record() -> FlightRecord {
        let wave = |n: usize, channel: usize| (0.11 * n as f64 + channel as f64).sin();
        FlightRecord {
            name: "sweep".to_owned(),
            time_s: (0..1650).map(|n| 0.04 * n as f64).collect(),
            inputs: DMatrix::from_fn(1650, 2, wave),
            outputs: DMatrix::from_fn(1650, 2, |n, o| wave(n, 2 + o)),
        }
    }

    fn prepared(record: FlightRecord) -> Prepared {
        let preparation = Preparation::new(&["LAT", "PED"], &["P", "R"]);
        prepare_filled(&[record], &preparation, LINES, &Sequential).unwrap()
    }

    #[test]
    fn a_gap_is_filled_in_the_channels_that_miss_samples_and_in_those_alone() {
        let logged = record();
        let mut record = logged.clone();
        record.outputs.rows_mut(750, 15).fill(f64::NAN);
        let prepared = prepared(record);
        assert_eq!(prepared.segments.len(), 2);
        assert_eq!(prepared.records[0].gaps[0].treatment, Treatment::Estimated);
        let [part] = prepared.filled.as_slice() else {
            panic!("{} parts", prepared.filled.len());
        };
        assert_eq!(part.segment.inputs.nrows(), 1650);
        assert!((&part.segment.inputs - &logged.inputs).amax() < 1e-9);
        for output in 0..2 {
            assert_eq!(part.gaps[output].side, ChannelSide::Output);
            assert_eq!(part.gaps[output].channel, output);
            assert_eq!(part.gaps[output].samples, 750..765);
            let [before, after] = [749, 765].map(|n| logged.outputs[(n, output)]);
            let expected = before + 5.0 / 16.0 * (after - before);
            assert!((part.segment.outputs[(754, output)] - expected).abs() < 1e-9);
        }
        // ceil(2 16 0.64 / pi) hats in each of two channels.
        let spectra = LINES.filled_spectra(&prepared.filled, &Sequential);
        assert_eq!(spectra[0].hats.len(), 14);
        assert_eq!(spectra[0].hats[0].lines.len(), spectra[0].omega.len());
    }

    #[test]
    fn a_jump_in_time_is_filled_in_all_channels() {
        let mut record = record();
        for time in &mut record.time_s[800..] {
            *time += 0.4;
        }
        let prepared = prepared(record);
        assert_eq!(prepared.records[0].gaps[0].treatment, Treatment::Estimated);
        assert_eq!(prepared.filled.len(), 1);
        assert_eq!(prepared.filled[0].segment.inputs.nrows(), 1660);
        let gaps = &prepared.filled[0].gaps;
        assert_eq!(gaps.len(), 4);
        assert!(gaps.iter().all(|gap| gap.samples == (800..810)));
    }

    #[test]
    fn a_record_is_cut_where_the_hats_are_a_tenth_of_the_values() {
        // 66 s have 2 2 166 = 664 real values up to 16 rad/s, 664 / 10 / 2 = 33 hats in each
        // output: gaps of up to 79 samples (ceil(2 16 0.04 80 / pi) = 33).
        for (samples, parts) in [(79, 1), (84, 2)] {
            let mut record = record();
            record.outputs.rows_mut(750, samples).fill(f64::NAN);
            assert_eq!(prepared(record).filled.len(), parts, "{samples} samples");
        }
        // Of two gaps only the long one is cut out.
        let mut record = record();
        record.outputs.rows_mut(300, 10).fill(f64::NAN);
        record.outputs.rows_mut(700, 400).fill(f64::NAN);
        let prepared = prepared(record);
        assert_eq!(prepared.filled.len(), 2);
        assert_eq!(prepared.filled[0].gaps.len(), 2);
        assert_eq!(prepared.filled[1].gaps, []);
        let treatments: Vec<Treatment> = prepared.records[0]
            .gaps
            .iter()
            .map(|gap| gap.treatment)
            .collect();
        assert_eq!(treatments, [Treatment::Estimated, Treatment::CutOut]);
    }

    #[test]
    fn a_short_run_beside_a_gap_is_used_in_the_whole_record() {
        let mut record = record();
        record.outputs.rows_mut(100, 10).fill(f64::NAN);
        let prepared = prepared(record);
        assert_eq!(prepared.segments.len(), 1);
        assert_eq!(prepared.cautions, []);
        assert_eq!(prepared.filled[0].segment.inputs.nrows(), 1650);
        assert!((prepared.records[0].used_s - 66.0).abs() < 1e-9);
    }
}
