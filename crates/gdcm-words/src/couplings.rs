//! Sentences about couplings (diagnosis, benefit and cost, M16.4), and tables of their values
//! (M16.5).

use std::collections::BTreeMap;

use nalgebra::{Complex, DMatrix};

use gdcm_method::couplings::coupling_shares::{
    FeedbackShare, MixingShare, cyclic_inputs, feedback_shares, mixing_shares,
};
use gdcm_method::couplings::{LEAST_CONDITIONS, LoopMargin, PoleShift, Unknown};
use gdcm_model::dataset::{Channel, ConditionId, Dataset, Pair};
use gdcm_model::number_format::counted;
use gdcm_model::number_format::with_minus_sign;
use gdcm_model::units::{number, signed, telling};
use gdcm_study::results::couplings_assessment::{
    AxisCost, CouplingCost, CouplingEntry, CouplingsAssessment, UnstablePole,
};
use gdcm_study::{Analysis, CouplingCorrection};

use crate::remark::{Remark, RemarkKind};
use crate::table::Table;

/// Maximum number of entries reported per matrix; the largest come first.
const MOST_REPORTED: usize = 3;
/// Smaller shares \[-\] are not reported.
const NOTHING: f64 = 0.005;

/// Returns the remarks on the couplings of an analysis: the reason why requested couplings are
/// unavailable, or the remarks of [`coupling_remarks`]; empty if none were requested.
pub fn analysis_coupling_remarks(analysis: &Analysis) -> Vec<Remark> {
    match (analysis.asked_couplings(), &analysis.coupling_assessment) {
        (Err(why), _) => vec![no_couplings(&why)],
        (Ok(Some(_)), Some(assessment)) => coupling_remarks(assessment, &analysis.study.dataset),
        _ => Vec::new(),
    }
}

/// Returns the remark that the requested couplings are unavailable, with the reason `why`; all
/// results are then computed without couplings.
pub fn no_couplings(why: &str) -> Remark {
    Remark::trouble(
        "no-couplings",
        format!("Couplings are unavailable: {why}. All results are computed without couplings."),
    )
}

