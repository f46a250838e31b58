//! `assessment.csv`: a row for each condition and response.
//!
//! `G` and `D` are the gain and the delay by which the identified representative differs from the
//! physics representative (M6), together its *delta*; `J` is the mismatch of the nominal model with
//! the identified representative (M4). A *held* response is constrained to its G and D; a
//! *held-out* condition is assessed, but not used to fit the schedule. A condition's *own*
//! correction is its own optimum. Error bars have a component due to the choice of the physics
//! model, that is, to its trim, and one due to the identification (M13).

use std::collections::BTreeSet;
use std::io::{self, Write};

use gdcm_method::schedule::CostChange;
use gdcm_method::uncertainty::{Bar, Scalar};
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::number_format::full_precision;
use gdcm_study::Analysis;
use gdcm_words::assessment::not_assessed_text;

use super::csv_condition::{ConditionResults, condition_results};
use crate::csv_text::write_records;

/// A row: one response in one condition.
struct ResponseRow<'a> {
    results: &'a ConditionResults<'a>,
    pair: Pair,
}

/// Column name, with the function that formats its cell.
type ResponseColumn = (&'static str, fn(&ResponseRow<'_>) -> String);

const RESPONSE_COLUMNS: [ResponseColumn; 36] = [
    ("condition", |row| row.results.condition.id().to_string()),
    ("airspeed_kt", |row| {
        row.results.condition.flight_state().airspeed_kt.to_string()
    }),
    ("output", |row| {
        row.results.analysis.study.dataset.outputs()[row.pair.output]
            .name
            .clone()
    }),
    ("input", |row| {
        row.results.analysis.study.dataset.inputs()[row.pair.input]
            .name
            .clone()
    }),
    ("on_axis", |row| {
        row.results.analysis.study.dataset.on_axis()[row.pair].to_string()
    }),
    ("held", |row| {
        row.results
            .result()
            .is_some_and(|result| result.held()[row.pair])
            .to_string()
    }),
    ("G", |row| {
        full_precision(
            row.results
                .result()
                .and_then(|result| result.delta_gain(row.pair)),
        )
    }),
    ("D_s", |row| {
        full_precision(
            row.results
                .result()
                .and_then(|result| result.comparison.delta.delay_s[row.pair]),
        )
    }),
    ("net_gain", |row| {
        full_precision(row.results.own().map(|own| own.net_gain(row.pair)))
    }),
    ("net_delay_s", |row| {
        full_precision(row.results.own().map(|own| own.net_delay_s(row.pair)))
    }),
    ("scheduled_net_gain", |row| {
        full_precision(
            row.results
                .scheduled
                .as_ref()
                .map(|scheduled| scheduled.net_gain(row.pair)),
        )
    }),
    ("scheduled_net_delay_s", |row| {
        full_precision(
            row.results
                .scheduled
                .as_ref()
                .map(|scheduled| scheduled.net_delay_s(row.pair)),
        )
    }),
    ("J_mag_uncorrected", |row| {
        full_precision(row.change().map(|change| change.uncorrected.magnitude))
    }),
    ("J_phase_uncorrected", |row| {
        full_precision(row.change().map(|change| change.uncorrected.phase))
    }),
    ("J_mag_scheduled", |row| {
        full_precision(row.change().map(|change| change.corrected.magnitude))
    }),
    ("J_phase_scheduled", |row| {
        full_precision(row.change().map(|change| change.corrected.phase))
    }),
    ("dJ_mag", |row| {
        full_precision(row.change().map(|change| change.magnitude()))
    }),
    ("dJ_phase", |row| {
        full_precision(row.change().map(|change| change.phase()))
    }),
    ("dJ", |row| {
        full_precision(row.change().map(|change| change.total()))
    }),
    ("left_out", |row| row.left_out()),
    ("D_band_s", |row| {
        full_precision(
            row.results
                .result()
                .and_then(|result| result.comparison.delta.band_delay_s[row.pair]),
        )
    }),
    ("held_out", |row| {
        row.results
            .analysis
            .study
            .choice(row.results.condition.id())
            .held_out
            .to_string()
    }),
    ("G_low", |row| row.results.lower_end(Scalar::Gain(row.pair))),
    ("G_high", |row| {
        row.results.upper_end(Scalar::Gain(row.pair))
    }),
    ("D_low_s", |row| {
        row.results.lower_end(Scalar::Delay(row.pair))
    }),
    ("D_high_s", |row| {
        row.results.upper_end(Scalar::Delay(row.pair))
    }),
    ("net_gain_low", |row| {
        row.results.lower_end(Scalar::NetGain(row.pair))
    }),
    ("net_gain_high", |row| {
        row.results.upper_end(Scalar::NetGain(row.pair))
    }),
    ("u_net_gain_physics", |row| {
        row.results
            .deviation(Scalar::NetGain(row.pair), |bar| bar.trim)
    }),
    ("u_net_gain_identification", |row| {
        row.results
            .deviation(Scalar::NetGain(row.pair), |bar| bar.identification)
    }),
    ("degrees_of_freedom", |row| {
        full_precision(
            row.results
                .bar(Scalar::NetGain(row.pair))
                .and_then(Bar::degrees_of_freedom),
        )
    }),
    ("left_in_band", |row| full_precision(row.left_in_band())),
    ("D_band_low_s", |row| {
        row.results.lower_end(Scalar::BandDelay(row.pair))
    }),
    ("D_band_high_s", |row| {
        row.results.upper_end(Scalar::BandDelay(row.pair))
    }),
    ("gain_above_band_db", |row| {
        full_precision(row.results.price().map(|price| price.of_pair_db(row.pair)))
    }),
    ("not_valid_above_rad_s", |row| {
        full_precision(row.results.price().map(|price| price.limit_rad_s))
    }),
];

