//! File contents in memory, with a limit on the total number of bytes read.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use hdf5_pure::{FormatError, Source};

/// Maximum number of times that a file's bytes are read on average: headers and indices are read
/// again for each query.
const MOST_PASSES: u64 = 16;
/// Additional bytes that may be read from any file, so that a small file may be read more often.
const ADDITIONAL: u64 = 16 << 20;
/// Minimum number of bytes counted for each read, so that many short reads reach the limit, too.
const LEAST_COUNTED: u64 = 16;

/// File contents in memory, with a limit on the total number of bytes read.
///
/// In a malicious file of a few kilobytes, index nodes may refer to one another and so form more
/// paths than can ever be visited. The library follows them all; the limit ends such reading.
pub(super) struct LimitedSource {
    bytes: Vec<u8>,
    /// Number of bytes that may still be read.
    remaining: AtomicU64,
    stop: Arc<AtomicBool>,
}

impl LimitedSource {
    /// Creates a source; reading fails once `stop` is set.
    pub(super) fn new(bytes: Vec<u8>, stop: Arc<AtomicBool>) -> Self {
        let limit = (bytes.len() as u64)
            .saturating_mul(MOST_PASSES)
            .saturating_add(ADDITIONAL);
        Self {
            bytes,
            remaining: AtomicU64::new(limit),
            stop,
        }
    }
}

impl Source for LimitedSource {
    fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> Result<(), FormatError> {
        let counted = (buffer.len() as u64).max(LEAST_COUNTED);
        let update =
            self.remaining
                .fetch_update(Ordering::Relaxed, Ordering::Relaxed, |remaining| {
                    remaining.checked_sub(counted)
                });
        if self.stop.load(Ordering::Relaxed) {
            return Err(FormatError::Source("stopped".to_owned()));
        }
        if update.is_err() {
            return Err(FormatError::Source(
                "the parts of the file refer to one another too often".to_owned(),
            ));
        }
        let start = usize::try_from(offset).unwrap_or(usize::MAX);
        let end = start.saturating_add(buffer.len());
        let Some(found) = self.bytes.get(start..end) else {
            return Err(FormatError::UnexpectedEof {
                expected: end,
                available: self.bytes.len(),
            });
        };
        buffer.copy_from_slice(found);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_can_be_read_a_limited_number_of_times() {
        let source = LimitedSource::new(vec![7; 1 << 20], Arc::default());
        let mut buffer = vec![0; 1 << 20];
        for _ in 0..32 {
            source.read_at(0, &mut buffer).unwrap();
        }
        assert!(matches!(
            source.read_at(0, &mut buffer),
            Err(FormatError::Source(_))
        ));
    }

    #[test]
    fn nothing_is_read_beyond_the_end() {
        let source = LimitedSource::new(vec![1, 2, 3], Arc::default());
        assert!(source.read_at(2, &mut [0; 2]).is_err());
        assert!(source.read_at(u64::MAX, &mut [0; 2]).is_err());
    }
}
