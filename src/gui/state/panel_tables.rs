//! The panels' tables (conditions, models, matrix, channels) as text, to be copied and saved.
//!
//! G and D are the *wanted* gain and delay, which would match a response (M6: docs/method.md); J is
//! the cost of its mismatch (M4). k and τ are a channel's gain and delay; the net gain of a
//! response is the product of the gains of its two channels, its net delay the sum of their delays.
//! A *held* (constrained) response has its net gain matched exactly, its delay as far as possible.
//!
//! A bundle is all physics models, or all identified models, in a condition; its representative
//! stands for it in comparisons (M5).

use gdcm_method::correction::Channel;
use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{BundleKind, Condition, Model, Pair};
use gdcm_model::number_format::full_precision;
use gdcm_model::units::s_to_ms;
use gdcm_plot::figure::all_channels;
use gdcm_words::Table;

use super::value_uncertainty::ValueUncertainty;
use super::window_state::State;

/// Table that can be copied and saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Every condition with its flight state and its open tasks.
    Conditions,
    /// Physics models in the displayed condition.
    PhysicsModels,
    /// Identified models in the displayed condition.
    IdentifiedModels,
    /// G, D and J for every response.
    Matrix,
    /// Gain and delay for every channel.
    Channels,
}

impl TableKind {
    /// Every table, in display order.
    pub const ALL: [TableKind; 5] = [
        Self::Conditions,
        Self::PhysicsModels,
        Self::IdentifiedModels,
        Self::Matrix,
        Self::Channels,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Conditions => "conditions",
            Self::PhysicsModels => "physics models",
            Self::IdentifiedModels => "identified models",
            Self::Matrix => "responses (G, D, J)",
            Self::Channels => "channel gains and delays",
        }
    }

    /// Returns the table for a bundle.
    pub fn of_bundle(bundle: BundleKind) -> Self {
        match bundle {
            BundleKind::Physics => Self::PhysicsModels,
            BundleKind::Identified => Self::IdentifiedModels,
        }
    }
}

/// Builds a table of this kind from the current state. Values have full precision; missing values
/// leave their cells empty.
pub fn table_of(state: &State, kind: TableKind) -> Table {
    match kind {
        TableKind::Conditions => conditions(state),
        TableKind::PhysicsModels => models(state, BundleKind::Physics),
        TableKind::IdentifiedModels => models(state, BundleKind::Identified),
        TableKind::Matrix => matrix(state),
        TableKind::Channels => channels(state),
    }
}

fn yes_or_no(value: bool) -> String {
    if value { "yes" } else { "no" }.to_owned()
}

/// Returns the title for a table about the displayed condition.
pub fn title(state: &State, subject: &str) -> String {
    let condition = state.condition();
    format!(
        "{}, condition {} ({}): {subject}",
        state.dataset().name(),
        condition.id(),
        condition.flight_state().name
    )
}

/// Table row: headings with their cells.
type Row = Vec<(&'static str, String)>;

/// Builds a table from rows with the same headings.
fn table_of_rows(title: String, rows: Vec<Row>) -> Table {
    let headings: Vec<&'static str> = match rows.first() {
        Some(row) => row.iter().map(|(heading, _)| *heading).collect(),
        None => Vec::new(),
    };
    let mut table = Table::new(title, headings);
    for row in rows {
        table.row(row.into_iter().map(|(_, cell)| cell));
    }
    table
}

/// Builds the condition table: flight state, and how many tasks are open.
fn conditions(state: &State) -> Table {
    let mut rows = Vec::new();
    for condition in state.dataset().conditions() {
        rows.push(condition_row(state, condition));
    }
    table_of_rows(format!("{}: conditions", state.dataset().name()), rows)
}

