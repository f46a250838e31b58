//! How much a reader may take, and whether it shall go on.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::importer::MOST_MEMORY;
use crate::variables::VariableFault;

/// Steps of work that reading one file may take: bytes of a text, elements of an array, values, comparisons of names.
pub(crate) const MOST_WORK: u64 = 4_000_000_000;

/// Counts the memory and the work of a reader: what goes beyond the limits is refused before it is taken, and a reader that shall stop
/// is told so. Every reader asks in its inner loops, for things without content too: a file of a few bytes may speak of 10^18 of them.
pub struct ReadingBudget<'p> {
    most_memory: u64,
    most_work: u64,
    memory: Cell<u64>,
    work: Cell<u64>,
    stop: Arc<AtomicBool>,
    tell: &'p dyn Fn(u64),
}

impl ReadingBudget<'static> {
    /// A budget for at most `most` bytes of memory.
    pub fn new(most: u64) -> Self {
        let zero = || Cell::new(0);
        let stop = Arc::default();
        Self { most_memory: most, most_work: MOST_WORK, memory: zero(), work: zero(), stop, tell: &|_| () }
    }
}

impl Default for ReadingBudget<'static> {
    /// The budget of any one file, which nobody stops.
    fn default() -> Self {
        Self::new(MOST_MEMORY)
    }
}

impl<'p> ReadingBudget<'p> {
    /// With another limit of work \[steps\].
    pub fn with_work(self, most: u64) -> Self {
        Self { most_work: most, ..self }
    }

    /// Ended by whoever sets this.
    pub fn stopped_by(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// With somebody who is told, whenever memory is taken, how many bytes are.
    pub fn telling<'q>(self, tell: &'q dyn Fn(u64)) -> ReadingBudget<'q> {
        let Self { most_memory, most_work, memory, work, stop, .. } = self;
        ReadingBudget { most_memory, most_work, memory, work, stop, tell }
    }

    /// What ends the reader when it is set.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// Counts `count` elements of `size` bytes that `variable` is about to take, each of which is a step of work too.
    pub fn take(&self, count: u64, size: u64, variable: &str) -> Result<(), VariableFault> {
        let memory = self.memory.get().saturating_add(count.saturating_mul(size));
        if memory > self.most_memory {
            self.work(0, variable)?;
            return Err(VariableFault::TooLarge { variable: variable.to_owned(), most_mib: self.most_memory >> 20 });
        }
        self.work(count, variable)?;
        self.memory.set(memory);
        (self.tell)(memory);
        Ok(())
    }

    /// Ends a reader that shall stop among elements which are counted already; asked for each, it looks now and then.
    pub fn go_on(&self, element: usize) -> Result<(), VariableFault> {
        /// Elements that take less than a hundredth of a second.
        const BETWEEN: usize = 1 << 14;
        let stops = element.is_multiple_of(BETWEEN) && self.stop.load(Ordering::Relaxed);
        if stops { Err(VariableFault::Stopped) } else { Ok(()) }
    }

    /// Counts steps of work that `variable` is about to take.
    pub fn work(&self, steps: u64, variable: &str) -> Result<(), VariableFault> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(VariableFault::Stopped);
        }
        // Whoever asks has done something since it asked last.
        let work = self.work.get().saturating_add(steps.max(1));
        if work > self.most_work {
            let most_millions = self.most_work / 1_000_000;
            return Err(VariableFault::TooMuchWork { variable: variable.to_owned(), most_millions });
        }
        self.work.set(work);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_and_work_are_refused_beyond_their_limits_and_not_before() {
        let budget = ReadingBudget::new(2 << 20).with_work(5_000_000);
        assert_eq!(budget.take(1 << 20, 2, "x"), Ok(()));
        let memory = budget.take(1, 1, "x").unwrap_err();
        let words =
            "variable x: this would take more than 2 MiB of memory, which is the most that is read; split the file";
        assert_eq!(memory.to_string(), words);
        assert_eq!(budget.work(3_000_000, ""), Ok(()));
        let work = budget.work(1_000_000, "").unwrap_err();
        let words = "this would take more than 5 million steps of work, which is the most that is read; split the file";
        assert_eq!(work.to_string(), words);
        assert!(memory.is_of_the_budget() && work.is_of_the_budget());
    }

    #[test]
    fn a_number_beyond_what_can_be_counted_is_beyond_the_limit() {
        let budget = ReadingBudget::new(1 << 20);
        assert!(matches!(budget.take(u64::MAX, 8, ""), Err(VariableFault::TooLarge { .. })));
        assert!(matches!(budget.take(u64::MAX, 0, ""), Err(VariableFault::TooMuchWork { .. })));
    }

    #[test]
    fn whoever_holds_the_flag_stops_the_reader_and_the_listener_hears_what_is_taken() {
        let (stop, heard) = (Arc::new(AtomicBool::new(false)), Cell::new(0));
        let tell = |taken| heard.set(taken);
        let budget = ReadingBudget::new(1 << 20).stopped_by(Arc::clone(&stop)).telling(&tell);
        assert_eq!((budget.take(3, 8, ""), heard.get()), (Ok(()), 24));
        stop.store(true, Ordering::Relaxed);
        assert_eq!(budget.take(u64::MAX, 1, ""), Err(VariableFault::Stopped));
        assert_eq!(budget.work(0, ""), Err(VariableFault::Stopped));
    }
}

