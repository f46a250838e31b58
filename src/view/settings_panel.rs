//! The settings that change a result.

use std::ops::RangeInclusive;

use egui::{ComboBox, DragValue, Grid, Response, RichText, Role, Slider, Ui, WidgetInfo};

use crate::correction::{GainBounds, GainObjective};
use crate::dataset::{Band, GREATEST_OMEGA, LEAST_OMEGA};
use crate::fidelity::CostAverage;
use crate::study::{
    Edit, GREATEST_DELAY_S, GREATEST_GAIN, GREATEST_QUANTILE, LARGEST_ALPHA, LEAST_GAIN, LEAST_POINTS, MOST_POINTS,
    Setting,
};
use crate::units::s_to_ms;

use super::command::Command;
use super::heading::heading_ui;
use super::palette::{Palette, SMALL_SIZE};
use super::state::State;

/// Largest alpha on the slider; more can be typed.
const SLIDER_ALPHA: f64 = 1e3;
/// Alpha below which the slider goes to zero.
const SMALLEST_ALPHA: f64 = 1e-3;

const LABEL_WIDTH: f32 = 60.0;
const TYPED_WIDTH: f32 = 62.0;

/// Alpha, band, points, bounds and the choices of the method.
pub fn settings_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    heading_ui(ui, palette, "Settings", "");
    let mut settings = Panel { ui, state, palette, commands };
    settings.alpha_ui("α gains", state.study.settings.alpha_gain, "output gains, eq. (7)", Setting::AlphaGain);
    settings.alpha_ui("α delays", state.study.settings.alpha_delay, "output delays, eq. (11)", Setting::AlphaDelay);
    Grid::new("settings").num_columns(2).spacing([8.0, 5.0]).show(settings.ui, |ui| {
        let mut settings = Panel { ui, state, palette, commands: settings.commands };
        settings.band_ui();
        settings.points_ui();
        settings.gain_bounds_ui();
        settings.delay_bound_ui();
        settings.method_ui();
    });
}

struct Panel<'a, 'c> {
    ui: &'a mut Ui,
    state: &'a State,
    palette: &'a Palette,
    commands: &'c mut Vec<Command>,
}

impl Panel<'_, '_> {
    fn label(&mut self, text: &str) {
        self.ui.label(RichText::new(text).color(self.palette.dim_text));
    }

    fn unit(ui: &mut Ui, palette: &Palette, text: &str) {
        ui.label(RichText::new(text).size(SMALL_SIZE).color(palette.dim_text));
    }

    fn set(&mut self, setting: Setting) {
        self.commands.push(Edit::Set(setting).into());
    }

    /// A decision made by dragging ends when the pointer lets go.
    fn end_with(&mut self, response: &Response) {
        if response.drag_stopped() || response.lost_focus() {
            self.commands.push(Command::EndEdit);
        }
    }

    fn alpha_ui(&mut self, name: &str, alpha: f64, of: &str, setting: fn(f64) -> Setting) {
        let mut value = alpha;
        let hint = format!("Weight that keeps the {of} near 1 (near 0 for delays); 0 is the limit α → 0");
        let (slider, typed) = self
            .ui
            .horizontal(|ui| {
                let label = ui.label(RichText::new(name).color(self.palette.dim_text));
                ui.add_space((LABEL_WIDTH - label.rect.width()).max(0.0));
                let gap = ui.spacing().item_spacing.x;
                ui.spacing_mut().slider_width = (ui.available_width() - TYPED_WIDTH - 2.0 * gap).max(60.0);
                let slider = Slider::new(&mut value, 0.0..=SLIDER_ALPHA)
                    .logarithmic(true)
                    .smallest_positive(SMALLEST_ALPHA)
                    .show_value(false);
                let slider = named(ui.add(slider), Role::Slider, &format!("{name} slider"));
                let drag = DragValue::new(&mut value)
                    .range(0.0..=LARGEST_ALPHA)
                    .speed(0.01 * alpha.max(0.01))
                    .custom_formatter(|alpha, _| significant(alpha));
                let typed = named(ui.add_sized([TYPED_WIDTH, 18.0], drag), Role::SpinButton, name);
                (slider, typed)
            })
            .inner;
        if slider.changed() || typed.changed() {
            self.set(setting(value));
        }
        self.end_with(&slider);
        self.end_with(&typed);
        slider.on_hover_text(&hint);
        typed.on_hover_text(&hint);
    }

