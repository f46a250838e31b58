//! Responses in a condition: magnitude above phase over frequency (Figures 2 and 5), with the
//! measured coherence below; and an overview with the magnitudes of all responses.
//!
//! A *held* response is one that the correction must match exactly (M1). J is a response's cost,
//! its weighted squared mismatch to the identified reference (M4). A *lead* is a filter that
//! advances the phase in a channel; the corrected model must not be used above the band then
//! (M15.6).

use gdcm_model::dataset::{Band, Pair};
use gdcm_model::units::db_to_ratio;

pub use super::bode_options::BodeOptions;
pub use super::coherence::CoherenceCurve;

use super::axis::{Axis, MagnitudeUnit, Range};
use super::bode_curve::{BodeCurve, Pane};
use super::coherence::coherence_panel;
use super::condition_source::ConditionSource;
use super::drawing::{Color, Dash, Hue, Stroke};
use super::figure::{Figure, Panel, Plot};
use super::frequency_panels::{FrequencyPanels, figure_of_pairs};
use super::marks::{Note, Place, Rule, Strip};
use super::muad::muad_about;
use super::reference_line::ReferenceLine;
use super::responses::{BodeBand, ResponseCache, fitted_values, uncertainty_bands};
use super::role::Role;

/// Background of the comparison band.
const BAND: Color = Color::new(Hue::Accent).tint(8);
/// Background above the band, at frequencies where a model with leads is invalid.
const INVALID: Color = Color::new(Hue::Warning).tint(10);
/// Line at a frequency at which a bandwidth is read.
const CROSSING: Stroke = Stroke::dashed(Color::new(Hue::Text), 0.8, Dash::Short);
/// Height of the magnitude panel; the phase panel has height 1.
const MAGNITUDE_WEIGHT: f64 = 1.35;
/// Margin above and below the curves, relative to their height.
const MARGIN: f64 = 0.04;
/// Minimum range of the magnitude axis \[dB\].
const LEAST_DB: f64 = 4.0;
/// Minimum range of the phase axis \[deg\].
const LEAST_DEG: f64 = 20.0;

/// Plots the responses `pairs` in a condition, magnitude above phase, for all models and corrected
/// models.
pub fn bode_figure(source: &ConditionSource<'_>, pairs: &[Pair], options: &BodeOptions) -> Figure {
    figure_of_pairs(source, pairs, None, |pair| {
        condition_plot(source, pair, options)
    })
}

/// Plots a response in a condition, with a coherence panel below if coherence was measured.
fn condition_plot(source: &ConditionSource<'_>, pair: Pair, options: &BodeOptions) -> Plot {
    let band = source.study.settings.band;
    let curves = source.response_curves(pair, options, &mut ResponseCache::default());
    let contents = ResponsePlot {
        curves: &curves,
        uncertainty_bands: &uncertainty_bands(source.dataset(), pair, &curves),
        references: &muad_about(&curves, options),
        ratio_unit: &ConditionSource::ratio_unit(source.dataset(), pair),
        band,
        options,
    };
    let plot = contents.plot();
    match coherence_panel(source, pair, options) {
        Some(panel) => plot.panel(panel.with_ground(band_strip(band, options))),
        None => plot,
    }
}

/// Contents of a response's plot, magnitude above phase.
pub(super) struct ResponsePlot<'a> {
    pub(super) curves: &'a [BodeCurve],
    pub(super) uncertainty_bands: &'a [BodeBand],
    pub(super) references: &'a [ReferenceLine],
    /// Unit for magnitudes drawn as ratios.
    pub(super) ratio_unit: &'a str,
    /// Comparison band.
    pub(super) band: Band,
    pub(super) options: &'a BodeOptions,
}

