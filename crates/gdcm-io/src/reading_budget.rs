//! Limits on memory and work for a reader, and its cancellation.

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub use crate::variable_fault::VariableFault;

/// Argument `variable` of [`ReadingBudget`] and [`VariableFault`] if no variable is affected, or if
/// the caller adds its name.
pub(crate) const NO_VARIABLE: &str = "";

/// Maximum memory for reading one file \[bytes\].
pub(crate) const MOST_MEMORY: u64 = 1 << 30;

/// Maximum work for reading one file \[steps\]: text bytes, array elements, values, and name
/// comparisons.
pub(crate) const MOST_WORK: u64 = 4_000_000_000;

/// Counts a reader's memory and work. Anything beyond the limits is rejected before it is
/// allocated, and a cancelled reader stops. Every reader queries the budget in its inner loops,
/// even for elements without content: a file with a few bytes may claim to hold 10^18 such
/// elements.
pub struct ReadingBudget<'p> {
    most_memory: u64,
    most_work: u64,
    memory: Cell<u64>,
    work: Cell<u64>,
    stop: Arc<AtomicBool>,
    /// Callback that receives the memory taken so far \[bytes\].
    on_memory: &'p dyn Fn(u64),
}

impl ReadingBudget<'static> {
    /// Creates a budget with a memory limit \[bytes\].
    pub fn new(most: u64) -> Self {
        Self {
            most_memory: most,
            most_work: MOST_WORK,
            memory: Cell::new(0),
            work: Cell::new(0),
            stop: Arc::default(),
            on_memory: &|_| (),
        }
    }
}

impl Default for ReadingBudget<'static> {
    /// Creates a budget with the default limits for a file, without cancellation.
    fn default() -> Self {
        Self::new(MOST_MEMORY)
    }
}

impl<'p> ReadingBudget<'p> {
    /// Replaces the work limit \[steps\].
    pub fn with_work(self, most: u64) -> Self {
        Self {
            most_work: most,
            ..self
        }
    }

    /// Sets the flag through which another thread stops the reader.
    pub fn stopped_by(self, stop: Arc<AtomicBool>) -> Self {
        Self { stop, ..self }
    }

    /// Sets a callback that receives the memory taken so far \[bytes\] whenever more is taken.
    pub fn with_memory_callback<'q>(self, on_memory: &'q dyn Fn(u64)) -> ReadingBudget<'q> {
        ReadingBudget {
            most_memory: self.most_memory,
            most_work: self.most_work,
            memory: self.memory,
            work: self.work,
            stop: self.stop,
            on_memory,
        }
    }

    /// Returns the flag through which another thread stops the reader.
    pub fn stop(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// Counts `count` elements that are about to be read for `variable`, each with `size` bytes and
    /// one work step. `variable` is named in the error; it is empty if no variable was begun.
    ///
    /// # Errors
    /// A limit would be exceeded, or the reader was cancelled.
    pub fn take(&self, count: u64, size: u64, variable: &str) -> Result<(), VariableFault> {
        let memory = self.memory.get().saturating_add(count.saturating_mul(size));
        if memory > self.most_memory {
            // A cancelled reader is reported as stopped, not as too large.
            self.work(0, variable)?;
            return Err(VariableFault::TooLarge {
                variable: variable.to_owned(),
                most_mib: self.most_memory >> 20,
            });
        }
        self.work(count, variable)?;
        self.memory.set(memory);
        (self.on_memory)(memory);
        Ok(())
    }

    /// Checks for cancellation in a loop over elements that are already counted. To be called for
    /// each `element`; only one call in some thousands queries the flag.
    pub fn check_stop(&self, element: usize) -> Result<(), VariableFault> {
        /// Number of elements between two queries, read in less than 0.01 s.
        const BETWEEN: usize = 1 << 14;
        if element.is_multiple_of(BETWEEN) && self.stop.load(Ordering::Relaxed) {
            return Err(VariableFault::Stopped);
        }
        Ok(())
    }

    /// Counts work steps that are about to be taken for `variable`, which is named in the error,
    /// and checks for cancellation. A call that only checks for cancellation passes 0 steps, which
    /// count as one.
    pub fn work(&self, steps: u64, variable: &str) -> Result<(), VariableFault> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(VariableFault::Stopped);
        }
        // `max(1)`: a loop that only checks for cancellation must end, too.
        let work = self.work.get().saturating_add(steps.max(1));
        if work > self.most_work {
            return Err(VariableFault::TooMuchWork {
                variable: variable.to_owned(),
                most_millions: self.most_work / 1_000_000,
            });
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
        let too_large = VariableFault::TooLarge {
            variable: "x".to_owned(),
            most_mib: 2,
        };
        assert_eq!(memory, too_large);
        assert_eq!(budget.work(3_000_000, ""), Ok(()));
        let work = budget.work(1_000_000, "").unwrap_err();
        let too_much = VariableFault::TooMuchWork {
            variable: String::new(),
            most_millions: 5,
        };
        assert_eq!(work, too_much);
        assert!(memory.is_of_the_budget() && work.is_of_the_budget());
    }

    #[test]
    fn counts_beyond_64_bits_are_beyond_the_limit() {
        let budget = ReadingBudget::new(1 << 20);
        assert!(matches!(
            budget.take(u64::MAX, 8, ""),
            Err(VariableFault::TooLarge { .. })
        ));
        assert!(matches!(
            budget.take(u64::MAX, 0, ""),
            Err(VariableFault::TooMuchWork { .. })
        ));
    }

    #[test]
    fn the_flag_stops_the_reader_and_the_callback_receives_the_memory() {
        let stop = Arc::new(AtomicBool::new(false));
        let heard = Cell::new(0);
        let on_memory = |taken| heard.set(taken);
        let budget = ReadingBudget::new(1 << 20)
            .stopped_by(Arc::clone(&stop))
            .with_memory_callback(&on_memory);
        assert_eq!((budget.take(3, 8, ""), heard.get()), (Ok(()), 24));
        stop.store(true, Ordering::Relaxed);
        assert_eq!(budget.take(u64::MAX, 1, ""), Err(VariableFault::Stopped));
        assert_eq!(budget.work(0, ""), Err(VariableFault::Stopped));
    }
}