    fn band_ui(&mut self) {
        let band = self.state.study.settings.band;
        let (mut min, mut max) = (band.min(), band.max());
        self.label("Band");
        let palette = self.palette;
        let (low, high) = self
            .ui
            .horizontal(|ui| {
                let low = named(ui.add(frequency_value(&mut min, LEAST_OMEGA..=max)), Role::SpinButton, "Band from");
                Self::unit(ui, palette, "–");
                let high = named(ui.add(frequency_value(&mut max, min..=GREATEST_OMEGA)), Role::SpinButton, "Band to");
                Self::unit(ui, palette, "rad/s");
                (low, high)
            })
            .inner;
        if (low.changed() || high.changed())
            && let Ok(band) = Band::new(min, max)
        {
            self.set(Setting::Band(band));
        }
        self.end_with(&low);
        self.end_with(&high);
        low.on_hover_text("Lower end of the band of comparison [rad/s]; drag its line in the plot too");
        high.on_hover_text("Upper end of the band of comparison [rad/s]; drag its line in the plot too");
        self.ui.end_row();
    }

    fn points_ui(&mut self) {
        let mut points = self.state.study.settings.points;
        let mut percent = 100.0 * self.state.study.settings.quantile;
        self.label("Points");
        let palette = self.palette;
        let (count, quantile) = self
            .ui
            .horizontal(|ui| {
                let drag = DragValue::new(&mut points).range(LEAST_POINTS..=MOST_POINTS);
                let count = named(ui.add(drag), Role::SpinButton, "Frequencies in the band");
                Self::unit(ui, palette, "quantile");
                let drag = DragValue::new(&mut percent).range(0.0..=100.0 * GREATEST_QUANTILE).speed(0.1).suffix(" %");
                let quantile = named(ui.add(drag), Role::SpinButton, "Quantile of the bounds");
                (count, quantile)
            })
            .inner;
        if count.changed() {
            self.set(Setting::Points(points));
        }
        if quantile.changed() {
            self.set(Setting::Quantile(percent / 100.0));
        }
        self.end_with(&count);
        self.end_with(&quantile);
        count.on_hover_text("Number of logarithmically spaced frequencies in the band");
        quantile.on_hover_text("Bounds are this quantile, and its complement, of |H_ref|/|H_sim| and of Δφ/ω [%]");
        self.ui.end_row();
    }

    fn gain_bounds_ui(&mut self) {
        let by_hand = self.state.study.settings.gain_bounds;
        let shown = self.state.shown().map(|shown| shown.gain_bounds());
        let Some(GainBounds { mut lower, mut upper }) = by_hand.or(shown) else {
            self.label("Gain bounds");
            self.label("…");
            self.ui.end_row();
            return;
        };
        self.label("Gain bounds");
        let palette = self.palette;
        let (low, high, automatic) = self
            .ui
            .horizontal(|ui| {
                let low = ui.add(gain_value(&mut lower, LEAST_GAIN..=upper));
                let low = named(low, Role::SpinButton, "Lower gain bound");
                Self::unit(ui, palette, "–");
                let high = ui.add(gain_value(&mut upper, lower..=GREATEST_GAIN));
                let high = named(high, Role::SpinButton, "Upper gain bound");
                (low, high, automatic_ui(ui, by_hand.is_some(), "Gain bounds"))
            })
            .inner;
        if low.changed() || high.changed() {
            self.set(Setting::GainBounds(Some(GainBounds { lower, upper })));
        } else if let Some(automatic) = automatic {
            let bounds = (!automatic).then_some(GainBounds { lower, upper });
            self.set(Setting::GainBounds(bounds));
        }
        self.end_with(&low);
        self.end_with(&high);
        low.on_hover_text("Least gain of every channel [-]; typing sets it by hand, for every condition");
        high.on_hover_text("Greatest gain of every channel [-]; typing sets it by hand, for every condition");
        self.ui.end_row();
    }

