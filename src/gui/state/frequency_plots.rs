//! State that the frequency plots keep between frames.
//!
//! A view ([`BodeView`]) has a plot's axis ranges, and the transforms between values and screen
//! positions. A response's *shape* is its magnitude and continuous phase, which take most of the
//! time to compute and are therefore cached.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::error::ErrorCache;
use gdcm_plot::figure::responses::{AirspeedCache, ResponseCache};
use gdcm_study::stages::condition_curves::ConditionCurves;

use super::across_display::{AcrossDisplay, AcrossFit};
use crate::gui::plot::overview_scene::OverviewView;
use crate::gui::plot::{BodeCurve, BodeView};

/// Views and cached curves of the frequency plots.
#[derive(Debug, Default)]
pub struct FrequencyPlots {
    /// View of the Bode plot.
    pub bode: BodeView,
    /// View of the error plot (the models' magnitude ratios and phase differences).
    pub error: BodeView,
    /// Models and conditions that the engineer has chosen for the plots across conditions.
    pub across_display: AcrossDisplay,
    /// View of the plot across conditions.
    pub across: BodeView,
    /// View of the plot that shows the schedule's error across conditions.
    pub across_error: BodeView,
    /// Content to which the axes in both plots across conditions were last fitted.
    pub across_fitted: Option<AcrossFit>,
    /// Response shapes across conditions.
    pub across_shapes: AirspeedCache,
    pub overview: OverviewView,
    /// Response shapes in the displayed condition.
    pub shapes: BTreeMap<Pair, ResponseCache>,
    /// Curves last drawn in the Bode plot.
    pub drawn: Vec<BodeCurve>,
    /// The models' error curves in the displayed condition.
    pub errors: ErrorCache,
    /// Curves last drawn in the error plot.
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

    /// Requests that all axes, also zoomed ones, be fitted to their curves in the next frame; the
    /// overview's axes are not affected.
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
