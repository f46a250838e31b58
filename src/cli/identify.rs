//! `gdcm identify`: models out of flight records.

use std::path::{Path, PathBuf};

use crate::app::Pool;
use crate::assembly::{ChannelRule, standard_patterns};
use crate::dataset::{Band, Condition, ConditionId, ConditionRecord, Dataset, DraftError};
use crate::identification::{ChannelPreparation, FlightRecord, Options, Preparation, identify as identify_records};
use crate::io::{
    FoundRecords, IdentifiedModels, LoadedDataset, Opened, OutputSet, add_dataset, add_identified, load_any,
    make_directory, plain, plain_path, read_records, relative_folder,
};
use crate::records::{LayoutProposal, RecordChannels, RecordGuess, RecordLayout, RecordTable, TimeWish};
use crate::units::telling;

use super::existing;
use super::failure::Failure;
use super::identification_outcome::identified_models;
use super::identify_arguments::{ChannelList, IdentifyArguments};
use super::models::{ReadingProgress, counted};
use super::progress::TerminalProgress;
use super::terminal::{say, say_error};
use super::text_table::{Side, TextTable};

/// The file of what was found.
const IDENTIFIED: &str = "identified.json";

/// What models are to be identified from.
struct IdentificationTask {
    /// The records, and whether each is held out.
    records: Vec<(FlightRecord, bool)>,
    /// The channels, in the units of the records.
    channels: RecordChannels,
    /// The band.
    band: Band,
    /// Known delays of the inputs \[s\], positive where logged late.
    input_delays_s: Vec<f64>,
    /// Known delays of the outputs \[s\].
    output_delays_s: Vec<f64>,
}

/// The condition of a dataset that models are put into.
struct Destination {
    loaded: LoadedDataset,
    condition: ConditionId,
    path: PathBuf,
}

/// A record as it was read.
struct ReadRecord {
    table: RecordTable,
    layout: RecordLayout,
    guess: RecordGuess,
}

/// Identifies models from flight records and writes them, beside a dataset with them in it where one is given.
pub(super) fn identify(arguments: &IdentifyArguments) -> Result<(), Failure> {
    let inputs = arguments.records.iter().chain(&arguments.into).cloned().collect();
    let mut outputs = OutputSet::new(existing(arguments.force), inputs);
    let identified = arguments.out.join(IDENTIFIED);
    let destination = arguments.into.as_deref().zip(arguments.condition);
    let destination = destination.map(|(path, id)| Destination::open(path, id, &arguments.out)).transpose()?;
    let places: Vec<&Path> =
        std::iter::once(identified.as_path()).chain(destination.iter().map(|of| of.path.as_path())).collect();
    outputs.check(&places)?;
    let mut channels = channels(arguments, destination.as_ref())?;
    let band = band(arguments, destination.as_ref())?;
    let records = held_out(arguments, laid_out(arguments, &mut channels)?)?;
    say(&table(&records))?;
    let task = task(arguments, &records, channels, band)?;
    let found = found_in(&task, &records)?;
    make_directory(&arguments.out)?;
    add_identified(&found, &identified, &mut outputs)?;
    if let Some(destination) = &destination {
        let entries = records.iter().map(|record| entry(record, &arguments.records, &destination.path)).collect();
        add_dataset(&destination.filled(&found, entries)?, &destination.path, &mut outputs)?;
    }
    outputs.persist()?;
    let models = counted(found.models.len(), "model");
    found.cautions.iter().for_each(|caution| say_error(&plain(caution)));
    say(&places.iter().map(|path| format!("{}: {models}\n", plain_path(path))).collect::<String>())
}

/// Identification proper, with a word about how far it is on a terminal.
fn found_in(task: &IdentificationTask, records: &[ReadRecord]) -> Result<IdentifiedModels, Failure> {
    let IdentificationTask { records: flights, channels, band, input_delays_s, output_delays_s } = task;
    let prepared = |rules: &[ChannelRule], delays: &[f64]| -> Vec<ChannelPreparation> {
        let of = |(rule, delay_s): (&ChannelRule, &f64)| ChannelPreparation {
            delay_s: *delay_s,
            ..ChannelPreparation::named(rule.name.clone())
        };
        rules.iter().zip(delays).map(of).collect()
    };
    let preparation = Preparation {
        inputs: prepared(&channels.inputs, input_delays_s),
        outputs: prepared(&channels.outputs, output_delays_s),
        ..Preparation::of(&[], &[])
    };
    let held_out = flights.iter().enumerate().filter(|(_, (_, held_out))| *held_out).map(|(index, _)| index);
    let options = Options { held_out: held_out.collect(), ..Options::new([band.min(), band.max()], preparation) };
    let all: Vec<FlightRecord> = flights.iter().map(|(flight, _)| flight.clone()).collect();
    let found = identify_records(&all, &options, &Pool, &TerminalProgress::new("identifying"))
        .map_err(|error| Failure::NoModels { reason: error.to_string() })?;
    let with_tables: Vec<(FlightRecord, &RecordTable)> =
        all.into_iter().zip(records.iter().map(|record| &record.table)).collect();
    Ok(identified_models(&found, &options, &with_tables, channels))
}

