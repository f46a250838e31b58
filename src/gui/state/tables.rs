//! Tables of the window as text, to be copied and saved.

use std::sync::Arc;

use gdcm_method::correction::Channel;
use gdcm_method::fidelity::SUGGESTION_RATIO;
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{BundleKind, Condition, Model, Pair};
use gdcm_model::units::s_to_ms;
use gdcm_plot::figure::all_channels;
use gdcm_study::ConditionAnalysis;
use gdcm_words::Table;

use super::results::Sureness;
use super::window_state::State;

/// Table of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Every condition with its flight state and its open tasks.
    Conditions,
    /// Physics models of the displayed condition.
    PhysicsModels,
    /// Identified models of the displayed condition.
    IdentifiedModels,
    /// G, D and J of every response.
    Matrix,
    /// Gain and delay of every channel.
    Channels,
}

impl TableKind {
    /// Every table, in the order of the window.
    pub const ALL: [TableKind; 5] = [
        Self::Conditions,
        Self::PhysicsModels,
        Self::IdentifiedModels,
        Self::Matrix,
        Self::Channels,
    ];

    /// Returns the title of the table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Conditions => "conditions",
            Self::PhysicsModels => "physics models",
            Self::IdentifiedModels => "identified models",
            Self::Matrix => "responses (G, D, J)",
            Self::Channels => "channel gains and delays",
        }
    }

    /// Returns the table of a bundle's models.
    pub fn of_bundle(bundle: BundleKind) -> Self {
        match bundle {
            BundleKind::Physics => Self::PhysicsModels,
            BundleKind::Identified => Self::IdentifiedModels,
        }
    }
}

/// Builds the current table. Numbers have full precision; unknown numbers are empty.
pub fn table_of(state: &State, kind: TableKind) -> Table {
    match kind {
        TableKind::Conditions => conditions(state),
        TableKind::PhysicsModels => models(state, BundleKind::Physics),
        TableKind::IdentifiedModels => models(state, BundleKind::Identified),
        TableKind::Matrix => matrix(state),
        TableKind::Channels => channels(state),
    }
}

/// Formats a number with full precision; empty for `None`.
fn digits(value: Option<f64>) -> String {
    // Debug writes an exponent where Display would write hundreds of zeros.
    value
        .filter(|value| value.is_finite())
        .map_or(String::new(), |value| format!("{value:?}"))
}

fn yes(is_so: bool) -> String {
    if is_so { "yes" } else { "no" }.to_owned()
}

pub fn title(state: &State, what: &str) -> String {
    let condition = state.condition();
    format!(
        "{}, condition {} ({}): {what}",
        state.dataset().name(),
        condition.id(),
        condition.flight_state().name
    )
}