impl ResponsePlot<'_> {
    /// Builds the plot, magnitude above phase.
    pub(super) fn plot(&self) -> Plot {
        let magnitude = self.magnitude_panel();
        let phase = self.phase_panel();
        Plot::default()
            .panel(self.with_backgrounds(magnitude).weight(MAGNITUDE_WEIGHT))
            .panel(self.with_backgrounds(phase))
    }

    /// Builds the magnitude panel, with labelled lines at the marked frequencies.
    fn magnitude_panel(&self) -> Panel {
        let range_db = self.options.values[0].or(self.fitted(Pane::Magnitude, LEAST_DB));
        let panel = match self.options.magnitude {
            MagnitudeUnit::Decibel => {
                let axis = Axis::linear("Magnitude [dB]").showing(range_db);
                self.panels().panel(Pane::Magnitude, axis)
            }
            MagnitudeUnit::Ratio => {
                let ratio = range_db.map(|db| Range::new(db_to_ratio(db.min), db_to_ratio(db.max)));
                let label = format!("Magnitude [{}]", self.ratio_unit);
                let axis = Axis::logarithmic(label).showing(ratio);
                self.panels()
                    .converted_panel(Pane::Magnitude, axis, db_to_ratio)
            }
        };
        let crossings = self
            .options
            .crossings
            .iter()
            .map(|(name, omega)| self.crossing(*omega).label(*name));
        panel.with_all(crossings)
    }

    /// Builds the phase panel, with unlabelled lines at the marked frequencies.
    fn phase_panel(&self) -> Panel {
        let range_deg = self.options.values[1].or(self.fitted(Pane::Phase, LEAST_DEG));
        let axis = Axis::degrees("Phase [deg]").showing(range_deg);
        let crossings = self
            .options
            .crossings
            .iter()
            .map(|(_, omega)| self.crossing(*omega));
        self.panels().panel(Pane::Phase, axis).with_all(crossings)
    }

    /// Returns the line at a marked frequency \[rad/s\].
    fn crossing(&self, omega: f64) -> Rule {
        Rule::vertical(self.options.unit.of_omega(omega), CROSSING)
    }

    fn panels(&self) -> FrequencyPanels<'_> {
        FrequencyPanels {
            curves: self.curves,
            references: self.references,
            uncertainty_bands: self.uncertainty_bands,
            noticed: &[],
            options: self.options,
        }
    }

    /// Returns a range that fits the visible curves within the band and is at least `least` high;
    /// `None` if no curve has a finite value. With leads, the band is extended to the end of the
    /// frequencies at which the correction is not valid.
    fn fitted(&self, pane: Pane, least: f64) -> Option<Range> {
        let visible: Vec<BodeCurve> = self
            .curves
            .iter()
            .filter(|curve| !curve.hidden)
            .cloned()
            .collect();
        let shown = Range {
            min: self.band.min(),
            max: self.invalid_up_to().unwrap_or(self.band.max()),
        };
        let range = fitted_values(&visible, pane, shown)?;
        Some(range.with_margin(MARGIN, least))
    }

    /// Returns the upper end \[rad/s\] of the range above the band where a model with leads is
    /// invalid (M15.6). This is the last frequency in the curve without leads; `None` if that curve
    /// is missing or hidden.
    fn invalid_up_to(&self) -> Option<f64> {
        let without_leads = self
            .curves
            .iter()
            .find(|curve| !curve.hidden && curve.role == Role::WithoutLeads)?;
        without_leads.omega.last().copied()
    }

    /// Returns the panel with the band and the invalid frequencies shaded.
    fn with_backgrounds(&self, panel: Panel) -> Panel {
        let band = band_strip(self.band, self.options);
        match self.invalid_up_to() {
            Some(up_to) => panel
                .with_ground(self.invalid_strip(up_to))
                .with_ground(band),
            None => panel.with_ground(band),
        }
    }

    /// Returns the shading from the band to `up_to` \[rad/s\], where a model with leads is invalid.
    fn invalid_strip(&self, up_to: f64) -> Strip {
        Strip {
            range: self.options.in_unit(self.band.max(), up_to),
            color: INVALID,
            key: "corrected model not valid (leads)".to_owned(),
        }
    }
}

/// Shades the comparison band.
pub(super) fn band_strip(band: Band, options: &BodeOptions) -> Strip {
    Strip {
        range: options.in_unit(band.min(), band.max()),
        color: BAND,
        key: "comparison band".to_owned(),
    }
}

/// Plots every response's magnitude in a condition: outputs in rows, inputs in columns, with J
/// before and after the correction.
pub fn overview_figure(source: &ConditionSource<'_>, options: &BodeOptions) -> Figure {
    let dataset = source.dataset();
    let plots = dataset
        .on_axis()
        .pairs()
        .map(|pair| overview_plot(source, pair, options));
    Figure::new(source.condition_words())
        .caption(format!(
            "{} An asterisk (*) marks held responses.",
            source.caption()
        ))
        .plots(plots)
        .columns(dataset.inputs().len())
        .dense()
        .shared_x()
        .aspect(0.55)
}

/// Plots a response's magnitude, with its J; a star after the title marks a constrained response.
fn overview_plot(source: &ConditionSource<'_>, pair: Pair, options: &BodeOptions) -> Plot {
    let panels = FrequencyPanels {
        curves: &source.response_curves(pair, options, &mut ResponseCache::default()),
        references: &[],
        uncertainty_bands: &[],
        noticed: &[],
        options,
    };
    let axis = Axis::linear("Magnitude [dB]").at_least(LEAST_DB);
    let mut panel = panels
        .panel(Pane::Magnitude, axis)
        .with_ground(band_strip(source.study.settings.band, options));
    let mut title = source.dataset().pair_name(pair);
    if let Some(analysis) = source.analysis {
        if let Some(cost) = &analysis.cost[pair] {
            let text = format!(
                "J {:.0} → {:.0}",
                cost.uncorrected.total(),
                cost.corrected.total()
            );
            panel = panel.with(Note {
                at: Place::LowerLeft,
                text,
            });
        }
        if analysis.held()[pair] {
            title.push_str(" *");
        }
    }
    Plot::new(title).panel(panel)
}
