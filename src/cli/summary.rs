//! The printed summary of `gdcm analyze`.

use std::path::Path;

use gdcm_io::LoadedDataset;
use gdcm_io::files::corrections_file::RESULT_FILES;
use gdcm_io::report::assessment_sentence;
use gdcm_method::correction::delta::GainSource;
use gdcm_method::correction::leads::ChannelLeads;
use gdcm_method::correction::{ChannelCorrection, LeadPrice, Outcome};
use gdcm_method::schedule::{Schedule, ScheduleCaution, ScheduledQuantity};
use gdcm_method::uncertainty::Scalar;
use gdcm_model::dataset::{BundleKind, Condition, ConditionId, Dataset, Pair};
use gdcm_model::message_text::{sanitized, sanitized_path};
use gdcm_model::units::{number, s_to_ms, signed, six_digits};
use gdcm_study::results::assessment_table::{AssessedModel, AssessmentChoice};
use gdcm_study::results::convention_doubt::ConventionDoubt;
use gdcm_study::{
    Analysis, AssessedCorrection, AssessmentTable, ConditionAnalysis, PhaseCorrection, Study,
};
use gdcm_words::Table;
use gdcm_words::assessment::{held_out_verdict, not_assessed_text};
use gdcm_words::caution::failure_text;
use gdcm_words::condition_remarks::remarks;
use gdcm_words::convention_doubt::doubt_text;
use gdcm_words::couplings::{
    analysis_coupling_remarks, coupling_cost_table, coupling_matrix_tables, couplings_heading,
};
use gdcm_words::leads::lead_limit_words;
use gdcm_words::remark::{Remark, RemarkKind, Repeated};
use gdcm_words::schedule::delayed_channel_text;
use gdcm_words::uncertainty::{
    difference_text, differences_summary, scatter_table, second_variable_text,
};

use super::terminal::{
    by_words, detail, detail_list, indented, keep_caution, keep_coded_caution, line, of_conditions,
};

/// Returns the readable results: settings, each condition, schedule, assessment, and output files.
pub(super) fn summary(analysis: &Analysis, loaded: &LoadedDataset, out: &Path) -> String {
    let doubts = analysis.doubts.iter().map(|doubt| {
        let words = doubt_words(doubt, &analysis.study.dataset);
        keep_caution(&doubt.conditions, &words);
        line("Caution", &sanitized(&words))
    });
    let doubts: String = doubts.collect();
    let conditions = analysis
        .study
        .dataset
        .conditions()
        .iter()
        .map(|of| format!("\n{}", condition_section(analysis, of)));
    let conditions: String = conditions.collect();
    heading(analysis, loaded)
        + &doubts
        + &conditions
        + &couplings_section(analysis)
        + "\n"
        + &cautions_section(analysis)
        + &schedule_section(analysis)
        + &assessment_lines(analysis)
        + &held_out_lines(analysis)
        + &evidence_section(analysis)
        + &line(
            "Written",
            &format!("{} in {}", RESULT_FILES.join(", "), sanitized_path(out)),
        )
}

/// Describes a doubtful sign or unit of a channel, with the option that inverts the sign.
pub(super) fn doubt_words(doubt: &ConventionDoubt, dataset: &Dataset) -> String {
    let (inputs, outputs) = dataset.names_of_channels();
    let option = doubt
        .turns()
        .map(|channel| format!(" (--sign {}=-1)", channel.name(&inputs, &outputs)));
    doubt_text(doubt, dataset) + &option.unwrap_or_default()
}

