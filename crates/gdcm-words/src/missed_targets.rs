//! Sentences about constrained responses that miss their targets.

use gdcm_method::correction::Solution;
use gdcm_study::Study;

/// Returns a text on all constrained responses that miss their targets, then a text on each
/// conflict among the constraints that causes this.
pub fn missed_target_texts(study: &Study, solution: &Solution) -> Vec<String> {
    let (inputs, outputs) = study.dataset.names_of_channels();
    let band_top = study.settings.band.max();
    let misses: Vec<String> = solution
        .unmatched
        .iter()
        .map(|miss| miss.words(band_top, &inputs, &outputs))
        .collect();
    let mut texts = vec![misses.join(" ")];
    for conflict in &solution.conflicts {
        texts.push(conflict.words(&inputs, &outputs));
    }
    texts
}
