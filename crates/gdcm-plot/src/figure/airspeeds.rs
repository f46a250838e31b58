//! One response in every condition, coloured by airspeed, and the error that the schedule leaves.
//!
//! The *schedule* gives each channel's gain and delay as functions of the airspeed. A condition's
//! *optimum* is its own correction, to which the schedule is fitted. Errors are those of the
//! corrected physics model against the identified model: a curve for each condition under the
//! schedule, and for comparison the range that the conditions' own optima leave.

use std::sync::Arc;

use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::progress::Unobserved;
use gdcm_study::AcrossRole;
use gdcm_study::jobs::across_job::AcrossJob;
use gdcm_study::jobs::job::Job;
use gdcm_study::results::analysis::Analysis;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, display_band};

use super::airspeed_curves::{AirspeedCache, AirspeedCurves, AirspeedResponse};
use super::axis::{Axis, Range};
use super::bode::{ResponsePlot, band_strip};
use super::bode_curve::Pane;
use super::bode_options::BodeOptions;
use super::caption_words::settings_words;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::frequency_panels::{FrequencyPanels, side_by_side};
use super::marks::{Envelope, Rule};
use super::responses::fitted_values;
use super::uncertainty_band::BodeBand;

/// Shaded range between the smallest and the largest error at the conditions' own optima; green, as
/// the caption says.
const OPTIMA: Color = Color::new(Hue::Corrected).tint(22);
/// Line at zero error.
const NO_ERROR: Stroke = Stroke::dashed(Color::DIM, 0.6, Dash::Short);
/// Margin above and below the curves, relative to their height.
const MARGIN: f64 = 0.06;
/// Minimum range of the axis for magnitude errors \[dB\].
const LEAST_ERROR_DB: f64 = 1.0;
/// Minimum range of the axis for phase errors \[deg\].
const LEAST_ERROR_DEG: f64 = 5.0;
/// Ratio of frame height to width for two plots side by side.
const ASPECT: f64 = 1.2;

/// Plots the responses `pairs` for models in these roles in the `conditions`, magnitude above
/// phase.
///
/// 1. Compute each response's curves; only the frequency unit and the ranges in `options` apply.
///    Without a curve, return `None`.
/// 2. For a single response: show the schedule's error beside it, if any of the conditions has an
///    identified model and a scheduled physics model (whether or not `roles` contains them).
/// 3. Otherwise: show the responses side by side.
pub fn airspeeds_figure(
    analysis: &Analysis,
    pairs: &[Pair],
    roles: &[AcrossRole],
    conditions: &[ConditionId],
    options: &BodeOptions,
) -> Option<Figure> {
    let dataset = &analysis.study.dataset;
    let settings = &analysis.study.settings;
    let grid = (display_band(settings.band), CURVE_POINTS);
    let job = AcrossJob::for_conditions(dataset, Some(analysis), grid);
    // The job fails only if it is cancelled, which `Unobserved` never does.
    let across = Arc::new(job.run(&mut (), &Unobserved).ok()?);
    let options = BodeOptions {
        unit: options.unit,
        omega: options.omega,
        values: options.values,
        ..BodeOptions::default()
    };
    // Step 1.
    let mut plots = Vec::new();
    for &pair in pairs {
        let response = AirspeedResponse {
            dataset,
            analysis: Some(analysis),
            roles,
            conditions,
            pair,
            band: settings.band,
            responses: &across,
        };
        let curves = response.curves(&mut AirspeedCache::default());
        plots.push(AirspeedPlots {
            curves,
            analysis,
            options: &options,
        });
    }
    if plots.iter().all(|plot| plot.curves.responses.is_empty()) {
        return None;
    }
    let names: Vec<&str> = roles.iter().map(|role| role.name()).collect();
    let names = names.join(", ");
    let caption = format!(
        "{} {}",
        settings_words(dataset, settings),
        "Curves are coloured by airspeed, from dark at the lowest to pale at the highest."
    );
    // Step 2.
    if let ([pair], [plot]) = (pairs, plots.as_slice())
        && !plot.curves.errors.is_empty()
    {
        let title = format!("{} · every condition: {names}", dataset.pair_name(*pair));
        return Some(plot.figure_with_error(title, &caption));
    }
    // Step 3.
    let title = format!("Every condition: {names}");
    // `side_by_side` passes each of `pairs`, so that the default plot is never used.
    let figure = side_by_side(dataset, pairs, title, |pair| {
        match pairs.iter().position(|known| *known == pair) {
            Some(index) => plots[index].response_plot(""),
            None => Plot::default(),
        }
    });
    Some(figure.caption(caption))
}

