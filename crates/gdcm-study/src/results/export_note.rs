//! Facts about an exported file, found by its writer: what it contains, omits or approximates.

use gdcm_method::correction::{Channel, LeadPrice};
use gdcm_method::couplings::problem::CouplingError;
use gdcm_method::schedule::ScheduleError;
use gdcm_model::dataset::ConditionId;

use super::schedule_losses::DelayedChannel;

/// Kind and size of an exported file's contents.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileSummary {
    /// All results.
    Results { has_error_bars: bool },
    /// A result table.
    Rows { rows: usize },
    /// The schedule as a function of airspeed.
    Function {
        channels: usize,
        has_delays: bool,
        has_leads: bool,
    },
    /// The schedule at some airspeeds.
    Table { airspeeds: usize },
    /// Corrected models; each has at most `added_states` states more than its physics model.
    Models { models: usize, added_states: usize },
    /// SHA-256 of the other files.
    Checksums { files: usize },
    /// The report, ready to print.
    Report {
        conditions: usize,
        figures: usize,
        tables: usize,
    },
}

/// A channel's signed delay in a condition, far from its mean in the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedDelayApart {
    pub channel: Channel,
    pub tau_s: f64,
    pub elsewhere_s: f64,
}

/// Something that an exported file omits or approximates.
#[derive(Clone, Debug, PartialEq)]
pub enum ExportNote {
    /// The schedule has no delays, although the conditions' own corrections have some.
    DelaysNotScheduled { channels: Vec<DelayedChannel> },
    /// Each scheduled delay is the same at all airspeeds.
    ConstantDelays {
        /// Whether the delays are signed, so that some may be leads.
        is_signed: bool,
    },
    /// In one condition, some channels have signed delays far from those in the others.
    SignedDelaysNotScheduled {
        condition: ConditionId,
        /// Channels, the greatest difference first.
        channels: Vec<SignedDelayApart>,
    },
    /// The requested couplings are unavailable.
    CouplingsLeftOut { why: CouplingError },
    /// Maximum error in a gain due to linear interpolation in a lookup table \[%\].
    GainTableError {
        channel: Channel,
        error_percent: f64,
        airspeed_kt: f64,
        /// Rounded airspeed \[kt\] near `airspeed_kt` at which another table row would reduce the
        /// error; `None` if the table has rows at all candidates.
        remedy_kt: Option<f64>,
    },
    /// Maximum error in a delay, or in a lead's time constant, due to linear interpolation in a
    /// lookup table \[ms\].
    TimeTableError {
        channel: Channel,
        error_ms: f64,
        airspeed_kt: f64,
        /// Rounded airspeed \[kt\] near `airspeed_kt` at which another table row would reduce the
        /// error; `None` if the table has rows at all candidates.
        remedy_kt: Option<f64>,
    },
    /// Lead filters are tables over airspeed.
    LeadsTabulated { points: u32 },
    /// Padé approximants replace delays.
    PadeError {
        order: usize,
        error_deg: f64,
        band_top_rad_s: f64,
        /// Order with a smaller error; `None` for the highest order.
        remedy: Option<usize>,
    },
    /// Tustin's rule converts the lead filters in sampled models.
    TustinError { error_deg: f64, band_top_rad_s: f64 },
    /// Lead filters limit the valid frequency range; their price is the gain that they add above
    /// it.
    NotValidAbove { price: LeadPrice },
    /// Conditions that the engineer excluded from the export.
    ConditionsNotChosen { conditions: Vec<ConditionId> },
    /// Conditions that the schedule fit leaves out.
    ConditionsNotScheduled { conditions: Vec<ConditionId> },
    /// Chosen conditions without a result.
    ConditionsWithoutResult { conditions: Vec<ConditionId> },
    /// The results contain no schedule.
    NoSchedule { why: ScheduleError },
    /// The error bars are not computed.
    NoErrorBars,
    /// The study applies no physics parameters, so that their table is empty.
    NoPhysicsParameters,
    /// No flight records are open, so that the report compares no time histories.
    NoFlightRecords,
    /// Conditions that the report shows in tables only: with figures it would be too long to print.
    ConditionsNotDrawn { conditions: Vec<ConditionId> },
    /// The report is about all conditions, although some are left out of the export.
    ReportOfAllConditions,
}

/// A change to the study or the export that removes or reduces what a note states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ExportRemedy {
    /// Schedules the delays.
    ScheduleDelays,
    /// Lets the signed delays depend on airspeed.
    SignedDelaysOverAirspeed,
    /// Adds a row to the lookup tables.
    AddBreakpoint { airspeed_kt: f64 },
    /// Raises the Padé order.
    UsePadeOrder { order: usize },
    /// Exports all conditions.
    IncludeAllConditions,
}

impl ExportNote {
    /// Returns the stable code, for scripts and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::DelaysNotScheduled { .. } => "delays-not-scheduled",
            Self::ConstantDelays { .. } => "constant-delays",
            Self::SignedDelaysNotScheduled { .. } => "signed-delays-not-scheduled",
            Self::CouplingsLeftOut { .. } => "couplings-left-out",
            Self::GainTableError { .. } => "gain-table-error",
            Self::TimeTableError { .. } => "time-table-error",
            Self::LeadsTabulated { .. } => "leads-tabulated",
            Self::PadeError { .. } => "pade-error",
            Self::TustinError { .. } => "tustin-error",
            Self::NotValidAbove { .. } => "not-valid-above",
            Self::ConditionsNotChosen { .. } => "conditions-not-chosen",
            Self::ConditionsNotScheduled { .. } => "conditions-not-scheduled",
            Self::ConditionsWithoutResult { .. } => "conditions-without-result",
            Self::NoSchedule { .. } => "no-schedule",
            Self::NoErrorBars => "no-error-bars",
            Self::NoPhysicsParameters => "no-physics-parameters",
            Self::NoFlightRecords => "no-flight-records",
            Self::ConditionsNotDrawn { .. } => "conditions-not-drawn",
            Self::ReportOfAllConditions => "report-of-all-conditions",
        }
    }

    /// Returns whether notes in several files state the same fact, so that a single note is enough.
    pub fn has_same_subject(&self, other: &Self) -> bool {
        match (self, other) {
            // The channels may differ: functions concern the scheduled conditions, models the
            // exported ones.
            (Self::DelaysNotScheduled { .. }, Self::DelaysNotScheduled { .. }) => true,
            _ => self == other,
        }
    }

    /// Returns the remedy, if there is one.
    pub fn remedy(&self) -> Option<ExportRemedy> {
        match self {
            Self::DelaysNotScheduled { .. } => Some(ExportRemedy::ScheduleDelays),
            Self::ConstantDelays { is_signed: true } => {
                Some(ExportRemedy::SignedDelaysOverAirspeed)
            }
            Self::GainTableError { remedy_kt, .. } | Self::TimeTableError { remedy_kt, .. } => {
                let airspeed_kt = (*remedy_kt)?;
                Some(ExportRemedy::AddBreakpoint { airspeed_kt })
            }
            Self::PadeError { remedy, .. } => {
                let order = (*remedy)?;
                Some(ExportRemedy::UsePadeOrder { order })
            }
            Self::ConditionsNotChosen { .. } => Some(ExportRemedy::IncludeAllConditions),
            _ => None,
        }
    }
}