fn condition_row(state: &State, condition: &Condition) -> Row {
    let id = condition.id();
    let flight = condition.flight_state();
    let mut suggested = String::new();
    let mut unmatched_gains = String::new();
    let mut unmatched_delays = String::new();
    if let Some(result) = state.analysis().and_then(|analysis| analysis.condition(id)) {
        suggested = state.open_suggestions(result).len().to_string();
        unmatched_gains = result.gains.unmatched.len().to_string();
        unmatched_delays = result.delays.unmatched.len().to_string();
    }
    vec![
        ("condition", id.to_string()),
        ("name", flight.name.clone()),
        ("airspeed [kt]", full_precision(Some(flight.airspeed_kt))),
        ("altitude", flight.altitude.clone().unwrap_or_default()),
        ("altitude [ft]", full_precision(flight.altitude_ft)),
        ("weight", flight.weight.clone().unwrap_or_default()),
        ("mass [kg]", full_precision(flight.mass_kg)),
        ("scheduled", yes_or_no(state.study.choice(id).scheduled)),
        ("suggested outliers not rejected", suggested),
        ("held gains not matched", unmatched_gains),
        ("held delays not matched", unmatched_delays),
    ]
}

/// Builds the table for the models in one of the displayed condition's bundles.
fn models(state: &State, bundle: BundleKind) -> Table {
    let mut rows = Vec::new();
    for model in state.condition().bundle(bundle) {
        rows.push(model_row(state, bundle, model));
    }
    table_of_rows(title(state, TableKind::of_bundle(bundle).name()), rows)
}

fn model_row(state: &State, bundle: BundleKind, model: &Model) -> Row {
    let choice = state.study.choice(state.condition().id()).bundle(bundle);
    let mut is_representative = false;
    let mut distance = None;
    let mut ratio = None;
    if let Some(shown) = state.shown() {
        is_representative = shown.representative_name(bundle) == model.name;
        distance = shown.score(bundle, &model.name);
        if bundle == BundleKind::Physics {
            ratio = shown.discontinuity_ratio(&model.name);
        }
    }
    let suggested = match ratio {
        Some(ratio) => yes_or_no(ratio > SUGGESTION_RATIO),
        None => String::new(),
    };
    let states = match model.order() {
        Some(order) => order.to_string(),
        None => String::new(),
    };
    let is_pinned = choice.pinned.as_ref() == Some(&model.name);
    vec![
        ("model", model.name.clone()),
        ("kept", yes_or_no(!choice.rejected.contains(&model.name))),
        ("chosen as representative", yes_or_no(is_pinned)),
        ("representative", yes_or_no(is_representative)),
        ("states", states),
        ("mean distance [√J]", full_precision(distance)),
        ("discontinuity ratio", full_precision(ratio)),
        ("suggested as outlier", suggested),
    ]
}

/// Returns the title for a table with error bars: subject, condition and confidence level.
fn title_with_bars(state: &State, kind: TableKind) -> String {
    let mut subject = kind.name().to_owned();
    if let Some(level) = state.value_uncertainty().level() {
        subject.push_str(&format!(", ± at {:.0} % confidence", 100.0 * level));
    }
    title(state, &subject)
}

/// Half-widths of a value's error bar: relative \[%\], or \[ms\] for delays; `None` without a bar.
#[derive(Clone, Copy, Default)]
struct HalfWidths {
    whole: Option<f64>,
    /// Half-width due to the identification alone: the uncertainty for a fixed physics model.
    from_identification: Option<f64>,
}

impl HalfWidths {
    /// Returns the half-widths for a gain or a delay (`scalar`).
    fn new(uncertainty: &ValueUncertainty<'_>, scalar: Scalar) -> Self {
        let Some((bar, confidence_level)) = uncertainty.error_bar(scalar) else {
            return Self::default();
        };
        Self {
            whole: displayed_half(scalar, bar.half_width(confidence_level)),
            from_identification: displayed_half(scalar, bar.inner_half_width(confidence_level)),
        }
    }
}

/// Converts a half-width from a ratio to \[%\] or, for delays, from \[s\] to \[ms\].
fn displayed_half(scalar: Scalar, half: Option<f64>) -> Option<f64> {
    let half = half?;
    if scalar.is_delay() {
        Some(s_to_ms(half))
    } else {
        Some(100.0 * half)
    }
}

/// Builds the table for all responses: G, D and net gain, each with its error bar; net delay; J,
/// J_mag and J_phase before and after the correction.
fn matrix(state: &State) -> Table {
    let pairs = state.dataset().on_axis().pairs();
    let rows = pairs.map(|pair| response_row(state, pair)).collect();
    table_of_rows(title_with_bars(state, TableKind::Matrix), rows)
}

