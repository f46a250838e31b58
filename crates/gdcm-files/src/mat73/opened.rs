//! An HDF5 file that is open.

use hdf5_pure::{File, FileAccessProperties, Group, MetadataCacheConfig, is_hdf5_bytes};

use super::fault::fault;
use super::rationed::Rationed;
use crate::variables::{MemoryBudget, VariableFault};

/// An HDF5 file in memory, found to be whole.
pub(super) struct Opened {
    file: File,
}

impl Opened {
    /// Opens a file, which is copied; a user block such as MATLAB's may stand before it.
    pub(super) fn new(bytes: &[u8], meter: &MemoryBudget<'_>) -> Result<Self, VariableFault> {
        if !is_hdf5_bytes(bytes) {
            let found = if bytes.is_empty() { "nothing" } else { "other bytes" };
            return Err(VariableFault::Format { expected: "a file of MATLAB 7.3 or HDF5", found: found.to_owned() });
        }
        meter.take(bytes.len() as u64, 1, "")?;
        // What a cache gave out would not count.
        let properties = FileAccessProperties::new().with_metadata_cache(MetadataCacheConfig::disabled());
        let source = Rationed::new(bytes.to_vec());
        let file = File::from_source_with_options(source, properties).map_err(|error| fault(&error, ""))?;
        // Chunks at the end may be missing without any structure reaching beyond it.
        if file.superblock().eof_address > bytes.len() as u64 {
            return Err(VariableFault::CutOff { variable: String::new(), offset: bytes.len() as u64 });
        }
        Ok(Self { file })
    }

    /// The group in which everything lies.
    pub(super) fn root(&self) -> Group {
        self.file.root()
    }
}
