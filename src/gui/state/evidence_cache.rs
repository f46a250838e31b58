//! Evidence for every schedule form, cached between frames.

use std::sync::Arc;

use gdcm_method::schedule::form_comparison::FormComparison;
use gdcm_method::schedule::lead_degree_comparison::LeadDegreeFit;
use gdcm_model::dataset::ConditionId;
use gdcm_study::Analysis;

/// Evidence for every schedule form, kept until the analysis changes.
#[derive(Debug, Default)]
pub struct CachedEvidence {
    /// Analysis to which the evidence belongs.
    pub analysis: Option<Arc<Analysis>>,
    /// Scheduled conditions, and how well each schedule form fits over them; `None` if the
    /// comparison failed.
    pub found: Option<(Vec<ConditionId>, FormComparison)>,
    /// Fits of the scheduled leads, one for each polynomial degree.
    pub leads: Vec<LeadDegreeFit>,
}
