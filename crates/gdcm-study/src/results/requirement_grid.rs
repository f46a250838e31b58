//! All requirements of all conditions in one grid (M17.5): a corrected model, and the physics model
//! beside it, against the identified model or the held-out flight records.
//!
//! ```text
//! bandwidth     omega_BW / omega_BW of the identified model - 1
//! phase delay   tau_p - tau_p of the identified model [s]
//! peak error    max |simulated - flown| / tolerance, over the held-out records of the condition
//! mode          |lambda| / |lambda| of the identified model - 1, judged by the tolerances of modes
//! summary       mean J; share of the band inside the MUAD envelopes
//! ```
//!
//! A cell counts as met or outside only where its requirement has a limit and both models, or the
//! record, determine its value.

use std::collections::BTreeSet;

use serde::Serialize;

use gdcm_method::requirements::mode_comparison::ModeTolerance;
use gdcm_method::requirements::{ModeName, ModeVerdict, Tolerance, ToleranceTable};
use gdcm_model::dataset::{ConditionId, Dataset, Pair};

use super::required_bandwidth::{BandwidthFinding, NoBandwidth};
use super::required_modes::{ModeFinding, ModeNumbers};
use super::required_summary::{NoSummary, SummaryFinding};
use super::requirement_role::RequirementRole;
use super::requirements::Requirements;
use super::time_histories::TimeHistories;
use crate::decisions::requirement_settings::{OverviewLimits, RequirementSettings};

/// Modes with a row of their own even without a tolerance; any other mode has one only with a
/// tolerance.
const SHOWN_MODES: [ModeName; 3] = [
    ModeName::DutchRoll,
    ModeName::ShortPeriod,
    ModeName::Phugoid,
];

/// Group of requirements, in the order of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RequirementGroup {
    Bandwidth,
    InTime,
    Modes,
    Summary,
}

impl RequirementGroup {
    pub const ALL: [Self; 4] = [Self::Bandwidth, Self::InTime, Self::Modes, Self::Summary];
}

/// A requirement: a row of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Requirement {
    Bandwidth(Pair),
    PhaseDelay(Pair),
    /// Peak error in time; the index is that of the row in the tolerance table.
    PeakError(usize),
    ModeFrequency(ModeName),
    MeanJOnAxis,
    MeanJAll,
    MuadShareOnAxis,
}

/// Unit in which the values of a requirement are displayed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RequirementUnit {
    /// The stored value is a fraction.
    Percent,
    /// The stored value is in seconds.
    Milliseconds,
    /// The value is a cost without unit.
    Cost,
}

impl Requirement {
    /// Returns the group of rows to which the requirement belongs.
    pub fn group(self) -> RequirementGroup {
        match self {
            Self::Bandwidth(_) | Self::PhaseDelay(_) => RequirementGroup::Bandwidth,
            Self::PeakError(_) => RequirementGroup::InTime,
            Self::ModeFrequency(_) => RequirementGroup::Modes,
            Self::MeanJOnAxis | Self::MeanJAll | Self::MuadShareOnAxis => RequirementGroup::Summary,
        }
    }

    /// Returns the unit of its cells and of its limit.
    pub fn unit(self) -> RequirementUnit {
        match self {
            Self::PhaseDelay(_) => RequirementUnit::Milliseconds,
            Self::MeanJOnAxis | Self::MeanJAll => RequirementUnit::Cost,
            Self::Bandwidth(_)
            | Self::PeakError(_)
            | Self::ModeFrequency(_)
            | Self::MuadShareOnAxis => RequirementUnit::Percent,
        }
    }

    /// Returns the stable code of the quantity, for files and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::Bandwidth(_) => "bandwidth",
            Self::PhaseDelay(_) => "phase-delay",
            Self::PeakError(_) => "peak-error",
            Self::ModeFrequency(_) => "mode-frequency",
            Self::MeanJOnAxis => "mean-j-on-axis",
            Self::MeanJAll => "mean-j-all",
            Self::MuadShareOnAxis => "muad-share-on-axis",
        }
    }

    /// Returns the response that a requirement concerns: for a peak error, the on-axis response of
    /// its output; `None` for modes and summary costs.
    pub fn pair(self, dataset: &Dataset, tolerances: &ToleranceTable) -> Option<Pair> {
        match self {
            Self::Bandwidth(pair) | Self::PhaseDelay(pair) => Some(pair),
            Self::PeakError(row) => {
                let channel = &tolerances.rows().get(row)?.channel;
                let outputs = dataset.outputs();
                let output = outputs.iter().position(|output| output.name == *channel)?;
                let pairs = dataset.measuring_pairs();
                pairs.marked().find(|pair| pair.output == output)
            }
            Self::ModeFrequency(_) | Self::MeanJOnAxis | Self::MeanJAll | Self::MuadShareOnAxis => {
                None
            }
        }
    }
}

