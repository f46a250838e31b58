//! `gdcm identify`: models out of flight records.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::executor::Pool;
use gdcm_core::assembly::ChannelRule;
use gdcm_core::dataset::{Band, BundleKind, ChannelRemedy, ChannelSide, ConditionId, ConditionRecord, Dataset};
use gdcm_core::identification::{
    CautionNote, ChannelPreparation, Hold, Identification, IdentificationCaution, IdentificationError, Preparation,
    RecordUse, Signal, is_held,
};
use gdcm_core::message_text::sanitized_path;
use gdcm_core::records::{
    ChannelList, LaidOutRecord, RecordChannels, ResamplingWish, SaidChannel, SaidConversion, median_step,
};
use gdcm_core::study::{AdoptedModels, ChannelTimeSkew, IdentificationRequest};
use gdcm_files::{IdentifiedModels, OutputSet, add_identified, make_directory, relative_entry};

use super::{
    ChannelDelay, ChannelTopic, Destination, Failure, Group, IdentifyArguments, ReadRecords, TerminalProgress,
    by_words, caution, caution_of, counted, existing, hold_out, is_called, laid_out, listed_paths, note, of_one_record,
    record_table, said_conditions, say, say_conversions,
};

/// The file of what was found.
const IDENTIFIED: &str = "identified.json";

/// Identifies models from flight records and writes them, beside a dataset with them in it where one is given.
pub(super) fn identify(arguments: &IdentifyArguments) -> Result<(), Failure> {
    let inputs = arguments.records.iter().chain(&arguments.into).cloned().collect();
    let mut outputs = OutputSet::new(existing(arguments.force), inputs);
    let mut destination = Destination::asked(arguments)?;
    let band = band(arguments, destination.as_ref())?;
    let mut channels = channels(arguments, destination.as_ref(), band)?;
    let Tasks { tasks, unread, reading, copies } = tasks(arguments, destination.as_ref(), &mut channels, band)?;
    let files: Vec<PathBuf> = tasks.iter().map(|task| identified_path(arguments, task)).collect();
    let dataset = destination.iter().map(|of| of.path.as_path());
    outputs.check(&files.iter().map(PathBuf::as_path).chain(dataset).collect::<Vec<&Path>>())?;
    say(&tasks.iter().map(IdentificationTask::table).collect::<String>())?;
    let (mut lines, mut taken, mut of_use) = (String::new(), 0, false);
    let mut cautions = Vec::new();
    for (task, file) in tasks.iter().zip(&files) {
        let found = match task.run() {
            Ok(found) => found,
            Err(why) if tasks.len() == 1 => return Err(Failure::NoModels { reason: why.to_string() }),
            Err(why) => {
                cautions.push((task.condition, format!("no model was identified: {why}")));
                continue;
            }
        };
        let records: Vec<ConditionRecord> =
            task.records.iter().zip(&found.record_uses).map(|(record, used)| record.entry(used, &channels)).collect();
        let late = destination.as_ref().and_then(|of| task.late_channel(&found, &of.dataset));
        let facts: Vec<String> = found.record_uses.iter().flat_map(RecordUse::facts).collect();
        facts.iter().for_each(|fact| note(fact));
        let reading: Vec<String> = reading.iter().cloned().chain(facts).collect();
        let of_task: Vec<CautionNote> = found.cautions.iter().map(|of| task.note(of)).chain(late).collect();
        cautions.extend(of_task.iter().map(|of| (task.condition, of.text.clone())));
        let is_here = |name: &str| task.records.iter().any(|record| record.table.name == name);
        let copies = copies.iter().filter(|(first, _)| is_here(first)).map(|(_, note)| note.clone());
        let of_task: Vec<CautionNote> = of_task.into_iter().chain(copies).collect();
        let of_model = without_references(&channels, arguments);
        of_use |= (0..of_model.inputs.len()).any(|input| is_identified(&found, input, of_model.outputs.len()));
        make_directory(&arguments.out)?;
        let models = IdentifiedModels {
            found: &found,
            channels: &of_model,
            records: &records,
            cautions: &of_task,
            reading: &reading,
        };
        add_identified(&models, file, &mut outputs)?;
        if let (Some(destination), Some(condition)) = (&mut destination, task.condition) {
            let entries = records.into_iter().map(|of| relative_entry(of, &arguments.records, &destination.path));
            destination.take(condition, &AdoptedModels::of(&found, arguments.take.offered(), entries.collect()))?;
        }
        lines += &outcome(task, file, &found);
        taken += 1;
    }
    let (of_conditions, of_all): (Vec<_>, Vec<_>) =
        cautions.into_iter().partition(|(condition, _)| condition.is_some());
    of_all.iter().for_each(|(_, words)| caution(words));
    let of_conditions = of_conditions.into_iter().filter_map(|(condition, words)| Some((condition?, words)));
    by_words(of_conditions).iter().for_each(|(conditions, words)| caution_of(conditions, words));
    if taken == 0 {
        return Err(Failure::NoModels { reason: format!("in none of {} conditions", tasks.len()) });
    }
    if let Some(destination) = &destination {
        let path = sanitized_path(destination.add(&mut outputs)?);
        lines += &format!("{path}: identified models of {}\n", counted(taken, "condition"));
    }
    outputs.persist()?;
    say(&lines)?;
    if !of_use {
        let names: Vec<&str> = channels.inputs.iter().map(|rule| rule.name.as_str()).collect();
        return Err(Failure::NotIdentified { inputs: names.join(", ") });
    }
    if unread.is_empty() { Ok(()) } else { Err(Failure::Unread { paths: listed_paths(&unread) }) }
}

