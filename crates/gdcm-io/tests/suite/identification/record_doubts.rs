//! Cautions about spikes and rate limits in logged flights (M14.24): the example's records, and the
//! log files of a folder.

use std::sync::Arc;

use nalgebra::DMatrix;

use gdcm_io::import::record_files::records_of_bytes;
use gdcm_io::reading_budget::ReadingBudget;
use gdcm_model::executor::Sequential;
use gdcm_model::simulation::FlightRecord;
use gdcm_sysid::identification::Preparation;
use gdcm_sysid::records::RecordTable;
use gdcm_sysid::spectra::preparation::prepare;
use gdcm_sysid::spectra::record_cautions::RecordCaution;

/// Environment variable with the path of a folder of log files.
const FOLDER: &str = "GDCM_LOGGED_FLIGHTS";

/// A channel on its own clock.
struct LoggedChannel {
    name: String,
    time_s: Vec<f64>,
    values: Vec<f64>,
}

/// Returns the channels of a table that vary, each with its own time stamps; columns without a
/// topic use the first column that always increases.
fn channels(table: &RecordTable) -> Vec<LoggedChannel> {
    let clock = table
        .columns
        .iter()
        .position(|column| column.topic.is_none() && increases(&column.values));
    let mut channels = Vec::new();
    for (index, column) in table.columns.iter().enumerate() {
        let time_s = match (&column.topic, clock) {
            (Some(topic), _) => Arc::clone(topic).time_s.clone(),
            (None, Some(clock)) if clock != index => table.columns[clock].values.clone(),
            _ => continue,
        };
        let is_moving = column.values.windows(2).any(|pair| pair[0] != pair[1]);
        if is_moving && time_s.len() == column.values.len() {
            channels.push(LoggedChannel {
                name: column.name.clone(),
                time_s,
                values: column.values.clone(),
            });
        }
    }
    channels
}

fn increases(values: &[f64]) -> bool {
    values.len() > 1 && values.windows(2).all(|pair| pair[0] < pair[1])
}

/// Returns the cautions about spikes and rate limits of a channel, taken as the input of a record
/// whose output is a sine.
fn spike_and_rate_cautions(channel: &LoggedChannel) -> Vec<RecordCaution> {
    let rows = channel.values.len();
    let record = FlightRecord {
        name: channel.name.clone(),
        time_s: channel.time_s.clone(),
        inputs: DMatrix::from_column_slice(rows, 1, &channel.values),
        outputs: DMatrix::from_fn(rows, 1, |row, _| (0.01 * row as f64).sin()),
    };
    let preparation = Preparation {
        resample: true,
        least_segment_s: 1.0,
        ..Preparation::new(&[channel.name.as_str()], &["sine"])
    };
    let Ok(prepared) = prepare(&[record], &preparation, &Sequential) else {
        return Vec::new();
    };
    let mut cautions = prepared.cautions;
    cautions.retain(|caution| {
        matches!(
            caution,
            RecordCaution::Spike { .. } | RecordCaution::RateLimited { .. }
        )
    });
    cautions
}

fn tables(bytes: &[u8], name: &str) -> Vec<RecordTable> {
    records_of_bytes(bytes, name, &ReadingBudget::new(1 << 30))
        .expect("the records can be read")
        .tables
}

#[test]
fn the_examples_records_have_no_spikes_and_no_rate_limits() {
    let mut count = 0;
    for table in tables(&crate::records_archive(), "example-records.zip") {
        for channel in channels(&table) {
            count += 1;
            assert_eq!(
                spike_and_rate_cautions(&channel),
                [],
                "{}: {}",
                table.name,
                channel.name
            );
        }
    }
    // Nine records of eleven conditions, with six outputs and four inputs each.
    assert_eq!(count, 990);
}

#[test]
#[ignore = "reads the log files of a folder given by an environment variable"]
fn print_cautions_about_the_logs_of_a_folder() {
    let Some(folder) = std::env::var_os(FOLDER) else {
        return;
    };
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let Ok(bytes) = std::fs::read(&path) else {
            continue;
        };
        let Ok(read) = records_of_bytes(&bytes, &name, &ReadingBudget::new(1 << 30)) else {
            continue;
        };
        let mut count = 0;
        for table in &read.tables {
            for channel in channels(table) {
                count += 1;
                for caution in spike_and_rate_cautions(&channel) {
                    println!("{name}: {caution}");
                }
            }
        }
        println!("{name}: {count} channels");
    }
}
