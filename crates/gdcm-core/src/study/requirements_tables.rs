//! What a qualification asks, as tables, and the job that finds it beside the live answer (M17).

use std::sync::Arc;

use crate::dataset::{ConditionId, Dataset};
use crate::executor::Executor;
use crate::requirements::{BandwidthRule, ModeVerdict, NamedBy};
use crate::units::{s_to_ms, telling};

use super::{
    Analysis, BandwidthFinding, Cancelled, Execution, Job, KnownPoles, MissingFinding, ModeNumbers, Progress,
    RequirementRole, RequirementSettings, Requirements, SummaryFinding, Table, TimeHistories, Uncertainty,
    requirements_of,
};

/// What a qualification asks of an analysis, with its error bars where they are known.
#[derive(Clone, Debug)]
pub struct RequirementsJob {
    /// The analysis.
    pub analysis: Arc<Analysis>,
    /// How sure its values are.
    pub uncertainty: Option<Arc<Uncertainty>>,
    /// What is asked with, which an analysis does not depend on.
    pub settings: Arc<RequirementSettings>,
    /// What was identified of conditions.
    pub known: KnownPoles,
}

impl PartialEq for RequirementsJob {
    fn eq(&self, other: &Self) -> bool {
        let same_bars = match (&self.uncertainty, &other.uncertainty) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (None, None) => true,
            _ => false,
        };
        let same_analysis = Arc::ptr_eq(&self.analysis, &other.analysis);
        same_analysis && same_bars && self.settings == other.settings && self.known == other.known
    }
}

impl Job for RequirementsJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    type Output = Arc<Requirements>;

    fn run(&self, executor: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let analysis = Analysis { uncertainty: self.uncertainty.clone(), ..self.analysis.asked_with(&self.settings) };
        let execution = Execution::new(executor.as_ref(), progress, analysis.conditions.len());
        Ok(Arc::new(requirements_of(&analysis, &self.known, &execution)?))
    }
}

/// Heading of the modulus of a pole.
const MODULUS: &str = "|\u{3bb}| [rad/s]";

fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}").replace('-', "\u{2212}"))
}

/// Modulus, damping ratio and period of a mode; dashes where there is none.
fn mode_cells(of: Option<&ModeNumbers>) -> [String; 3] {
    [
        cell(of.map(|of| of.pole_real_rad_s.hypot(of.pole_imaginary_rad_s)), 2),
        cell(of.and_then(|of| of.values.damping_ratio), 2),
        cell(of.and_then(|of| of.values.period_s), 1),
    ]
}

impl Requirements {
    /// Bandwidth and phase delay of every on-axis response of every condition and model, with what has to be known of each.
    pub fn bandwidth_table(&self, dataset: &Dataset) -> Table {
        let columns = [
            "condition",
            "airspeed [kt]",
            "response",
            "model",
            "ω_BW [rad/s]",
            "ω_phase [rad/s]",
            "ω_gain [rad/s]",
            "ω180 [rad/s]",
            "τ_p [ms]",
            "remark",
        ];
        let mut table = Table::new("Bandwidth and phase delay of the attitudes", columns);
        for of in &self.bandwidth {
            let crossings = [of.omega_bw_rad_s, of.omega_phase_rad_s, of.omega_gain_rad_s, of.omega_180_rad_s];
            let [bandwidth, phase, gain, neutral] = crossings.map(|value| cell(value, 2));
            table.row([
                of.condition.to_string(),
                telling(of.airspeed_kt, 0),
                dataset.pair_name(of.pair),
                of.role.name().to_owned(),
                bandwidth,
                phase,
                gain,
                neutral,
                cell(of.phase_delay_s.map(s_to_ms), 0),
                of.remark(),
            ]);
        }
        table
    }

    /// Why a condition has no modes to compare; none where it has.
    pub fn no_modes(&self, condition: ConditionId) -> Option<&str> {
        let is_of = |of: &&MissingFinding| of.condition == Some(condition) && matches!(of.what, "modes" | "all");
        self.missing.iter().find(is_of).map(|of| of.why.as_str())
    }

    /// The modes of a condition: flown, of the physics representative, and with the couplings of the study where there are some.
    pub fn mode_table(&self, condition: ConditionId) -> Table {
        let modes = || self.modes.iter().filter(|of| of.condition == condition);
        let is_coupled = modes().any(|of| of.corrected_verdict.is_some());
        let heads = |model: &str| [MODULUS, "\u{3b6}", "period [s]"].map(|what| format!("{model} {what}"));
        let verdict_of = |model: &str| format!("{model}: tolerance");
        let mut columns = vec!["mode".to_owned(), "named by".to_owned()];
        columns.extend(heads("flown").into_iter().chain(heads("physics")).chain([verdict_of("physics")]));
        if is_coupled {
            columns.extend(heads("corrected").into_iter().chain([verdict_of("corrected")]));
        }
        let deviations = if modes().any(|of| of.identified_deviation.is_some()) {
            "standard deviations of flown modes known"
        } else {
            "standard deviations of flown modes not known (they are of a model identified in this session): not determined is what lies below \
             the band"
        };
        let mut table = Table::new(format!("Modes of condition {condition}; {deviations}"), columns);
        for of in modes() {
            let name = of.name.map_or_else(|| format!("mode {}", of.number), |name| name.to_string());
            let named_by = if of.named_by == NamedBy::States { "states" } else { "frequency" };
            let entry = of.tolerance.as_ref().map_or_else(String::new, |of| format!(" ({})", of.entry));
            let verdict = |of: ModeVerdict| format!("{}{entry}", of.words());
            let mut cells = vec![name, named_by.to_owned()];
            cells.extend(mode_cells(Some(&of.identified)));
            cells.extend(mode_cells(of.physics.as_ref()).into_iter().chain([verdict(of.verdict)]));
            if let Some(corrected) = of.corrected_verdict {
                cells.extend(mode_cells(of.corrected.as_ref()).into_iter().chain([verdict(corrected)]));
            }
            table.row(cells);
        }
        table
    }