/// Row of a table: headings with their cells.
type Row = Vec<(&'static str, String)>;

/// Builds a table from rows with the same headings.
fn table_of_rows(title: String, rows: Vec<Row>) -> Table {
    let headings = rows
        .first()
        .map(|row| row.iter().map(|(heading, _)| *heading).collect::<Vec<_>>());
    let mut table = Table::new(title, headings.unwrap_or_default());
    for row in rows {
        table.row(row.into_iter().map(|(_, cell)| cell));
    }
    table
}

fn conditions(state: &State) -> Table {
    let row = |condition: &Arc<Condition>| {
        let id = condition.id();
        let flight = condition.flight_state();
        let result = state.analysis().and_then(|analysis| analysis.condition(id));
        let count = |of: &dyn Fn(&ConditionAnalysis) -> usize| {
            result.map_or(String::new(), |result| of(result).to_string())
        };
        vec![
            ("condition", id.to_string()),
            ("name", flight.name.clone()),
            ("airspeed [kt]", digits(Some(flight.airspeed_kt))),
            ("altitude", flight.altitude.clone().unwrap_or_default()),
            ("altitude [ft]", digits(flight.altitude_ft)),
            ("weight", flight.weight.clone().unwrap_or_default()),
            ("mass [kg]", digits(flight.mass_kg)),
            ("scheduled", yes(state.study.choice(id).scheduled)),
            (
                "suggested outliers not rejected",
                count(&|result| state.open_suggestions(result).len()),
            ),
            (
                "held gains not matched",
                count(&|result| result.gains.unmatched.len()),
            ),
            (
                "held delays not matched",
                count(&|result| result.delays.unmatched.len()),
            ),
        ]
    };
    let rows = state.dataset().conditions().iter().map(row).collect();
    table_of_rows(format!("{}: conditions", state.dataset().name()), rows)
}

fn models(state: &State, bundle: BundleKind) -> Table {
    let condition = state.condition();
    let shown = state.shown();
    let choice = state.study.choice(condition.id()).bundle(bundle);
    let row = |model: &Model| {
        let ratio = shown.filter(|_| bundle == BundleKind::Physics);
        let ratio = ratio.and_then(|shown| shown.discontinuity_ratio(&model.name));
        let is_representative =
            shown.is_some_and(|shown| shown.representative_name(bundle) == model.name);
        vec![
            ("model", model.name.clone()),
            ("kept", yes(!choice.rejected.contains(&model.name))),
            (
                "chosen as representative",
                yes(choice.pinned.as_ref() == Some(&model.name)),
            ),
            ("representative", yes(is_representative)),
            (
                "states",
                model
                    .order()
                    .map_or(String::new(), |order| order.to_string()),
            ),
            (
                "mean distance [√J]",
                digits(shown.and_then(|shown| shown.score(bundle, &model.name))),
            ),
            ("discontinuity ratio", digits(ratio)),
            (
                "suggested",
                ratio.map_or(String::new(), |ratio| yes(ratio > SUGGESTION_RATIO)),
            ),
        ]
    };
    let rows = condition.bundle(bundle).iter().map(row).collect();
    table_of_rows(title(state, TableKind::of_bundle(bundle).name()), rows)
}

/// Returns the title with the condition and the confidence level.
fn title_with_bars(state: &State, kind: TableKind) -> String {
    let level = state
        .sureness()
        .level()
        .map(|level| format!(", ± of {:.0} %", 100.0 * level));
    title(
        state,
        &format!("{}{}", kind.name(), level.unwrap_or_default()),
    )
}

/// Returns the half-widths of a value's error bar and of its inner bar, "for this physics model":
/// \[%\], for delays \[ms\].
fn halves(sure: &Sureness<'_>, scalar: Scalar) -> [Option<f64>; 2] {
    let Some((bar, level)) = sure.bar(scalar) else {
        return [None; 2];
    };
    let shown = |half: f64| {
        if scalar.is_delay() {
            s_to_ms(half)
        } else {
            100.0 * half
        }
    };
    [bar.half_width(level), bar.inner_half_width(level)].map(|half| half.map(shown))
}

/// Builds the table of G, D, net gain, each with error bars, net delay, and J, J_mag and J_phase
/// before and after.
fn matrix(state: &State) -> Table {
    let sure = state.sureness();
    let shown = state.shown();
    let settings = &state.study.settings;
    let row = |pair: Pair| {
        let (output, input) = state.dataset().channel_names(pair);
        let cost = shown.and_then(|shown| shown.cost[pair]);
        let before = cost.map(|cost| cost.uncorrected);
        let after = cost.map(|cost| cost.corrected);
        let [gain, gain_inner] = halves(&sure, Scalar::Gain(pair));
        let [delay, delay_inner] =
            shown.map_or([None; 2], |shown| halves(&sure, shown.wanted_delay(pair)));
        let [net, net_inner] = halves(&sure, Scalar::NetGain(pair));
        let net_delay = shown.map(|shown| s_to_ms(shown.correction.net_delay_s(pair)));
        let words = [
            ("output", output.to_owned()),
            ("input", input.to_owned()),
            ("on-axis", yes(state.dataset().on_axis()[pair])),
            ("held", yes(settings.constrained[pair])),
            ("fitted", yes(!settings.ignored[pair])),
        ];
        let values = [
            ("G [-]", shown.and_then(|shown| shown.wanted_gain(pair))),
            ("G ± [%]", gain),
            ("G ± of identification [%]", gain_inner),
            (
                "D [ms]",
                shown
                    .and_then(|shown| shown.wanted_delay_s(pair))
                    .map(s_to_ms),
            ),
            ("D ± [ms]", delay),
            ("D ± of identification [ms]", delay_inner),
            (
                "net gain [-]",
                shown.map(|shown| shown.correction.net_gain(pair)),
            ),
            ("net gain ± [%]", net),
            ("net gain ± of identification [%]", net_inner),
            ("net delay [ms]", net_delay),
            ("J before", before.map(|cost| cost.total())),
            ("J after", after.map(|cost| cost.total())),
            ("J_mag before", before.map(|cost| cost.magnitude)),
            ("J_mag after", after.map(|cost| cost.magnitude)),
            ("J_phase before", before.map(|cost| cost.phase)),
            ("J_phase after", after.map(|cost| cost.phase)),
        ];
        words
            .into_iter()
            .chain(values.map(|(heading, value)| (heading, digits(value))))
            .collect()
    };
    table_of_rows(
        title_with_bars(state, TableKind::Matrix),
        state.dataset().on_axis().pairs().map(row).collect(),
    )
}

fn channels(state: &State) -> Table {
    let sure = state.sureness();
    let correction = state.shown().map(|shown| &shown.correction);
    let (inputs, outputs) = state.dataset().names_of_channels();
    let row = |channel: Channel| {
        let side = if matches!(channel, Channel::Input(_)) {
            "input"
        } else {
            "output"
        };
        let [half, inner] = halves(&sure, Scalar::ChannelGain(channel));
        let [delay_half, delay_inner] = halves(&sure, Scalar::ChannelDelay(channel));
        let values = [
            ("k [-]", correction.map(|of| of.gain(channel))),
            ("k ± [%]", half),
            ("k ± of identification [%]", inner),
            ("τ [ms]", correction.map(|of| s_to_ms(of.delay_s(channel)))),
            ("τ ± [ms]", delay_half),
            ("τ ± of identification [ms]", delay_inner),
        ];
        let words = [
            ("side", side.to_owned()),
            ("channel", channel.name(&inputs, &outputs)),
        ];
        words
            .into_iter()
            .chain(values.map(|(heading, value)| (heading, digits(value))))
            .collect()
    };
    let rows = all_channels(state.dataset()).into_iter().map(row).collect();
    table_of_rows(title_with_bars(state, TableKind::Channels), rows)
}