fn heading(analysis: &Analysis, loaded: &LoadedDataset) -> String {
    let study = &analysis.study;
    let settings = &analysis.study.settings;
    let held: Vec<String> = settings
        .constrained
        .marked()
        .map(|pair| sanitized(&study.dataset.pair_name(pair)))
        .collect();
    let held = if held.is_empty() {
        "none".to_owned()
    } else {
        held.join(", ")
    };
    let band = format!(
        "{} to {} rad/s, {} frequencies; alpha {} (gains), {} (delays)",
        six_digits(settings.band.min()),
        six_digits(settings.band.max()),
        settings.points,
        six_digits(settings.alpha_gain),
        six_digits(settings.alpha_delay)
    );
    let dataset = format!("{}, {}", sanitized(study.dataset.name()), loaded.origin);
    let phase = match settings.phase {
        PhaseCorrection::None => "left as it is".to_owned(),
        PhaseCorrection::Delay => format!("corrected by delays; D is the {}", settings.delay_from),
        PhaseCorrection::Lead => format!(
            "corrected by a delay or a lead filter a channel: order {}, n {}, R_max {}",
            settings.lead.order.number(),
            six_digits(settings.lead.pole),
            six_digits(settings.lead.limit)
        ),
    };
    let mut text = line("Dataset", &dataset) + &line("Band", &band);
    if settings.gain_source != GainSource::default() {
        text += &line("G from", &settings.gain_source_words());
    }
    for turned in study.turned_channels() {
        let words = format!(
            "{} of {} is turned",
            sanitized(&turned.channel),
            turned.of.models()
        );
        text += &line("Sign", &words);
    }
    text + &line("Phase", &phase) + &line("Held", &held)
}

/// Returns the meaning, benefit and cost of the couplings; empty without couplings.
fn couplings_section(analysis: &Analysis) -> String {
    let said = analysis_coupling_remarks(analysis);
    if said.is_empty() {
        return String::new();
    }
    let mut text = "\n".to_owned();
    if let Some(assessment) = &analysis.coupling_assessment {
        text += &line("Couplings", &sanitized(&couplings_heading(assessment)));
        text += &indented(&coupling_cost_table(assessment), 2);
        for mut table in coupling_matrix_tables(assessment, &analysis.study.dataset) {
            let names = table.rows.iter_mut().filter_map(|row| row.first_mut());
            names
                .chain(&mut table.columns)
                .for_each(|name| *name = sanitized(name));
            text += &indented(&table, 2);
        }
    }
    for remark in &said {
        let label = match remark.kind {
            RemarkKind::Good => "couplings",
            RemarkKind::Caution | RemarkKind::Trouble => "caution",
        };
        if remark.kind != RemarkKind::Good {
            keep_caution(&[], &remark.text);
        }
        text += &detail(label, &sanitized(&remark.text));
    }
    text
}

/// Returns how far the scheduled correction improves the nominal models, and which conditions it is
/// not judged in.
fn assessment_lines(analysis: &Analysis) -> String {
    let mut text = line("Assessment", &sanitized(&assessment_sentence(analysis)));
    for left_out in
        AssessmentTable::of(analysis, usual(analysis, AssessedCorrection::Scheduled)).left_out
    {
        let words = format!(
            "condition {}: {}",
            left_out.condition,
            sanitized(&not_assessed_text(&left_out.why, &analysis.study.dataset))
        );
        text += &line("Left out", &words);
    }
    text
}

/// Returns the section of one condition: representatives, rejections, the on-axis and constrained
/// responses, and unmatched entries.
fn condition_section(analysis: &Analysis, condition: &Condition) -> String {
    let state = condition.flight_state();
    let title = format!(
        "{} ({} kt)",
        sanitized(&state.name),
        number(state.airspeed_kt)
    );
    let mut text = line(&format!("Condition {}", state.id), &title);
    match analysis.conditions.get(&condition.id()) {
        None => {}
        Some(Ok(result)) => {
            text += &model_lines(analysis, result);
            text += &indented(&response_table(analysis, result), 2);
            text += &channel_lines(analysis, result);
            text += &trouble_lines(analysis, result);
        }
        Some(Err(failure)) => text.push_str(&detail(
            "no result",
            &sanitized(&failure_text(failure, &analysis.study.dataset)),
        )),
    }
    text
}

