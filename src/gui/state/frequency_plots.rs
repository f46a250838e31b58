//! Plots over frequency, kept between frames.

use std::collections::BTreeMap;

use gdcm_model::dataset::Pair;
use gdcm_plot::figure::error::ErrorCache;
use gdcm_plot::figure::responses::{AirspeedCache, ResponseCache};
use gdcm_study::AcrossRole;

use crate::gui::plot::overview::OverviewView;
use crate::gui::plot::{BodeCurve, BodeView};

/// Ranges, transforms and cached curves of the plots over frequency.
#[derive(Debug, Default)]
pub struct FrequencyPlots {
    /// Ranges and transforms of the Bode plot.
    pub bode: BodeView,
    /// Ranges and transforms of the error plot.
    pub error: BodeView,
    /// Role displayed by the plot across conditions.
    pub across_role: AcrossRole,
    /// Ranges and transforms of the plot across conditions.
    pub across: BodeView,
    /// Response and role to which the plot across conditions was last fitted.
    pub across_fitted: Option<(Pair, AcrossRole)>,
    /// Response shapes across conditions, cached between frames.
    pub across_shapes: AirspeedCache,
    pub overview: OverviewView,
    /// Response shapes, cached between frames.
    pub shapes: BTreeMap<Pair, ResponseCache>,
    /// Curves shown by the Bode plot.
    pub drawn: Vec<BodeCurve>,
    /// Drawn errors, cached between frames.
    pub errors: ErrorCache,
    /// Curves shown by the error plot.
    pub drawn_errors: Vec<BodeCurve>,
}

impl FrequencyPlots {
    /// Fits the plots to all their curves.
    pub fn fit(&mut self) {
        self.bode.request_fit();
        self.error.request_fit();
        self.across.request_fit();
    }

    /// Fits the plots to other curves, except axes that have been zoomed.
    pub fn refit(&mut self) {
        self.bode.request_refit();
        self.error.request_refit();
    }
}
