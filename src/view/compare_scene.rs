//! Variants beside the present decisions, made of what was computed.

use gdcm_core::dataset::{ConditionId, Pair};
use gdcm_core::study::{Analysis, Table, Variant, VariantJob, decision_differences};

use super::net_gain_scene::net_gain_pairs;
use super::state::State;

/// The analyses that the comparison needs.
pub fn variant_jobs(state: &State) -> Vec<VariantJob> {
    let studies = state.study.variants.iter().filter_map(|variant| state.study.of_variant(&variant.name));
    studies.map(|study| VariantJob { study }).collect()
}

/// The analysis of a variant, where it is there.
pub fn variant_analysis<'a>(state: &'a State, variant: &Variant) -> Option<&'a Analysis> {
    let job = VariantJob { study: state.study.of_variant(&variant.name)? };
    state.results.variants.iter().find(|(known, _)| *known == job).map(|(_, analysis)| analysis.as_ref())
}

/// Every decision in which a variant differs from the present ones.
pub fn difference_table(state: &State) -> Table {
    let mut table = Table::new("What differs", ["variant", "decision", "in the variant", "now"]);
    for variant in &state.study.variants {
        let Some(study) = state.study.of_variant(&variant.name) else { continue };
        let differences = decision_differences(&study, &state.study);
        if differences.is_empty() {
            table.row([variant.name.as_str(), "nothing: the same decisions"]);
        }
        for difference in differences {
            table.row([variant.name.clone(), difference.what, difference.before, difference.after]);
        }
    }
    table
}

/// What the decisions do: net gain and J of the responses of the net-gain plots in the condition shown, and the mean change of J
/// of the scheduled correction over all conditions, now and in each variant.
pub fn figure_table(state: &State) -> Table {
    let condition = state.condition().id();
    let title = format!("What it does: condition {condition}, and the schedule over all conditions");
    let names = state.study.variants.iter().map(|variant| variant.name.clone());
    let mut table = Table::new(title, ["figure".to_owned(), "now".to_owned()].into_iter().chain(names));
    let analyses: Vec<Option<&Analysis>> = std::iter::once(state.analysis())
        .chain(state.study.variants.iter().map(|variant| variant_analysis(state, variant)))
        .collect();
    let mut row = |name: String, figure: &dyn Fn(&Analysis) -> Option<String>| {
        let cell = |analysis: &Option<&Analysis>| match analysis {
            Some(analysis) => figure(analysis).unwrap_or_else(|| "–".to_owned()),
            None => "…".to_owned(),
        };
        table.row(std::iter::once(name).chain(analyses.iter().map(cell)));
    };
    for pair in net_gain_pairs(state) {
        let name = state.dataset().pair_name(pair);
        row(format!("net gain {name}"), &|analysis| net_gain(analysis, condition, pair));
        row(format!("J {name}"), &|analysis| cost(analysis, condition, pair));
    }
    row("objective of the gains".to_owned(), &|analysis| {
        analysis.condition(condition).map(|result| format!("{:.4}", result.gains.objective))
    });
    row("mean ΔJ on-axis, scheduled".to_owned(), &|analysis| mean_change(state, analysis));
    table
}

fn net_gain(analysis: &Analysis, condition: ConditionId, pair: Pair) -> Option<String> {
    Some(format!("{:.4}", analysis.condition(condition)?.correction.net_gain(pair).value()))
}

fn cost(analysis: &Analysis, condition: ConditionId, pair: Pair) -> Option<String> {
    let cost = analysis.condition(condition)?.cost[pair]?;
    Some(format!("{:.1} → {:.1}", cost.uncorrected.total(), cost.corrected.total()))
}

/// Mean change of J of the on-axis responses of the nominal models under the schedule, over the conditions assessed.
fn mean_change(state: &State, analysis: &Analysis) -> Option<String> {
    let measuring = state.dataset().measuring_pairs();
    let changes: Vec<f64> = analysis
        .assessment
        .values()
        .filter_map(|assessed| match assessed {
            gdcm_core::study::Assessed::Nominal(changes) => Some(changes),
            gdcm_core::study::Assessed::LeftOut { .. } => None,
        })
        .flat_map(|changes| measuring.marked().filter_map(|pair| Some(changes[pair]?.total())))
        .collect();
    let mean = changes.iter().sum::<f64>() / changes.len() as f64;
    mean.is_finite().then(|| gdcm_core::units::signed(mean, 2))
}