    fn delay_bound_ui(&mut self) {
        let by_hand = self.state.study.settings.delay_upper_s;
        let shown = self.state.shown().map(|shown| shown.delay_upper_s());
        self.label("Delay bound");
        let Some(upper_s) = by_hand.or(shown) else {
            self.label("…");
            self.ui.end_row();
            return;
        };
        let mut upper_ms = s_to_ms(upper_s);
        let (typed, automatic) = self
            .ui
            .horizontal(|ui| {
                let drag = DragValue::new(&mut upper_ms)
                    .range(0.0..=s_to_ms(GREATEST_DELAY_S))
                    .speed(0.2)
                    .max_decimals(1)
                    .suffix(" ms");
                let typed = named(ui.add(drag), Role::SpinButton, "Upper delay bound");
                (typed, automatic_ui(ui, by_hand.is_some(), "Delay bound"))
            })
            .inner;
        if typed.changed() {
            self.set(Setting::DelayUpper(Some(upper_ms / 1e3)));
        } else if let Some(automatic) = automatic {
            self.set(Setting::DelayUpper((!automatic).then_some(upper_s)));
        }
        self.end_with(&typed);
        typed.on_hover_text("Greatest delay of every channel [ms]; typing sets it by hand, for every condition");
        self.ui.end_row();
    }

    fn method_ui(&mut self) {
        let settings = &self.state.study.settings;
        self.label("Method");
        let (mut average, mut objective) = (settings.cost_average, settings.gain_objective);
        self.ui.horizontal(|ui| {
            choice_ui(
                ui,
                "Average in J",
                &mut average,
                &[
                    (CostAverage::Median, "J median", "J takes the median over frequency (the paper)"),
                    (CostAverage::Mean, "J mean", "J takes the mean over frequency (Tischler)"),
                ],
            );
            choice_ui(
                ui,
                "Objective of the gains",
                &mut objective,
                &[
                    (GainObjective::Ratio, "ratio", "Gains minimise squared errors of the ratios, eq. (7)"),
                    (GainObjective::Decibel, "dB", "Gains minimise squared errors in dB: up and down count alike"),
                ],
            );
        });
        if average != settings.cost_average {
            self.set(Setting::CostAverage(average));
        }
        if objective != settings.gain_objective {
            self.set(Setting::GainObjective(objective));
        }
        self.ui.end_row();
    }
}

fn frequency_value(omega: &mut f64, range: RangeInclusive<f64>) -> DragValue<'_> {
    DragValue::new(omega).range(range).speed(0.01).custom_formatter(|omega, _| significant(omega))
}

fn gain_value(gain: &mut f64, range: RangeInclusive<f64>) -> DragValue<'_> {
    DragValue::new(gain).range(range).speed(0.002).min_decimals(2).max_decimals(3)
}

/// Names a widget for screen readers and tests.
fn named(response: Response, kind: Role, name: &str) -> Response {
    let enabled = response.enabled();
    response.widget_info(|| WidgetInfo::labeled(kind, enabled, name));
    response
}

/// The box that hands bounds back to the quantiles; the new state where it was clicked.
fn automatic_ui(ui: &mut Ui, by_hand: bool, name: &str) -> Option<bool> {
    let mut automatic = !by_hand;
    let response = ui.checkbox(&mut automatic, "auto");
    let changed = response.changed();
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, automatic, format!("{name} automatic")));
    response.on_hover_text("From the quantiles of each condition; off: set by hand, the same for every condition");
    changed.then_some(automatic)
}

/// A small drop-down list.
pub(super) fn choice_ui<T: Copy + PartialEq>(ui: &mut Ui, name: &str, value: &mut T, choices: &[(T, &str, &str)]) {
    let current = choices.iter().find(|(choice, ..)| choice == value).map_or("…", |(_, text, _)| *text);
    let shown = ComboBox::from_id_salt(name).selected_text(current).width(60.0).show_ui(ui, |ui| {
        for (choice, text, hint) in choices {
            ui.selectable_value(value, *choice, *text).on_hover_text(*hint);
        }
    });
    shown.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, name));
    shown.response.on_hover_text(name);
}

/// Three significant digits, without an exponent from 0.001 to 9999.
fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let magnitude = value.abs().log10().floor();
    if (-3.0..4.0).contains(&magnitude) {
        format!("{value:.*}", (2.0 - magnitude).max(0.0) as usize)
    } else {
        format!("{value:.2e}")
    }
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn alpha_is_shown_with_three_significant_digits() {
        for (value, text) in [(0.0, "0"), (1.0, "1.00"), (0.00123, "0.00123"), (120.0, "120"), (1e6, "1.00e6")] {
            assert_eq!(significant(value), text);
        }
    }
}
