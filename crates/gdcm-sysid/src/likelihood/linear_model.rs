//! A state-space model as seen by the cost, and its evaluation at many frequencies.

use nalgebra::{Complex, DMatrix};

use gdcm_model::executor::{Executor, each};

/// A continuous-time model `(A, B, C, D)` whose resolvent can be evaluated.
pub(crate) trait LinearModel: Sync {
    /// Returns `B`, n x inputs.
    fn b(&self) -> &DMatrix<f64>;

    /// Returns `C`, outputs x n.
    fn c(&self) -> &DMatrix<f64>;

    /// Returns `D`, outputs x inputs.
    fn d(&self) -> &DMatrix<f64>;

    /// Computes `C (j omega - A)^-1`, outputs x n, into `cr`, column after column.
    fn output_resolvent(&self, omega: f64, cr: &mut [Complex<f64>]);

    /// Computes `(j omega - A)^-1 x` in place.
    fn resolve(&self, omega: f64, x: &mut [Complex<f64>]);

    /// Returns the number of states n.
    fn order(&self) -> usize {
        self.b().nrows()
    }

    /// Computes `C (j omega - A)^-1 B + D`, outputs x inputs.
    fn response(&self, omega: f64) -> DMatrix<Complex<f64>> {
        let mut cr = DMatrix::zeros(self.c().nrows(), self.order());
        self.output_resolvent(omega, cr.as_mut_slice());
        cr * self.b().map(Complex::from) + self.d().map(Complex::from)
    }
}

/// The frequencies of a set of lines without duplicates: records of equal length share theirs.
#[derive(Clone, Debug, Default)]
pub(crate) struct FrequencyTable {
    /// \[rad/s\], ascending, without duplicates.
    omega: Vec<f64>,
}

impl FrequencyTable {
    /// Collects the frequencies of all lines \[rad/s\].
    pub(crate) fn new<'l>(lines: impl Iterator<Item = &'l [f64]>) -> Self {
        let mut omega: Vec<f64> = lines.flatten().copied().collect();
        omega.sort_by(f64::total_cmp);
        omega.dedup();
        Self { omega }
    }

    /// Returns the index of a frequency of the table \[rad/s\].
    fn index(&self, omega: f64) -> usize {
        self.omega.partition_point(|other| *other < omega)
    }

    /// Computes `C (j omega - A)^-1` of a model at every frequency.
    pub(crate) fn output_resolvents(
        &self,
        model: &impl LinearModel,
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

/// `C (j omega - A)^-1` of a model at the frequencies of a table.
pub(crate) struct OutputResolvents<'t> {
    table: &'t FrequencyTable,
    /// Outputs x n for each frequency, column after column.
    values: Vec<Vec<Complex<f64>>>,
}

impl OutputResolvents<'_> {
    /// Returns the matrix at each frequency of `omega` \[rad/s\], all of which are in the table.
    pub(crate) fn at_lines(&self, omega: &[f64]) -> Vec<&[Complex<f64>]> {
        omega
            .iter()
            .map(|omega| self.values[self.table.index(*omega)].as_slice())
            .collect()
    }
}
