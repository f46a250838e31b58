//! The matrices of a model in one table whose rows are whole vectors.

use super::aligned_numbers::{AlignedNumbers, LINE};

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
    pub fn zeros(states: usize, sides: usize, outputs: usize) -> Self {
        let blocks = (states + sides).div_ceil(BLOCK).max(1);
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
