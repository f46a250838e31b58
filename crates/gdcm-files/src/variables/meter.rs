//! How much a reader may take, and whether it shall go on.

use std::cell::Cell;

use super::fault::VariableFault;

/// Counts the memory that a reader is about to take, refuses what goes beyond the limit before it is taken, and asks now and then
/// whether the reader shall go on.
pub struct MemoryBudget<'s> {
    most: u64,
    taken: Cell<u64>,
    stop: &'s dyn Fn(u64) -> bool,
}

impl<'s> MemoryBudget<'s> {
    /// A meter for at most `most` bytes; `stop` is told at every [`MemoryBudget::take`] how many are taken, and answers whether to stop.
    pub fn new(most: u64, stop: &'s dyn Fn(u64) -> bool) -> Self {
        Self { most, taken: Cell::new(0), stop }
    }

    /// Counts `count` elements of `size` bytes that `variable` is about to take.
    pub fn take(&self, count: u64, size: u64, variable: &str) -> Result<(), VariableFault> {
        if (self.stop)(self.taken.get()) {
            return Err(VariableFault::Stopped);
        }
        let taken = self.taken.get().saturating_add(count.saturating_mul(size));
        if taken > self.most {
            return Err(VariableFault::TooLarge { variable: variable.to_owned(), most_mib: self.most >> 20 });
        }
        self.taken.set(taken);
        Ok(())
    }
}
