//! The tables of the window as texts, to be copied and saved.

use std::sync::Arc;

use gdcm_core::correction::Channel as CorrectedChannel;
use gdcm_core::dataset::{BundleKind, Channel, Condition, Model, Pair};
use gdcm_core::fidelity::SUGGESTION_RATIO;
use gdcm_core::study::{ConditionAnalysis, Table};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;

use super::{State, Sureness};

/// A table of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Every condition with its flight state and what is still to do there.
    Conditions,
    /// The physics models of the condition shown.
    PhysicsModels,
    /// Its identified models.
    IdentifiedModels,
    /// G, D and J of every response.
    Matrix,
    /// Gain and delay of every channel.
    Channels,
}

impl TableKind {
    /// Every table, in the order of the window.
    pub const ALL: [TableKind; 5] =
        [Self::Conditions, Self::PhysicsModels, Self::IdentifiedModels, Self::Matrix, Self::Channels];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Conditions => "conditions",
            Self::PhysicsModels => "physics models",
            Self::IdentifiedModels => "identified models",
            Self::Matrix => "responses (G, D, J)",
            Self::Channels => "channel gains and delays",
        }
    }

    /// The table of bundle models.
    pub fn of_bundle(bundle: BundleKind) -> Self {
        match bundle {
            BundleKind::Physics => Self::PhysicsModels,
            BundleKind::Identified => Self::IdentifiedModels,
        }
    }
}

/// The table as it is now. Numbers have every digit; those that are not known are empty.
pub fn table_of(state: &State, kind: TableKind) -> Table {
    match kind {
        TableKind::Conditions => conditions(state),
        TableKind::PhysicsModels => models(state, BundleKind::Physics),
        TableKind::IdentifiedModels => models(state, BundleKind::Identified),
        TableKind::Matrix => matrix(state),
        TableKind::Channels => channels(state),
    }
}

/// A number with every digit; nothing where there is none.
fn digits(value: Option<f64>) -> String {
    // Debug writes an exponent where Display would write hundreds of zeros.
    value.filter(|value| value.is_finite()).map_or(String::new(), |value| format!("{value:?}"))
}

fn yes(is_so: bool) -> String {
    if is_so { "yes" } else { "no" }.to_owned()
}

fn title(state: &State, what: &str) -> String {
    let condition = state.condition();
    format!("{}, condition {} ({}): {what}", state.dataset().name(), condition.id(), condition.flight_state().name)
}

