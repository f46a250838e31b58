//! Builds the requirement grid from a study's results, and judges its cells (M17.5).
//!
//! 1. Columns: every condition with a result (`conditions`).
//! 2. Rows: the requirements that the dataset, the records and the tolerances allow
//!    (`bandwidth_rows` to `summary_rows`).
//! 3. Cells: for the corrected and the uncorrected physics model, the value, compared with the
//!    row's limit; or why it is not determined (`cell`).
//!
//! The identified model is the reference. A held-out record is a flight record that was excluded
//! from the identification.

use std::collections::BTreeSet;

use gdcm_method::requirements::level_boundary::AssessedLevel;
use gdcm_method::requirements::{ModeName, ModeVerdict};
use gdcm_model::dataset::{ConditionId, Dataset, Pair};

use super::grid_cell::{CellVerdict, GridCell, NotDetermined, RoleCell};
use super::grid_requirement::{Requirement, RequirementLimit};
use super::required_bandwidth::BandwidthFinding;
use super::required_summary::{NoSummary, SummaryFinding};
use super::requirement_grid::{GridCondition, GridRow, RequirementGrid};
use super::requirement_role::RequirementRole;
use super::requirements::Requirements;
use super::time_histories::TimeHistories;
use crate::decisions::requirement_settings::{OverviewLimits, RequirementSettings};

/// Modes that have a row whenever flight shows them; any other mode only with a tolerance.
const SHOWN_MODES: [ModeName; 3] = [
    ModeName::DutchRoll,
    ModeName::ShortPeriod,
    ModeName::Phugoid,
];

/// Results from which a grid is built.
#[derive(Clone, Copy)]
pub struct GridSource<'a> {
    pub requirements: &'a Requirements,
    /// Comparisons with flight records; `None` without records.
    pub histories: Option<&'a TimeHistories>,
    pub dataset: &'a Dataset,
    pub settings: &'a RequirementSettings,
    /// The corrected model to be judged: `Corrected` or `Scheduled`.
    pub role: RequirementRole,
}

impl RequirementGrid {
    /// Judges every condition with a result by every requirement.
    pub fn new(source: &GridSource<'_>) -> Self {
        let conditions = source.conditions();
        let mut rows = source.bandwidth_rows();
        rows.extend(source.peak_error_rows());
        rows.extend(source.mode_rows());
        rows.extend(source.summary_rows());
        let mut grid = Self {
            role: source.role,
            conditions,
            rows: Vec::new(),
        };
        for RowSource { requirement, limit } in rows {
            let mut cells = Vec::new();
            for condition in &grid.conditions {
                let id = condition.id;
                cells.push(GridCell {
                    corrected: source.cell(requirement, &limit, id, source.role),
                    physics: source.cell(requirement, &limit, id, RequirementRole::Physics),
                });
            }
            grid.rows.push(GridRow {
                requirement,
                limit,
                cells,
            });
        }
        grid
    }
}

/// A row before its cells are judged.
struct RowSource {
    requirement: Requirement,
    limit: RequirementLimit,
}

