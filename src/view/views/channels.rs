//! Channel gains against airspeed.

use egui::Ui;
use gdcm_core::correction::ChannelCorrection;
use gdcm_core::dataset::ConditionId;
use gdcm_core::schedule::Schedule;
use gdcm_core::study::{AirspeedDifference, Uncertainty};
use gdcm_core::uncertainty::{Bar, Scalar};
use gdcm_core::units::s_to_ms;

use super::net_gain::{bars_switch_ui, channel_panels, gain_command};
use crate::view::command::Command;
use crate::view::palette::Palette;
use crate::view::plot::{Across, Bracket, ChannelsScene, Dot, DotBar, GainBand, Measure, channels_ui};
use crate::view::settings_panel::choice_ui;
use crate::view::state::State;

/// Gains or delays, over airspeed or over conditions. Laid out from right to left.
pub fn channels_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.channel_values;
    let (mut measure, mut across) = shown;
    let axes = [
        (Across::Airspeed, "over airspeed", "With the schedule"),
        (Across::Conditions, "over conditions", "Conditions side by side, in file order"),
    ];
    choice_ui(ui, "Horizontal axis of the channels", &mut across, &axes);
    let figures = [
        (Measure::Gain, "gains", "Gain k of every channel, its bounds, and 1: no correction"),
        (Measure::Delay, "delays", "Delay τ of every channel [ms], its bounds, and 0: no correction"),
    ];
    choice_ui(ui, "Figure of the channels", &mut measure, &figures);
    bars_switch_ui(ui, state, "bars of the channels", commands);
    if (measure, across) != shown {
        commands.push(Command::ShowChannels(measure, across));
    }
}

/// Gain or delay of every channel against airspeed (Figures 3 and 4).
pub fn channels_view_ui(ui: &mut Ui, state: &mut State, palette: &Palette, commands: &mut Vec<Command>) {
    let (measure, across) = state.display.channel_values;
    let (inputs, outputs) = channel_panels(state, measure, across);
    let scene = ChannelsScene { inputs: &inputs, outputs: &outputs, message: Some(state.results.absence()) };
    let events = channels_ui(ui, &scene, &mut state.display.channels, palette);
    commands.extend(events.into_iter().filter_map(|event| gain_command(state, event)));
}

/// Places between the least and the greatest airspeed at which bands are looked at.
const BAND_STEPS: usize = 48;

/// The bands of a schedule about a figure of it; none where it has none.
pub(super) fn gain_bands(
    schedule: &Schedule,
    uncertainty: &Uncertainty,
    scalar: Scalar,
    figure: &dyn Fn(&ChannelCorrection) -> f64,
) -> Vec<GainBand> {
    let Some(bands) = &uncertainty.bands else { return Vec::new() };
    let (min, max) = (schedule.airspeeds.min_kt, schedule.airspeeds.max_kt);
    let band = |step: usize| {
        let x = min + (max - min) * step as f64 / BAND_STEPS as f64;
        let (widths, middle) = (bands.at(schedule, scalar, x)?, figure(&schedule.at(x)));
        let about = |half: f64| [middle * (-half).exp(), middle * half.exp()];
        Some(GainBand { x, confidence: about(widths.confidence), scatter: about(widths.scatter) })
    };
    (0..=BAND_STEPS).map(band).collect::<Option<_>>().unwrap_or_default()
}

/// For each airspeed the difference that is the largest multiple of what is expected.
pub(super) fn brackets(uncertainty: &Uncertainty, scalar: Scalar, dots: &[Dot]) -> Vec<Bracket> {
    let Scalar::NetGain(pair) = scalar else { return Vec::new() };
    let value = |id: ConditionId| dots.iter().find(|dot| dot.condition == id).map(|dot| dot.value);
    let bracket = |of: &AirspeedDifference| {
        let ([one, other], ratio) = (of.conditions.map(value), of.difference.ratio()?);
        let (label, beyond) = (format!("{ratio:.1}×"), of.is_significant(uncertainty.level));
        Some(Bracket { x: of.airspeed_kt, ends: [one?, other?], label, beyond })
    };
    uncertainty.greatest_differences(pair).into_iter().filter_map(bracket).collect()
}

/// The bar of a figure in the unit of its plot: ratios, or \[ms\].
pub(super) fn dot_bar(bar: &Bar, scalar: Scalar, level: f64) -> Option<DotBar> {
    let shown = |ends: [f64; 2]| ends.map(|end| if scalar.is_delay() { s_to_ms(end) } else { end.exp() });
    let inner = bar.inner_interval(level).map(shown);
    Some(DotBar { inner, outer: shown(bar.interval(level)?) })
}

/// How sure a figure is, in words: "± 3.3 % (90 %): trim 78 %, identification 22 % of the variance".
pub fn bar_words(bar: &Bar, scalar: Scalar, level: f64) -> String {
    let remarks = bar.remarks().join(", ");
    let Some(half) = bar.half_width(level) else { return format!("no bar: {remarks}") };
    let half =
        if scalar.is_delay() { format!("± {:.1} ms", s_to_ms(half)) } else { format!("± {:.1} %", 100.0 * half) };
    let trim = 100.0 * bar.trim_share().unwrap_or_default();
    let mut words = format!(
        "{half} ({:.0} %): trim {trim:.0} %, identification {:.0} % of the variance",
        100.0 * level,
        100.0 - trim
    );
    if !remarks.is_empty() {
        words.push_str(&format!("; {remarks}"));
    }
    if bar.left_out > 0 {
        words.push_str(&format!("; {} swaps without this figure", bar.left_out));
    }
    words
}

/// How sure a figure is in a condition, and how it differs from others at its airspeed, in sentences.
pub(super) fn bar_sentences(uncertainty: &Uncertainty, scalar: Scalar, condition: ConditionId) -> Vec<String> {
    let bar = uncertainty.bar(condition, scalar);
    let mut sentences: Vec<String> = bar.iter().map(|bar| bar_words(bar, scalar, uncertainty.level)).collect();
    if let Scalar::NetGain(pair) = scalar {
        let left = uncertainty.conditions.get(&condition).and_then(|of| of.left_in_band[pair]);
        sentences.extend(left.map(|left| format!("residual in the band: ± {:.1} %", 100.0 * left)));
        let differences =
            uncertainty.differences.iter().filter(|of| of.pair == pair && of.conditions.contains(&condition));
        sentences.extend(differences.map(|of| of.words(uncertainty.level)));
    }
    sentences
}
