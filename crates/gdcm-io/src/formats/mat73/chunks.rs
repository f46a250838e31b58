//! Checks the chunks of datasets.
//!
//! A dataset may be stored in chunks: equally shaped blocks that cover it and may each be
//! compressed. An index gives each chunk's position in the file.

use hdf5_pure::{Chunk, ChunkIndex, Dataset};

use crate::formats::mat73::library_fault::{damaged, library_fault};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;
use crate::variable_fault::unsupported_content::UnsupportedContent;

/// Memory that the library needs for each chunk while it reads \[bytes\].
const CHUNK: u64 = 128;
/// Maximum ratio of a chunk's stored to its decompressed length: compression lengthens data that it
/// cannot shorten, but only slightly.
const MOST_STORED_PER_DECOMPRESSED: u64 = 2;
/// Stored length permitted beyond this ratio \[bytes\], for the headers of short chunks.
const OVERHEAD: u64 = 4096;

/// Takes the memory needed to read a dataset in chunks from the budget: a decompressed chunk, and
/// the library's data about each chunk. Rejects chunks that are impossible, because the library
/// allocates memory for the claimed sizes and adds offsets without overflow checks.
///
/// `sides` are the dataset's dimensions; `size` is the element size \[bytes\].
///
/// # Errors
/// [`VariableFault`] for impossible chunks, for several unlimited dimensions, which the library
/// does not read, and for an exhausted budget.
pub(super) fn check_chunks(
    dataset: &Dataset,
    sides: &[usize],
    size: u64,
    path: &str,
    budget: &ReadingBudget<'_>,
) -> Result<(), VariableFault> {
    let shape = dataset
        .chunk_shape()
        .map_err(|error| library_fault(&error, path))?;
    let Some(shape) = shape else {
        return Ok(());
    };
    if shape.contains(&0) || shape.len() != sides.len() {
        return Err(damaged(path, Damage::ChunkSize));
    }
    let mut elements_per_chunk: u64 = 1;
    let mut most_chunks: u64 = 1;
    for (&side, &chunk_side) in sides.iter().zip(&shape) {
        elements_per_chunk = elements_per_chunk.saturating_mul(chunk_side);
        most_chunks = most_chunks.saturating_mul((side as u64).div_ceil(chunk_side));
    }
    budget.take(elements_per_chunk, size, path)?;
    budget.take(most_chunks, CHUNK, path)?;
    let index = dataset
        .chunk_index()
        .map_err(|error| library_fault(&error, path))?;
    if index == Some(ChunkIndex::BTreeV2) {
        return Err(VariableFault::unsupported(
            path,
            UnsupportedContent::UnlimitedDimensions,
        ));
    }
    let longest = elements_per_chunk
        .saturating_mul(size)
        .saturating_mul(MOST_STORED_PER_DECOMPRESSED)
        .saturating_add(OVERHEAD);
    let chunks = dataset
        .chunks()
        .map_err(|error| library_fault(&error, path))?;
    if chunks.iter().any(|chunk| chunk.storage_size > longest) {
        return Err(damaged(path, Damage::ChunkShape));
    }
    // Only this index stores where each chunk begins in the dataset; for the others, the library
    // computes it.
    if index == Some(ChunkIndex::BTreeV1) {
        let is_outside = chunks.iter().any(|chunk| begins_outside(chunk, sides));
        if is_outside || chunks.len() as u64 > most_chunks {
            return Err(damaged(path, Damage::ChunkOutside));
        }
    }
    Ok(())
}

/// Returns whether a chunk's first element is outside the dataset.
fn begins_outside(chunk: &Chunk, sides: &[usize]) -> bool {
    chunk
        .offset
        .iter()
        .zip(sides)
        .any(|(&first_index, &side)| first_index >= side as u64)
}