#[cfg(test)]
mod limits_tests {
    use gdcm_core::dataset::limits::{
        LARGEST_TEXT, MOST_CHANNELS, MOST_CONDITIONS, MOST_COORDINATES, MOST_FREQUENCIES, MOST_MODELS,
        MOST_MODELS_IN_ALL, MOST_STATES,
    };
    use gdcm_core::dataset::{GREATEST_CHANNEL_DELAY_S, limits};
    use gdcm_core::study::{Kind, SETTINGS};
    use gdcm_core::units::number;

    use super::MOST_WORK;
    use crate::importer::{DEEPEST, LARGEST_FILE, MOST_FILES, MOST_MEMORY};
    use crate::recognise::{DEEPEST as DEEPEST_VALUE, MOST_FOUND};
    use crate::record_files::MOST_RECORDS;
    use crate::study_file::MOST_VARIANTS;

    fn of_files() -> String {
        let mib = |bytes: u64| format!("{} MiB", bytes >> 20);
        let rows = [
            ("a file of other programs", mib(LARGEST_FILE)),
            ("text of a file, unpacked", mib(LARGEST_TEXT)),
            ("memory for what a file holds, beside a copy of the models or records found in it", mib(MOST_MEMORY)),
            (
                "work on a file: bytes of text, elements of arrays, values, names compared",
                format!("{} million steps", MOST_WORK / 1_000_000),
            ),
            ("files of the folders that are given", MOST_FILES.to_string()),
            ("folders inside one another", DEEPEST.to_string()),
            (
                "models among the variables of a file; values inside one another",
                format!("{MOST_FOUND}; {DEEPEST_VALUE}"),
            ),
            ("records of an archive", MOST_RECORDS.to_string()),
            ("inputs, outputs", format!("{MOST_CHANNELS} each")),
            ("conditions", MOST_CONDITIONS.to_string()),
            ("models of a bundle; of a file", format!("{MOST_MODELS}; {MOST_MODELS_IN_ALL}")),
            ("records of a condition", limits::MOST_RECORDS.to_string()),
            ("states of a model", MOST_STATES.to_string()),
            ("frequencies of a measured response", MOST_FREQUENCIES.to_string()),
            ("coordinates of a perturbation", MOST_COORDINATES.to_string()),
            ("variants of a study", MOST_VARIANTS.to_string()),
            ("delay of a model's channel", format!("{} s", number(GREATEST_CHANNEL_DELAY_S))),
        ];
        rows.map(|(what, most)| format!("| {what} | {most} |\n")).concat()
    }

    fn of_settings() -> String {
        let row = |setting: &&gdcm_core::study::Setting| {
            let ([least, greatest], whole) = match setting.kind {
                Kind::Number { range, whole, .. } => (range, whole),
                Kind::Optional { range, .. } | Kind::Range { range, .. } => (range, false),
                _ => return None,
            };
            let kind = if whole { ", a whole number" } else { "" };
            let unit = if setting.unit.file.is_empty() { String::new() } else { format!(" {}", setting.unit.file) };
            let (option, name) = (setting.option, setting.name);
            Some(format!("| {name}{kind} | `{option}` | {}{unit} | {}{unit} |\n", number(least), number(greatest)))
        };
        SETTINGS.iter().filter_map(row).collect()
    }

    #[test]
    fn the_limits_of_the_documentation_are_those_of_the_program() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/limits.md");
        let text = std::fs::read_to_string(path).unwrap();
        let mut parts: Vec<&str> = text.split_inclusive("|---|\n").collect();
        let [_, files, settings] = parts.as_mut_slice() else { panic!("two tables") };
        let end = |part: &str| {
            part.lines().take_while(|line| line.starts_with('|')).map(|line| line.len() + 1).sum::<usize>()
        };
        let (files, settings) = (&files[..end(files)], &settings[..end(settings)]);
        if std::env::var_os("GDCM_WRITE_FILES").is_some() {
            std::fs::write(path, text.replace(files, &of_files()).replace(settings, &of_settings())).unwrap();
            return;
        }
        assert_eq!(files, of_files());
        assert_eq!(settings, of_settings());
    }
}