/// Contents of a response's two plots: its curves, and the schedule's error.
struct AirspeedPlots<'a> {
    curves: AirspeedCurves,
    analysis: &'a Analysis,
    options: &'a BodeOptions,
}

impl AirspeedPlots<'_> {
    /// Shows the models' responses, and beside them the schedule's error.
    fn figure_with_error(&self, title: String, caption: &str) -> Figure {
        let optima = if self.curves.optima.is_some() {
            "; green: range of the errors at the optima of the conditions"
        } else {
            ""
        };
        Figure::new(title)
            .caption(format!(
                "{caption} Error: scheduled minus identified model{optima}."
            ))
            .columns(2)
            .aspect(ASPECT)
            .shared_x()
            .plots([self.response_plot("Response"), self.error_plot()])
    }

    /// Builds the plot of the models' responses, magnitude above phase.
    fn response_plot(&self, title: &str) -> Plot {
        let contents = ResponsePlot {
            curves: &self.curves.responses,
            uncertainty_bands: &[],
            references: &[],
            ratio_unit: "",
            band: self.analysis.study.settings.band,
            options: self.options,
        };
        Plot {
            title: title.to_owned(),
            ..contents.plot()
        }
    }

    /// Builds the plot of the schedule's error.
    fn error_plot(&self) -> Plot {
        Plot::new("Error of the schedule")
            .panel(self.error_panel(
                Pane::Magnitude,
                Axis::linear("Error of magnitude [dB]"),
                LEAST_ERROR_DB,
            ))
            .panel(self.error_panel(
                Pane::Phase,
                Axis::degrees("Error of phase [deg]"),
                LEAST_ERROR_DEG,
            ))
    }

    /// Builds a panel of the schedule's error, fitted to the errors within the band; `least` is the
    /// minimum range of its axis.
    fn error_panel(&self, pane: Pane, axis: Axis, least: f64) -> Panel {
        let band = self.analysis.study.settings.band;
        let shown = Range::new(band.min(), band.max());
        let range = fitted_values(&self.curves.errors, pane, shown);
        let axis = axis.showing(range.map(|range| range.with_margin(MARGIN, least)));
        let panels = FrequencyPanels {
            curves: &self.curves.errors,
            references: &[],
            uncertainty_bands: &[],
            noticed: &[],
            options: self.options,
        };
        let mut panel = panels.panel(pane, axis);
        if let Some(optima) = &self.curves.optima {
            panel = panel.with_ground(optima_envelope(optima, pane, self.options));
        }
        panel
            .with_ground(band_strip(band, self.options))
            .with(Rule::horizontal(0.0, NO_ERROR))
    }
}

/// Shades the range between the errors at the optima.
fn optima_envelope(optima: &BodeBand, pane: Pane, options: &BodeOptions) -> Envelope {
    let values = match pane {
        Pane::Magnitude => &optima.magnitude_db,
        Pane::Phase => &optima.phase_deg,
    };
    let mut points = Vec::with_capacity(values.len());
    for (omega, [low, high]) in optima.omega.iter().zip(values) {
        points.push([options.unit.of_omega(*omega), *low, *high]);
    }
    Envelope {
        name: "range of the optima".to_owned(),
        color: OPTIMA,
        edge: None,
        points,
    }
}