fn model_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let id = result.condition.id();
    let rejected: Vec<String> = analysis
        .study
        .rejected_names(id)
        .into_iter()
        .map(sanitized)
        .collect();
    let is_rejected = |name: &String| analysis.study.choice(id).physics.rejected.contains(name);
    let suggested = result
        .suggested()
        .into_iter()
        .filter(|name| !is_rejected(name));
    let suggested: Vec<String> = suggested.map(|name| sanitized(&name)).collect();
    let mut text = detail(
        "physics",
        &sanitized(result.representative_name(BundleKind::Physics)),
    );
    text += &detail(
        "identified",
        &sanitized(result.representative_name(BundleKind::Identified)),
    );
    text += &detail_list("rejected", &rejected);
    if !suggested.is_empty() {
        text += &detail_list("outliers?", &suggested);
    }
    text
}

/// Returns the responses in tables: the on-axis ones, which rate a model, and the constrained ones.
fn shown_pairs(study: &Study) -> impl Iterator<Item = Pair> {
    let measuring = study.dataset.measuring_pairs();
    let shown = measuring.map(|pair, measures| *measures || study.settings.constrained[pair]);
    shown.marked().collect::<Vec<_>>().into_iter()
}

fn response_table(analysis: &Analysis, result: &ConditionAnalysis) -> Table {
    let columns = [
        "response",
        "held",
        "G",
        "± %",
        "net gain",
        "± %",
        "D [ms]",
        "± ms",
        "net delay [ms]",
        "J before",
        "J after",
    ];
    let price = result
        .compensated
        .as_ref()
        .and_then(|compensated| LeadPrice::of(&compensated.leads));
    let mut table = Table::new(
        "",
        columns
            .map(str::to_owned)
            .into_iter()
            .chain(price.as_ref().map(price_heading)),
    );
    let dataset = &analysis.study.dataset;
    let half = |scalar: Scalar, factor: f64| {
        let uncertainty = analysis.uncertainty.as_ref()?;
        Some(
            factor
                * uncertainty
                    .bar(result.condition.id(), scalar)?
                    .half_width(uncertainty.level)?,
        )
    };
    for pair in shown_pairs(&analysis.study) {
        let cost = result.cost[pair];
        let cells = [
            sanitized(&dataset.pair_name(pair)),
            if result.held()[pair] { "yes" } else { "no" }.to_owned(),
            value(result.wanted_gain(pair), 3),
            value(half(Scalar::Gain(pair), 100.0), 1),
            value(Some(result.correction.net_gain(pair)), 3),
            value(half(Scalar::NetGain(pair), 100.0), 1),
            value(result.wanted_delay_s(pair).map(s_to_ms), 1),
            value(half(result.wanted_delay(pair), 1e3), 1),
            value(Some(s_to_ms(result.correction.net_delay_s(pair))), 1),
            value(cost.map(|cost| cost.uncorrected.total()), 1),
            value(cost.map(|cost| cost.corrected.total()), 1),
        ];
        let price_db = price
            .as_ref()
            .map(|price| signed(price.of_pair_db(pair), 1));
        table.row(cells.into_iter().chain(price_db));
    }
    table
}

/// Returns the column heading for the amplification by leads above the band.
fn price_heading(price: &LeadPrice) -> String {
    format!("dB at {} rad/s", number(price.above_rad_s()))
}

fn value(value: Option<f64>, digits: usize) -> String {
    // Adding zero turns a rounded minus zero into zero.
    let rounded = |value: f64| {
        (value * 10_f64.powi(digits as i32)).round() / 10_f64.powi(digits as i32) + 0.0
    };
    value.map_or("-".to_owned(), |value| match value.abs() {
        ..1e7 => format!("{:.digits$}", rounded(value)),
        _ => format!("{value:.digits$e}"),
    })
}

