//! Groups that hold a sparse matrix in compressed sparse column format: a dataset for each of its
//! parts.

use hdf5_pure::Object;

use crate::formats::mat73::dataset::{Elements, Order};
use crate::formats::mat73::library_fault::damaged;
use crate::formats::mat73::member::Member;
use crate::formats::sparse_matrix::CompressedColumns;
use crate::formats::variables::{Array, ElementKind};
use crate::reading_budget::{ReadingBudget, VariableFault};
use crate::variable_fault::damage::Damage;

/// Group with a sparse matrix in compressed sparse column format (`MATLAB_sparse`).
pub(super) struct SparseGroup<'g> {
    pub(super) height: u64,
    pub(super) is_logical: bool,
    /// Group members: row indices `ir`, column starts `jc` and numbers `data`.
    pub(super) members: &'g [Member],
    pub(super) path: &'g str,
    pub(super) budget: &'g ReadingBudget<'g>,
}

impl SparseGroup<'_> {
    pub(super) fn full_matrix(&self) -> Result<Array, VariableFault> {
        let starts = self.integers("jc")?.ok_or_else(|| self.contradiction())?;
        let rows = self.integers("ir")?.unwrap_or_default();
        let data = self.data()?;
        let height = usize::try_from(self.height).map_err(|_| self.contradiction())?;
        let width = starts
            .len()
            .checked_sub(1)
            .ok_or_else(|| self.contradiction())?;
        let kind = if self.is_logical {
            ElementKind::Logical
        } else {
            data.kind
        };
        self.budget.take(rows.len() as u64, 8, self.path)?;
        let columns = CompressedColumns {
            shape: [height, width],
            kind,
            rows,
            starts,
            re: data.re,
            im: data.im,
        };
        columns
            .into_entries()
            .ok_or_else(|| self.contradiction())?
            .full_matrix(self.path, self.budget, || self.contradiction())
    }

    /// Reads the nonzero numbers; without a dataset `data` there are none.
    fn data(&self) -> Result<Array, VariableFault> {
        let Some(elements) = self.member("data")? else {
            return Ok(Array::matrix(0, 0, Vec::new()));
        };
        match elements.numbers(self.path, self.budget)? {
            Some(numbers) => Ok(numbers),
            None => Err(damaged(self.path, Damage::SparseElements)),
        }
    }

    /// Reads the integers in the member `name`; `None` if the group has no such member.
    fn integers(&self, name: &str) -> Result<Option<Vec<usize>>, VariableFault> {
        let Some(elements) = self.member(name)? else {
            return Ok(None);
        };
        let Some(words) = elements.words(self.path, self.budget)? else {
            return Err(damaged(self.path, Damage::SparseIndices));
        };
        Ok(Some(
            words
                .into_iter()
                .map(|word| usize::try_from(word).unwrap_or(usize::MAX))
                .collect(),
        ))
    }

    /// Reads the dataset called `name`; `None` if the group has no such dataset.
    fn member(&self, name: &str) -> Result<Option<Elements>, VariableFault> {
        let found = self.members.iter().find(|member| member.name == name);
        match found.map(|member| &member.object) {
            Some(Object::Dataset(dataset)) => {
                Elements::read(dataset, Order::Columns, self.path, self.budget).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Returns the error for a sparse matrix whose parts do not match.
    fn contradiction(&self) -> VariableFault {
        damaged(self.path, Damage::SparseMatrix)
    }
}
