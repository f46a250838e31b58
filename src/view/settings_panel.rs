//! The settings that change a result.

use egui::{ComboBox, Grid, RichText, Role, Slider, Ui, WidgetInfo};

use gdcm_core::correction::{GainBounds, GainObjective, GainSource};
use gdcm_core::dataset::{Band, GREATEST_OMEGA, LEAST_OMEGA};
use gdcm_core::fidelity::CostAverage;
use gdcm_core::study::{
    Edit, GREATEST_AGREEMENT_DB, GREATEST_DELAY_S, GREATEST_GAIN, GREATEST_QUANTILE, LARGEST_ALPHA, LEAST_GAIN,
    LEAST_POINTS, MOST_POINTS, PhaseCorrection, Setting,
};
use gdcm_core::uncertainty::{GREATEST_PRIOR, LEVELS, UncertaintySettings};
use gdcm_core::units::s_to_ms;

use super::coherence_setting::coherence_ui;
use super::command::Command;
use super::controls::heading_ui;
use super::focus::{Region, region_ui};
use super::number_field::{Entered, NumberField, gain_text};
use super::palette::{Palette, SMALL_SIZE};
use super::phase_setting::phase_ui;
use super::state::State;

/// Largest alpha on the slider; more can be typed.
const SLIDER_ALPHA: f64 = 1e3;
/// Alpha below which the slider goes to zero.
const SMALLEST_ALPHA: f64 = 1e-3;

/// Levels of error bars \[%\].
const LEVELS_PERCENT: std::ops::RangeInclusive<f64> = 100.0 * LEVELS[0]..=100.0 * LEVELS[1];

const LABEL_WIDTH: f32 = 60.0;
const TYPED_WIDTH: f32 = 62.0;

/// Alpha, band, points, bounds and the choices of the method.
pub fn settings_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    heading_ui(ui, palette, "Settings", "");
    region_ui(ui, Region::Settings, |ui| fields_ui(ui, state, palette, commands));
}