impl GridSource<'_> {
    fn limits(&self) -> &OverviewLimits {
        &self.settings.overview
    }

    /// Returns the conditions with a result, which are those with a summary of the physics model.
    fn conditions(&self) -> Vec<GridCondition> {
        let mut conditions: Vec<GridCondition> = Vec::new();
        for finding in &self.requirements.summary {
            if finding.role == RequirementRole::Physics {
                conditions.push(GridCondition {
                    id: finding.condition,
                    airspeed_kt: finding.airspeed_kt,
                });
            }
        }
        conditions
    }

    /// Returns a bandwidth row and a phase delay row for each on-axis response in which any model
    /// has either, and a level row where boundaries give levels for its axis.
    fn bandwidth_rows(&self) -> Vec<RowSource> {
        let mut rows = Vec::new();
        for pair in self.dataset.measuring_pairs().marked() {
            let is_known = self.requirements.bandwidth.iter().any(|finding| {
                finding.pair == pair
                    && (finding.omega_bw_rad_s.is_some() || finding.phase_delay_s.is_some())
            });
            if !is_known {
                continue;
            }
            rows.push(RowSource {
                requirement: Requirement::Bandwidth(pair),
                limit: RequirementLimit::Within(self.limits().bandwidth),
            });
            rows.push(RowSource {
                requirement: Requirement::PhaseDelay(pair),
                limit: RequirementLimit::Within(self.limits().phase_delay_s),
            });
            let output = &self.dataset.outputs()[pair.output].name;
            if self.settings.levels.assesses(output) {
                rows.push(RowSource {
                    requirement: Requirement::Level(pair),
                    limit: RequirementLimit::IdentifiedLevel,
                });
            }
        }
        rows
    }

    /// Returns the tolerance table's first row for each quantity in the dataset. Further rows for
    /// the same quantity are alternatives in the standard (2.c.3.b joins attitude and rate by
    /// "or"), not separate requirements.
    fn peak_error_rows(&self) -> Vec<RowSource> {
        let mut rows = Vec::new();
        let mut known = BTreeSet::new();
        for (row, tolerance) in self.settings.tolerances.rows().iter().enumerate() {
            let is_new = known.insert((&tolerance.channel, tolerance.integrated));
            if is_new && tolerance.in_output_units(self.dataset.outputs()).is_ok() {
                rows.push(RowSource {
                    requirement: Requirement::PeakError(row),
                    limit: RequirementLimit::Tolerance(tolerance.clone()),
                });
            }
        }
        rows
    }

    /// Returns a row for each mode that any condition shows in flight: those in [`SHOWN_MODES`],
    /// then others that have a tolerance.
    fn mode_rows(&self) -> Vec<RowSource> {
        let tolerances = self.settings.mode_tolerances.rows();
        let mut in_flight: BTreeSet<ModeName> = BTreeSet::new();
        for mode in &self.requirements.modes {
            in_flight.extend(mode.name);
        }
        let mut names: Vec<ModeName> = SHOWN_MODES.to_vec();
        for name in tolerances.iter().flat_map(|row| &row.modes) {
            if !names.contains(name) {
                names.push(*name);
            }
        }
        let mut rows = Vec::new();
        for name in names {
            if !in_flight.contains(&name) {
                continue;
            }
            let tolerance = tolerances.iter().find(|row| row.modes.contains(&name));
            rows.push(RowSource {
                requirement: Requirement::ModeFrequency(name),
                limit: match tolerance {
                    Some(tolerance) => RequirementLimit::Mode(tolerance.clone()),
                    None => RequirementLimit::None,
                },
            });
        }
        rows
    }

    fn summary_rows(&self) -> Vec<RowSource> {
        if self.requirements.summary.is_empty() {
            return Vec::new();
        }
        vec![
            RowSource {
                requirement: Requirement::MeanJOnAxis,
                limit: RequirementLimit::AtMost(self.limits().mean_j),
            },
            RowSource {
                requirement: Requirement::MeanJAll,
                limit: RequirementLimit::None,
            },
            RowSource {
                requirement: Requirement::MuadShareOnAxis,
                limit: RequirementLimit::AtLeast(self.limits().muad_share),
            },
        ]
    }

    /// Judges a model by a requirement. Levels and modes have their own verdicts; every other value
    /// is compared with `limit`.
    fn cell(
        &self,
        requirement: Requirement,
        limit: &RequirementLimit,
        condition: ConditionId,
        role: RequirementRole,
    ) -> RoleCell {
        let found = match requirement {
            Requirement::Bandwidth(pair) => self.bandwidth_change(condition, pair, role),
            Requirement::PhaseDelay(pair) => self.phase_delay_change(condition, pair, role),
            Requirement::Level(pair) => return self.level_cell(condition, pair, role),
            Requirement::PeakError(row) => self.peak_error(condition, row, role),
            Requirement::ModeFrequency(name) => return self.mode_cell(condition, name, role),
            Requirement::MeanJOnAxis | Requirement::MeanJAll | Requirement::MuadShareOnAxis => {
                self.summary_value(condition, requirement, role)
            }
        };
        match found {
            Ok(value) => RoleCell::judged(value, limit),
            Err(why) => RoleCell::absent(why),
        }
    }

    /// Returns the relative difference in bandwidth from the identified model.
    fn bandwidth_change(
        &self,
        condition: ConditionId,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<f64, NotDetermined> {
        let model = self.bandwidth_finding(condition, pair, role)?;
        let reference = self.bandwidth_finding(condition, pair, RequirementRole::Identified)?;
        let model_rad_s = known_metric(model, model.omega_bw_rad_s, "omega_bw_rad_s")?;
        let reference_rad_s = known_metric(reference, reference.omega_bw_rad_s, "omega_bw_rad_s")?;
        Ok(model_rad_s / reference_rad_s - 1.0)
    }

    /// Returns the difference in phase delay from the identified model \[s\].
    fn phase_delay_change(
        &self,
        condition: ConditionId,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<f64, NotDetermined> {
        let model = self.bandwidth_finding(condition, pair, role)?;
        let reference = self.bandwidth_finding(condition, pair, RequirementRole::Identified)?;
        let model_s = known_metric(model, model.phase_delay_s, "phase_delay_s")?;
        let reference_s = known_metric(reference, reference.phase_delay_s, "phase_delay_s")?;
        Ok(model_s - reference_s)
    }

    /// Compares a model's level with the identified model's: met if they are equal.
    fn level_cell(&self, condition: ConditionId, pair: Pair, role: RequirementRole) -> RoleCell {
        let level = match self.level(condition, pair, role) {
            Ok(level) => level,
            Err(why) => return RoleCell::absent(why),
        };
        let verdict = match self.level(condition, pair, RequirementRole::Identified) {
            Ok(reference) if reference == level => CellVerdict::Met,
            Ok(_) => CellVerdict::Outside,
            Err(why) => CellVerdict::NotDetermined(why),
        };
        RoleCell {
            value: Some(f64::from(level)),
            verdict,
        }
    }

    /// Returns a model's level number.
    fn level(
        &self,
        condition: ConditionId,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<u32, NotDetermined> {
        let model = self.bandwidth_finding(condition, pair, role)?;
        known_metric(model, model.omega_bw_rad_s, "omega_bw_rad_s")?;
        known_metric(model, model.phase_delay_s, "phase_delay_s")?;
        model
            .level(&self.settings.levels)
            .and_then(AssessedLevel::number)
            .ok_or(NotDetermined::AboveBoundaries(role))
    }

    fn bandwidth_finding(
        &self,
        condition: ConditionId,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<&BandwidthFinding, NotDetermined> {
        self.requirements
            .bandwidth_of(condition, pair, role)
            .ok_or(NotDetermined::NoModel(role))
    }

    /// Returns the largest error over the condition's held-out records, as a multiple of the
    /// tolerance; otherwise the first reason that applies: no held-out record, no simulation of
    /// this model, no comparison with this tolerance.
    fn peak_error(
        &self,
        condition: ConditionId,
        row: usize,
        role: RequirementRole,
    ) -> Result<f64, NotDetermined> {
        let Some(histories) = self.histories else {
            return Err(NotDetermined::NoHeldOutRecord);
        };
        let mut has_record = false;
        let mut has_model = false;
        let mut peak: Option<f64> = None;
        for finding in &histories.records {
            if !finding.held_out || finding.condition != condition {
                continue;
            }
            has_record = true;
            if finding.role != role {
                continue;
            }
            has_model = true;
            if let Some(tolerance) = self.settings.tolerances.rows().get(row)
                && let Some(error) = finding.peak_error(tolerance)
            {
                peak = Some(peak.unwrap_or(0.0).max(error));
            }
        }
        match peak {
            Some(peak) => Ok(peak),
            None if !has_record => Err(NotDetermined::NoHeldOutRecord),
            None if !has_model => Err(NotDetermined::NoModel(role)),
            None => Err(NotDetermined::NotCompared),
        }
    }

    /// Judges a mode by its tolerance; the value is its natural frequency's relative difference
    /// from flight. Without a value, the first reason that applies: the condition has no modes;
    /// flight does not show this mode; the model has no paired mode; the verdict is uncertain.
    fn mode_cell(&self, condition: ConditionId, name: ModeName, role: RequirementRole) -> RoleCell {
        if self.requirements.missing_modes_reason(condition).is_some() {
            return RoleCell::absent(NotDetermined::NoModes);
        }
        let finding = self
            .requirements
            .modes
            .iter()
            .find(|mode| mode.condition == condition && mode.name == Some(name));
        let Some(finding) = finding else {
            return RoleCell::absent(NotDetermined::NoMode);
        };
        let mode = finding.of_role(role);
        match (mode.verdict, mode.numbers) {
            (ModeVerdict::NotPaired, _) | (_, None) => {
                RoleCell::absent(NotDetermined::ModeNotPaired)
            }
            (ModeVerdict::NotDetermined, Some(_)) => RoleCell::absent(NotDetermined::ModeUncertain),
            (verdict, Some(numbers)) => RoleCell {
                value: Some(numbers.modulus_rad_s() / finding.identified.modulus_rad_s() - 1.0),
                verdict: match verdict {
                    ModeVerdict::Within => CellVerdict::Met,
                    ModeVerdict::Outside => CellVerdict::Outside,
                    ModeVerdict::NotDetermined
                    | ModeVerdict::NoTolerance
                    | ModeVerdict::NotPaired => CellVerdict::NoTolerance,
                },
            },
        }
    }

    fn summary_value(
        &self,
        condition: ConditionId,
        requirement: Requirement,
        role: RequirementRole,
    ) -> Result<f64, NotDetermined> {
        let finding: &SummaryFinding = self
            .requirements
            .summary
            .iter()
            .find(|finding| finding.condition == condition && finding.role == role)
            .ok_or(NotDetermined::NoModel(role))?;
        let value = match requirement {
            Requirement::MeanJOnAxis => finding.mean_j_on_axis,
            Requirement::MeanJAll => finding.mean_j_all,
            _ => finding.muad_share_on_axis,
        };
        value.ok_or(NotDetermined::Summary(match requirement {
            Requirement::MeanJAll => NoSummary::NoResponse,
            _ => NoSummary::NoOnAxisResponse,
        }))
    }
}

/// Returns a bandwidth or a phase delay, or the reason for its absence.
fn known_metric(
    finding: &BandwidthFinding,
    value: Option<f64>,
    name: &'static str,
) -> Result<f64, NotDetermined> {
    if let Some(value) = value {
        return Ok(value);
    }
    Err(match finding.absent.get(name) {
        Some(why) => NotDetermined::Bandwidth {
            role: finding.role,
            why: why.clone(),
        },
        None => NotDetermined::NoModel(finding.role),
    })
}
