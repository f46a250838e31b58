//! Sentences and tables about uncertainty in the results (M13).
//!
//! An error bar has two parts: *trim*, the spread over the physics models at other trims, and
//! *identification*, the spread over the identified models or their own standard errors. *Scatter*
//! is the variation of a net gain over the conditions; *unexplained* is its part beyond the error
//! bars. The *residual in the band* is the spread over frequency of the gain that would be needed:
//! a constant gain leaves it. Holm's correction raises probabilities for the number of tests.
//!
//! Gains are compared as logarithms, so that a standard deviation of 0.01 is 1 %.

use gdcm_method::uncertainty::bar::BarRemark;
use gdcm_method::uncertainty::{Bar, Scalar, VarianceDecomposition};
use gdcm_model::dataset::Dataset;
use gdcm_model::number_format::NO_VALUE;
use gdcm_model::units::signed;
use gdcm_study::Analysis;
use gdcm_study::results::uncertainty::{AirspeedDifference, SecondVariableTest, Uncertainty};

use crate::table::Table;

/// Returns the remarks on an error bar in words.
pub fn bar_remark_texts(bar: &Bar) -> Vec<&'static str> {
    bar.remarks().into_iter().map(bar_remark_text).collect()
}

fn bar_remark_text(remark: BarRemark) -> &'static str {
    match remark {
        BarRemark::NoTrim => "uncertainty of the trim not included",
        BarRemark::NoIdentification => "uncertainty of the identification not included",
        BarRemark::NoSpread => "the bundle has no spread",
        BarRemark::FromCoherence => "identification part from the coherence",
        BarRemark::FromModelBand => "identification part from the model's confidence band",
    }
}

/// Returns the verdict on a difference at equal airspeed, at a confidence level.
pub fn difference_verdict(difference: &AirspeedDifference, level: f64) -> &'static str {
    // Without a spread of the bundles, a difference has no test.
    if difference.p_holm.is_none() {
        "no spread"
    } else if difference.is_significant(level) {
        "significant: a physical effect, or a model-form error"
    } else {
        "not significant"
    }
}

/// Describes a difference: "conditions 3 and 5 (45 kt) differ by 13 %, 5.4 times the difference
/// expected from trim and identification uncertainty; significant: a physical effect, or a
/// model-form error".
pub fn difference_text(difference: &AirspeedDifference, level: f64) -> String {
    let [first, second] = difference.conditions;
    let airspeed_kt = difference.airspeed_kt;
    let percent = 100.0 * difference.difference.delta.abs();
    let differ =
        format!("conditions {first} and {second} ({airspeed_kt:.0} kt) differ by {percent:.0} %");
    let Some(ratio) = difference.difference.ratio() else {
        return format!("{differ}; their bundles have no spread to compare the difference with");
    };
    format!(
        "{differ}, {ratio:.1} times the difference expected from trim and identification \
        uncertainty; {}",
        difference_verdict(difference, level)
    )
}

/// Summarises the differences at equal airspeed in a sentence.
pub fn differences_summary(uncertainty: &Uncertainty) -> String {
    let compared = uncertainty.differences.len();
    let significant = uncertainty
        .differences
        .iter()
        .filter(|difference| difference.is_significant(uncertainty.level))
        .count();
    match (compared, significant, uncertainty.too_many_differences) {
        (0, _, None) => "No two conditions with error bars have equal airspeeds.".to_owned(),
        (0, _, Some(count)) => {
            format!(
                "{count} differences between net gains at equal airspeed are too many to compare."
            )
        }
        (1, 0, _) => {
            "The only difference between net gains at equal airspeed is not significant.".to_owned()
        }
        (_, 0, _) => format!(
            "None of the {compared} differences between net gains at equal airspeed is significant."
        ),
        (_, significant, _) => format!(
            "Significant differences between net gains at equal airspeed: {significant} of {compared}."
        ),
    }
}

/// Describes the test for a second variable: "net gain −7.2 % from the lowest to the highest
/// altitude, which is not needed in the schedule; an effect below ± 6.1 % could not have been
/// detected"; or the reason why it could not be tested.
pub fn second_variable_text(test: &SecondVariableTest) -> String {
    let variable = test.variable.name();
    let effect = match &test.effect {
        Ok(effect) => effect,
        Err(error) => return format!("{variable}: {error}"),
    };
    let percent = 100.0 * effect.effect;
    let detectable = 100.0 * effect.detectable;
    let sign = if percent < 0.0 { "−" } else { "+" };
    format!(
        "net gain {sign}{:.1} % from the lowest to the highest {variable}, which is {} in the \
        schedule; an effect below ± {detectable:.1} % could not have been detected",
        percent.abs(),
        verdict_on_need(test)
    )
}

/// Returns the verdict on a second variable.
fn verdict_on_need(test: &SecondVariableTest) -> &'static str {
    if test.needed { "needed" } else { "not needed" }
}

/// Formats a value with this many decimals; a missing value becomes [`NO_VALUE`].
fn cell(figure: Option<f64>, decimals: usize) -> String {
    match figure {
        Some(figure) => format!("{figure:.decimals$}"),
        None => NO_VALUE.to_owned(),
    }
}

/// Formats a logarithm's standard deviation in percent.
fn percent(deviation: Option<f64>) -> String {
    cell(deviation.map(|deviation| 100.0 * deviation), 1)
}

