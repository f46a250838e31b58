//! State of the frequency plots, kept between frames.

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::error::ErrorCache;
use gdcm_plot::figure::responses::{AirspeedCache, ResponseCache};
use gdcm_study::AcrossRole;
use gdcm_study::stages::condition_curves::ConditionCurves;

use crate::gui::plot::overview_scene::OverviewView;
use crate::gui::plot::{BodeCurve, BodeView};

/// Axis ranges, transforms and cached curves of the frequency plots.
#[derive(Debug, Default)]
pub struct FrequencyPlots {
    /// Axis ranges and transforms of the Bode plot.
    pub bode: BodeView,
    /// Axis ranges and transforms of the error plot (ratio and phase difference of the models).
    pub error: BodeView,
    /// Model role displayed by the plot across conditions.
    pub across_role: AcrossRole,
    /// Axis ranges and transforms of the plot across conditions.
    pub across: BodeView,
    /// Response and role for which the axes of the plot across conditions were last fitted.
    pub across_fitted: Option<(Pair, AcrossRole)>,
    /// Response shapes across conditions, cached between frames.
    pub across_shapes: AirspeedCache,
    pub overview: OverviewView,
    /// Response shapes, cached between frames.
    pub shapes: BTreeMap<Pair, ResponseCache>,
    /// Curves shown by the Bode plot.
    pub drawn: Vec<BodeCurve>,
    /// Curves of the model errors, cached between frames.
    pub errors: ErrorCache,
    /// Curves shown by the error plot.
    pub drawn_errors: Vec<BodeCurve>,
}

impl FrequencyPlots {
    /// Drops the shapes of responses that do not belong to these curves, with the curves of other
    /// conditions that they keep in memory.
    pub fn keep_shapes_of(&mut self, curves: Option<&Arc<ConditionCurves>>) {
        match curves {
            Some(curves) => self.shapes.retain(|_, cache| cache.is_from(curves)),
            None => self.shapes.clear(),
        }
    }

    /// Requests that all axes be fitted to their curves in the next frame.
    pub fn fit(&mut self) {
        self.bode.request_fit();
        self.error.request_fit();
        self.across.request_fit();
    }

    /// Requests that the value axes be fitted to other curves, except axes that have been zoomed.
    pub fn refit(&mut self) {
        self.bode.request_refit();
        self.error.request_refit();
    }
}