/// The channels of the models: references are none.
fn without_references(channels: &RecordChannels, arguments: &IdentifyArguments) -> RecordChannels {
    let mut of_model = channels.clone();
    of_model.inputs.truncate(channels.inputs.len() - arguments.references().len());
    of_model
}

/// Whether the records say anything of an input: the others do not explain it, and a response to it is known (M14).
fn is_identified(found: &Identification, input: usize, outputs: usize) -> bool {
    let is_swept = found.measured.excitation().not_identified().all(|of| of != input);
    is_swept && (0..outputs).any(|output| !found.not_identified.contains(&(output, input)))
}

/// Models are to be identified from the records of a condition.
struct IdentificationTask {
    /// The condition of the dataset; none without one.
    condition: Option<ConditionId>,
    records: Vec<LaidOutRecord>,
    request: IdentificationRequest,
}

impl IdentificationTask {
    /// The task of a group of records.
    fn new(
        (condition, records): Group,
        preparation: &Preparation,
        band: Band,
        arguments: &IdentifyArguments,
    ) -> Result<Self, Failure> {
        let request = IdentificationRequest::of(records.iter(), preparation.clone(), [band.min(), band.max()]);
        let refused = |why| Failure::Option { option: "--hold-out", reason: format!("{}{why}", label(condition)) };
        let mut request = request.map_err(refused)?;
        arguments.search().set(&mut request.options);
        request.options.references = arguments.references().len();
        Ok(Self { request, condition, records })
    }

    /// Identification proper, with a word about how far it is on a terminal.
    fn run(&self) -> Result<Identification, IdentificationError> {
        let doing = self.condition.map_or_else(|| "identifying".to_owned(), |id| format!("identifying condition {id}"));
        self.request.identify(&Pool, &TerminalProgress::new(&doing))
    }

    /// A channel that is late in all records by what the nominal physics model of the condition says, and the option that takes its
    /// delay out.
    fn late_channel(&self, found: &Identification, dataset: &Dataset) -> Option<CautionNote> {
        let condition = dataset.condition(self.condition?)?;
        let options = &self.request.options;
        let late = ChannelTimeSkew::of_condition(&found.measured, options.band, condition)?;
        let signal = late.signal(dataset)?;
        let known = options.preparation.channel(&signal)?.delay_s;
        let words = late.words(&signal.name, &condition.bundle(BundleKind::Physics).get(condition.nominal())?.name);
        let text = format!("{words} (--delay {}={:.3})", signal.name, known + late.delay_s);
        Some(CautionNote { code: "time-skew", channel: Some(signal.name), text, ..CautionNote::default() })
    }

