//! Error bars on gains and delays: whether they are shown, their description, and their switch. The
//! variance of a bar has two sources: the unknown trim of the flight, and the identification (M13:
//! docs/error-bars.md).
//!
//! The *current* uncertainty belongs to the present settings, the *older* one to earlier settings.
//! Texts use only the current one; plots draw the older one dim until the current one is computed.

use egui::Ui;

use gdcm_method::uncertainty::{Bar, Scalar};
use gdcm_model::number_format::counted;
use gdcm_model::units::s_to_ms;
use gdcm_plot::figure::marks::Mark;
use gdcm_plot::figure::{Color, Figure};
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_words::uncertainty::bar_remark_texts;

use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::Toggle;

/// Returns the current uncertainty in gains and delays; `None` if error bars are hidden or until it
/// is computed.
pub fn shown_uncertainty(state: &State) -> Option<&Uncertainty> {
    if state.display.gains.hide_bars {
        None
    } else {
        state.uncertainty().map(AsRef::as_ref)
    }
}

/// Returns the uncertainty drawn in gain plots: the current one or, until it is computed, the older
/// one, which [`dim_older_bars`] dims. `None` if error bars are hidden or have never been computed.
pub fn painted_uncertainty(state: &State) -> Option<&Uncertainty> {
    if state.display.gains.hide_bars {
        return None;
    }
    match state.older_uncertainty() {
        Some(older) => Some(older),
        None => shown_uncertainty(state),
    }
}

/// If a figure's error bars and bands belong to earlier settings, dims them, and removes the
/// brackets at significant differences, which depend on the bars.
pub fn dim_older_bars(state: &State, figure: &mut Figure) {
    if state.older_uncertainty().is_none() {
        return;
    }
    for panel in figure.plots.iter_mut().flat_map(|plot| &mut plot.panels) {
        panel
            .marks
            .retain(|mark| !matches!(mark, Mark::Brackets(_)));
        for mark in &mut panel.marks {
            match mark {
                Mark::Intervals(bars) => dim(&mut bars.stroke.color),
                Mark::Envelope(band) => dim(&mut band.color),
                _ => {}
            }
        }
    }
}

fn dim(color: &mut Color) {
    *color = color.tint(color.percent / 2);
}

/// Describes an error bar: "± 3.3 % (90 %): trim 78 %, identification 22 % of the variance;
/// undefined with 2 other models as representative", with the bar's remarks before "undefined".
/// Without a half-width, only the remarks.
///
/// The bar comes from substitutions: each replaces a representative by another model of its bundle
/// (M13.1), with which the value may be undefined.
pub fn error_bar_words(bar: &Bar, scalar: Scalar, level: f64) -> String {
    let remarks = bar_remark_texts(bar).join(", ");
    let Some(half_width) = bar.half_width(level) else {
        return format!("no error bar: {remarks}");
    };
    let interval = if scalar.is_delay() {
        format!("± {:.1} ms", s_to_ms(half_width))
    } else {
        format!("± {:.1} %", 100.0 * half_width)
    };
    // A bar with a half-width has spread, and therefore a trim share.
    let trim_percent = 100.0 * bar.trim_share().unwrap_or_default();
    let mut words = format!(
        "{interval} ({:.0} %): trim {trim_percent:.0} %, identification {:.0} % of the variance",
        100.0 * level,
        100.0 - trim_percent
    );
    if !remarks.is_empty() {
        words.push_str(&format!("; {remarks}"));
    }
    let undefined_count = bar.left_out;
    if undefined_count > 0 {
        words.push_str(&format!(
            "; undefined with {} as representative",
            counted(undefined_count, "other model")
        ));
    }
    words
}

/// Draws the switch that shows error bars and bands; `name` distinguishes it from the switches in
/// other views.
pub fn error_bars_switch_ui(ui: &mut Ui, state: &State, name: &str, commands: &mut Vec<Command>) {
    let shown = !state.display.gains.hide_bars;
    let level = 100.0 * state.study.settings.uncertainty.level;
    let hint = format!(
        "{level:.0} % error bars. Thick: uncertainty of the identification, for the chosen \
        physics model. Thin: with the unknown trim of the flight. Bands over airspeed: confidence \
        of the schedule, and prediction for another condition"
    );
    let toggle = Toggle {
        text: "bars",
        name,
        hint: &hint,
    };
    if toggle.ui(ui, shown) {
        commands.push(DisplayCommand::ShowBars(!shown).into());
    }
}