fn probability(p: Option<f64>) -> String {
    match p {
        None => NO_VALUE.to_owned(),
        Some(p) if p < 0.001 => "< 0.001".to_owned(),
        Some(p) => format!("{p:.3}"),
    }
}

/// Tabulates the differences in net gain at equal airspeed, in descending order of their ratio to
/// the expected difference; also returns the differences in row order.
pub fn difference_table(
    dataset: &Dataset,
    uncertainty: &Uncertainty,
) -> (Table, Vec<AirspeedDifference>) {
    let columns = [
        "response",
        "conditions",
        "airspeed [kt]",
        "difference [%]",
        "× expected",
        "Holm p",
        "verdict",
    ];
    let mut table = Table::new("Differences at equal airspeed", columns);
    let mut differences = uncertainty.differences.clone();
    let ratio = |difference: &AirspeedDifference| difference.difference.ratio().unwrap_or_default();
    differences.sort_by(|a, b| ratio(b).total_cmp(&ratio(a)));
    for difference in &differences {
        let [first, second] = difference.conditions;
        table.row([
            dataset.pair_name(difference.pair),
            format!("{first} and {second}"),
            format!("{:.0}", difference.airspeed_kt),
            signed(100.0 * difference.difference.delta, 1),
            cell(difference.difference.ratio(), 1),
            probability(difference.p_holm),
            difference_verdict(difference, uncertainty.level).to_owned(),
        ]);
    }
    (table, differences)
}

/// Tabulates whether the schedule needs a second variable, with the smallest detectable effect.
pub fn second_variable_table(dataset: &Dataset, uncertainty: &Uncertainty) -> Table {
    let columns = [
        "response",
        "variable",
        "effect [%]",
        "detectable from ± [%]",
        "Holm p",
        "leave-one-out error without [%]",
        "leave-one-out error with [%]",
        "verdict",
    ];
    let mut table = Table::new("Does the schedule need a second variable?", columns);
    for test in &uncertainty.second_variables {
        let mut cells = vec![
            dataset.pair_name(test.pair),
            test.variable.name().to_owned(),
        ];
        match &test.effect {
            Err(error) => {
                cells.extend([NO_VALUE; 5].map(str::to_owned));
                cells.push(error.to_string());
            }
            Ok(effect) => cells.extend([
                signed(100.0 * effect.effect, 1),
                percent(Some(effect.detectable)),
                probability(test.p_holm),
                percent(effect.left_out_without),
                percent(effect.left_out_with),
                verdict_on_need(test).to_owned(),
            ]),
        }
        table.row(cells);
    }
    table
}

/// Tabulates the scatter components for each on-axis net gain.
pub fn scatter_table(dataset: &Dataset, uncertainty: &Uncertainty) -> Table {
    let columns = [
        "response",
        "scatter about",
        "scatter [%]",
        "trim [%]",
        "identification [%]",
        "unexplained [%]",
        "interval [%]",
        "× expected",
    ];
    let mut table = Table::new(
        "Contributions to the scatter of the net gains, as standard deviations",
        columns,
    );
    let deviation = |variance: f64| percent(Some(variance.sqrt()));
    for scatter in &uncertainty.scatter {
        for (about, decomposition) in [
            ("equal airspeed", &scatter.same_airspeed),
            ("the schedule", &scatter.about_schedule),
        ] {
            let Some(decomposition) = decomposition else {
                continue;
            };
            table.row([
                dataset.pair_name(scatter.pair),
                about.to_owned(),
                deviation(decomposition.scatter),
                deviation(decomposition.trim),
                deviation(decomposition.identification),
                deviation(decomposition.unexplained()),
                interval(decomposition, uncertainty.level),
                cell(decomposition.ratio(), 1),
            ]);
        }
    }
    table
}

/// Formats the unexplained component's interval: "1.2 to 5.6".
fn interval(decomposition: &VarianceDecomposition, level: f64) -> String {
    match decomposition.unexplained_interval(level) {
        Some([low, high]) => format!("{} to {}", percent(Some(low)), percent(Some(high))),
        None => NO_VALUE.to_owned(),
    }
}

/// Tabulates every condition's on-axis net gains (all net gains, if no response is on-axis) with
/// their error bars.
pub fn bar_table(analysis: &Analysis, uncertainty: &Uncertainty) -> Table {
    let level = format!("± [%] at {:.0} %", 100.0 * uncertainty.level);
    let columns = [
        "condition",
        "response",
        "net gain",
        &level,
        "trim, standard deviation [%]",
        "identification, standard deviation [%]",
        "residual in the band [%]",
        "remarks",
    ];
    let mut table = Table::new("Error bars of the net gains", columns);
    let dataset = &analysis.study.dataset;
    for (id, condition) in &uncertainty.conditions {
        for pair in dataset.measuring_pairs().marked() {
            let Some(bar) = &condition.bars[Scalar::NetGain(pair)] else {
                continue;
            };
            table.row([
                id.to_string(),
                dataset.pair_name(pair),
                format!("{:.3}", bar.value.exp()),
                percent(bar.half_width(uncertainty.level)),
                percent(bar.trim.map(|part| part.variance.sqrt())),
                percent(bar.identification.map(|part| part.variance.sqrt())),
                percent(condition.left_in_band[pair]),
                bar_remark_texts(bar).join(", "),
            ]);
        }
    }
    table
}
