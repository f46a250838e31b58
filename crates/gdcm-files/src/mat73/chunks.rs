//! Chunks, in which datasets are packed.

use hdf5_pure::{Chunk, ChunkIndex, Dataset};

use super::fault::{damaged, fault};
use crate::variables::{MemoryBudget, VariableFault};

/// What the library keeps for each chunk of a dataset while it reads \[bytes\].
const CHUNK: u64 = 128;
/// What no filter makes a chunk longer by, beyond twice its length \[bytes\].
const OVERHEAD: u64 = 4096;

/// Counts what reading a dataset chunk by chunk takes, one chunk unpacked and what is kept of each, and finds out whether its chunks
/// can be as they claim: the library takes memory for what they claim, and adds up their places, without asking.
pub(super) fn check(
    dataset: &Dataset,
    sides: &[usize],
    size: u64,
    path: &str,
    meter: &MemoryBudget<'_>,
) -> Result<(), VariableFault> {
    let failed = |error| fault(&error, path);
    let Some(shape) = dataset.chunk_shape().map_err(failed)? else { return Ok(()) };
    if shape.contains(&0) || shape.len() != sides.len() {
        return Err(damaged(path, "the chunks have no size"));
    }
    let elements = shape.iter().copied().fold(1, u64::saturating_mul);
    let along = |(&side, &chunk): (&usize, &u64)| (side as u64).div_ceil(chunk);
    let most = sides.iter().zip(&shape).map(along).fold(1, u64::saturating_mul);
    meter.take(elements, size, path)?;
    meter.take(most, CHUNK, path)?;
    let index = dataset.chunk_index().map_err(failed)?;
    if index == Some(ChunkIndex::BTreeV2) {
        let (what, remedy) = ("a dataset that can grow in two directions", "write it with a shape that is fixed");
        let (what, remedy) = (what.to_owned(), remedy.to_owned());
        return Err(VariableFault::Unsupported { variable: path.to_owned(), what, remedy });
    }
    let longest = elements.saturating_mul(size).saturating_mul(2).saturating_add(OVERHEAD);
    let chunks = dataset.chunks().map_err(failed)?;
    if chunks.iter().any(|chunk| chunk.storage_size > longest) {
        return Err(damaged(path, "a chunk is longer than it can be"));
    }
    // The other indices do not store places, they count them.
    if index == Some(ChunkIndex::BTreeV1)
        && (chunks.len() as u64 > most || chunks.iter().any(|chunk| outside(chunk, sides)))
    {
        return Err(damaged(path, "a chunk lies outside the dataset"));
    }
    Ok(())
}

fn outside(chunk: &Chunk, sides: &[usize]) -> bool {
    chunk.offset.iter().zip(sides).any(|(&offset, &side)| offset >= side as u64)
}