/// Limit of the values in a row.
#[derive(Clone, Debug, PartialEq)]
pub enum RequirementLimit {
    /// Maximum magnitude, in the stored unit of the values.
    Within(f64),
    AtMost(f64),
    AtLeast(f64),
    /// Tolerance of a time history: a peak error of at most 1.
    Tolerance(Tolerance),
    /// Tolerances of a mode: the period, and the time to half amplitude or the damping ratio.
    Mode(ModeTolerance),
    None,
}

impl RequirementLimit {
    fn verdict(&self, value: f64) -> CellVerdict {
        let is_met = match self {
            Self::Within(limit) => value.abs() <= *limit,
            Self::AtMost(limit) => value <= *limit,
            Self::AtLeast(limit) => value >= *limit,
            Self::Tolerance(_) => value <= 1.0,
            // A mode has a verdict of its own.
            Self::Mode(_) | Self::None => return CellVerdict::NoTolerance,
        };
        if is_met {
            CellVerdict::Met
        } else {
            CellVerdict::Outside
        }
    }
}

/// Verdict on a value.
#[derive(Clone, Debug, PartialEq)]
pub enum CellVerdict {
    Met,
    Outside,
    /// The requirement has no limit.
    NoTolerance,
    NotDetermined(NotDetermined),
}

impl CellVerdict {
    /// Returns the stable code, for files and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Met => "met",
            Self::Outside => "outside",
            Self::NoTolerance => "no-tolerance",
            Self::NotDetermined(_) => "not-determined",
        }
    }
}

/// Why a cell has no value, or a value without a verdict.
#[derive(Clone, Debug, PartialEq)]
pub enum NotDetermined {
    /// There is no model in this role.
    NoModel(RequirementRole),
    Bandwidth {
        role: RequirementRole,
        why: NoBandwidth,
    },
    /// The condition has no flight record that was held out of the identification.
    NoHeldOutRecord,
    /// The quantity could not be compared with the held-out records.
    NotCompared,
    /// Flight does not show this mode.
    NoMode,
    /// The models have no modes that could be compared.
    NoModes,
    ModeNotPaired,
    /// The mode is below the band, or its standard deviations exceed the tolerance.
    ModeUncertain,
    Summary(NoSummary),
}

impl NotDetermined {
    /// Returns the stable code, for files and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoModel(_) => "no-model",
            Self::Bandwidth { why, .. } => why.code(),
            Self::NoHeldOutRecord => "no-held-out-record",
            Self::NotCompared => "not-compared",
            Self::NoMode => "no-mode",
            Self::NoModes => "no-modes",
            Self::ModeNotPaired => "mode-not-paired",
            Self::ModeUncertain => "mode-uncertain",
            Self::Summary(why) => why.code(),
        }
    }
}

/// Value of a model, and its verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct RoleCell {
    /// Fraction, seconds or cost ([`Requirement::unit`]); `None` where it is not determined.
    pub value: Option<f64>,
    pub verdict: CellVerdict,
}

impl RoleCell {
    fn absent(why: NotDetermined) -> Self {
        Self {
            value: None,
            verdict: CellVerdict::NotDetermined(why),
        }
    }

    fn judged(value: f64, limit: &RequirementLimit) -> Self {
        Self {
            value: Some(value),
            verdict: limit.verdict(value),
        }
    }
}

/// A requirement in a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct GridCell {
    /// The corrected model, in the role of the grid.
    pub corrected: RoleCell,
    /// The uncorrected physics model.
    pub physics: RoleCell,
}

