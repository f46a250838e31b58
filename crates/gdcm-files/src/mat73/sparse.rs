//! Matrices of which only the numbers other than zero are stored (`MATLAB_sparse`): by columns, compressed.

use hdf5_pure::{Dataset, Object};

use super::dataset::{Elements, Order};
use super::fault::damaged;
use super::marks::MatlabAttributes;
use crate::variables::{Array, ElementKind, MemoryBudget, VariableFault};

/// The members of a group that is a sparse matrix, and its marks.
pub(super) struct Sparse<'s> {
    pub(super) rows: u64,
    pub(super) marks: &'s MatlabAttributes,
    pub(super) members: &'s [(String, Object)],
    pub(super) path: &'s str,
    pub(super) meter: &'s MemoryBudget<'s>,
}

impl Sparse<'_> {
    /// The matrix, filled up with zeros.
    pub(super) fn filled(&self) -> Result<Array, VariableFault> {
        let wrong = || damaged(self.path, "the sparse matrix contradicts itself");
        let starts = self.indices("jc")?.ok_or_else(wrong)?;
        let (indices, data) = (self.indices("ir")?.unwrap_or_default(), self.data()?);
        let columns = starts.len().checked_sub(1).ok_or_else(wrong)?;
        let cells = self.rows.saturating_mul(columns as u64);
        self.meter.take(cells, if data.im.is_some() { 16 } else { 8 }, self.path)?;
        let (cells, rows) =
            (usize::try_from(cells).map_err(|_| wrong())?, usize::try_from(self.rows).map_err(|_| wrong())?);
        let (mut re, mut im) = (vec![0.0; cells], data.im.as_ref().map(|_| vec![0.0; cells]));
        for (column, bounds) in starts.windows(2).enumerate() {
            let [first, end] = [bounds[0], bounds[1]];
            if first > end || end > indices.len() || end > data.re.len() {
                return Err(wrong());
            }
            for place in first..end {
                let cell = column * rows + Some(indices[place]).filter(|&row| row < rows).ok_or_else(wrong)?;
                re[cell] = data.re[place];
                if let (Some(im), Some(data)) = (&mut im, &data.im) {
                    im[cell] = data[place];
                }
            }
        }
        let kind = if self.marks.class() == "logical" { ElementKind::Logical } else { data.kind };
        Ok(Array { shape: vec![rows, columns], kind, re, im })
    }

    fn member(&self, name: &str) -> Option<&Dataset> {
        self.members.iter().find_map(|(member, object)| match object {
            Object::Dataset(dataset) if member == name => Some(dataset.as_ref()),
            _ => None,
        })
    }

    fn indices(&self, name: &str) -> Result<Option<Vec<usize>>, VariableFault> {
        let Some(dataset) = self.member(name) else { return Ok(None) };
        let words = Elements::read(dataset, Order::Columns, self.path, self.meter)?.words(self.path, self.meter)?;
        let words = words.ok_or_else(|| damaged(self.path, "the places of a sparse matrix are no whole numbers"))?;
        Ok(Some(words.into_iter().map(|word| usize::try_from(word).unwrap_or(usize::MAX)).collect()))
    }

    /// The numbers; there is no dataset where there are none.
    fn data(&self) -> Result<Array, VariableFault> {
        let Some(dataset) = self.member("data") else { return Ok(Array::matrix(0, 0, Vec::new())) };
        let numbers = Elements::read(dataset, Order::Columns, self.path, self.meter)?.numbers(self.path, self.meter)?;
        numbers.ok_or_else(|| damaged(self.path, "the elements of a sparse matrix are no numbers"))
    }
}
