//! Display options for the views that assess the correction: assessment, requirements, variants,
//! costs.

use super::assessment_display::AssessmentDisplay;
use super::mapped_cost::MappedCost;
use super::requirements_display::RequirementsDisplay;
use crate::gui::plot::figure_view::FigureView;
use crate::gui::widgets::tables::Sorting;

/// Options for displaying the assessment, the requirements, the variants and the cost map.
#[derive(Debug, Default)]
pub struct JudgingDisplay {
    pub mapped_cost: MappedCost,
    pub assessed: AssessmentDisplay,
    pub assessment_sorting: Sorting,
    /// Whether responses to a test input are shown even if flight records are available.
    pub shows_test: bool,
    pub requirements: RequirementsDisplay,
    /// Plots over time, from the record or the test input, among a requirement's details.
    pub history_figure: FigureView,
    /// Typed name under which the current decisions are stored as a variant.
    pub variant_name: String,
    /// Variant whose corrected model and net gains are overlaid.
    pub overlaid: Option<String>,
    /// Sort order for the comparison tables: differences, and their effects.
    pub compare_sorting: [Sorting; 2],
}
