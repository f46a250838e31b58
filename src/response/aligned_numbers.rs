//! Numbers that begin on a cache line.

use std::ops::{Deref, DerefMut};

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