fn channel_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let dataset = &analysis.study.dataset;
    let correction = &result.correction;
    if let Some(compensated) = &result.compensated {
        return indented(&lead_table(dataset, correction, &compensated.leads), 2);
    }
    let channels = || {
        dataset
            .inputs()
            .iter()
            .chain(dataset.outputs())
            .map(|channel| sanitized(&channel.name))
    };
    let gains = correction
        .input_gains
        .iter()
        .chain(&correction.output_gains);
    let gains: Vec<String> = channels()
        .zip(gains)
        .map(|(name, gain)| format!("{name} {}", value(Some(*gain), 3)))
        .collect();
    let delays_s = correction.signed_delays_s();
    let delays = channels()
        .zip(delays_s.iter())
        .filter_map(|(name, (_, delay))| {
            let words = value(Some(s_to_ms(*delay)), 1);
            (words != "0.0").then(|| format!("{name} {words} ms"))
        });
    detail_list("gains", &gains) + &detail_list("delays", &delays.collect::<Vec<_>>())
}

/// Returns a table of the gain and the delay or lead of each channel, with the servos that its
/// filter is equivalent to: as if the first were replaced by the second (M15).
fn lead_table(dataset: &Dataset, correction: &ChannelCorrection, leads: &ChannelLeads) -> Table {
    let columns = [
        "channel",
        "k",
        "delay/lead [ms]",
        "servo of [rad/s]",
        "replaced by",
    ];
    let price = LeadPrice::of(leads);
    let mut table = Table::new(
        "",
        columns
            .map(str::to_owned)
            .into_iter()
            .chain(price.as_ref().map(price_heading)),
    );
    let (inputs, outputs) = dataset.names_of_channels();
    for (channel, delay_s) in correction.signed_delays_s().iter() {
        let filter = leads.filters()[channel];
        let cells = [
            sanitized(&channel.name(&inputs, &outputs)),
            value(Some(correction.gain(channel)), 3),
            value(Some(s_to_ms(*delay_s)), 1),
            value(filter.map(|filter| filter.zero_rad_s()), 0),
            value(filter.map(|filter| filter.lag_rad_s()), 0),
        ];
        let price_db = price
            .as_ref()
            .map(|price| filter.map_or("-".to_owned(), |_| signed(price.gains_db[channel], 1)));
        table.row(cells.into_iter().chain(price_db));
    }
    table
}

/// Returns the cautions common to most conditions as one table with one sentence each, and every
/// other caution once with its conditions.
fn cautions_section(analysis: &Analysis) -> String {
    let mut rows = Vec::new();
    let mut others = Vec::new();
    for result in analysis
        .study
        .dataset
        .conditions()
        .iter()
        .filter_map(|of| analysis.condition(of.id()))
    {
        let id = result.condition.id();
        let said = remarks(&analysis.study, result, None);
        // Doubts about signs and units are printed above all conditions.
        let cautions = said
            .into_iter()
            .skip(result.doubts.len())
            .filter(|of| of.kind == RemarkKind::Caution);
        let (repeated, rest): (Vec<Remark>, Vec<Remark>) =
            cautions.partition(|of| of.repeated.is_some());
        rows.extend((!repeated.is_empty()).then_some((id, repeated)));
        others.extend(
            rest.into_iter()
                .map(|of| of.text)
                .chain(lead_limit_words(result))
                .map(|text| (id, text)),
        );
    }
    let text = match &rows[..] {
        [] => String::new(),
        // For a single condition a sentence suffices.
        [(id, alone)] if alone.len() == 1 => {
            others.insert(0, (*id, alone[0].text.clone()));
            String::new()
        }
        rows => repeated_table(analysis, rows),
    };
    by_words(others)
        .into_iter()
        .fold(text, |text, (conditions, words)| {
            keep_caution(&conditions, &words);
            text + &line("Caution", &sanitized(&of_conditions(&conditions, &words)))
        })
}