/// Interprets the largest entries, then adds the remarks of [`coupling_consequences`].
pub fn coupling_remarks(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<Remark> {
    let mut remarks: Vec<Remark> = diagnosis(assessment, dataset)
        .into_iter()
        .map(|text| Remark::good("coupling-entry", text))
        .collect();
    remarks.extend(coupling_consequences(assessment, dataset));
    remarks
}

/// Returns remarks on the benefit and the cost of the couplings, and cautions about them.
pub fn coupling_consequences(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<Remark> {
    let mut remarks = verdict(assessment);
    remarks.extend(price(assessment, dataset));
    remarks.extend(coupling_cautions(assessment, dataset));
    remarks
}

/// Interprets the largest significant entries: "LAT receives 4.7 % of LON, equivalent to a swashplate
/// phase of 2.7°"; "PED follows NY by 1.2 % per m/s²: directional stiffness that the physics model
/// does not represent correctly".
fn diagnosis(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<String> {
    let airspeed_kt = assessment.mean_airspeed_kt();
    let matrices = assessment.fitted.matrices();
    let mixing = assessment.mixing(airspeed_kt);
    let cyclic = cyclic_inputs(dataset.on_axis(), |output| {
        is_rate(&dataset.outputs()[output])
    });
    let mixed = mixing_shares(&matrices.normalised_mixing(airspeed_kt), cyclic)
        .into_iter()
        .filter(|share| {
            !mixing[(share.to, share.from)].is_within_bar && share.share.abs() >= NOTHING
        })
        .take(MOST_REPORTED);
    let mut words: Vec<String> = mixed.map(|share| mixing_words(dataset, &share)).collect();
    let feedback = assessment.feedback();
    let fed = feedback_shares(&assessment.fitted.problem, matrices)
        .into_iter()
        .filter(|share| {
            !feedback[(share.input, share.output)].is_within_bar && share.share >= NOTHING
        })
        .take(MOST_REPORTED);
    words.extend(fed.map(|share| feedback_words(dataset, &share)));
    words
}

/// Names the source of the J by which the benefit is judged: conditions left out of the fit, or the
/// schedule.
fn cost_source(assessment: &CouplingsAssessment) -> &'static str {
    if assessment.costs.left_out.is_some() {
        "conditions left out of the fit"
    } else {
        "the schedule"
    }
}

/// Compares J without and with couplings, for conditions left out of the fit or, if none was left
/// out, under the schedule. Adds a caution if the couplings are not worthwhile.
fn verdict(assessment: &CouplingsAssessment) -> Vec<Remark> {
    let cost = assessment.deciding_cost();
    let (Some(with), Some(without)) = (cost.with.others, cost.without.others) else {
        return Vec::new();
    };
    let source = cost_source(assessment);
    let couplings = assessment.couplings.name();
    let mut text = format!(
        "Off-axis J of {source} is {} without couplings and {} with {couplings}",
        telling(without, 1),
        telling(with, 1)
    );
    if let (Some(with), Some(without)) = (cost.with.on_axis, cost.without.on_axis) {
        text.push_str(&format!(
            "; on-axis J is {} and {}",
            telling(without, 1),
            telling(with, 1)
        ));
    }
    text.push('.');
    let mut remarks = vec![Remark::good("coupling-costs", text)];
    if !cost.is_worth_it() {
        remarks.push(Remark::caution(
            "couplings-not-worthwhile",
            format!(
                "Off-axis J of {source} decreases by less than a tenth with {couplings}: switch \
                the couplings off."
            ),
        ));
    }
    remarks
}

/// Returns the hint that recommends these couplings to a study that does not use them; `None` if
/// they are not worthwhile, or if no condition was left out of the fit.
pub fn coupling_offer(assessment: &CouplingsAssessment) -> Option<String> {
    let cost = assessment
        .costs
        .left_out
        .filter(CouplingCost::is_worth_it)?;
    Some(format!(
        "With {}, off-axis J of conditions left out of the fit would be {} instead of {}.",
        assessment.couplings.name(),
        telling(cost.with.others?, 1),
        telling(cost.without.others?, 1)
    ))
}

/// Describes the change in response above the band, the pole shifts within the band, and the
/// meaning of the error bars.
fn price(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<Remark> {
    let mut remarks = Vec::new();
    if let Some(text) = above_band_words(assessment, dataset) {
        remarks.push(Remark::good("change-above-band", text));
    }
    if let Some(text) = farthest_pole_words(assessment) {
        remarks.push(Remark::good("poles-moved", text));
    }
    remarks.push(Remark::good(
        "bars-under-couplings",
        "Error bars of gains, delays and leads are computed with these couplings: the couplings \
        are not fitted again when models are exchanged.",
    ));
    remarks
}

/// Describes the largest change of an on-axis response above the band.
fn above_band_words(assessment: &CouplingsAssessment, dataset: &Dataset) -> Option<String> {
    let changes = assessment.conditions.iter().filter_map(|(id, condition)| {
        let (pair, change_db) = condition.most_changed_above_band(dataset.on_axis())?;
        Some((*id, pair, change_db))
    });
    let (id, pair, change_db) = changes.max_by(|a, b| a.2.total_cmp(&b.2))?;
    if !change_db.is_finite() {
        return None;
    }
    let top = assessment.omega.last().copied().unwrap_or_default();
    Some(format!(
        "Above the band, at {} rad/s, the couplings change {} more than any other on-axis \
         response: the relative change is {} dB (condition {id}).",
        number(top),
        dataset.pair_name(pair),
        signed(change_db, 0)
    ))
}

/// Describes the pole in the band with the largest shift.
fn farthest_pole_words(assessment: &CouplingsAssessment) -> Option<String> {
    let band = assessment.band.min()..=assessment.band.max();
    let mut farthest: Option<(ConditionId, &PoleShift, f64)> = None;
    for (id, condition) in &assessment.conditions {
        for shift in condition.poles.iter().flatten() {
            let (Some(before), Some(distance)) = (shift.before, shift.distance_rad_s()) else {
                continue;
            };
            if !band.contains(&before.norm()) {
                continue;
            }
            if farthest.is_none_or(|(.., known)| distance.total_cmp(&known).is_ge()) {
                farthest = Some((*id, shift, distance));
            }
        }
    }
    let (id, shift, distance_rad_s) = farthest?;
    if distance_rad_s > 0.0 {
        Some(format!(
            "Poles within the band move by up to {} rad/s: from {} to {} (condition {id}).",
            telling(distance_rad_s, 2),
            pole_words(shift.before?),
            pole_words(shift.after)
        ))
    } else {
        None
    }
}

/// Returns the cautions to consider before couplings are used, such as newly unstable poles, a loop
/// that is close to ringing, and entries that the data do not determine.
pub fn coupling_cautions(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<Remark> {
    let mut remarks = unstable_pole_remarks(assessment);
    if let Some(text) = ringing_words(assessment) {
        remarks.push(Remark::caution("close-to-ringing", text));
    }
    let has_feedback = assessment.couplings == CouplingCorrection::MixingAndFeedback;
    if assessment.want_leads > 0 && has_feedback {
        remarks.push(Remark::caution(
            "feedback-as-lead",
            format!(
                "In {}, all held responses need lead, which no channel provides. The feedback \
            compensates for it, with large entries and large pole shifts. Correct the phase by \
            leads first.",
                counted(assessment.want_leads, "condition")
            ),
        ));
    }
    let conditions = assessment.fitted.problem.conditions.len();
    if conditions < LEAST_CONDITIONS {
        remarks.push(Remark::caution(
            "few-conditions",
            format!(
                "The couplings are fitted to {}; error bars, and J of conditions left out, \
                require three.",
                counted(conditions, "condition")
            ),
        ));
    }
    let fit = &assessment.fitted.fit;
    if let Some(text) = not_fed_back_words(dataset, &fit.not_fed_back) {
        remarks.push(Remark::caution("not-fed-back", text));
    }
    if let Some(text) = undetermined_words(dataset, &fit.undetermined) {
        remarks.push(Remark::caution("entries-undetermined", text));
    }
    remarks.extend(unknown_pole_remarks(assessment));
    if let Some(text) = partly_left_out_words(assessment) {
        remarks.push(Remark::caution("partly-left-out", text));
    }
    remarks
}

/// Lists the outputs that cannot be fed back, because their response to some input is missing in
/// every condition; `None` if there are none.
fn not_fed_back_words(dataset: &Dataset, outputs: &[usize]) -> Option<String> {
    if outputs.is_empty() {
        return None;
    }
    let names: Vec<&str> = outputs
        .iter()
        .map(|&output| dataset.outputs()[output].name.as_str())
        .collect();
    Some(format!(
        "{} cannot be fed back: the response to at least one input is missing in every condition.",
        names.join(", ")
    ))
}

/// Returns a caution for each condition whose poles could not be computed, then a caution for each
/// model to which the couplings cannot be applied.
fn unknown_pole_remarks(assessment: &CouplingsAssessment) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for (id, condition) in &assessment.conditions {
        if let Err(why) = &condition.poles {
            let text = format!("Condition {id}: the poles cannot be computed: {why}.");
            remarks.push(Remark::caution("poles-unknown", text));
        }
    }
    for (id, condition) in &assessment.conditions {
        for (model, why) in &condition.refused {
            let text = format!(
                "Condition {id}, {model}: the effect of the couplings cannot be computed: {why}."
            );
            remarks.push(Remark::caution("model-refused", text));
        }
    }
    remarks
}

/// Returns a remark on newly unstable poles of the physics representatives, then a remark on newly
/// unstable poles of the other kept physics models.
fn unstable_pole_remarks(assessment: &CouplingsAssessment) -> Vec<Remark> {
    let mut remarks = Vec::new();
    for is_representative in [true, false] {
        let poles: Vec<&UnstablePole> = assessment
            .unstable
            .iter()
            .filter(|pole| pole.is_representative == is_representative)
            .collect();
        if poles.is_empty() {
            continue;
        }
        let models = if is_representative {
            "physics representatives"
        } else {
            "other kept physics models"
        };
        let places = unstable_places(&poles);
        let text = if poles.len() == 1 {
            format!("A pole of the {models} becomes unstable with the couplings: {places}.")
        } else {
            format!(
                "{} poles of {models} become unstable with the couplings: {places}.",
                poles.len()
            )
        };
        let kind = if poles.iter().any(|pole| pole.is_in_band) {
            RemarkKind::Trouble
        } else {
            RemarkKind::Caution
        };
        remarks.push(Remark::new("newly-unstable", kind, text));
    }
    remarks
}

/// Reports how many conditions can be left out of the fit; `None` if all can.
fn partly_left_out_words(assessment: &CouplingsAssessment) -> Option<String> {
    let all = assessment.fitted.problem.conditions.len();
    let known = assessment.left_out_fits.len();
    if all < LEAST_CONDITIONS || known >= all {
        return None;
    }
    Some(format!(
        "J of conditions left out, and the error bars of the couplings, are based on {known} of \
        {all} conditions: if one of the others is left out, the couplings or the schedule cannot \
        be fitted."
    ))
}

/// Reports the minimum singular value of the loop over all conditions; `None` unless it is close to
/// ringing.
fn ringing_words(assessment: &CouplingsAssessment) -> Option<String> {
    let margins = assessment
        .conditions
        .iter()
        .filter_map(|(id, condition)| Some((*id, condition.margin?)));
    let (id, margin): (ConditionId, LoopMargin) =
        margins.min_by(|a, b| a.1.least.total_cmp(&b.1.least))?;
    if !margin.is_close_to_ringing() {
        return None;
    }
    Some(format!(
        "The loop is close to ringing at {} rad/s: the minimum singular value of I − K H is {} \
        (condition {id}).",
        telling(margin.omega_rad_s, 1),
        telling(margin.least, 2)
    ))
}

/// Returns whether the unit of a channel belongs to an angular rate.
fn is_rate(channel: &Channel) -> bool {
    ["deg/s", "rad/s", "°/s"].contains(&channel.unit.trim())
}

/// Returns whether the unit of a channel belongs to an acceleration.
fn is_acceleration(channel: &Channel) -> bool {
    matches!(
        channel.unit.trim(),
        "g" | "m/s^2" | "m/s²" | "m/s2" | "ft/s^2" | "ft/s²" | "ft/s2"
    )
}

/// Describes a mixing entry: "LAT receives 4.7 % of LON, equivalent to a swashplate phase of 2.7°".
fn mixing_words(dataset: &Dataset, mixing: &MixingShare) -> String {
    let to = &dataset.inputs()[mixing.to];
    let from = &dataset.inputs()[mixing.from];
    if to.unit != from.unit {
        return format!(
            "{} receives {} {} per {} of {}.",
            to.name,
            with_minus_sign(&telling(mixing.share, 3)),
            to.unit,
            from.unit,
            from.name
        );
    }
    let phase = match mixing.swashplate_phase_deg {
        Some(phase_deg) => format!(
            ", equivalent to a swashplate phase of {}°",
            with_minus_sign(&telling(phase_deg, 1))
        ),
        None => String::new(),
    };
    format!(
        "{} receives {} % of {}{phase}.",
        to.name,
        percent(mixing.share),
        from.name
    )
}

/// Describes a feedback entry: "PED follows NY by 1.2 % per m/s²: directional stiffness that the
/// physics model does not represent correctly".
fn feedback_words(dataset: &Dataset, feedback: &FeedbackShare) -> String {
    let input = &dataset.inputs()[feedback.input];
    let output = &dataset.outputs()[feedback.output];
    let meaning = feedback_meaning(dataset, feedback);
    // A percentage is meaningful only between channels with the same unit.
    let moved = &dataset.inputs()[feedback.moved];
    let share = if moved.unit == input.unit {
        format!("{} % of {}", percent(feedback.share), moved.name)
    } else {
        format!(
            "{} {} per {} of {}",
            telling(feedback.share, 3),
            input.unit,
            moved.unit,
            moved.name
        )
    };
    format!(
        "{} follows {} by {} {} per {}, up to {share} at {} rad/s: {meaning} that the physics \
        model does not represent correctly.",
        input.name,
        output.name,
        with_minus_sign(&telling(feedback.entry, 3)),
        input.unit,
        output.unit,
        telling(feedback.omega_rad_s, 1)
    )
}

/// Names the physical meaning of a feedback entry, derived from the unit of its output.
fn feedback_meaning(dataset: &Dataset, feedback: &FeedbackShare) -> &'static str {
    let is_on_axis = |output: usize| dataset.on_axis()[Pair::new(output, feedback.input)];
    if !is_on_axis(feedback.output) {
        return "a coupling";
    }
    let output = &dataset.outputs()[feedback.output];
    let input_has_rate = dataset
        .outputs()
        .iter()
        .enumerate()
        .any(|(index, output)| is_on_axis(index) && is_rate(output));
    if input_has_rate && is_acceleration(output) {
        "directional stiffness"
    } else if is_rate(output) {
        "damping"
    } else {
        "a coupling"
    }
}

/// Formats a share in percent.
fn percent(share: f64) -> String {
    with_minus_sign(&telling(100.0 * share, 1))
}

/// Locates unstable poles, grouped by condition: "within the band, condition 4, slow at 2
/// rad/s; condition 1, 8 models at 0.143 to 0.149 rad/s".
fn unstable_places(poles: &[&UnstablePole]) -> String {
    let mut in_band: BTreeMap<ConditionId, Vec<&UnstablePole>> = BTreeMap::new();
    let mut beyond: BTreeMap<ConditionId, Vec<&UnstablePole>> = BTreeMap::new();
    for pole in poles {
        let places = if pole.is_in_band {
            &mut in_band
        } else {
            &mut beyond
        };
        places.entry(pole.condition).or_default().push(pole);
    }
    let mut places = Vec::new();
    for (condition, poles) in &in_band {
        places.push(format!(
            "within the band, {}",
            unstable_place(*condition, poles)
        ));
    }
    for (condition, poles) in &beyond {
        places.push(unstable_place(*condition, poles));
    }
    places.join("; ")
}

/// Locates a condition's unstable poles: "condition 1, 8 models at 0.143 to 0.149 rad/s".
fn unstable_place(condition: ConditionId, poles: &[&UnstablePole]) -> String {
    let moduli: Vec<f64> = poles.iter().map(|pole| pole.pole.norm()).collect();
    let least = telling(moduli.iter().copied().fold(f64::INFINITY, f64::min), 3);
    let most = telling(moduli.iter().copied().fold(0.0, f64::max), 3);
    let models = match poles {
        poles if poles.iter().all(|pole| pole.is_representative) => String::new(),
        [pole] => format!(", {}", pole.model),
        poles => format!(", {} models", poles.len()),
    };
    let frequencies = if least == most {
        least
    } else {
        format!("{least} to {most}")
    };
    format!("condition {condition}{models} at {frequencies} rad/s")
}

/// Formats a pole: "−0.30 ± 1.20j rad/s".
fn pole_words(pole: Complex<f64>) -> String {
    let imaginary = pole.im.abs();
    let imaginary = if imaginary > 0.0 {
        format!(" ± {}j", telling(imaginary, 2))
    } else {
        String::new()
    };
    format!("{}{imaginary} rad/s", signed(pole.re, 3))
}

/// Lists the entries that the data do not determine; `None` if there are none.
fn undetermined_words(dataset: &Dataset, unknowns: &[Unknown]) -> Option<String> {
    if unknowns.is_empty() {
        return None;
    }
    let (inputs, outputs) = dataset.names_of_channels();
    let names: Vec<String> = unknowns
        .iter()
        .map(|unknown| match *unknown {
            Unknown::Mixing { to, from, .. } => format!("{} of {}", inputs[to], inputs[from]),
            Unknown::Feedback { input, output } => {
                format!("{} of {}", inputs[input], outputs[output])
            }
        })
        .collect();
    Some(format!(
        "No response determines these entries, which are left as without couplings: {}.",
        names.join(", ")
    ))
}

/// Returns the heading: "mixing and feedback fitted to 11 conditions; the normal equations of the
/// last solution are satisfied to 3e-16".
pub fn couplings_heading(assessment: &CouplingsAssessment) -> String {
    format!(
        "{} fitted to {}; the normal equations of the last solution are satisfied to {:.0e}",
        assessment.couplings.name(),
        counted(assessment.fitted.problem.conditions.len(), "condition"),
        assessment.fitted.fit.residual
    )
}

/// Tabulates J on-axis and off-axis, without and with couplings.
pub fn coupling_cost_table(assessment: &CouplingsAssessment) -> Table {
    let columns = [
        "mean J",
        "on-axis, without",
        "on-axis, with",
        "others, without",
        "others, with",
    ];
    let mut table = Table::new("", columns);
    let costs = &assessment.costs;
    let uncorrected = CouplingCost {
        without: costs.uncorrected,
        with: AxisCost::default(),
    };
    table.row(cost_cells("uncorrected", uncorrected));
    table.row(cost_cells("own correction", costs.own));
    table.row(cost_cells("scheduled", costs.scheduled));
    if let Some(left_out) = costs.left_out {
        table.row(cost_cells("condition left out", left_out));
    }
    table
}

fn cost_cells(name: &str, cost: CouplingCost) -> [String; 5] {
    let cell = |cost: Option<f64>| match cost {
        Some(cost) => format!("{cost:.1}"),
        None => "-".to_owned(),
    };
    [
        name.to_owned(),
        cell(cost.without.on_axis),
        cell(cost.with.on_axis),
        cell(cost.without.others),
        cell(cost.with.others),
    ]
}

/// Tabulates the mixing at the mean airspeed and, unless it is zero, the feedback: a row for each
/// receiving input, a column for each input or output that acts on it. An entry that does not
/// exceed its error bar is in brackets.
pub fn coupling_matrix_tables(assessment: &CouplingsAssessment, dataset: &Dataset) -> Vec<Table> {
    let airspeed_kt = assessment.mean_airspeed_kt();
    let (inputs, outputs) = dataset.names_of_channels();
    let bars = if assessment.left_out_fits.is_empty() {
        String::new()
    } else {
        format!(
            ", ± {} % error bar; entries in brackets do not exceed it",
            number(100.0 * assessment.level)
        )
    };
    let title = format!(
        "Mixing at {} kt: share of each input (column) that an input (row) receives{bars}",
        telling(airspeed_kt, 0)
    );
    let mixing = assessment.mixing(airspeed_kt);
    let mut tables = vec![matrix_table(title, &inputs, &inputs, &mixing)];
    let feedback = assessment.feedback();
    if feedback.iter().any(|entry| entry.value != 0.0) {
        let to = with_units(&inputs, dataset.inputs());
        let from = with_units(&outputs, dataset.outputs());
        let title = format!(
            "Feedback: units of an input (row) per unit of an output \
            (column){bars}"
        );
        tables.push(matrix_table(title, &to, &from, &feedback));
    }
    tables
}

/// Appends the unit of each channel to its name: "LON [%]".
fn with_units(names: &[String], channels: &[Channel]) -> Vec<String> {
    names
        .iter()
        .zip(channels)
        .map(|(name, channel)| format!("{name} [{}]", channel.unit))
        .collect()
}

fn matrix_table(
    title: String,
    to: &[String],
    from: &[String],
    entries: &DMatrix<CouplingEntry>,
) -> Table {
    let mut columns = vec!["to".to_owned()];
    columns.extend_from_slice(from);
    let mut table = Table::new(title, columns);
    for (row, name) in to.iter().enumerate() {
        let mut cells = vec![name.clone()];
        cells.extend((0..from.len()).map(|column| entry_words(&entries[(row, column)])));
        table.row(cells);
    }
    table
}

/// Formats an entry: "0.047 ± 0.011"; in brackets if it does not exceed its error bar.
fn entry_words(entry: &CouplingEntry) -> String {
    let mut text = with_minus_sign(&telling(entry.value, 3));
    if let Some(half_width) = entry.half_width
        && half_width > 0.0
    {
        text.push_str(&format!(" ± {}", telling(half_width, 3)));
    }
    if entry.is_within_bar && entry.value != 0.0 {
        format!("({text})")
    } else {
        text
    }
}

/// Tabulates the poles of each physics representative without and with couplings, largest shift
/// first.
pub fn pole_table(assessment: &CouplingsAssessment) -> Table {
    let columns = [
        "condition",
        "before [rad/s]",
        "after [rad/s]",
        "moved by [rad/s]",
    ];
    let mut table = Table::new(
        "Poles of the physics representatives, without and with couplings",
        columns,
    );
    for (id, condition) in &assessment.conditions {
        let mut shifts: Vec<&PoleShift> = condition.poles.iter().flatten().collect();
        shifts.sort_by(|a, b| {
            b.distance_rad_s()
                .unwrap_or(0.0)
                .total_cmp(&a.distance_rad_s().unwrap_or(0.0))
        });
        for shift in shifts {
            let before = match shift.before {
                Some(before) => pole_cell(before),
                None => "-".to_owned(),
            };
            let distance = match shift.distance_rad_s() {
                Some(distance_rad_s) => telling(distance_rad_s, 3),
                None => "-".to_owned(),
            };
            table.row([id.to_string(), before, pole_cell(shift.after), distance]);
        }
    }
    table
}

/// Formats a pole in a table: "−0.300 ± 1.200j".
fn pole_cell(pole: Complex<f64>) -> String {
    let imaginary = if pole.im == 0.0 {
        String::new()
    } else {
        format!(" ± {}j", telling(pole.im.abs(), 3))
    };
    format!("{}{imaginary}", with_minus_sign(&telling(pole.re, 3)))
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::dataset::DatasetHeader;

    use super::*;
    use crate::reference_tests::reference_dataset;

    #[test]
    fn a_share_of_a_stick_in_another_unit_is_no_percentage() {
        let old = reference_dataset();
        let share = FeedbackShare {
            input: 2,
            output: 5,
            entry: 0.092,
            share: 0.106,
            moved: 0,
            condition: ConditionId(1),
            omega_rad_s: 0.5,
        };
        let words = feedback_words(&old, &share);
        assert!(
            words.contains("up to 10.6 % of LON at 0.5 rad/s"),
            "{words}"
        );
        let mut inputs = old.inputs().to_vec();
        inputs[0].unit = "inch".into();
        let header = DatasetHeader {
            name: old.name().into(),
            description: String::new(),
            inputs,
            outputs: old.outputs().to_vec(),
            on_axis: old.on_axis().clone(),
            band: old.band(),
        };
        let conditions = old
            .conditions()
            .iter()
            .map(|condition| (**condition).clone())
            .collect();
        let words = feedback_words(&Dataset::new(header, conditions).unwrap(), &share);
        assert!(
            words.contains("up to 0.106 % per inch of LON at 0.5 rad/s"),
            "{words}"
        );
    }
}