impl Destination {
    fn open(path: &Path, condition: i64, out: &Path) -> Result<Self, Failure> {
        let loaded = match load_any(path)? {
            Opened::Dataset(loaded) => loaded,
            Opened::Study(_) => {
                let reason = "expected a dataset, found a study; give the study's dataset".to_owned();
                return Err(Failure::Option { option: "--into", reason });
            }
        };
        let condition = ConditionId(condition);
        if loaded.dataset.condition(condition).is_none() {
            let ids: Vec<String> = loaded.dataset.conditions().iter().map(|of| of.id().to_string()).collect();
            let reason = format!("the dataset has no condition {condition}; it has {}", ids.join(", "));
            return Err(Failure::Option { option: "--condition", reason });
        }
        let path = out.join(path.file_name().unwrap_or_default());
        Ok(Self { loaded, condition, path })
    }

    /// The dataset with the models and records in the condition.
    fn filled(&self, found: &IdentifiedModels, records: Vec<ConditionRecord>) -> Result<Dataset, Failure> {
        let dataset = &self.loaded.dataset;
        let refused =
            |reason: String| Failure::NoModels { reason: format!("the dataset does not take the models: {reason}") };
        let condition: &Condition =
            dataset.condition(self.condition).ok_or_else(|| refused("no condition".to_owned()))?;
        let model = |draft| -> Result<_, DraftError> { Ok(dataset.identified_model(draft)?.0) };
        let models = found.models.iter().map(|model_found| model(model_found.draft.clone()));
        let models = models.collect::<Result<_, _>>().map_err(|error: DraftError| refused(error.fault.to_string()))?;
        let condition = condition.with_identified(models, records).map_err(|error| refused(error.to_string()))?;
        dataset.with_condition(condition).map_err(|error| refused(error.to_string()))
    }
}

/// The channels asked for: the dataset's, in its units, or those of the command line, in the units of the first record.
fn channels(arguments: &IdentifyArguments, destination: Option<&Destination>) -> Result<RecordChannels, Failure> {
    let Some(destination) = destination else {
        let rules = |list: &Option<ChannelList>| {
            let channels = list.iter().flat_map(|list| &list.channels);
            channels.map(|(name, column)| with_column(ChannelRule::named(name.clone()), column.as_ref())).collect()
        };
        return Ok(RecordChannels { inputs: rules(&arguments.inputs), outputs: rules(&arguments.outputs) });
    };
    let mut channels = RecordChannels::of_dataset(&destination.loaded.dataset);
    for (option, list, rules) in [
        ("--inputs", &arguments.inputs, &mut channels.inputs),
        ("--outputs", &arguments.outputs, &mut channels.outputs),
    ] {
        for (name, column) in list.iter().flat_map(|list| &list.channels) {
            let Some(rule) = rules.iter_mut().find(|rule| rule.name == *name) else {
                let names: Vec<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
                let reason = format!("the dataset has no {name} there; it has {}", names.join(", "));
                return Err(Failure::Option { option, reason });
            };
            *rule = with_column(std::mem::take(rule), column.as_ref());
        }
    }
    Ok(channels)
}

/// The rule of a channel that is this column, where one is said.
fn with_column(rule: ChannelRule, column: Option<&String>) -> ChannelRule {
    ChannelRule { aliases: column.cloned().into_iter().collect(), ..rule }
}

fn band(arguments: &IdentifyArguments, destination: Option<&Destination>) -> Result<Band, Failure> {
    match (arguments.band.as_deref(), destination) {
        (Some(&[min, max]), _) => {
            Band::new(min, max).map_err(|error| Failure::Option { option: "--band", reason: error.to_string() })
        }
        (_, Some(destination)) => Ok(destination.loaded.dataset.band()),
        _ => Err(Failure::Option { option: "--band", reason: "expected two frequencies".to_owned() }),
    }
}

/// Every record with its columns; what was chosen, and what is wrong, is told on standard error.
fn laid_out(arguments: &IdentifyArguments, channels: &mut RecordChannels) -> Result<Vec<ReadRecord>, Failure> {
    let tables = tables(arguments)?;
    let wish = TimeWish { column: arguments.time.clone(), sample_time_s: arguments.sample_rate.map(|rate| 1.0 / rate) };
    let patterns = standard_patterns();
    let (mut records, mut wrong, mut told): (Vec<ReadRecord>, usize, Vec<String>) = (Vec::new(), 0, Vec::new());
    for table in tables {
        let LayoutProposal { layout, notes, problems, cautions } = RecordLayout::proposed(&table, channels, &wish);
        let name = plain(&table.name);
        // Records of one flight are alike: what is chosen is said once.
        if notes != told {
            notes.iter().for_each(|note| say_error(&format!("{name}: {}", plain(note))));
            told = notes;
        }
        cautions.iter().for_each(|caution| say_error(&format!("{name}: caution: {}", plain(&caution.to_string()))));
        problems.iter().for_each(|problem| say_error(&format!("{name}: {}", plain(&problem.to_string()))));
        wrong += usize::from(!problems.is_empty());
        channels.take_units(&layout, &table);
        let guess = RecordGuess::of(&format!("{}/{}", table.source.file, table.name), &patterns);
        records.push(ReadRecord { table, layout, guess });
    }
    if wrong > 0 { Err(Failure::Records { wrong, of: records.len() }) } else { Ok(records) }
}

