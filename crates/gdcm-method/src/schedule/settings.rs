//! Schedule settings: form, degree, regressed quantity, delays (M11), and how they are written in
//! files. A schedule gives each channel's gain `k`, and delay where requested, as a function of
//! airspeed.

use serde::{Deserialize, Serialize};

use gdcm_model::whole_number::{whole, whole_or_none};

use super::second_variable::SecondVariable;

/// Highest polynomial degree (M11).
pub const HIGHEST_DEGREE: usize = 3;

/// Default cluster tolerance \[kt\] (M11b).
pub const DEFAULT_TOLERANCE_KT: f64 = 2.0;

/// Form of a schedule: the kind of function of airspeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ScheduleKind {
    /// Polynomial by least squares.
    Polynomial {
        /// 0 to [`HIGHEST_DEGREE`].
        degree: usize,
    },
    /// Lookup table: the mean in each airspeed cluster, with linear interpolation.
    Table,
}

/// Quantity regressed on airspeed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum ScheduledQuantity {
    /// `ln k`: the product of two scheduled gains is then the regression of the product.
    #[serde(rename = "ln k")]
    LnGain,
    #[serde(rename = "k")]
    Gain,
}

/// Form, degree and variables for a gain schedule (M11, M13.7).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ScheduleEntry", into = "ScheduleEntry")]
pub struct ScheduleSettings {
    pub kind: ScheduleKind,
    pub quantity: ScheduledQuantity,
    /// Whether this schedule includes delays, as determined by
    /// [`DelayScheduling`](super::delay_scheduling::DelayScheduling) for its conditions. Older
    /// program versions read this field from study settings; there it is `true` only if delays are
    /// always scheduled.
    pub delays: bool,
    /// Polynomial degree for signed delays, 0 to [`HIGHEST_DEGREE`]; 0 by default, because servo,
    /// sensor and computing lags do not depend on airspeed (M15.5).
    pub tau_degree: usize,
    /// Maximum distance between neighbours in an airspeed cluster \[kt\] (M11b).
    pub airspeed_tolerance_kt: f64,
    /// Variable scheduled besides airspeed (M13.7).
    pub second: Option<SecondVariable>,
}

/// [`ScheduleSettings`] in files, where the degree is a field beside the form.
#[derive(Serialize, Deserialize)]
struct ScheduleEntry {
    kind: KindEntry,
    #[serde(default, deserialize_with = "whole_or_none")]
    degree: Option<usize>,
    #[serde(rename = "of")]
    quantity: ScheduledQuantity,
    delays: bool,
    #[serde(default = "default_tolerance_kt")]
    airspeed_tolerance_kt: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    second_variable: Option<SecondVariable>,
    #[serde(default, skip_serializing_if = "is_zero", deserialize_with = "whole")]
    tau_degree: usize,
}

/// [`ScheduleKind`] in files, without its degree.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum KindEntry {
    Polynomial,
    Table,
}

fn default_tolerance_kt() -> f64 {
    DEFAULT_TOLERANCE_KT
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

impl TryFrom<ScheduleEntry> for ScheduleSettings {
    type Error = String;

    fn try_from(entry: ScheduleEntry) -> Result<Self, String> {
        Ok(Self {
            kind: entry.schedule_kind()?,
            quantity: entry.quantity,
            delays: entry.delays,
            tau_degree: entry.tau_degree,
            airspeed_tolerance_kt: entry.airspeed_tolerance_kt,
            second: entry.second_variable,
        })
    }
}

impl ScheduleEntry {
    /// Combines the kind and the degree, separate fields in files.
    fn schedule_kind(&self) -> Result<ScheduleKind, String> {
        match (&self.kind, self.degree) {
            (KindEntry::Table, _) => Ok(ScheduleKind::Table),
            (KindEntry::Polynomial, Some(degree)) if degree <= HIGHEST_DEGREE => {
                Ok(ScheduleKind::Polynomial { degree })
            }
            (KindEntry::Polynomial, Some(degree)) => Err(format!(
                "degree: expected a whole number from 0 to {HIGHEST_DEGREE}, found {degree}"
            )),
            // Worded like serde's own error, so that readers treat both alike.
            (KindEntry::Polynomial, None) => Err("missing field `degree`".to_owned()),
        }
    }
}

impl From<ScheduleSettings> for ScheduleEntry {
    fn from(settings: ScheduleSettings) -> Self {
        let (kind, degree) = match settings.kind {
            ScheduleKind::Polynomial { degree } => (KindEntry::Polynomial, Some(degree)),
            ScheduleKind::Table => (KindEntry::Table, None),
        };
        Self {
            kind,
            degree,
            quantity: settings.quantity,
            delays: settings.delays,
            airspeed_tolerance_kt: settings.airspeed_tolerance_kt,
            second_variable: settings.second,
            tau_degree: settings.tau_degree,
        }
    }
}

impl Default for ScheduleSettings {
    fn default() -> Self {
        Self {
            kind: ScheduleKind::Polynomial { degree: 2 },
            quantity: ScheduledQuantity::LnGain,
            delays: false,
            tau_degree: 0,
            airspeed_tolerance_kt: DEFAULT_TOLERANCE_KT,
            second: None,
        }
    }
}