/// Returns a table with a row for each condition, a column for each response that needs lead or
/// moves away from flight, and columns for other repeated remarks.
fn repeated_table(analysis: &Analysis, rows: &[(ConditionId, Vec<Remark>)]) -> String {
    let dataset = &analysis.study.dataset;
    let all = || {
        rows.iter()
            .flat_map(|(_, row)| row)
            .filter_map(|of| of.repeated.as_ref())
    };
    let is_farther =
        |of: &Repeated, pair: Pair| matches!(of, Repeated::Farther(pairs) if pairs.contains(&pair));
    let lead_ms = |of: &Repeated, pair: Pair| match of {
        Repeated::NeedsLead(needed) => needed
            .iter()
            .find(|(at, _)| *at == pair)
            .map(|(_, lead_ms)| lead_ms.clone()),
        _ => None,
    };
    let is_told =
        |pair: &Pair| all().any(|of| is_farther(of, *pair) || lead_ms(of, *pair).is_some());
    let pairs: Vec<Pair> = dataset.on_axis().pairs().filter(is_told).collect();
    let mut sentences = Vec::new();
    if all().any(|of| matches!(of, Repeated::NeedsLead(_))) {
        sentences.push("held responses need lead [ms], because the physics model lags, which a delay cannot give");
    }
    if all().any(|of| matches!(of, Repeated::Farther(_))) {
        sentences.push("* is farther from flight (larger J) than without a correction");
    }
    let columns: Vec<&(&str, &str, CellOf)> = REPEATED
        .iter()
        .filter(|(.., cell)| all().any(|of| cell(of, dataset).is_some()))
        .collect();
    sentences.extend(columns.iter().map(|(_, sentence, _)| *sentence));
    let headings = std::iter::once("condition".to_owned())
        .chain(pairs.iter().map(|pair| dataset.pair_name(*pair)));
    let mut table = Table::new(
        "",
        headings.chain(columns.iter().map(|(heading, ..)| (*heading).to_owned())),
    );
    for (id, row) in rows {
        let row = || row.iter().filter_map(|of| of.repeated.as_ref());
        let or_none = |cell: Option<String>| cell.unwrap_or_else(|| "-".to_owned());
        let of_pair = |pair: &Pair| {
            let lead = or_none(row().find_map(|of| lead_ms(of, *pair)));
            if row().any(|of| is_farther(of, *pair)) {
                format!("{lead} *")
            } else {
                lead
            }
        };
        let others = columns
            .iter()
            .map(|(.., cell)| or_none(row().find_map(|of| cell(of, dataset))));
        table.row(
            std::iter::once(id.to_string())
                .chain(pairs.iter().map(of_pair))
                .chain(others),
        );
    }
    let conditions: Vec<ConditionId> = rows.iter().map(|(id, _)| *id).collect();
    let sentence = sentences.join("; ");
    keep_caution(&conditions, &sentence);
    line("Cautions", &format!("{sentence}:")) + &indented(&table, 2)
}

/// Returns the cell of a repeated remark, if it belongs in the column.
type CellOf = fn(&Repeated, &Dataset) -> Option<String>;

/// Columns for repeated remarks: heading, sentence, cell.
const REPEATED: [(&str, &str, CellOf); 3] = [
    (
        "all",
        "where all want about the same lead (column all [ms]), check first the time alignment of the records, the simulation's \
         integration and sampling delay, then servo and sensor models: a common lag is better taken out where it arises than corrected",
        |of, _| {
            if let Repeated::CommonLead(lead_ms) = of {
                Some(lead_ms.clone())
            } else {
                None
            }
        },
    ),
    (
        "gain",
        "column gain [dB] is what the lead filters raise the gain within the band by at most, which the gains take back",
        |of, dataset| match of {
            Repeated::RaisedGain(most_db, pair) => {
                Some(format!("{most_db} ({})", dataset.pair_name(*pair)))
            }
            _ => None,
        },
    ),
    (
        "J with leads",
        "the last column is the mean J of the held responses, and what it would be with a delay or lead in each channel",
        |of, _| match of {
            Repeated::LeadsOffered([without, with]) => Some(format!("{without} → {with}")),
            _ => None,
        },
    ),
];

