//! Normal equations in a model's [local parameters](super::local_parameters), kept segment by
//! segment, so that those of some records can be summed, or left out.
//!
//! ```text
//! e   whitened residual of a segment's spectral lines (`cost`): their cost is e'e
//! J   Jacobian of the whitened model output: a step d in the parameters changes e to e - J d
//! G = J'J,   g = J'e
//! ```
//!
//! The nuisance columns (`nuisance_elimination`), which describe a segment's transient, trim, drift
//! and missing samples, are projected out of e and J.
//!
//! Used for the covariance (M14.5), for models without a record (M14.5), and for records compared
//! with one another (M14.16) or held out (M14.17).

use nalgebra::{DMatrix, DVector};

use gdcm_model::executor::each;

use super::cost::{Likelihood, SegmentCost};
use super::descent::Fit;
use super::gram_matrix::scale_columns;
use super::local_parameters::LocalParameters;
use super::normal_equations::{EXACT, NormalEquations, products_with};
use super::schur_model::SchurModel;
use super::spectral_lines::SpectralLines;

/// `G` and `g`: a step d in the parameters changes the cost by `-2 g'd + d'G d`.
#[derive(Clone, Debug)]
pub(crate) struct LocalSystem {
    /// `G = J'J`.
    pub(crate) matrix: DMatrix<f64>,
    /// `g = J'e`.
    pub(crate) gradient: DVector<f64>,
}

impl LocalSystem {
    /// Sums systems with this many parameters; zero if there are none.
    pub(crate) fn sum<'s>(parameters: usize, systems: impl IntoIterator<Item = &'s Self>) -> Self {
        let mut sum = Self {
            matrix: DMatrix::zeros(parameters, parameters),
            gradient: DVector::zeros(parameters),
        };
        for system in systems {
            sum.matrix += &system.matrix;
            sum.gradient += &system.gradient;
        }
        sum
    }

    /// Returns this system minus another.
    pub(crate) fn without(&self, other: &Self) -> Self {
        Self {
            matrix: &self.matrix - &other.matrix,
            gradient: &self.gradient - &other.gradient,
        }
    }

    /// Computes the Levenberg-Marquardt step, `(G + lambda diag G) d = g`.
    ///
    /// ```text
    /// 1  G in columns scaled to unit length
    /// 2  its diagonal becomes 1 + lambda, or 1 for a column of zeros, whose step is then 0
    /// 3  Cholesky solution, scaled back
    /// ```
    ///
    /// `None` if the matrix is not positive definite, or the step not finite.
    pub(crate) fn damped_step(&self, lambda: f64) -> Option<DVector<f64>> {
        // Steps 1 and 2.
        let mut scaled = self.matrix.clone();
        let scales = scale_columns(&mut scaled);
        for (k, scale) in scales.iter().enumerate() {
            scaled[(k, k)] = if *scale > 0.0 { 1.0 + lambda } else { 1.0 };
        }
        // Step 3.
        let step = scaled
            .cholesky()?
            .solve(&self.gradient.component_mul(&scales))
            .component_mul(&scales);
        if step.iter().all(|entry| entry.is_finite()) {
            Some(step)
        } else {
            None
        }
    }
}

/// The systems of all segments at a model, in common parameters.
pub(crate) struct LocalSystems {
    pub(crate) parameters: LocalParameters,
    /// A system for each segment, in the likelihood's order.
    pub(crate) systems: Vec<LocalSystem>,
    /// Record index for each segment.
    records: Vec<usize>,
}

impl LocalSystems {
    /// Selects parameters for a fit, and computes the systems; `None` under the conditions of
    /// [`NormalEquations::new`].
    pub(crate) fn new(likelihood: &Likelihood, fit: &Fit) -> Option<Self> {
        let bin_width = EXACT;
        let whole = NormalEquations::new(likelihood, &fit.model, &fit.parts, bin_width)?;
        let parameters = LocalParameters::select(&fit.model, &whole.matrix);
        Self::in_parameters(parameters, likelihood, &fit.model, &fit.parts)
    }

    /// Computes the systems in given parameters; `parts` are the segment costs at the model. `None`
    /// under the conditions of [`NormalEquations::new`].
    pub(crate) fn in_parameters(
        parameters: LocalParameters,
        likelihood: &Likelihood,
        model: &SchurModel,
        parts: &[SegmentCost],
    ) -> Option<Self> {
        let places = parameters.places();
        let segments = likelihood.segments.iter().zip(parts);
        let bin_width = EXACT;
        let computed = each(likelihood.executor, segments, |(segment, part)| {
            let alone = Likelihood::of_segment(segment.clone());
            let own_part = std::slice::from_ref(part);
            let equations = NormalEquations::new(&alone, model, own_part, bin_width)?;
            Some(LocalSystem {
                matrix: equations
                    .matrix
                    .select_rows(&places)
                    .select_columns(&places),
                gradient: equations.gradient.select_rows(&places),
            })
        });
        let mut systems = Vec::with_capacity(computed.len());
        for system in computed {
            systems.push(system?);
        }
        let records = likelihood.segments.iter().map(|segment| segment.record);
        Some(Self {
            parameters,
            systems,
            records: records.collect(),
        })
    }

    /// Sums all systems.
    pub(crate) fn whole(&self) -> LocalSystem {
        LocalSystem::sum(self.parameters.count(), &self.systems)
    }

    /// Sums a record's systems.
    pub(crate) fn of_record(&self, record: usize) -> LocalSystem {
        let segments = self.systems.iter().zip(&self.records);
        let own = segments.filter(|(_, segment_record)| **segment_record == record);
        LocalSystem::sum(self.parameters.count(), own.map(|(system, _)| system))
    }

    /// Computes the inner products of a segment's `J` with a further column, such as the effect of
    /// a fault in its record (M14.16).
    ///
    /// `extra` is the segment's cost with that column instead of its residual; the nuisance columns
    /// are already projected out of it.
    pub(crate) fn products_with(
        &self,
        lines: &SpectralLines,
        model: &SchurModel,
        extra: &SegmentCost,
    ) -> DVector<f64> {
        products_with(lines, model, extra).select_rows(&self.parameters.places())
    }
}