    /// A caution with the options that put right what it speaks of.
    fn note(&self, caution: &IdentificationCaution) -> CautionNote {
        let mut note = caution.note();
        let IdentificationCaution::Contradiction { records, .. } = caution else { return note };
        let channels = self.request.options.preparation.outputs.iter().enumerate();
        let signal = |(index, channel): (usize, &ChannelPreparation)| {
            let (role, name) = (ChannelSide::Output, channel.name.clone());
            Signal { role, index, name }
        };
        let outputs: Vec<Signal> = channels.map(signal).collect();
        let options = records.iter().filter_map(|of| {
            let (record, fault) = (&of.name, of.fault.as_ref()?);
            let options = fault.remedies(&outputs).into_iter().map(|(signal, remedy)| match remedy.factor {
                1.0 => format!("--delay {record}:{signal}={:.3}", remedy.delay_s),
                factor => format!("--factor {record}:{signal}={factor:.2}"),
            });
            Some(options.collect::<Vec<_>>().join(" "))
        });
        let options = options.collect::<Vec<_>>().join(" or ");
        note.text += &if options.is_empty() { options } else { format!(" ({options})") };
        note
    }

    /// A line a record, below the condition where there is one.
    fn table(&self) -> String {
        match self.condition {
            Some(id) => format!("condition {id}\n{}", record_table(&self.records, 2)),
            None => record_table(&self.records, 0),
        }
    }

    /// What stands before words about it.
    fn label(&self) -> String {
        label(self.condition)
    }
}

fn label(condition: Option<ConditionId>) -> String {
    condition.map_or_else(String::new, |id| format!("condition {id}: "))
}

/// What is to be identified.
struct Tasks {
    tasks: Vec<IdentificationTask>,
    /// The files of which no record came.
    unread: Vec<PathBuf>,
    /// What was chosen and done while the records were read.
    reading: Vec<String>,
    /// Records that are others under second names: the name of the other, and what was said.
    copies: Vec<(String, CautionNote)>,
}

/// What is to be identified: all records together, or those of each condition.
fn tasks(
    arguments: &IdentifyArguments,
    destination: Option<&Destination>,
    channels: &mut RecordChannels,
    band: Band,
) -> Result<Tasks, Failure> {
    let ReadRecords { mut records, unread, reading, copies } =
        laid_out(arguments, channels, destination.map(|of| of.dataset.as_ref()))?;
    hold_out(&arguments.hold_out, &mut records)?;
    put_right(arguments, &mut records, channels)?;
    let mut preparation = preparation(channels, &arguments.delay)?;
    hold(&mut preparation, &records, channels);
    let groups = match destination {
        Some(destination) => destination.groups(records)?,
        None => {
            let conditions = said_conditions(&records);
            if conditions.contains(',') {
                caution(&format!("the names of the records say conditions {conditions}: all are fitted together"));
            }
            vec![(None, records)]
        }
    };
    let tasks = groups.into_iter().map(|group| IdentificationTask::new(group, &preparation, band, arguments));
    Ok(Tasks { tasks: tasks.collect::<Result<_, _>>()?, unread, reading, copies })
}

/// Where what was found is written: a file for each condition where there are many.
fn identified_path(arguments: &IdentifyArguments, task: &IdentificationTask) -> PathBuf {
    let of_many = task.condition.filter(|_| arguments.every_condition);
    arguments.out.join(of_many.map_or_else(|| IDENTIFIED.to_owned(), |id| format!("identified-condition-{id}.json")))
}

/// One line of what was found and where it is.
fn outcome(task: &IdentificationTask, file: &Path, found: &Identification) -> String {
    let held_out = found.held_out_cost.map_or_else(String::new, |cost| format!(", of what is held out {cost:.2}"));
    format!(
        "{}{}: {}; order {}, J per degree of freedom {:.2}{held_out}\n",
        task.label(),
        sanitized_path(file),
        counted(2 + found.bundle.len(), "model"),
        found.refined.order().unwrap_or_default(),
        found.cost,
    )
}