/// Writes `assessment.csv`: G, D \[s\], net gains, and the nominal model's J with and without the
/// scheduled correction, for every response in the chosen conditions. A missing value is an empty
/// cell. `left_out` gives the reason why a condition is not assessed, `D_band_s` is the band delay
/// (M15.2), and the columns `…_low` and `…_high` contain confidence intervals. The last two columns
/// contain the gain that the condition's own leads add to the response at ten times the band's
/// upper end, and the frequency above which they make the model invalid (M15.6).
pub fn write_assessment_csv(
    analysis: &Analysis,
    chosen: &BTreeSet<ConditionId>,
    file: &mut dyn Write,
) -> io::Result<()> {
    let mut records = vec![RESPONSE_COLUMNS.map(|(name, _)| name.to_owned())];
    for results in &condition_results(analysis, chosen) {
        for pair in analysis.study.dataset.on_axis().pairs() {
            let row = ResponseRow { results, pair };
            records.push(RESPONSE_COLUMNS.map(|(_, cell)| cell(&row)));
        }
    }
    write_records(file, records.into_iter())
}

impl ResponseRow<'_> {
    /// Returns the change in J that is due to the schedule; `None` if the condition or the response
    /// is not assessed.
    fn change(&self) -> Option<CostChange> {
        let id = self.results.condition.id();
        let changes = self.results.analysis.assessment.get(&id)?;
        changes.as_ref().ok()?[self.pair]
    }

    /// Returns the reason why the condition is not assessed; empty if it is assessed.
    fn left_out(&self) -> String {
        let id = self.results.condition.id();
        match self.results.analysis.assessment.get(&id) {
            Some(Err(why)) => not_assessed_text(why, &self.results.analysis.study.dataset),
            _ => String::new(),
        }
    }

    /// Returns the half-width of the range of `ln |H_ref / H_sim|` over the frequency band, where
    /// `H_ref` is the identified and `H_sim` the physics representative: the mismatch that remains
    /// because a single gain cannot match every frequency. `None` without error bars.
    fn left_in_band(&self) -> Option<f64> {
        let uncertainty = self.results.analysis.uncertainty.as_ref()?;
        let id = self.results.condition.id();
        uncertainty.conditions.get(&id)?.left_in_band[self.pair]
    }
}
