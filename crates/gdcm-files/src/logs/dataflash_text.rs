//! DataFlash, the logs of ArduPilot, as text: a line for each message, `NAME, value, value`, with what describes messages in FMT,
//! FMTU, UNIT and MULT lines. Values are as the log means them: hundredths are multiplied already.

use std::collections::BTreeMap;
use std::path::Path;

use crate::file_error::FileError;
use crate::importer::{Contents, Importer};
use crate::logs::dataflash::{Layout, Layouts, Taken, Topics};
use crate::record_files::Columns;
use crate::variables::{ReadingBudget, VariableFault};

/// Logs of ArduPilot as text.
pub(crate) struct DataFlashText;

impl Importer for DataFlashText {
    fn name(&self) -> &'static str {
        "a DataFlash log of ArduPilot as text"
    }

    fn endings(&self) -> &'static [&'static str] {
        &["log"]
    }

    fn recognises(&self, bytes: &[u8], _: &str) -> bool {
        let start: Vec<u8> = bytes.iter().take(40).copied().filter(|byte| *byte != b' ').collect();
        start.starts_with(b"FMT,128,89,FMT,")
    }

    fn read(&self, bytes: &[u8], path: &Path, budget: &ReadingBudget<'_>) -> Result<Contents, FileError> {
        let columns = read_text(bytes, budget).map_err(|fault| FileError::variables(path, fault))?;
        Ok(Contents::Logs(vec![columns]))
    }
}

fn read_text(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Columns, VariableFault> {
    budget.take(bytes.len() as u64, 1, "")?;
    let text = String::from_utf8_lossy(bytes);
    let layouts = layouts_of(&text);
    let by_name: BTreeMap<&str, Taken<'_>> = layouts
        .by_type
        .values()
        .filter_map(|layout| Some((layout.name.as_str(), Taken::of(layout, &layouts)?)))
        .collect();
    let mut topics = Topics::default();
    for line in text.lines() {
        budget.work(line.len() as u64, "")?;
        let mut cells = line.split(',').map(str::trim);
        let Some(taken) = cells.next().and_then(|name| by_name.get(name)) else { continue };
        let cells: Vec<&str> = cells.collect();
        topics.take(taken, |at| cells.get(at)?.parse::<f64>().ok(), budget)?;
    }
    topics.columns(vec!["a log of ArduPilot as text; time in seconds since the autopilot was started".to_owned()])
}

/// What the lines that describe others say.
fn layouts_of(text: &str) -> Layouts {
    let mut layouts = Layouts::default();
    for line in text.lines() {
        let (name, rest) = line.split_once(',').unwrap_or((line, ""));
        let cells: Vec<&str> = match name.trim() {
            "FMT" => rest.splitn(5, ',').map(str::trim).collect(),
            "FMTU" | "UNIT" | "MULT" => rest.split(',').map(str::trim).collect(),
            _ => continue,
        };
        let letter = |cell: &str| cell.parse::<u8>().map(char::from).ok().or_else(|| cell.chars().next());
        match (name.trim(), cells.as_slice()) {
            ("FMT", [kind, _, name, letters, names]) => {
                if let (Ok(kind), Some(layout)) = (kind.parse(), Layout::of(name, letters, names)) {
                    layouts.by_type.insert(kind, layout);
                }
            }
            ("FMTU", [_, kind, units, by]) => {
                kind.parse().into_iter().for_each(|kind| layouts.describe(kind, units, by));
            }
            ("UNIT", [_, id, label]) => {
                letter(id).into_iter().for_each(|id| drop(layouts.units.insert(id, (*label).to_owned())));
            }
            // Values of a text are multiplied already.
            _ => {}
        }
    }
    layouts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_for_each_message_is_read_with_units() {
        let mut text = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 130, 44, FMTU, QBNN, TimeUS,FmtType,UnitIds,MultIds\n\
                        FMT, 140, 19, RATE, Qff, TimeUS,R,ROut\nUNIT, 0, 107, deg/s\nFMTU, 0, 140, sk-, F--\n"
            .to_owned();
        for k in 0..30 {
            text += &format!("RATE, {}, {k}, 0.{k}\nMSG, {k}, hello, there\n", 1_000_000 + 2500 * k);
        }
        assert!(DataFlashText.recognises(text.as_bytes(), "log"));
        let columns = read_text(text.as_bytes(), &ReadingBudget::new(1 << 20)).unwrap();
        let rate = &columns.columns[0];
        assert_eq!((rate.name.as_str(), rate.unit.as_deref(), rate.meaning), ("RATE.R", Some("deg/s"), Some("P")));
        assert_eq!((rate.values[4], columns.columns.len()), (4.0, 2));
        assert!(read_text(b"FMT, 128, 89, FMT, BBnNZ, Type\n", &ReadingBudget::new(1 << 20)).is_err());
    }
}
