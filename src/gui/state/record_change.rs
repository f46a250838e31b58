//! Changes to flight records in the undo history.
//!
//! A remedy corrects a channel in a single record (M14.16: docs/identification.md); a part is a
//! time span of a record, used instead of the whole.

use gdcm_model::dataset::ConditionId;
use gdcm_model::dataset::condition::RecordKind;
use gdcm_model::number_format::counted;

/// A change to flight records that can be undone, with the names of the records and channels that
/// it concerns.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordChange {
    /// A change to the records in one condition.
    InCondition {
        condition: ConditionId,
        change: ConditionRecordChange,
    },
    /// A record's columns were changed, and those of similar records in all conditions.
    Columns { record: String },
    /// The assumed units were confirmed.
    DatasetUnits,
    /// Records were added to their conditions.
    Add { records: usize },
    /// Added records without a condition were assigned to one.
    Assign {
        records: usize,
        condition: ConditionId,
    },
    /// An added record without a condition was removed.
    Discard { record: String },
}

/// A change to the records in one condition.
#[derive(Clone, Debug, PartialEq)]
pub enum ConditionRecordChange {
    Kind {
        record: String,
        kind: RecordKind,
    },
    Use {
        record: String,
        used: bool,
    },
    HoldOut {
        record: String,
        held_out: bool,
    },
    TimeSkew {
        channel: String,
    },
    Remedies {
        record: String,
    },
    SampleHold {
        channel: String,
    },
    Band,
    Search,
    References,
    AddPart {
        record: String,
    },
    MovePart {
        record: String,
    },
    RemovePart {
        record: String,
    },
    /// Any other change.
    Records,
}

impl RecordChange {
    /// Returns the change's name in the menu, such as "leave run_2 out (condition 10)".
    pub fn name(&self) -> String {
        match self {
            Self::InCondition { condition, change } => {
                format!("{} (condition {condition})", change.name())
            }
            Self::Columns { record } => format!("change the columns of {record}"),
            Self::DatasetUnits => "confirm the assumed units".to_owned(),
            Self::Add { records } => format!("add {}", counted(*records, "record")),
            Self::Assign { records, condition } => {
                format!(
                    "assign {} to condition {condition}",
                    counted(*records, "record")
                )
            }
            Self::Discard { record } => format!("remove {record}"),
        }
    }
}

impl ConditionRecordChange {
    fn name(&self) -> String {
        match self {
            Self::Kind { record, kind } => {
                format!("set the manoeuvre of {record} to {}", kind.word())
            }
            Self::Use { record, used: true } => format!("use {record}"),
            Self::Use { record, .. } => format!("leave {record} out"),
            Self::HoldOut {
                record,
                held_out: true,
            } => format!("hold {record} out"),
            Self::HoldOut { record, .. } => format!("stop holding {record} out"),
            Self::TimeSkew { channel } => format!("set the time skew of {channel}"),
            Self::Remedies { record } => format!("correct channels of {record}"),
            Self::SampleHold { channel } => format!("set the sample hold of {channel}"),
            Self::Band => "set the identification band".to_owned(),
            Self::Search => "change orders, past windows or Laguerre poles".to_owned(),
            Self::References => "choose the references".to_owned(),
            Self::AddPart { record } => format!("add a part of {record}"),
            Self::MovePart { record } => format!("move the ends of {record}"),
            Self::RemovePart { record } => format!("remove {record}"),
            Self::Records => "change the records".to_owned(),
        }
    }
}
