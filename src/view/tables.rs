//! The tables of the window as texts, to be copied and saved.

use crate::dataset::{BundleKind, Channel, Pair};
use crate::fidelity::SUGGESTION_RATIO;
use crate::study::{ConditionAnalysis, Table};
use crate::units::s_to_ms;

use super::state::State;

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

/// The table as it is now. Figures have every digit; those that are not known are empty.
pub fn table_of(state: &State, kind: TableKind) -> Table {
    match kind {
        TableKind::Conditions => conditions(state),
        TableKind::PhysicsModels => models(state, BundleKind::Physics),
        TableKind::IdentifiedModels => models(state, BundleKind::Identified),
        TableKind::Matrix => matrix(state),
        TableKind::Channels => channels(state),
    }
}

/// A figure with every digit; nothing where there is none.
fn figure(value: Option<f64>) -> String {
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

fn conditions(state: &State) -> Table {
    let mut table = Table::new(
        format!("{}: conditions", state.dataset().name()),
        [
            "condition",
            "name",
            "airspeed [kt]",
            "altitude",
            "altitude [ft]",
            "weight",
            "mass [kg]",
            "scheduled",
            "suggested outliers not rejected",
            "held gains not matched",
            "held delays not matched",
        ],
    );
    for condition in state.dataset().conditions() {
        let (id, flight_state) = (condition.id(), condition.flight_state());
        let choice = state.study.choice(id);
        let result = state.analysis().and_then(|analysis| analysis.condition(id));
        let count = |of: fn(&ConditionAnalysis) -> usize| result.map_or(String::new(), |result| of(result).to_string());
        let suggested = result.map_or(String::new(), |result| {
            let open = result.suggested().into_iter().filter(|model| !choice.physics.rejected.contains(model));
            open.count().to_string()
        });
        table.row([
            id.to_string(),
            flight_state.name.clone(),
            figure(Some(flight_state.airspeed_kt)),
            flight_state.altitude.clone().unwrap_or_default(),
            figure(flight_state.altitude_ft),
            flight_state.weight.clone().unwrap_or_default(),
            figure(flight_state.mass_kg),
            yes(choice.scheduled),
            suggested,
            count(|result| result.gains.unmatched.len()),
            count(|result| result.delays.unmatched.len()),
        ]);
    }
    table
}

fn models(state: &State, bundle: BundleKind) -> Table {
    let columns =
        ["model", "kept", "pinned", "represents", "states", "mean distance [√J]", "discontinuity ratio", "suggested"];
    let mut table = Table::new(title(state, TableKind::of_bundle(bundle).name()), columns);
    let (condition, shown) = (state.condition(), state.shown());
    let choice = state.study.choice(condition.id()).bundle(bundle);
    for model in condition.bundle(bundle) {
        let ratio = match bundle {
            BundleKind::Physics => shown.and_then(|shown| shown.discontinuity_ratio(&model.name)),
            BundleKind::Identified => None,
        };
        table.row([
            model.name.clone(),
            yes(!choice.rejected.contains(&model.name)),
            yes(choice.pinned.as_ref() == Some(&model.name)),
            yes(shown.is_some_and(|shown| shown.representative_name(bundle) == model.name)),
            model.order().map_or(String::new(), |order| order.to_string()),
            figure(shown.and_then(|shown| shown.score(bundle, &model.name))),
            figure(ratio),
            ratio.map_or(String::new(), |ratio| yes(ratio > SUGGESTION_RATIO)),
        ]);
    }
    table
}

fn matrix(state: &State) -> Table {
    let columns = [
        "output",
        "input",
        "on-axis",
        "held",
        "fitted",
        "G [-]",
        "D [ms]",
        "net gain [-]",
        "net delay [ms]",
        "J before",
        "J after",
        "J_mag before",
        "J_mag after",
        "J_phase before",
        "J_phase after",
    ];
    let mut table = Table::new(title(state, TableKind::Matrix.name()), columns);
    for pair in state.dataset().on_axis().pairs() {
        let (output, input) = state.dataset().channel_names(pair);
        let settings = &state.study.settings;
        let flags = [state.dataset().on_axis()[pair], settings.constrained[pair], settings.fitted[pair]].map(yes);
        let figures = state.shown().map_or([None; 10], |shown| response_figures(shown, pair));
        table.row([output, input].into_iter().chain(flags).chain(figures.map(figure)));
    }
    table
}

/// G, D, net gain, net delay, and J, J_mag and J_phase before and after.
fn response_figures(shown: &ConditionAnalysis, pair: Pair) -> [Option<f64>; 10] {
    let cost = shown.cost[pair];
    let (before, after) = (cost.map(|cost| cost.uncorrected), cost.map(|cost| cost.corrected));
    [
        shown.wanted_gain(pair),
        shown.wanted_delay_s(pair).map(s_to_ms),
        Some(shown.correction.net_gain(pair).value()),
        Some(s_to_ms(shown.correction.net_delay(pair).value_s())),
        before.map(|cost| cost.total()),
        after.map(|cost| cost.total()),
        before.map(|cost| cost.magnitude),
        after.map(|cost| cost.magnitude),
        before.map(|cost| cost.phase),
        after.map(|cost| cost.phase),
    ]
}

fn channels(state: &State) -> Table {
    let mut table = Table::new(title(state, TableKind::Channels.name()), ["side", "channel", "k [-]", "τ [ms]"]);
    let correction = state.shown().map(|shown| &shown.correction);
    let mut add = |side: &str, channels: &[Channel], gains: Option<&Vec<f64>>, delays_s: Option<&[f64]>| {
        for (index, channel) in channels.iter().enumerate() {
            let gain = gains.map(|gains| gains[index]);
            let delay_ms = delays_s.map(|delays_s| s_to_ms(delays_s[index]));
            table.row([side.to_owned(), channel.name.clone(), figure(gain), figure(delay_ms)]);
        }
    };
    let (inputs, outputs) = (state.dataset().inputs(), state.dataset().outputs());
    let delays_s = correction.map(|of| of.signed_delays_s());
    add("input", inputs, correction.map(|of| &of.input_gains), delays_s.map(|[inputs_s, _]| inputs_s));
    add("output", outputs, correction.map(|of| &of.output_gains), delays_s.map(|[_, outputs_s]| outputs_s));
    table
}
