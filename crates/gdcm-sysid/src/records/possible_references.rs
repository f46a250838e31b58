//! Finds a record's columns that may hold a reference: a signal that drove the loop from outside
//! (M14.15).

use super::laid_out_record::LaidOutRecord;

/// Name endings for recorded references: pilot and position references, setpoints, injected
/// signals. Endings up to two letters long must be whole words.
const REFERENCES: &str =
    "ref reference cmd command sp setpoint des desired targ target chirp excitation x0";
/// Documented meaning that marks a reference: the target in a system identification mode.
const REFERENCE_MEANING: &str = "TARG";

impl LaidOutRecord {
    /// Returns the varying columns that are neither the time nor a channel: these may have driven
    /// the loop from outside (M14.15). The flag states whether the column is named like a
    /// reference; flagged columns come first.
    pub fn possible_references(&self) -> Vec<(&str, bool)> {
        let mut taken = Vec::new();
        taken.extend(self.layout.time_column());
        for used in self.layout.inputs.iter().chain(&self.layout.outputs) {
            taken.extend(used.map(|used| used.column));
        }
        let mut found = Vec::new();
        for (index, column) in self.table.columns.iter().enumerate() {
            if taken.contains(&index) || !column.varies() {
                continue;
            }
            // A column that the logging system's documentation identifies as an aircraft signal is
            // not a reference.
            let may_be_reference = column
                .meaning
                .is_none_or(|meaning| meaning == REFERENCE_MEANING);
            let is_reference = may_be_reference && is_reference_name(&column.name);
            found.push((column.name.as_str(), is_reference));
        }
        found.sort_by_key(|(_, is_reference)| !is_reference);
        found
    }
}

/// Returns whether a word in a name marks a recorded reference: "pos_ref", "RATE.RDes",
/// "SIDD.Targ".
fn is_reference_name(name: &str) -> bool {
    name.to_lowercase()
        .split(|letter: char| !letter.is_alphanumeric())
        .any(ends_as_reference)
}

fn ends_as_reference(word: &str) -> bool {
    REFERENCES
        .split(' ')
        .any(|end| word == end || (end.len() > 2 && word.ends_with(end)))
}

#[cfg(test)]
mod tests {
    use gdcm_model::names::ChannelRule;

    use super::*;
    use crate::records::layout_proposal::TimeSettings;
    use crate::records::record_channels::RecordChannels;
    use crate::records::record_table::{RecordColumn, RecordTable};

    fn moving(name: &str) -> RecordColumn {
        RecordColumn::new(name, (0..60).map(|k| f64::from(k) * 0.02).collect())
    }

    fn documented(name: &str, meaning: &'static str) -> RecordColumn {
        RecordColumn {
            meaning: Some(meaning),
            ..moving(name)
        }
    }

    #[test]
    fn possible_references_are_varying_columns_and_those_with_reference_names_come_first() {
        let columns = vec![
            moving("t"),
            moving("M"),
            moving("q"),
            moving("theta"),
            moving("x0"),
            moving("RATE.RDes"),
            documented("SIDD.Targ", "TARG"),
            documented("torque_setpoint", "LAT"),
            RecordColumn::new("yaw_ref", vec![1.0; 60]),
        ];
        let table = RecordTable::new("log", columns);
        let channels = RecordChannels {
            inputs: vec![ChannelRule::named("M")],
            outputs: vec![ChannelRule::named("q")],
            ..RecordChannels::default()
        };
        let (record, _) = LaidOutRecord::proposed(table, &channels, &TimeSettings::default());
        assert_eq!(
            record.possible_references(),
            [
                ("x0", true),
                ("RATE.RDes", true),
                ("SIDD.Targ", true),
                ("theta", false),
                ("torque_setpoint", false),
            ]
        );
    }
}
