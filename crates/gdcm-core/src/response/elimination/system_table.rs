//! The matrices of a model in one table whose rows are whole vectors.

use std::ops::{Deref, DerefMut};

/// Numbers in a [`Block`]: as many as the longest vector register holds.
pub const BLOCK: usize = LINE;

/// Neighbouring entries of a row. Loops over them become vector instructions of whatever length the processor has.
pub type Block = [f64; BLOCK];

/// `[A B; C D]`, row by row, with zeros after each row up to a whole number of blocks.
#[derive(Clone, Debug)]
pub struct SystemTable {
    states: usize,
    blocks: usize,
    entries: AlignedNumbers,
}

impl SystemTable {
    /// Zeros for so many states, columns of B and rows of C.
    pub fn zeros(states: usize, inputs: usize, outputs: usize) -> Self {
        let blocks = (states + inputs).div_ceil(BLOCK).max(1);
        Self { states, blocks, entries: AlignedNumbers::zeros(blocks * BLOCK * (states + outputs)) }
    }

    /// Rows of A.
    #[inline(always)]
    pub fn states(&self) -> usize {
        self.states
    }

    /// Blocks in a row.
    #[inline(always)]
    pub fn blocks(&self) -> usize {
        self.blocks
    }

    /// Numbers in a row, the zeros at its end included.
    #[inline(always)]
    pub fn width(&self) -> usize {
        self.blocks * BLOCK
    }

    /// All numbers, row by row.
    #[inline(always)]
    pub fn numbers(&self) -> &[f64] {
        &self.entries
    }

    /// A row, its blocks as numbers.
    #[inline(always)]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.numbers()[row * self.width()..(row + 1) * self.width()]
    }

    /// All numbers to change, row by row.
    #[inline(always)]
    pub fn numbers_mut(&mut self) -> &mut [f64] {
        &mut self.entries
    }

    /// Every row as blocks.
    #[inline(always)]
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[Block]> {
        self.entries.as_chunks().0.chunks_exact(self.blocks)
    }

    /// Every row as blocks to change.
    #[inline(always)]
    pub fn rows_mut(&mut self) -> impl Iterator<Item = &mut [Block]> {
        self.entries.as_chunks_mut().0.chunks_exact_mut(self.blocks)
    }
}

/// Numbers in a cache line, and in the longest vector register.
pub const LINE: usize = 8;

/// Numbers that begin on a cache line: a vector that lies across two of them takes twice as long to read and to write.
#[derive(Clone, Debug)]
pub struct AlignedNumbers {
    /// A copy begins where the copied ones did, on a cache line or not: that costs time, not correctness.
    numbers: Vec<f64>,
    start: usize,
    count: usize,
}

impl AlignedNumbers {
    /// So many zeros.
    pub fn zeros(count: usize) -> Self {
        let numbers = vec![0.0_f64; count + LINE - 1];
        let start = numbers.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE - 1);
        Self { numbers, start, count }
    }
}

impl Deref for AlignedNumbers {
    type Target = [f64];

    #[inline(always)]
    fn deref(&self) -> &[f64] {
        &self.numbers[self.start..self.start + self.count]
    }
}

impl DerefMut for AlignedNumbers {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[self.start..self.start + self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_begin_on_a_cache_line() {
        for count in [0, 1, 7, 8, 9, 100] {
            let numbers = AlignedNumbers::zeros(count);
            assert_eq!((numbers.len(), numbers.as_ptr().align_offset(64)), (count, 0));
        }
    }

    #[test]
    fn a_copy_has_the_same_numbers() {
        let mut numbers = AlignedNumbers::zeros(5);
        numbers.copy_from_slice(&[1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(numbers.clone()[..], numbers[..]);
    }
}