fn tables(arguments: &IdentifyArguments) -> Result<Vec<RecordTable>, Failure> {
    let FoundRecords { tables, faults, passed_over, .. } = read_records(&arguments.records, &ReadingProgress::new())?;
    faults.iter().for_each(|fault| say_error(&format!("not taken: {}", plain(fault))));
    passed_over.iter().for_each(|words| say_error(&format!("no record: {}", plain(words))));
    if tables.is_empty() {
        return Err(Failure::Option { option: "RECORD", reason: "holds no record that could be taken".to_owned() });
    }
    Ok(tables)
}

/// Which records are held out: those asked for, or else those whose names say so.
fn held_out(arguments: &IdentifyArguments, mut records: Vec<ReadRecord>) -> Result<Vec<ReadRecord>, Failure> {
    if !arguments.hold_out.is_empty() {
        records.iter_mut().for_each(|record| record.guess.held_out = false);
    }
    for wanted in &arguments.hold_out {
        let file = Path::new(wanted).file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let is_it = |record: &&mut ReadRecord| {
            let source = &record.table.source;
            let own = source.file.rsplit('/').next() == Some(&file);
            own || record.table.name == *wanted || source.variable.as_deref() == Some(wanted)
        };
        let found: Vec<&mut ReadRecord> = records.iter_mut().filter(is_it).collect();
        if found.is_empty() {
            let reason = format!("\"{wanted}\" is none of the records; give its file among them too");
            return Err(Failure::Option { option: "--hold-out", reason });
        }
        found.into_iter().for_each(|record| record.guess.held_out = true);
    }
    if records.iter().all(|record| record.guess.held_out) {
        let reason = "every record is held out; at least one has to be left to identify from".to_owned();
        return Err(Failure::Option { option: "--hold-out", reason });
    }
    Ok(records)
}

fn task(
    arguments: &IdentifyArguments,
    records: &[ReadRecord],
    channels: RecordChannels,
    band: Band,
) -> Result<IdentificationTask, Failure> {
    let flight = |record: &ReadRecord| {
        let flight = record.layout.flight_record(&record.table, &channels);
        flight
            .map(|flight| (flight, record.guess.held_out))
            .map_err(|_| Failure::Records { wrong: 1, of: records.len() })
    };
    let flights = records.iter().map(flight).collect::<Result<_, _>>()?;
    let delays = |rules: &[ChannelRule]| -> Vec<f64> {
        let of = |rule: &ChannelRule| arguments.delay.iter().rfind(|delay| delay.channel == rule.name);
        rules.iter().map(|rule| of(rule).map_or(0.0, |delay| delay.delay_s)).collect()
    };
    let all = || channels.inputs.iter().chain(&channels.outputs);
    if let Some(unknown) = arguments.delay.iter().find(|delay| all().all(|rule| rule.name != delay.channel)) {
        let reason = format!("{} is none of the channels", unknown.channel);
        return Err(Failure::Option { option: "--delay", reason });
    }
    let (input_delays_s, output_delays_s) = (delays(&channels.inputs), delays(&channels.outputs));
    Ok(IdentificationTask { records: flights, channels, band, input_delays_s, output_delays_s })
}

/// What the dataset says of a record, its file relative to the dataset's.
fn entry(record: &ReadRecord, asked: &[PathBuf], dataset: &Path) -> ConditionRecord {
    let mut entry = record.layout.condition_record(&record.table, &record.guess);
    // A file by itself, or below the folder that was asked for.
    let place = asked.iter().find_map(|path| {
        let own = path.file_name().is_some_and(|name| name.to_string_lossy() == record.table.source.file.as_str());
        let below = path.join(&record.table.source.file);
        if own { Some(path.clone()) } else { Some(below).filter(|_| path.is_dir()) }
    });
    if let Some(place) = place {
        let folder = relative_folder(place.parent().unwrap_or(Path::new(".")), dataset);
        let name = place.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        entry.file = if folder.is_empty() || folder == "." { name } else { format!("{folder}/{name}") };
    }
    entry
}

/// A line a record.
fn table(records: &[ReadRecord]) -> String {
    use Side::{Left, Right};
    let heads = [("record", Left), ("kind", Left), ("samples", Right), ("step", Right), ("length", Right), ("", Left)];
    let mut table = TextTable::new(heads);
    for ReadRecord { table: record, layout, guess } in records {
        let step_s = layout.time.and_then(|time| time.step_s(record)).unwrap_or(f64::NAN);
        table.row([
            plain(&record.name),
            guess.kind.word().to_owned(),
            record.rows().to_string(),
            format!("{} s", telling(step_s, 3)),
            format!("{:.1} s", step_s * record.rows() as f64),
            if guess.held_out { "held out".to_owned() } else { String::new() },
        ]);
    }
    table.lines(0)
}