    /// Mean J, and the share of the band inside the envelopes of unnoticeable added dynamics, of every condition and model; with the
    /// answers to flight records `J_rms` and Theil's coefficients too.
    pub fn summary_table(&self, histories: Option<&TimeHistories>) -> Table {
        let heads = [
            "condition",
            "airspeed [kt]",
            "model",
            "J on-axis",
            "J of all",
            "in MUAD on-axis [%]",
            "in MUAD of all [%]",
        ];
        let of_records = histories.filter(|of| !of.records.is_empty());
        let columns = heads.map(str::to_owned).into_iter().chain(of_records.into_iter().flat_map(|of| of.cost_heads()));
        let weights = match of_records {
            Some(of) => format!("; J_rms over all records of a condition, {}", of.weights_words()),
            None => String::new(),
        };
        let mut table = Table::new(format!("Summary: models against flight{weights}"), columns);
        let over_time = |id, role| of_records.into_iter().flat_map(move |found| found.costs(id, role));
        for of in &self.summary {
            let [on_axis, all] = [of.mean_j_on_axis, of.mean_j_all].map(|value| cell(value, 1));
            let shares = [of.muad_share_on_axis, of.muad_share_all];
            let [on_axis_share, all_share] = shares.map(|value| cell(value.map(|share| 100.0 * share), 0));
            let head = [of.condition.to_string(), telling(of.airspeed_kt, 0), of.role.name().to_owned()];
            let numbers = [on_axis, all, on_axis_share, all_share];
            table.row(head.into_iter().chain(numbers).chain(over_time(of.condition, of.role)));
        }
        // The others are compared with it: over time only is there something to say of it.
        let role = RequirementRole::Identified;
        for of in of_records.into_iter().flat_map(|found| found.records.iter().filter(|of| of.role == role)) {
            let head = [of.condition.to_string(), telling(of.airspeed_kt, 0), role.name().to_owned()];
            let row = head.into_iter().chain([(); 4].map(|()| "-".to_owned())).chain(over_time(of.condition, role));
            let row: Vec<String> = row.collect();
            if !table.rows.contains(&row) {
                table.row(row);
            }
        }
        table.rows.sort_by_key(|row| row[0].parse::<i64>().unwrap_or(i64::MAX));
        table
    }

    /// The summary of a row of [`Requirements::summary_table`]; none of the identified model, which the others are compared with.
    pub fn summary_of(&self, row: &[String]) -> Option<&SummaryFinding> {
        let [condition, _, role, ..] = row else { return None };
        self.summary.iter().find(|of| of.condition.to_string() == *condition && of.role.name() == role)
    }

    /// What a condition's model has of a response.
    pub fn bandwidth_of(
        &self,
        condition: ConditionId,
        pair: crate::dataset::Pair,
        role: RequirementRole,
    ) -> Option<&BandwidthFinding> {
        self.bandwidth.iter().find(|of| (of.condition, of.pair, of.role) == (condition, pair, role))
    }
}

impl BandwidthFinding {
    /// What has to be known of it, or why it has no number.
    pub fn remark(&self) -> String {
        let mut words = Vec::new();
        if let Some(why) = self.absent.get("omega_bw_rad_s").or_else(|| self.absent.get("phase_delay_s")) {
            words.push(why.clone());
        }
        let limit = self.rule.map(|rule| match rule {
            BandwidthRule::Gain => "gain-limited: the standard warns of it",
            BandwidthRule::Phase => "of the phase margin",
            BandwidthRule::PhaseGainUnknown => "of the phase margin; the gain margin is not known",
        });
        words.extend(limit.filter(|_| self.gain_limited || words.is_empty()).map(str::to_owned));
        if !self.rests_above_band.is_empty() {
            words.push("rests on the model above the band".to_owned());
        }
        if !self.rests_below_band.is_empty() {
            words.push("rests on the model below the band".to_owned());
        }
        if self.phase_delay_of_line {
            words.push("τ_p of the least-squares line".to_owned());
        }
        words.join("; ")
    }
}

impl ModeVerdict {
    /// What it says, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Within => "within",
            Self::Outside => "outside",
            Self::NotDetermined => "not determined by flight",
            Self::NoTolerance => "no tolerance",
            Self::NotPaired => "none near",
        }
    }
}