/// Lists the unmatched entries with reasons, and the unproven results.
fn trouble_lines(analysis: &Analysis, result: &ConditionAnalysis) -> String {
    let said = remarks(&analysis.study, result, None);
    // Doubts about signs and units are printed above all conditions; cautions are collected in
    // their own section.
    let troubles = said
        .iter()
        .skip(result.doubts.len())
        .filter(|remark| remark.kind == RemarkKind::Trouble);
    // The unmatched entries come first, then the reasons and remedies.
    let labels = std::iter::once("not matched").chain(std::iter::repeat("why"));
    let lines = labels
        .zip(troubles)
        .map(|(label, remark)| detail(label, &sanitized(&remark.text)));
    let mut text: String = lines.collect();
    if matches!(result.gains.proof.outcome, Outcome::NotProven { .. }) {
        text += &detail(
            "not proven",
            &sanitized(&result.gains.proof.outcome.words()),
        );
    }
    text
}

/// Returns the scheduled net gains of the on-axis and constrained responses over airspeed.
fn schedule_section(analysis: &Analysis) -> String {
    let schedule = match &analysis.schedule {
        Ok(schedule) => schedule,
        Err(error) => return line("Schedule", &error.to_string()),
    };
    let of = match schedule.settings.quantity {
        ScheduledQuantity::LnGain => "ln k",
        ScheduledQuantity::Gain => "k",
    };
    let kind = match schedule.degree() {
        Some(degree) => format!("polynomial of degree {degree} in airspeed, fitted to {of}"),
        None => format!("lookup table in airspeed, of {of}"),
    };
    let range = format!(
        "{} to {} kt",
        number(schedule.airspeeds.min_kt),
        number(schedule.airspeeds.max_kt)
    );
    let second = schedule.second.as_ref().map_or_else(String::new, |term| {
        format!(
            "; with {}, here in the middle of its range, {} {}",
            term.variable,
            number(term.middle()),
            term.variable.unit()
        )
    });
    let mut text = line("Schedule", &format!("{kind}, {range}{second}; net gains:"));
    let (inputs, outputs) = analysis.study.dataset.names_of_channels();
    for caution in &schedule.cautions {
        let words = caution.words(&inputs, &outputs);
        if let ScheduleCaution::CostsMore(cost) = caution {
            keep_coded_caution(Some(caution.code()), &[cost.condition], &words);
        }
        text += &detail("caution", &sanitized(&words));
    }
    for delayed in analysis.unscheduled_delays() {
        text += &detail(
            "left out",
            &sanitized(&delayed_channel_text(&delayed, &analysis.study.dataset)),
        );
    }
    text += &schedule_table(analysis, schedule, |correction, pair| {
        value(Some(correction.net_gain(pair)), 3)
    });
    if schedule.has_delays() {
        text += &line("", "net delays in ms:");
        text += &schedule_table(analysis, schedule, |correction, pair| {
            value(Some(s_to_ms(correction.net_delay_s(pair))), 1)
        });
    }
    text
}

fn schedule_table(
    analysis: &Analysis,
    schedule: &Schedule,
    entry: impl Fn(&ChannelCorrection, Pair) -> String,
) -> String {
    /// Displayed airspeeds as fractions of the range: the ends, the middle, and the quarters.
    const SHOWN: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
    let dataset = &analysis.study.dataset;
    let min = schedule.airspeeds.min_kt;
    let max = schedule.airspeeds.max_kt;
    let at = SHOWN.map(|fraction| min + fraction * (max - min));
    let heading = at.map(|airspeed| format!("{} kt", value(Some(airspeed), 0)));
    let mut table = Table::new("", std::iter::once("response".to_owned()).chain(heading));
    let corrections = at.map(|airspeed| schedule.at(airspeed));
    for pair in shown_pairs(&analysis.study) {
        let entries = corrections.iter().map(|correction| entry(correction, pair));
        table.row(std::iter::once(sanitized(&dataset.pair_name(pair))).chain(entries));
    }
    indented(&table, 2)
}

