//! What a qualification asks, as tables, and the job that finds it beside the live answer (M17).

use std::sync::Arc;

use crate::dataset::{ConditionId, Dataset};
use crate::executor::Executor;
use crate::requirements::{BandwidthRule, ModeVerdict};
use crate::units::{s_to_ms, telling};

use super::{
    Analysis, BandwidthFinding, Cancelled, Execution, Job, ModeNumbers, Progress, RequirementRole, RequirementSettings, Requirements,
    SummaryFinding, Table, Uncertainty, requirements_of,
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
}

impl PartialEq for RequirementsJob {
    fn eq(&self, other: &Self) -> bool {
        let same_bars = match (&self.uncertainty, &other.uncertainty) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (None, None) => true,
            _ => false,
        };
        Arc::ptr_eq(&self.analysis, &other.analysis) && same_bars && self.settings == other.settings
    }
}

impl Job for RequirementsJob {
    /// Who carries out its pieces.
    type Tools = Box<dyn Executor>;
    type Output = Arc<Requirements>;

    fn run(&self, executor: &mut Self::Tools, progress: &dyn Progress) -> Result<Self::Output, Cancelled> {
        let analysis = Analysis { uncertainty: self.uncertainty.clone(), ..self.analysis.asked_with(&self.settings) };
        let execution = Execution::new(executor.as_ref(), progress, analysis.conditions.len());
        Ok(Arc::new(requirements_of(&analysis, &execution)?))
    }
}

fn cell(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}").replace('-', "\u{2212}"))
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

    /// The modes of a condition: flown, and those of the physics model in their places.
    pub fn mode_table(&self, condition: ConditionId) -> Table {
        let columns = [
            "mode",
            "named by",
            "flown |λ| [rad/s]",
            "flown ζ",
            "physics |λ| [rad/s]",
            "physics ζ",
            "period [s]",
            "physics period [s]",
            "tolerance",
        ];
        let mut table = Table::new(format!("Modes of condition {condition}"), columns);
        let frequency = |of: &ModeNumbers| of.pole_real_rad_s.hypot(of.pole_imaginary_rad_s);
        for of in self.modes.iter().filter(|of| of.condition == condition) {
            let physics = of.physics.as_ref();
            let name = of.name.map_or_else(|| format!("mode {}", of.number), |name| name.to_string());
            let entry = of.tolerance.as_ref().map_or_else(String::new, |of| format!(" ({})", of.entry));
            table.row([
                name,
                if of.named_by == crate::requirements::NamedBy::States { "states" } else { "frequency" }.to_owned(),
                cell(Some(frequency(&of.identified)), 2),
                cell(of.identified.values.damping_ratio, 2),
                cell(physics.map(frequency), 2),
                cell(physics.and_then(|of| of.values.damping_ratio), 2),
                cell(of.identified.values.period_s, 1),
                cell(physics.and_then(|of| of.values.period_s), 1),
                format!("{}{entry}", of.verdict.words()),
            ]);
        }
        table
    }

    /// Mean J, and the share of the band inside the envelopes of unnoticeable added dynamics, of every condition and model.
    pub fn summary_table(&self) -> Table {
        let columns = [
            "condition",
            "airspeed [kt]",
            "model",
            "J on-axis",
            "J of all",
            "in MUAD on-axis [%]",
            "in MUAD of all [%]",
        ];
        let mut table = Table::new("Summary: models against flight", columns);
        for of in &self.summary {
            let [on_axis, all] = [of.mean_j_on_axis, of.mean_j_all].map(|value| cell(value, 1));
            let shares = [of.muad_share_on_axis, of.muad_share_all];
            let [on_axis_share, all_share] = shares.map(|value| cell(value.map(|share| 100.0 * share), 0));
            let head = [of.condition.to_string(), telling(of.airspeed_kt, 0), of.role.name().to_owned()];
            table.row(head.into_iter().chain([on_axis, all, on_axis_share, all_share]));
        }
        table
    }

    /// The summary of a row of [`Requirements::summary_table`].
    pub fn summary_of_row(&self, row: usize) -> Option<&SummaryFinding> {
        self.summary.get(row)
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
            words.push("τ_p of the line of least squares".to_owned());
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
