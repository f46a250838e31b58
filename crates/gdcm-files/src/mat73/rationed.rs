//! A file's bytes, of which only so many are given out.

use std::sync::atomic::{AtomicU64, Ordering};

use hdf5_pure::{FormatError, Source};

/// How often a file may be read through: headers and indices are read several times, once for each question.
const TIMES: u64 = 16;
/// What may be read of a small file besides \[bytes\].
const BESIDES: u64 = 16 << 20;
/// What a read costs at least \[bytes\].
const LEAST: u64 = 16;

/// Bytes in memory that can be read only so often.
///
/// The nodes of an index may lead to one another in a way that a file of a few kilobytes has more of them than can ever be
/// visited; the library follows them all. Here it runs dry.
pub(super) struct Rationed {
    bytes: Vec<u8>,
    left: AtomicU64,
}

impl Rationed {
    pub(super) fn new(bytes: Vec<u8>) -> Self {
        let left = AtomicU64::new((bytes.len() as u64).saturating_mul(TIMES).saturating_add(BESIDES));
        Self { bytes, left }
    }
}

impl Source for Rationed {
    fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> Result<(), FormatError> {
        let cost = (buffer.len() as u64).max(LEAST);
        let paid = self.left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(cost));
        if paid.is_err() {
            return Err(FormatError::Source("its parts lead to one another too often".to_owned()));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let found = self.bytes.get(start..start.saturating_add(buffer.len()));
        let end =
            FormatError::UnexpectedEof { expected: start.saturating_add(buffer.len()), available: self.bytes.len() };
        buffer.copy_from_slice(found.ok_or(end)?);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_can_be_read_only_so_often() {
        let source = Rationed::new(vec![7; 1 << 20]);
        let mut buffer = vec![0; 1 << 20];
        for _ in 0..32 {
            source.read_at(0, &mut buffer).unwrap();
        }
        assert!(matches!(source.read_at(0, &mut buffer), Err(FormatError::Source(_))));
    }

    #[test]
    fn nothing_is_read_beyond_the_end() {
        let source = Rationed::new(vec![1, 2, 3]);
        assert!(source.read_at(2, &mut [0; 2]).is_err());
        assert!(source.read_at(u64::MAX, &mut [0; 2]).is_err());
    }
}
