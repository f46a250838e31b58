//! ArduPilot DataFlash logs as text: a line `NAME, value, value` for each message.
//!
//! FMT, FMTU, UNIT and MULT lines describe the messages, as in the binary form (`dataflash.rs`);
//! other lines with a time stamp and numbers are samples, grouped into topics
//! (`dataflash_topics.rs`). The values already include the multipliers.

use std::collections::BTreeMap;

use crate::file_error::FileError;
use crate::formats::logs::dataflash_layouts::{Layouts, MessageLayout};
use crate::formats::logs::dataflash_topics::{SampleFields, Topics};
use crate::formats::reading_note::ReadingNote;
use crate::formats::recorded_columns::Columns;
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

/// First characters of a log after blanks are removed.
const BEGINNING: &[u8] = b"FMT,128,89,FMT,";

/// Importer for ArduPilot logs in text form.
pub(crate) const DATAFLASH_TEXT: Importer = Importer {
    name: "an ArduPilot DataFlash log as text",
    endings: &["log"],
    recognises: |bytes, _| {
        let start: Vec<u8> = bytes
            .iter()
            .take(40)
            .copied()
            .filter(|byte| *byte != b' ')
            .collect();
        start.starts_with(BEGINNING)
    },
    read: |bytes, path, budget| {
        let columns =
            read_text(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Logs(vec![columns]))
    },
};

fn read_text(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    budget.take(bytes.len() as u64, 1, "")?;
    let text = String::from_utf8_lossy(bytes);
    let layouts = read_layouts(&text);
    let mut fields_by_name: BTreeMap<&str, SampleFields<'_>> = BTreeMap::new();
    for layout in layouts.by_type.values() {
        if let Some(fields) = SampleFields::find(layout, &layouts) {
            fields_by_name.insert(layout.name.as_str(), fields);
        }
    }
    let mut topics = Topics::default();
    for line in text.lines() {
        budget.work(line.len() as u64, "")?;
        let mut cells = line.split(',').map(str::trim);
        let Some(fields) = cells.next().and_then(|name| fields_by_name.get(name)) else {
            continue;
        };
        let cells: Vec<&str> = cells.collect();
        topics.add(fields, |index| cells.get(index)?.parse().ok(), budget)?;
    }
    topics.into_columns(vec![ReadingNote::ArduPilotText])
}

/// Reads the message layouts from the lines that describe messages.
fn read_layouts(text: &str) -> Layouts {
    let mut layouts = Layouts::default();
    for line in text.lines() {
        let (name, rest) = line.split_once(',').unwrap_or((line, ""));
        match name.trim() {
            "FMT" => {
                let cells: Vec<&str> = rest.splitn(5, ',').map(str::trim).collect();
                if let [kind, _, name, letters, names] = cells.as_slice()
                    && let Ok(kind) = kind.parse()
                    && let Some(layout) = MessageLayout::parse(name, letters, names)
                {
                    layouts.by_type.insert(kind, layout);
                }
            }
            "FMTU" => {
                let cells: Vec<&str> = rest.split(',').map(str::trim).collect();
                if let [_, kind, units, multipliers] = cells.as_slice()
                    && let Ok(kind) = kind.parse()
                {
                    layouts.set_units(kind, units, multipliers);
                }
            }
            "UNIT" => {
                let cells: Vec<&str> = rest.split(',').map(str::trim).collect();
                if let [_, id, label] = cells.as_slice()
                    && let Some(letter) = letter_from(id)
                {
                    layouts.units.insert(letter, (*label).to_owned());
                }
            }
            // MULT is not needed: values in text logs already include the multipliers.
            _ => {}
        }
    }
    layouts
}

/// Parses a unit letter, written as a character code or as the letter itself.
fn letter_from(cell: &str) -> Option<char> {
    match cell.parse::<u8>() {
        Ok(code) => Some(char::from(code)),
        Err(_) => cell.chars().next(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn message_lines_are_read_with_units() {
        let mut text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 130, 44, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds\n\
                        FMT, 140, 19, RATE, Qff, TimeUS,R,ROut\nUNIT, 0, 107, deg/s\nFMTU, 0, 140, sk-, F--\n"
            .to_owned();
        for k in 0..30 {
            text += &format!(
                "RATE, {}, {k}, 0.{k}\nMSG, {k}, hello, there\n",
                1_000_000 + 2500 * k
            );
        }
        assert!((DATAFLASH_TEXT.recognises)(text.as_bytes(), "log"));
        let columns = read_text(text.as_bytes(), &ReadingBudget::new(1 << 20)).unwrap();
        let rate = &columns.columns[0];
        assert_eq!(
            (rate.name.as_str(), rate.unit.as_deref(), rate.meaning),
            ("RATE.R", Some("deg/s"), Some("P"))
        );
        assert_eq!((rate.values[4], columns.columns.len()), (4.0, 2));
        assert!(
            read_text(
                b"FMT, 128, 89, FMT, BBnNZ, Type\n",
                &ReadingBudget::new(1 << 20)
            )
            .is_err()
        );
    }
}
