//! Display options for views that judge the correction: assessment, requirements, variants, costs.

use super::assessed_figures::AssessedFigures;
use super::mapped_cost::MappedCost;
use super::requirements_page::RequirementsPage;
use crate::gui::widgets::tables::Sorting;

/// Content of assessment, requirements, variants and cost map.
#[derive(Debug, Default)]
pub struct JudgingDisplay {
    pub mapped_cost: MappedCost,
    pub assessed: AssessedFigures,
    pub assessment_sorting: Sorting,
    /// Whether responses to a test input are shown although there are records.
    pub shows_test: bool,
    pub requirements_page: RequirementsPage,
    pub requirements_sorting: [Sorting; 2],
    /// Name for the present decisions as a variant, as typed.
    pub variant_name: String,
    /// Variant whose corrected model and net gains are overlaid.
    pub overlaid: Option<String>,
    /// Sorting in the comparison tables: differences, and their effects.
    pub compare_sorting: [Sorting; 2],
}
