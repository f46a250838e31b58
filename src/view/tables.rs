//! The tables of the window as texts, to be copied and saved.

use gdcm_core::correction::Channel as CorrectedChannel;
use gdcm_core::dataset::{BundleKind, Pair};
use gdcm_core::fidelity::SUGGESTION_RATIO;
use gdcm_core::study::{ConditionAnalysis, Table};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;

use super::state::{State, Sureness};

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
            digits(Some(flight_state.airspeed_kt)),
            flight_state.altitude.clone().unwrap_or_default(),
            digits(flight_state.altitude_ft),
            flight_state.weight.clone().unwrap_or_default(),
            digits(flight_state.mass_kg),
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
            digits(shown.and_then(|shown| shown.score(bundle, &model.name))),
            digits(ratio),
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
        "G ± [%]",
        "G ± of identification [%]",
        "D [ms]",
        "D ± [ms]",
        "D ± of identification [ms]",
        "net gain [-]",
        "net gain ± [%]",
        "net gain ± of identification [%]",
        "net delay [ms]",
        "J before",
        "J after",
        "J_mag before",
        "J_mag after",
        "J_phase before",
        "J_phase after",
    ];
    let sure = state.sureness();
    let mut table = Table::new(title_with_bars(state, TableKind::Matrix), columns);
    for pair in state.dataset().on_axis().pairs() {
        let (output, input) = state.dataset().channel_names(pair);
        let settings = &state.study.settings;
        let flags = [state.dataset().on_axis()[pair], settings.constrained[pair], !settings.ignored[pair]].map(yes);
        let values = state.shown().map_or([None; 16], |shown| response_values(shown, sure, pair));
        table.row([output, input].into_iter().chain(flags).chain(values.map(digits)));
    }
    table
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
fn response_values(shown: &ConditionAnalysis, sure: Sureness<'_>, pair: Pair) -> [Option<f64>; 16] {
    let cost = shown.cost[pair];
    let (before, after) = (cost.map(|cost| cost.uncorrected), cost.map(|cost| cost.corrected));
    let [[gain, gain_inner], [delay, delay_inner], [net, net_inner]] =
        [Scalar::Gain(pair), shown.wanted_delay(pair), Scalar::NetGain(pair)].map(|scalar| halves(&sure, scalar));
    [
        shown.wanted_gain(pair),
        gain,
        gain_inner,
        shown.wanted_delay_s(pair).map(s_to_ms),
        delay,
        delay_inner,
        Some(shown.correction.net_gain(pair).value()),
        net,
        net_inner,
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
    let columns = [
        "side",
        "channel",
        "k [-]",
        "k ± [%]",
        "k ± of identification [%]",
        "τ [ms]",
        "τ ± [ms]",
        "τ ± of identification [ms]",
    ];
    let sure = state.sureness();
    let mut table = Table::new(title_with_bars(state, TableKind::Channels), columns);
    let correction = state.shown().map(|shown| &shown.correction);
    let (inputs, outputs) = (state.dataset().inputs(), state.dataset().outputs());
    let of_inputs = (0..inputs.len()).map(CorrectedChannel::Input);
    let of_outputs = (0..outputs.len()).map(CorrectedChannel::Output);
    for (channel, named) in of_inputs.chain(of_outputs).zip(inputs.iter().chain(outputs)) {
        let (side, gain) = match channel {
            CorrectedChannel::Input(input) => ("input", correction.map(|of| of.input_gains[input])),
            CorrectedChannel::Output(output) => ("output", correction.map(|of| of.output_gains[output])),
        };
        let delay_ms = correction.map(|of| s_to_ms(of.delay_s(channel)));
        let [half, inner] = halves(&sure, Scalar::ChannelGain(channel));
        let [delay_half, delay_inner] = halves(&sure, Scalar::ChannelDelay(channel));
        let values = [gain, half, inner, delay_ms, delay_half, delay_inner].map(digits);
        table.row([side.to_owned(), named.name.clone()].into_iter().chain(values));
    }
    table
}
