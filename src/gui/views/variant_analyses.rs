//! Analyses of the variants (named decision sets): jobs and results. `compare` lists the variants,
//! `variant_effects` their effects.

use gdcm_study::Analysis;
use gdcm_study::decisions::study::Variant;
use gdcm_study::jobs::analysis_jobs::VariantJob;

use crate::gui::state::window_state::State;

/// Returns the jobs that analyse the variants.
pub fn variant_jobs(state: &State) -> Vec<VariantJob> {
    let mut jobs = Vec::new();
    for variant in &state.study.variants {
        jobs.extend(variant_job(state, &variant.name));
    }
    jobs
}

fn variant_job(state: &State, name: &str) -> Option<VariantJob> {
    let study = state.study.of_variant(name)?;
    Some(VariantJob { study })
}

/// Returns a variant's analysis, if available.
pub fn variant_analysis<'a>(state: &'a State, variant: &Variant) -> Option<&'a Analysis> {
    let job = variant_job(state, &variant.name)?;
    for (known, analysis) in &state.results.variants {
        if *known == job {
            return Some(analysis.as_ref());
        }
    }
    None
}

/// Returns the overlaid variant and its analysis, if available.
pub fn overlaid_analysis(state: &State) -> Option<(&str, &Analysis)> {
    let name = state.display.judging.overlaid.as_deref()?;
    let variant = state.study.variant(name)?;
    Some((&variant.name, variant_analysis(state, variant)?))
}

/// Returns the job that analyses the overlaid variant; `None` without one.
pub fn overlay_job(state: &State) -> Option<VariantJob> {
    variant_job(state, state.display.judging.overlaid.as_deref()?)
}
