//! Divides prepared segments into those to fit and those held out, and takes the references out of
//! their inputs.
//!
//! A *segment* is a stretch of a record on a uniform grid; in a *filled* segment, missing samples
//! are unknowns (`filled_segment`). A *reference* is a recorded signal that drove the loop from
//! outside (M14.15). In scaled units each channel is divided by its rms (`scales`).

use nalgebra::DMatrix;

use gdcm_model::simulation::Segment;

use crate::options::Options;
use crate::spectra::filled_segment::FilledSegment;
use crate::spectra::scales::Scales;

/// Segments to fit and held-out segments, without the references among their inputs.
pub(super) struct SplitSegments {
    pub(super) to_fit: Vec<Segment>,
    /// References for each fitted segment, samples x references.
    pub(super) references: Vec<DMatrix<f64>>,
    pub(super) held_out: Vec<Segment>,
}

impl SplitSegments {
    pub(super) fn new(segments: Vec<Segment>, options: &Options) -> Self {
        let mut split = Self {
            to_fit: Vec::new(),
            references: Vec::new(),
            held_out: Vec::new(),
        };
        for mut segment in segments {
            let references = take_references(&mut segment, options.references);
            if options.held_out.contains(&segment.record) {
                split.held_out.push(segment);
            } else {
                split.references.push(references);
                split.to_fit.push(segment);
            }
        }
        split
    }
}

/// Filled segments, to fit or held out, without the references among their inputs.
pub(super) struct SplitFilled {
    pub(super) to_fit: Vec<FilledSegment>,
    pub(super) held_out: Vec<FilledSegment>,
}

impl SplitFilled {
    pub(super) fn new(filled: Vec<FilledSegment>, options: &Options) -> Self {
        let mut split = Self {
            to_fit: Vec::new(),
            held_out: Vec::new(),
        };
        for mut part in filled {
            // With references, segments have no gaps, so that no gap lies in a removed reference.
            take_references(&mut part.segment, options.references);
            if options.held_out.contains(&part.segment.record) {
                split.held_out.push(part);
            } else {
                split.to_fit.push(part);
            }
        }
        split
    }
}

/// Removes the last `references` inputs from a segment and returns them.
fn take_references(segment: &mut Segment, references: usize) -> DMatrix<f64> {
    let inputs = segment.inputs.ncols().saturating_sub(references);
    let taken = segment
        .inputs
        .columns(inputs, segment.inputs.ncols() - inputs)
        .into_owned();
    segment.inputs = segment.inputs.columns(0, inputs).into_owned();
    taken
}

/// Scales segments.
pub(super) fn scale_all(scales: &Scales, segments: &[Segment]) -> Vec<Segment> {
    segments
        .iter()
        .map(|segment| scales.scaled(segment))
        .collect()
}

/// Scales filled segments.
pub(super) fn scale_filled(scales: &Scales, filled: &[FilledSegment]) -> Vec<FilledSegment> {
    let mut scaled = Vec::with_capacity(filled.len());
    for part in filled {
        scaled.push(FilledSegment {
            segment: scales.scaled(&part.segment),
            gaps: part.gaps.clone(),
        });
    }
    scaled
}