fn fields_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let mut settings = Panel { ui, state, palette, commands };
    settings.alpha_ui("α gains", state.study.settings.alpha_gain, "output gains, eq. (7)", Setting::AlphaGain);
    let of = if state.study.settings.phase == PhaseCorrection::Lead {
        "signed delays, M15"
    } else {
        "output delays, eq. (11)"
    };
    settings.alpha_ui("α delays", state.study.settings.alpha_delay, of, Setting::AlphaDelay);
    phase_ui(settings.ui, state, palette, settings.commands);
    Grid::new("settings").num_columns(2).spacing([8.0, 5.0]).show(settings.ui, |ui| {
        let mut settings = Panel { ui, state, palette, commands: settings.commands };
        settings.band_ui();
        settings.points_ui();
        settings.gain_bounds_ui();
        settings.delay_bound_ui();
        settings.agreement_ui();
        settings.method_ui();
        settings.error_bars_ui();
        coherence_ui(settings.ui, state, palette, settings.commands);
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

    /// Takes up what was entered, tells why it is not taken, or ends the decision.
    fn take(&mut self, entered: Entered, setting: impl FnOnce(f64) -> Setting) {
        if let Some(value) = entered.value {
            self.set(setting(value));
        }
        self.end(entered);
    }

    fn end(&mut self, entered: Entered) {
        self.commands.extend(entered.refusal.map(Command::Refuse));
        if entered.is_ended {
            self.commands.push(Command::EndEdit);
        }
    }

    fn alpha_ui(&mut self, name: &str, alpha: f64, of: &str, setting: fn(f64) -> Setting) {
        let mut value = alpha;
        let hint = format!("Weight that keeps the {of} near 1 (near 0 for delays); 0 is the limit α → 0");
        let field = NumberField {
            step: 0.01 * alpha.max(0.01),
            width: TYPED_WIDTH,
            ..NumberField::new(name, &hint, 0.0..=LARGEST_ALPHA)
        };
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
                let slider = ui.add(slider);
                slider.widget_info(|| WidgetInfo::labeled(Role::Slider, true, format!("{name} slider")));
                (slider, field.ui(ui, alpha))
            })
            .inner;
        if slider.changed() {
            self.set(setting(value));
        }
        if slider.drag_stopped() || slider.lost_focus() {
            self.commands.push(Command::EndEdit);
        }
        slider.on_hover_text(&hint);
        self.take(typed, setting);
    }

    fn band_ui(&mut self) {
        let band = self.state.study.settings.band;
        self.label("Band");
        let palette = self.palette;
        let frequency = |name, hint, range| NumberField { unit: "rad/s", ..NumberField::new(name, hint, range) };
        let low = frequency(
            "Band from",
            "Lower end of the band of comparison [rad/s]; drag its line in the plot too",
            LEAST_OMEGA..=band.max(),
        );
        let high = frequency(
            "Band to",
            "Upper end of the band of comparison [rad/s]; drag its line in the plot too",
            band.min()..=GREATEST_OMEGA,
        );
        let (low, high) = self
            .ui
            .horizontal(|ui| {
                let low = low.ui(ui, band.min());
                Self::unit(ui, palette, "–");
                let high = high.ui(ui, band.max());
                Self::unit(ui, palette, "rad/s");
                (low, high)
            })
            .inner;
        if low.value.is_some() || high.value.is_some() {
            match Band::new(low.value.unwrap_or(band.min()), high.value.unwrap_or(band.max())) {
                Ok(band) => self.set(Setting::Band(band)),
                // An end that is dragged stops before the other.
                Err(_) if low.is_dragged || high.is_dragged => {}
                Err(error) => self.commands.push(Command::Refuse(error.to_string())),
            }
        }
        self.end(low);
        self.end(high);
        self.ui.end_row();
    }

    fn points_ui(&mut self) {
        let (points, quantile) = (self.state.study.settings.points, self.state.study.settings.quantile);
        self.label("Points");
        let palette = self.palette;
        let hint = "Number of logarithmically spaced frequencies in the band";
        let range = LEAST_POINTS as f64..=MOST_POINTS as f64;
        let count = NumberField {
            is_whole: true,
            step: 1.0,
            text: |points| format!("{points:.0}"),
            ..NumberField::new("Frequencies in the band", hint, range)
        };
        let hint = "Bounds are this quantile, and its complement, of |H_ref|/|H_sim| and of Δφ/ω [%]";
        let percent = NumberField {
            unit: "%",
            shows_unit: true,
            step: 0.1,
            text: |percent| format!("{percent:.1}"),
            ..NumberField::new("Quantile of the bounds", hint, 0.0..=100.0 * GREATEST_QUANTILE)
        };
        let (count, percent) = self
            .ui
            .horizontal(|ui| {
                let count = count.ui(ui, points as f64);
                Self::unit(ui, palette, "quantile");
                (count, percent.ui(ui, 100.0 * quantile))
            })
            .inner;
        self.take(count, |count| Setting::Points(count.round() as usize));
        self.take(percent, |percent| Setting::Quantile(percent / 100.0));
        self.ui.end_row();
    }

    fn gain_bounds_ui(&mut self) {
        let by_hand = self.state.study.settings.gain_bounds;
        let shown = self.state.shown().map(|shown| shown.gain_bounds());
        let Some(bounds) = by_hand.or(shown) else {
            self.label("Gain bounds");
            self.label("…");
            self.ui.end_row();
            return;
        };
        self.label("Gain bounds");
        let palette = self.palette;
        let gain =
            |name, hint, range| NumberField { step: 0.002, text: gain_text, ..NumberField::new(name, hint, range) };
        let low = gain(
            "Lower gain bound",
            "Least gain of every channel [-]; typing sets it by hand, for every condition",
            LEAST_GAIN..=bounds.upper,
        );
        let high = gain(
            "Upper gain bound",
            "Greatest gain of every channel [-]; typing sets it by hand, for every condition",
            bounds.lower..=GREATEST_GAIN,
        );
        let (low, high, automatic) = self
            .ui
            .horizontal(|ui| {
                let low = low.ui(ui, bounds.lower);
                Self::unit(ui, palette, "–");
                let high = high.ui(ui, bounds.upper);
                (low, high, automatic_ui(ui, by_hand.is_some(), "Gain bounds"))
            })
            .inner;
        if low.value.is_some() || high.value.is_some() {
            let (lower, upper) = (low.value.unwrap_or(bounds.lower), high.value.unwrap_or(bounds.upper));
            self.set(Setting::GainBounds(Some(GainBounds { lower, upper })));
        } else if let Some(automatic) = automatic {
            self.set(Setting::GainBounds((!automatic).then_some(bounds)));
        }
        self.end(low);
        self.end(high);
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
        let hint = "Greatest delay of every channel [ms]; typing sets it by hand, for every condition";
        let field = NumberField {
            unit: "ms",
            shows_unit: true,
            step: 0.2,
            text: |delay_ms| format!("{delay_ms:.1}"),
            ..NumberField::new("Upper delay bound", hint, 0.0..=s_to_ms(GREATEST_DELAY_S))
        };
        let (typed, automatic) = self
            .ui
            .horizontal(|ui| (field.ui(ui, s_to_ms(upper_s)), automatic_ui(ui, by_hand.is_some(), "Delay bound")))
            .inner;
        if let Some(automatic) = automatic.filter(|_| typed.value.is_none()) {
            self.set(Setting::DelayUpper((!automatic).then_some(upper_s)));
        }
        self.take(typed, |upper_ms| Setting::DelayUpper(Some(upper_ms / 1e3)));
        self.ui.end_row();
    }

    fn agreement_ui(&mut self) {
        self.label("Agreement");
        let hint = "A loop of held gains that disagrees by no more than this [dB] counts as agreeing";
        let field = NumberField {
            unit: "dB",
            shows_unit: true,
            ..NumberField::new("Agreement tolerance", hint, 0.0..=GREATEST_AGREEMENT_DB)
        };
        let entered = field.ui(self.ui, self.state.study.settings.agreement_db);
        self.take(entered, Setting::Agreement);
        self.ui.end_row();
    }

    /// The level of the error bars, and how much a condition's identification borrows from the others.
    fn error_bars_ui(&mut self) {
        let settings = self.state.study.settings.uncertainty;
        self.label("Bars");
        let level = NumberField {
            unit: "%",
            shows_unit: true,
            step: 0.5,
            text: |percent| format!("{percent:.1}"),
            ..NumberField::new("Level of error bars", "Level of every error bar, interval and test [%]", LEVELS_PERCENT)
        };
        let hint = "Degrees of freedom that a condition's identification part borrows from the other conditions at most; 0 trusts \
                    the condition alone";
        let prior =
            NumberField { step: 0.1, ..NumberField::new("Borrowed degrees of freedom", hint, 0.0..=GREATEST_PRIOR) };
        let palette = self.palette;
        let (level, prior) = self
            .ui
            .horizontal(|ui| {
                let level = level.ui(ui, 100.0 * settings.level);
                Self::unit(ui, palette, "borrow");
                (level, prior.ui(ui, settings.prior_degrees))
            })
            .inner;
        self.take(level, |percent| Setting::Uncertainty(UncertaintySettings { level: 0.01 * percent, ..settings }));
        self.take(prior, |prior_degrees| Setting::Uncertainty(UncertaintySettings { prior_degrees, ..settings }));
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
        let (of_study, mut source) = (settings.gain_source, settings.gain_source);
        self.ui.end_row();
        self.label("G from");
        choice_ui(
            self.ui,
            "Source of G",
            &mut source,
            &[
                (GainSource::Representatives, "representatives", "G of the two representatives (the paper)"),
                (GainSource::MeanOfPairs, "mean of pairs", "G is the mean of ln G over all pairs of kept models"),
            ],
        );
        if source != of_study {
            self.set(Setting::GainSource(source));
        }
        if of_study == GainSource::MeanOfPairs && settings.phase == PhaseCorrection::Lead {
            self.ui.end_row();
            self.label("");
            let text = RichText::new("No effect with leads").size(SMALL_SIZE).color(self.palette.warning);
            self.ui.label(text).on_hover_text(format!("G from {}", settings.gain_source_words()));
        }
        if average != settings.cost_average {
            self.set(Setting::CostAverage(average));
        }
        if objective != settings.gain_objective {
            self.set(Setting::GainObjective(objective));
        }
        self.ui.end_row();
    }
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