/// A requirement in all conditions.
#[derive(Clone, Debug, PartialEq)]
pub struct GridRow {
    pub requirement: Requirement,
    pub limit: RequirementLimit,
    /// Cells in the order of [`RequirementGrid::conditions`].
    pub cells: Vec<GridCell>,
}

/// A condition: a column of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridCondition {
    pub id: ConditionId,
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
}

/// Number of cells by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct GridCount {
    /// Cells that the corrected model meets.
    pub met: usize,
    /// Cells with a limit and a value of the corrected model.
    pub judged: usize,
    /// Cells that the physics model meets.
    pub physics_met: usize,
    /// Cells with a limit whose value or verdict is not determined.
    pub not_determined: usize,
}

impl GridCount {
    fn add(&mut self, cell: &GridCell) {
        match cell.corrected.verdict {
            CellVerdict::Met => {
                self.met += 1;
                self.judged += 1;
            }
            CellVerdict::Outside => self.judged += 1,
            CellVerdict::NotDetermined(_) => self.not_determined += 1,
            CellVerdict::NoTolerance => {}
        }
        if cell.physics.verdict == CellVerdict::Met {
            self.physics_met += 1;
        }
    }
}

/// Result of a group of requirements in a condition, for folded groups.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GroupCell {
    pub count: GridCount,
    /// Whether the physics model is outside any limit.
    pub is_physics_outside: bool,
}

/// Requirements by condition.
#[derive(Clone, Debug, PartialEq)]
pub struct RequirementGrid {
    /// Role of the corrected model: with the condition's own correction or with the schedule.
    pub role: RequirementRole,
    pub conditions: Vec<GridCondition>,
    pub rows: Vec<GridRow>,
}