/// The channels asked for, with what is said of their samples.
fn channels(
    arguments: &IdentifyArguments,
    destination: Option<&Destination>,
    band: Band,
) -> Result<RecordChannels, Failure> {
    let mut channels = named_channels(arguments, destination)?;
    for reference in arguments.references() {
        if channels.inputs.iter().chain(&channels.outputs).any(|rule| rule.name == reference.name) {
            let reason = format!("{} is an input or an output already; a reference is neither", reference.name);
            return Err(Failure::Option { option: "--reference", reason });
        }
        // Read as an input, after those of the model.
        channels.inputs.push(reference.rule());
    }
    let unknown =
        |option, channel: &String| Failure::Option { option, reason: format!("{channel} is none of the channels") };
    for (at, ChannelTopic { channel, column }) in arguments.topic.iter().enumerate() {
        if arguments.topic[..at].iter().any(|before| before.channel == *channel) {
            let reason = format!("{channel} stands twice; a channel is found in one place");
            return Err(Failure::Option { option: "--topic", reason });
        }
        let rule = channels.inputs.iter_mut().chain(&mut channels.outputs).find(|rule| rule.name == *channel);
        rule.ok_or_else(|| unknown("--topic", channel))?.aliases = vec![column.clone()];
    }
    if let Some(held) = arguments.held.iter().find(|held| channels.inputs.iter().all(|rule| rule.name != **held)) {
        return Err(Failure::Option { option: "--held", reason: format!("{held} is none of the inputs") });
    }
    channels.resampling = ResamplingWish {
        band_end: Some(band.max()),
        rate_hz: arguments.resample,
        held: arguments.held.iter().cloned().collect(),
    };
    say_conversions("--unit", &arguments.unit, &mut channels)?;
    let factors = arguments.factor.iter().filter(|of| of_one_record(&of.channel).is_none());
    say_conversions("--factor", factors, &mut channels)?;
    Ok(channels)
}

/// The channels asked for: the dataset's, in its units, or those of the command line, in the units of the first record.
fn named_channels(arguments: &IdentifyArguments, destination: Option<&Destination>) -> Result<RecordChannels, Failure> {
    let Some(destination) = destination else {
        let rules =
            |list: &Option<ChannelList>| list.iter().flat_map(|list| &list.channels).map(SaidChannel::rule).collect();
        return Ok(RecordChannels {
            inputs: rules(&arguments.inputs),
            outputs: rules(&arguments.outputs),
            ..RecordChannels::default()
        });
    };
    let mut channels = RecordChannels::of_dataset(&destination.dataset);
    for (option, list, rules) in [
        ("--inputs", &arguments.inputs, &mut channels.inputs),
        ("--outputs", &arguments.outputs, &mut channels.outputs),
    ] {
        for SaidChannel { name, unit, column } in list.iter().flat_map(|list| &list.channels) {
            let Some(rule) = rules.iter_mut().find(|rule| rule.name == *name) else {
                let names: Vec<&str> = rules.iter().map(|rule| rule.name.as_str()).collect();
                let reason = format!("the dataset has no {name} there; it has {}", names.join(", "));
                return Err(Failure::Option { option, reason });
            };
            if !unit.is_empty() && *unit != rule.unit {
                let reason = format!("{name} has the unit {} in the dataset, not {unit}", rule.unit);
                return Err(Failure::Option { option, reason });
            }
            rule.aliases = column.iter().cloned().collect();
            rule.unit_in_files = Some(unit.clone()).filter(|unit| !unit.is_empty());
        }
    }
    Ok(channels)
}

fn band(arguments: &IdentifyArguments, destination: Option<&Destination>) -> Result<Band, Failure> {
    match (arguments.band.as_deref(), destination) {
        (Some(&[min, max]), _) => {
            Band::new(min, max).map_err(|error| Failure::Option { option: "--band", reason: error.to_string() })
        }
        (_, Some(destination)) => Ok(destination.dataset.band()),
        _ => Err(Failure::Option { option: "--band", reason: "expected two frequencies".to_owned() }),
    }
}

