//! State that the frequency plots keep between frames.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::error::ErrorCache;
use gdcm_plot::figure::responses::{AirspeedCache, ResponseCache};
use gdcm_study::stages::condition_curves::ConditionCurves;

use super::across_display::{AcrossDisplay, AcrossFit};
use crate::gui::plot::overview_scene::OverviewView;
use crate::gui::plot::{BodeCurve, BodeView};

/// Axis ranges, transforms and cached curves for the frequency plots.
#[derive(Debug, Default)]
pub struct FrequencyPlots {
    /// Axis ranges and transforms in the Bode plot.
    pub bode: BodeView,
    /// Axis ranges and transforms in the error plot (the models' ratios and phase differences).
    pub error: BodeView,
    /// Models and conditions in the plots across conditions.
    pub across_display: AcrossDisplay,
    /// Axis ranges and transforms in the plot across conditions.
    pub across: BodeView,
    /// Axis ranges and transforms in the plot that shows the schedule's error.
    pub across_error: BodeView,
    /// Content to which the axes in both plots across conditions were last fitted.
    pub across_fitted: Option<AcrossFit>,
    /// Response shapes across conditions, cached between frames.
    pub across_shapes: AirspeedCache,
    pub overview: OverviewView,
    /// Response shapes, cached between frames.
    pub shapes: BTreeMap<Pair, ResponseCache>,
    /// Curves shown by the Bode plot.
    pub drawn: Vec<BodeCurve>,
    /// The models' error curves, cached between frames.
    pub errors: ErrorCache,
    /// Curves shown by the error plot.
    pub drawn_errors: Vec<BodeCurve>,
}

impl FrequencyPlots {
    /// Drops response shapes that do not belong to these curves, and with them other conditions'
    /// curves that they keep in memory.
    pub fn keep_shapes_of(&mut self, curves: Option<&Arc<ConditionCurves>>) {
        match curves {
            Some(curves) => self.shapes.retain(|_, cache| cache.is_from(curves)),
            None => self.shapes.clear(),
        }
    }

    /// Requests that all axes, except those in the overview, be fitted to their curves in the next
    /// frame.
    pub fn fit(&mut self) {
        self.bode.request_fit();
        self.error.request_fit();
        self.across.request_fit();
        self.across_error.request_fit();
    }

    /// Requests that the value axes in the Bode and error plots be fitted to the curves in the next
    /// frame, except axes that have been zoomed.
    pub fn refit(&mut self) {
        self.bode.request_refit();
        self.error.request_refit();
    }
}