fn response_row(state: &State, pair: Pair) -> Row {
    let uncertainty = state.value_uncertainty();
    let shown = state.shown();
    let settings = &state.study.settings;
    let (output, input) = state.dataset().output_and_input_name(pair);
    let cost = shown.and_then(|shown| shown.cost[pair]);
    let before = cost.map(|cost| cost.uncorrected);
    let after = cost.map(|cost| cost.corrected);
    let gain = HalfWidths::new(&uncertainty, Scalar::Gain(pair));
    let delay = match shown {
        Some(shown) => HalfWidths::new(&uncertainty, shown.delta_delay_scalar(pair)),
        None => HalfWidths::default(),
    };
    let net_gain = HalfWidths::new(&uncertainty, Scalar::NetGain(pair));
    let delta_delay_s = shown.and_then(|shown| shown.delta_delay_s(pair));
    let values = [
        ("G [-]", shown.and_then(|shown| shown.delta_gain(pair))),
        ("G ± [%]", gain.whole),
        (
            "G ± from identification alone [%]",
            gain.from_identification,
        ),
        ("D [ms]", delta_delay_s.map(s_to_ms)),
        ("D ± [ms]", delay.whole),
        (
            "D ± from identification alone [ms]",
            delay.from_identification,
        ),
        (
            "net gain [-]",
            shown.map(|shown| shown.correction.net_gain(pair)),
        ),
        ("net gain ± [%]", net_gain.whole),
        (
            "net gain ± from identification alone [%]",
            net_gain.from_identification,
        ),
        (
            "net delay [ms]",
            shown.map(|shown| s_to_ms(shown.correction.net_delay_s(pair))),
        ),
        ("J before", before.map(|cost| cost.total())),
        ("J after", after.map(|cost| cost.total())),
        ("J_mag before", before.map(|cost| cost.magnitude)),
        ("J_mag after", after.map(|cost| cost.magnitude)),
        ("J_phase before", before.map(|cost| cost.phase)),
        ("J_phase after", after.map(|cost| cost.phase)),
    ];
    let mut row = vec![
        ("output", output.to_owned()),
        ("input", input.to_owned()),
        ("on-axis", yes_or_no(state.dataset().on_axis()[pair])),
        ("held", yes_or_no(settings.constrained[pair])),
        ("fitted", yes_or_no(!settings.ignored[pair])),
    ];
    row.extend(values.map(|(heading, value)| (heading, full_precision(value))));
    row
}

/// Builds the table for channel gains and delays with their error bars.
fn channels(state: &State) -> Table {
    let channels = all_channels(state.dataset()).into_iter();
    let rows = channels
        .map(|channel| channel_row(state, channel))
        .collect();
    table_of_rows(title_with_bars(state, TableKind::Channels), rows)
}

fn channel_row(state: &State, channel: Channel) -> Row {
    let uncertainty = state.value_uncertainty();
    let correction = state.shown().map(|shown| &shown.correction);
    let (inputs, outputs) = state.dataset().input_and_output_names();
    let side = match channel {
        Channel::Input(_) => "input",
        Channel::Output(_) => "output",
    };
    let gain = HalfWidths::new(&uncertainty, Scalar::ChannelGain(channel));
    let delay = HalfWidths::new(&uncertainty, Scalar::ChannelDelay(channel));
    let values = [
        ("k [-]", correction.map(|found| found.gain(channel))),
        ("k ± [%]", gain.whole),
        (
            "k ± from identification alone [%]",
            gain.from_identification,
        ),
        (
            "τ [ms]",
            correction.map(|found| s_to_ms(found.delay_s(channel))),
        ),
        ("τ ± [ms]", delay.whole),
        (
            "τ ± from identification alone [ms]",
            delay.from_identification,
        ),
    ];
    let mut row = vec![
        ("side", side.to_owned()),
        ("channel", channel.name(&inputs, &outputs)),
    ];
    row.extend(values.map(|(heading, value)| (heading, full_precision(value))));
    row
}