/// What the inputs that are held are prepared as, in records that were not brought to another clock: those moved their stamps.
fn hold(preparation: &mut Preparation, records: &[LaidOutRecord], channels: &RecordChannels) {
    let as_logged = |record: &&LaidOutRecord| !record.layout.is_resampled(&record.table, channels);
    let Some(flight) = records.iter().find(as_logged).and_then(|record| record.flight.as_ref()) else { return };
    for (index, input) in preparation.inputs.iter_mut().enumerate() {
        if !channels.resampling.held.contains(&input.name) {
            continue;
        }
        // A stair that is seen acts as it is; a command logged once a hold acts half a hold later (M14.1).
        let values: Vec<f64> = flight.inputs.column(index).iter().copied().collect();
        input.hold = match median_step(&flight.time_s) {
            Some(hold_s) if !is_held(&values) => Hold::Command { hold_s },
            _ => Hold::Acts,
        };
    }
}

/// Puts channels right in single records, as asked.
fn put_right(
    arguments: &IdentifyArguments,
    records: &mut [LaidOutRecord],
    channels: &RecordChannels,
) -> Result<(), Failure> {
    let delays = arguments.delay.iter().map(|of| {
        let remedy = ChannelRemedy { delay_s: of.delay_s, ..ChannelRemedy::NONE };
        ("--delay", &of.channel, remedy)
    });
    let factors = arguments.factor.iter().filter_map(|of| match of.said {
        SaidConversion::Factor(factor) => {
            Some(("--factor", &of.channel, ChannelRemedy { factor, ..ChannelRemedy::NONE }))
        }
        SaidConversion::Unit(_) => None,
    });
    let mut done: Vec<(&str, String, &str)> = Vec::new();
    for (option, said, remedy) in delays.chain(factors) {
        let Some((record, channel)) = of_one_record(said) else { continue };
        if !channels.inputs.iter().chain(&channels.outputs).any(|rule| rule.name == channel) {
            return Err(Failure::Option { option, reason: format!("{channel} is none of the channels") });
        }
        let mut of_it = records.iter_mut().filter(|of| is_called(&of.table, record)).peekable();
        if of_it.peek().is_none() {
            return Err(Failure::Option { option, reason: format!("\"{record}\" is none of the records") });
        }
        for of in of_it {
            let of_channel = (option, of.table.name.clone(), channel);
            if done.contains(&of_channel) {
                return Err(Failure::Option { option, reason: format!("{channel} of {record} stands twice") });
            }
            done.push(of_channel);
            let mut layout = of.layout.clone();
            layout.put_right(&BTreeMap::from([(channel.to_owned(), remedy)]), channels);
            *of = of.laid_out(layout, channels);
            if let Some(problem) = of.problems.first() {
                return Err(Failure::Option { option, reason: format!("{record}: {problem}") });
            }
        }
    }
    Ok(())
}

/// How the channels are prepared: their known delays are taken out.
fn preparation(channels: &RecordChannels, delays: &[ChannelDelay]) -> Result<Preparation, Failure> {
    let delays: Vec<&ChannelDelay> = delays.iter().filter(|of| of_one_record(&of.channel).is_none()).collect();
    let is_known =
        |delay: &&&ChannelDelay| channels.inputs.iter().chain(&channels.outputs).any(|rule| rule.name == delay.channel);
    if let Some(unknown) = delays.iter().find(|delay| !is_known(delay)) {
        let reason = format!("{} is none of the channels", unknown.channel);
        return Err(Failure::Option { option: "--delay", reason });
    }
    let is_again = |at: usize| delays[..at].iter().any(|before| before.channel == delays[at].channel);
    if let Some(again) = (0..delays.len()).find(|at| is_again(*at)) {
        let reason = format!("{} stands twice", delays[again].channel);
        return Err(Failure::Option { option: "--delay", reason });
    }
    let prepared = |rule: &ChannelRule| {
        let delay = delays.iter().find(|delay| delay.channel == rule.name);
        ChannelPreparation {
            delay_s: delay.map_or(0.0, |delay| delay.delay_s),
            ..ChannelPreparation::named(rule.name.clone())
        }
    };
    Ok(Preparation {
        inputs: channels.inputs.iter().map(prepared).collect(),
        outputs: channels.outputs.iter().map(prepared).collect(),
        ..Preparation::of(&[], &[])
    })
}
