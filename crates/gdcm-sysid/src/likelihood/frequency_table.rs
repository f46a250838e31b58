//! The frequencies of all lines, and a model's resolvent at each.

use nalgebra::Complex;

use gdcm_model::executor::{Executor, each};

use super::schur_model::SchurModel;

/// The lines' frequencies without duplicates: records with equal length share theirs.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrequencyTable {
    /// \[rad/s\], ascending, without duplicates.
    omega: Vec<f64>,
}

impl FrequencyTable {
    /// Collects the lines' frequencies \[rad/s\].
    pub(crate) fn new<'l>(lines: impl Iterator<Item = &'l [f64]>) -> Self {
        let mut omega: Vec<f64> = lines.flatten().copied().collect();
        omega.sort_by(f64::total_cmp);
        omega.dedup();
        Self { omega }
    }

    /// Returns the index of a frequency \[rad/s\] that is in the table.
    fn index(&self, omega: f64) -> usize {
        self.omega.partition_point(|other| *other < omega)
    }

    /// Computes a model's `C (j omega - A)^-1` at every frequency.
    pub(crate) fn output_resolvents(
        &self,
        model: &SchurModel,
        executor: &dyn Executor,
    ) -> OutputResolvents<'_> {
        let size = model.c().nrows() * model.order();
        let values = each(executor, &self.omega, |&omega| {
            let mut cr = vec![Complex::default(); size];
            model.output_resolvent(omega, &mut cr);
            cr
        });
        OutputResolvents {
            table: self,
            values,
        }
    }
}

/// A model's `C (j omega - A)^-1` at the frequencies in a table.
pub(crate) struct OutputResolvents<'t> {
    table: &'t FrequencyTable,
    /// Outputs x n for each frequency, column after column.
    values: Vec<Vec<Complex<f64>>>,
}

impl OutputResolvents<'_> {
    /// Returns the matrix at each frequency in `omega` \[rad/s\]; the table must hold them all.
    pub(crate) fn at_lines(&self, omega: &[f64]) -> Vec<&[Complex<f64>]> {
        omega
            .iter()
            .map(|omega| self.values[self.table.index(*omega)].as_slice())
            .collect()
    }
}