/// Results from which a grid is built.
#[derive(Clone, Copy)]
pub struct GridSource<'a> {
    pub requirements: &'a Requirements,
    /// Comparisons with flight records; `None` without records.
    pub histories: Option<&'a TimeHistories>,
    pub dataset: &'a Dataset,
    pub settings: &'a RequirementSettings,
    /// `Corrected` or `Scheduled`.
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

    /// Counts the cells of all rows.
    pub fn count(&self) -> GridCount {
        let mut count = GridCount::default();
        for cell in self.rows.iter().flat_map(|row| &row.cells) {
            count.add(cell);
        }
        count
    }

    /// Counts the cells of a group in a column.
    pub fn group_cell(&self, group: RequirementGroup, column: usize) -> GroupCell {
        let mut found = GroupCell::default();
        for row in self.group_rows(group) {
            if let Some(cell) = row.cells.get(column) {
                found.count.add(cell);
                if cell.physics.verdict == CellVerdict::Outside {
                    found.is_physics_outside = true;
                }
            }
        }
        found
    }

    /// Returns the rows of a group.
    pub fn group_rows(&self, group: RequirementGroup) -> impl Iterator<Item = &GridRow> {
        self.rows
            .iter()
            .filter(move |row| row.requirement.group() == group)
    }

    /// Returns the row of a requirement.
    pub fn row(&self, requirement: Requirement) -> Option<&GridRow> {
        self.rows.iter().find(|row| row.requirement == requirement)
    }

    /// Returns the cell of a requirement in a condition.
    pub fn cell(&self, requirement: Requirement, condition: ConditionId) -> Option<&GridCell> {
        let column = self.column(condition)?;
        self.row(requirement)?.cells.get(column)
    }

    /// Returns the column of a condition.
    pub fn column(&self, condition: ConditionId) -> Option<usize> {
        self.conditions
            .iter()
            .position(|known| known.id == condition)
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

    /// Returns the conditions with a result.
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

    /// Returns bandwidth and phase delay of each on-axis response in which any model has either.
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
        }
        rows
    }

    /// Returns the first row of the tolerance table for each quantity of the dataset. Further rows
    /// for the same quantity are alternatives in the standard (2.c.3.b joins attitude and rate by
    /// "or"), not requirements of their own.
    fn peak_error_rows(&self) -> Vec<RowSource> {
        let mut rows = Vec::new();
        let mut known = BTreeSet::new();
        for (row, tolerance) in self.settings.tolerances.rows().iter().enumerate() {
            let is_new = known.insert((&tolerance.channel, tolerance.integrated));
            if is_new && tolerance.of_outputs(self.dataset.outputs()).is_ok() {
                rows.push(RowSource {
                    requirement: Requirement::PeakError(row),
                    limit: RequirementLimit::Tolerance(tolerance.clone()),
                });
            }
        }
        rows
    }

    /// Returns the modes that any condition shows in flight.
    fn mode_rows(&self) -> Vec<RowSource> {
        let tolerances = self.settings.mode_tolerances.rows();
        let mut flown: BTreeSet<ModeName> = BTreeSet::new();
        for mode in &self.requirements.modes {
            flown.extend(mode.name);
        }
        let mut names: Vec<ModeName> = SHOWN_MODES.to_vec();
        for name in tolerances.iter().flat_map(|row| &row.modes) {
            if !names.contains(name) {
                names.push(*name);
            }
        }
        let mut rows = Vec::new();
        for name in names {
            if !flown.contains(&name) {
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

    /// Returns the relative change of the bandwidth from that of the identified model.
    fn bandwidth_change(
        &self,
        condition: ConditionId,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<f64, NotDetermined> {
        let model = self.bandwidth_finding(condition, pair, role)?;
        let flown = self.bandwidth_finding(condition, pair, RequirementRole::Identified)?;
        let model_rad_s = known_metric(model, model.omega_bw_rad_s, "omega_bw_rad_s")?;
        let flown_rad_s = known_metric(flown, flown.omega_bw_rad_s, "omega_bw_rad_s")?;
        Ok(model_rad_s / flown_rad_s - 1.0)
    }

    /// Returns the change of the phase delay \[s\] from that of the identified model.
    fn phase_delay_change(
        &self,
        condition: ConditionId,
        pair: Pair,
        role: RequirementRole,
    ) -> Result<f64, NotDetermined> {
        let model = self.bandwidth_finding(condition, pair, role)?;
        let flown = self.bandwidth_finding(condition, pair, RequirementRole::Identified)?;
        let model_s = known_metric(model, model.phase_delay_s, "phase_delay_s")?;
        let flown_s = known_metric(flown, flown.phase_delay_s, "phase_delay_s")?;
        Ok(model_s - flown_s)
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

    /// Returns the largest error over the held-out records, as a multiple of the tolerance.
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

    /// Judges a mode by its tolerance; the value is the relative change of its natural frequency.
    fn mode_cell(&self, condition: ConditionId, name: ModeName, role: RequirementRole) -> RoleCell {
        if self.requirements.no_modes(condition).is_some() {
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

/// A mode of the model in a role, with its verdict.
pub struct RoleMode<'a> {
    pub numbers: Option<&'a ModeNumbers>,
    pub verdict: ModeVerdict,
}

impl ModeFinding {
    /// Returns the counterpart of the flown mode in the model of a role. Gains and delays move no
    /// pole: without couplings, a corrected model has the modes of the physics model.
    pub fn of_role(&self, role: RequirementRole) -> RoleMode<'_> {
        match (role, self.corrected_verdict) {
            (RequirementRole::Corrected | RequirementRole::Scheduled, Some(verdict)) => RoleMode {
                numbers: self.corrected.as_ref(),
                verdict,
            },
            _ => RoleMode {
                numbers: self.physics.as_ref(),
                verdict: self.verdict,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use gdcm_method::requirements::NamedBy;
    use gdcm_method::requirements::mode_comparison::ModeValues;

    use super::*;
    use crate::execution::Execution;
    use crate::jobs::couplings_tests::EXAMPLE;
    use crate::results::required_modes::KnownPoles;
    use crate::results::requirements::requirements_of;
    use crate::results::time_histories::{HistoryFinding, ToleranceFinding};

    const ID: ConditionId = ConditionId(3);

    /// A bandwidth \[rad/s\] and a phase delay \[s\] of the example's roll response.
    fn bandwidth(role: RequirementRole, omega: Option<f64>, delay_s: f64) -> BandwidthFinding {
        let dataset = &EXAMPLE.analysis.study.dataset;
        BandwidthFinding {
            condition: ID,
            pair: dataset.find_pair("P", "LAT").unwrap(),
            role,
            omega_bw_rad_s: omega,
            phase_delay_s: Some(delay_s),
            ..BandwidthFinding::default()
        }
    }

    fn summary(role: RequirementRole, mean_j: f64, share: f64) -> SummaryFinding {
        SummaryFinding {
            condition: ID,
            airspeed_kt: 45.0,
            role,
            model: String::new(),
            mean_j_on_axis: Some(mean_j),
            mean_j_all: Some(mean_j),
            muad_share_on_axis: Some(share),
            muad_share_all: Some(share),
            absent: BTreeMap::new(),
        }
    }

    fn numbers(modulus_rad_s: f64) -> ModeNumbers {
        ModeNumbers {
            model: String::new(),
            pole_real_rad_s: -0.6 * modulus_rad_s,
            pole_imaginary_rad_s: 0.8 * modulus_rad_s,
            values: ModeValues {
                period_s: None,
                time_to_half_s: None,
                damping_ratio: Some(0.6),
            },
            absent: BTreeMap::new(),
        }
    }

    fn mode(name: ModeName, verdict: ModeVerdict, physics: Option<f64>) -> ModeFinding {
        ModeFinding {
            condition: ID,
            airspeed_kt: 45.0,
            number: 1,
            name: Some(name),
            named_by: NamedBy::States,
            verdict,
            identified: numbers(2.0),
            identified_deviation: None,
            physics: physics.map(numbers),
            corrected_verdict: None,
            corrected: None,
            tolerance: None,
        }
    }

    fn known() -> Requirements {
        use RequirementRole::{Corrected, Identified, Physics};
        Requirements {
            bandwidth: vec![
                bandwidth(Physics, Some(2.5), 0.16),
                bandwidth(Corrected, Some(2.1), 0.10),
                bandwidth(Identified, Some(2.0), 0.13),
            ],
            modes: vec![
                mode(ModeName::DutchRoll, ModeVerdict::Outside, Some(1.8)),
                mode(ModeName::ShortPeriod, ModeVerdict::NoTolerance, Some(2.2)),
                mode(ModeName::Phugoid, ModeVerdict::NotPaired, None),
            ],
            summary: vec![summary(Physics, 60.0, 0.5), summary(Corrected, 6.0, 0.95)],
            ..Requirements::default()
        }
    }

    /// A record with the peak error of the roll rate of the corrected and the physics model.
    fn record(held_out: bool, corrected: f64, physics: f64) -> Vec<HistoryFinding> {
        let roles = [
            (RequirementRole::Corrected, corrected),
            (RequirementRole::Physics, physics),
        ];
        let mut findings = Vec::new();
        for (role, peak_error) in roles {
            findings.push(HistoryFinding {
                condition: ID,
                airspeed_kt: 45.0,
                record: "a".to_owned(),
                held_out,
                role,
                model: String::new(),
                moved_input: None,
                samples: 100,
                windows: 1,
                window_s: 10.0,
                j_rms: None,
                j_rms_left_out: Vec::new(),
                theil: BTreeMap::new(),
                tolerances: vec![ToleranceFinding {
                    quantity: "roll rate".to_owned(),
                    output: "P".to_owned(),
                    integrated: false,
                    unit: "deg/s".to_owned(),
                    share_inside: 1.0,
                    largest_excess: -1.0,
                    largest_excess_at_s: 0.0,
                    peak_error,
                    peak_error_at_s: 0.0,
                    correlation: None,
                    on_axis: None,
                    trend: None,
                }],
            });
        }
        findings
    }

    fn grid(requirements: &Requirements, records: Vec<HistoryFinding>) -> RequirementGrid {
        let histories = TimeHistories {
            tolerance_table: ToleranceTable::default(),
            records,
            missing: Vec::new(),
        };
        RequirementGrid::new(&GridSource {
            requirements,
            histories: Some(&histories),
            dataset: &EXAMPLE.analysis.study.dataset,
            settings: &RequirementSettings::default(),
            role: RequirementRole::Corrected,
        })
    }

    fn value(grid: &RequirementGrid, requirement: Requirement) -> f64 {
        grid.cell(requirement, ID).unwrap().corrected.value.unwrap()
    }

    #[test]
    fn known_values_are_judged_and_counted() {
        let grid = grid(&known(), record(true, 0.7, 1.2));
        let pair = EXAMPLE
            .analysis
            .study
            .dataset
            .find_pair("P", "LAT")
            .unwrap();
        let cases = [
            (Requirement::Bandwidth(pair), 0.05, "met", "outside"),
            (Requirement::PhaseDelay(pair), -0.03, "outside", "outside"),
            (Requirement::PeakError(0), 0.7, "met", "outside"),
            (
                Requirement::ModeFrequency(ModeName::DutchRoll),
                -0.1,
                "outside",
                "outside",
            ),
            (
                Requirement::ModeFrequency(ModeName::ShortPeriod),
                0.1,
                "no-tolerance",
                "no-tolerance",
            ),
            (Requirement::MeanJOnAxis, 6.0, "met", "outside"),
            (Requirement::MeanJAll, 6.0, "no-tolerance", "no-tolerance"),
            (Requirement::MuadShareOnAxis, 0.95, "met", "outside"),
        ];
        for (requirement, expected, corrected, physics) in cases {
            assert!(
                (value(&grid, requirement) - expected).abs() < 1e-12,
                "{requirement:?}"
            );
            let cell = grid.cell(requirement, ID).unwrap();
            assert_eq!(cell.corrected.verdict.code(), corrected, "{requirement:?}");
            assert_eq!(cell.physics.verdict.code(), physics, "{requirement:?}");
        }
        // Not determined: the unpaired phugoid, and the quantities of the table that the record
        // lacks.
        let phugoid = grid
            .cell(Requirement::ModeFrequency(ModeName::Phugoid), ID)
            .unwrap();
        assert_eq!(
            phugoid.corrected.verdict,
            CellVerdict::NotDetermined(NotDetermined::ModeNotPaired)
        );
        let in_time = grid.group_rows(RequirementGroup::InTime).count();
        assert_eq!(
            grid.count(),
            GridCount {
                met: 4,
                judged: 6,
                physics_met: 0,
                not_determined: 1 + (in_time - 1),
            }
        );
        let summary = grid.group_cell(RequirementGroup::Summary, 0);
        assert_eq!((summary.count.met, summary.count.judged), (2, 2));
        assert!(summary.is_physics_outside);
    }

    #[test]
    fn only_held_out_records_count_and_of_several_the_worst() {
        let peak = Requirement::PeakError(0);
        let mut records = record(true, 0.7, 0.5);
        records.extend(record(true, 0.9, 0.4));
        records.extend(record(false, 5.0, 5.0));
        assert!((value(&grid(&known(), records), peak) - 0.9).abs() < 1e-12);
        let grid = grid(&known(), record(false, 0.7, 0.5));
        assert_eq!(
            grid.cell(peak, ID).unwrap().corrected.verdict,
            CellVerdict::NotDetermined(NotDetermined::NoHeldOutRecord)
        );
    }

    #[test]
    fn a_missing_bandwidth_says_which_model_lacks_it() {
        let mut requirements = known();
        requirements.bandwidth[2].omega_bw_rad_s = None;
        requirements.bandwidth[2]
            .absent
            .insert("omega_bw_rad_s", NoBandwidth::NetGainNotPositive);
        let pair = requirements.bandwidth[0].pair;
        let grid = grid(&requirements, Vec::new());
        let cell = grid.cell(Requirement::Bandwidth(pair), ID).unwrap();
        assert_eq!(
            cell.corrected.verdict,
            CellVerdict::NotDetermined(NotDetermined::Bandwidth {
                role: RequirementRole::Identified,
                why: NoBandwidth::NetGainNotPositive
            })
        );
    }

    #[test]
    fn a_quantity_has_one_row_and_each_condition_a_cell() {
        let analysis = &EXAMPLE.analysis;
        let requirements =
            requirements_of(analysis, &KnownPoles::default(), &Execution::sequential()).unwrap();
        let grid = grid(&requirements, Vec::new());
        assert_eq!(grid.conditions.len(), analysis.conditions.len());
        for row in &grid.rows {
            assert_eq!(row.cells.len(), grid.conditions.len());
        }
        // The two short-term rows of the table repeat pitch attitude and pitch rate.
        let table = ToleranceTable::default().rows().len();
        let in_time = grid.group_rows(RequirementGroup::InTime).count();
        assert_eq!(in_time, table - 2);
        let count = grid.count();
        assert!(count.met <= count.judged && count.judged > 0);
    }
}