/// Returns the sources of the scatter, the differences at equal airspeed, and the second variables;
/// empty if the error bars were not computed.
fn evidence_section(analysis: &Analysis) -> String {
    let Some(uncertainty) = &analysis.uncertainty else {
        return String::new();
    };
    let pair_name = |pair| sanitized(&analysis.study.dataset.pair_name(pair));
    let level = 100.0 * uncertainty.level;
    let mut text = line(
        "Scatter",
        "of the on-axis net gains, and what trim and identification uncertainty explain of it:",
    );
    let table = Table {
        title: String::new(),
        ..scatter_table(&analysis.study.dataset, uncertainty)
    };
    text += &indented(&table, 2);
    let significant = uncertainty
        .differences
        .iter()
        .filter(|difference| difference.is_significant(uncertainty.level));
    let words = format!(
        "{} (error bars of {level:.0} %, Holm)",
        differences_summary(uncertainty).trim_end_matches('.')
    );
    text += &line("Differences", &words);
    for difference in significant {
        let words = format!(
            "{}: {}",
            pair_name(difference.pair),
            difference_text(difference, uncertainty.level)
        );
        text += &detail("", &words);
    }
    if let Some(variable) = analysis.study.settings.schedule.second {
        let tests = uncertainty
            .second_variables
            .iter()
            .filter(|test| test.variable == variable);
        if !tests.clone().any(|test| test.needed) {
            let words = format!(
                "the schedule is one of airspeed and {variable}, though no response is found to need it"
            );
            text += &line("Caution", &words);
        }
    }
    for test in uncertainty
        .second_variables
        .iter()
        .filter(|test| test.needed)
    {
        text += &line(
            "Schedule",
            &format!("{}: {}", pair_name(test.pair), second_variable_text(test)),
        );
    }
    text
}

/// Returns the results of the schedule for the held-out conditions.
fn held_out_lines(analysis: &Analysis) -> String {
    let verdict = held_out_verdict(analysis, usual(analysis, AssessedCorrection::Scheduled));
    verdict.map_or_else(String::new, |words| line("Held out", &words))
}

/// Returns the change of J of each condition's nominal model under the schedule made from the other
/// conditions.
pub(super) fn leave_one_out_section(analysis: &Analysis) -> String {
    let [seen, unseen] = [
        AssessedCorrection::Scheduled,
        AssessedCorrection::ScheduleOfOthers,
    ]
    .map(|correction| AssessmentTable::of(analysis, usual(analysis, correction)));
    let measuring: Vec<_> = analysis.study.dataset.measuring_pairs().marked().collect();
    let text = line(
        "Left out",
        "change of J of each condition under the schedule of the others, on-axis mean:",
    );
    let mut table = Table::new("", ["condition", "kt", "schedule of all", "of the others"]);
    for condition in &unseen.conditions {
        let id = condition.condition;
        let mean = |table: &AssessmentTable| {
            let changes = measuring
                .iter()
                .filter_map(|&pair| Some(table.change(id, pair)?.total()));
            let changes: Vec<f64> = changes.collect();
            (!changes.is_empty()).then(|| changes.iter().sum::<f64>() / changes.len() as f64)
        };
        let airspeed = value(Some(condition.airspeed_kt), 0);
        table.row([
            id.to_string(),
            airspeed,
            value(mean(&seen), 1),
            value(mean(&unseen), 1),
        ]);
    }
    let mut text = text + &indented(&table, 2);
    for left_out in &unseen.left_out {
        text += &detail(
            "",
            &format!(
                "condition {}: {}",
                left_out.condition,
                sanitized(&not_assessed_text(&left_out.why, &analysis.study.dataset))
            ),
        );
    }
    if analysis.fitted_couplings().is_some() {
        let words = "the couplings here are those of all conditions; J with couplings found without each stands under Couplings";
        text += &detail("", words);
    }
    text
}

fn usual(analysis: &Analysis, correction: AssessedCorrection) -> AssessmentChoice {
    let average = analysis.study.settings.cost_average;
    AssessmentChoice {
        model: AssessedModel::Nominal,
        correction,
        average,
    }
}
