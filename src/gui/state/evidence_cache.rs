//! Evidence for every schedule form, cached between frames.

use std::sync::Arc;

use gdcm_method::schedule::form_comparison::FormComparison;
use gdcm_method::schedule::lead_degree_comparison::LeadDegreeFit;
use gdcm_model::dataset::ConditionId;
use gdcm_study::Analysis;

/// Evidence for every schedule form, kept until the analysis changes.
#[derive(Debug, Default)]
pub struct CachedEvidence {
    pub analysis: Option<Arc<Analysis>>,
    pub found: Option<(Vec<ConditionId>, FormComparison)>,
    pub leads: Vec<LeadDegreeFit>,
}