/// A row of a table: each heading with what stands below it.
type Row = Vec<(&'static str, String)>;

/// A table of rows that have the same headings.
fn table_of_rows(title: String, rows: Vec<Row>) -> Table {
    let headings = rows.first().map(|row| row.iter().map(|(heading, _)| *heading).collect::<Vec<_>>());
    let mut table = Table::new(title, headings.unwrap_or_default());
    for row in rows {
        table.row(row.into_iter().map(|(_, cell)| cell));
    }
    table
}

fn conditions(state: &State) -> Table {
    let row = |condition: &Arc<Condition>| {
        let (id, flight) = (condition.id(), condition.flight_state());
        let result = state.analysis().and_then(|analysis| analysis.condition(id));
        let count =
            |of: &dyn Fn(&ConditionAnalysis) -> usize| result.map_or(String::new(), |result| of(result).to_string());
        vec![
            ("condition", id.to_string()),
            ("name", flight.name.clone()),
            ("airspeed [kt]", digits(Some(flight.airspeed_kt))),
            ("altitude", flight.altitude.clone().unwrap_or_default()),
            ("altitude [ft]", digits(flight.altitude_ft)),
            ("weight", flight.weight.clone().unwrap_or_default()),
            ("mass [kg]", digits(flight.mass_kg)),
            ("scheduled", yes(state.study.choice(id).scheduled)),
            ("suggested outliers not rejected", count(&|result| state.open_suggestions(result).len())),
            ("held gains not matched", count(&|result| result.gains.unmatched.len())),
            ("held delays not matched", count(&|result| result.delays.unmatched.len())),
        ]
    };
    let rows = state.dataset().conditions().iter().map(row).collect();
    table_of_rows(format!("{}: conditions", state.dataset().name()), rows)
}

fn models(state: &State, bundle: BundleKind) -> Table {
    let (condition, shown) = (state.condition(), state.shown());
    let choice = state.study.choice(condition.id()).bundle(bundle);
    let row = |model: &Model| {
        let ratio = shown.filter(|_| bundle == BundleKind::Physics);
        let ratio = ratio.and_then(|shown| shown.discontinuity_ratio(&model.name));
        let is_representative = shown.is_some_and(|shown| shown.representative_name(bundle) == model.name);
        vec![
            ("model", model.name.clone()),
            ("kept", yes(!choice.rejected.contains(&model.name))),
            ("chosen as representative", yes(choice.pinned.as_ref() == Some(&model.name))),
            ("representative", yes(is_representative)),
            ("states", model.order().map_or(String::new(), |order| order.to_string())),
            ("mean distance [√J]", digits(shown.and_then(|shown| shown.score(bundle, &model.name)))),
            ("discontinuity ratio", digits(ratio)),
            ("suggested", ratio.map_or(String::new(), |ratio| yes(ratio > SUGGESTION_RATIO))),
        ]
    };
    let rows = condition.bundle(bundle).iter().map(row).collect();
    table_of_rows(title(state, TableKind::of_bundle(bundle).name()), rows)
}

/// What a table is of, with the level of its bars.
fn title_with_bars(state: &State, kind: TableKind) -> String {
    let level = state.sureness().level().map(|level| format!(", ± of {:.0} %", 100.0 * level));
    title(state, &format!("{}{}", kind.name(), level.unwrap_or_default()))
}

/// Half-width of the bar of a value, and of its inner bar, "for this physics model": \[%\], of delays \[ms\].
fn halves(sure: &Sureness<'_>, scalar: Scalar) -> [Option<f64>; 2] {
    let Some((bar, level)) = sure.bar(scalar) else { return [None; 2] };
    let shown = |half: f64| if scalar.is_delay() { s_to_ms(half) } else { 100.0 * half };
    [bar.half_width(level), bar.inner_half_width(level)].map(|half| half.map(shown))
}

/// G, D, net gain, each with its bars, net delay, and J, J_mag and J_phase before and after.
fn matrix(state: &State) -> Table {
    let (sure, shown, settings) = (state.sureness(), state.shown(), &state.study.settings);
    let row = |pair: Pair| {
        let (output, input) = state.dataset().channel_names(pair);
        let cost = shown.and_then(|shown| shown.cost[pair]);
        let (before, after) = (cost.map(|cost| cost.uncorrected), cost.map(|cost| cost.corrected));
        let [gain, gain_inner] = halves(&sure, Scalar::Gain(pair));
        let [delay, delay_inner] = shown.map_or([None; 2], |shown| halves(&sure, shown.wanted_delay(pair)));
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
            ("D [ms]", shown.and_then(|shown| shown.wanted_delay_s(pair)).map(s_to_ms)),
            ("D ± [ms]", delay),
            ("D ± of identification [ms]", delay_inner),
            ("net gain [-]", shown.map(|shown| shown.correction.net_gain(pair))),
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
        words.into_iter().chain(values.map(|(heading, value)| (heading, digits(value)))).collect()
    };
    table_of_rows(title_with_bars(state, TableKind::Matrix), state.dataset().on_axis().pairs().map(row).collect())
}

fn channels(state: &State) -> Table {
    let (sure, correction) = (state.sureness(), state.shown().map(|shown| &shown.correction));
    let row = |(channel, named): (CorrectedChannel, &Channel)| {
        let (side, gain) = match channel {
            CorrectedChannel::Input(input) => ("input", correction.map(|of| of.input_gains[input])),
            CorrectedChannel::Output(output) => ("output", correction.map(|of| of.output_gains[output])),
        };
        let [half, inner] = halves(&sure, Scalar::ChannelGain(channel));
        let [delay_half, delay_inner] = halves(&sure, Scalar::ChannelDelay(channel));
        let values = [
            ("k [-]", gain),
            ("k ± [%]", half),
            ("k ± of identification [%]", inner),
            ("τ [ms]", correction.map(|of| s_to_ms(of.delay_s(channel)))),
            ("τ ± [ms]", delay_half),
            ("τ ± of identification [ms]", delay_inner),
        ];
        let words = [("side", side.to_owned()), ("channel", named.name.clone())];
        words.into_iter().chain(values.map(|(heading, value)| (heading, digits(value)))).collect()
    };
    let (inputs, outputs) = (state.dataset().inputs(), state.dataset().outputs());
    let of_inputs = (0..inputs.len()).map(CorrectedChannel::Input);
    let channels = of_inputs.chain((0..outputs.len()).map(CorrectedChannel::Output));
    let rows = channels.zip(inputs.iter().chain(outputs)).map(row).collect();
    table_of_rows(title_with_bars(state, TableKind::Channels), rows)
}
