//! Compares records with each other: which contradict the others (M14.16).
//!
//! A record's normal equations tell in which direction the model would change if it followed this
//! record alone. Where both the record and the others determine the model, that change is zero
//! within the noise unless the record contradicts the others.
//!
//! ```text
//! theta independent entries of the model (`local_parameters`); phi dispersion (`Fit::dispersion`)
//! G_r, g_r normal equations of record r in theta (`local_system`);   G = sum G_r,  g = sum g_r
//! V with V'GV = I: in the coordinates V each direction holds information 1
//! 1  a = V'G_r V = Q diag(eps) Q';  eps: share of the information in a direction that comes from
//!    record r.  In the nu directions with 0.02 < eps < 0.98 both the record and the others hold
//!    information
//! 2  c = Q'(V'g_r - a V'g);   F_r = sum c^2 / (eps (1 - eps)) / (nu phi): 1 if the record agrees
//!    with the others' model
//! 3  a contradiction if the largest F exceeds 6, or 12 in gusts (with a caution about feedback).
//!    Suspect: the record with the largest F; and that with the second largest, if there is no
//!    third record or the largest is less than 1.5 times the second
//! 4  the most likely fault of each suspect (`fault_search`)
//! ```
//!
//! The systems are those at the optimum before records are weighed by their noise, which would hide
//! the wrong record. If leaving a record out changes the model much, the record need not be wrong:
//! it may be the only one that excites an axis.

use nalgebra::{DMatrix, DVector};

use gdcm_model::executor::each;

use super::cautions::IdentificationCaution;
use super::model_cautions::ModelCautions;
use super::record_fault::ContradictingRecord;
use crate::likelihood::cost::Likelihood;
use crate::likelihood::descent::Fit;
use crate::likelihood::gram_matrix::pseudo_inverse_root;
use crate::likelihood::local_system::{LocalSystem, LocalSystems};
use crate::spectra::spectrum::Spectrum;

/// Minimum share `eps` of a direction's information that a record must hold to be compared in that
/// direction.
const LEAST_SHARE: f64 = 0.02;
/// Largest share `eps` at which a record is compared, so that the others hold some information too.
const LARGEST_SHARE: f64 = 0.98;
/// Eigenvalues of the information matrix `G` below this share of the largest are rounding errors.
const ROUNDING: f64 = 1e-13;
/// `F` above which a record contradicts the others (M14.23).
const CONTRADICTS: f64 = 6.0;
/// `F` above which a record contradicts the others if gusts are fed back, because gusts differ
/// between flights.
const CONTRADICTS_IN_GUSTS: f64 = 12.0;
/// Only the worst record is reported if its `F` is at least this many times the second largest, and
/// if there is a third record.
const ALONE: f64 = 1.5;

/// Contradiction between a record and the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordContrast {
    /// Record index, from 0.
    pub record: usize,
    /// `F`; 1 is agreement.
    pub contrast: f64,
}

/// A fit's records, compared with each other at its optimum.
pub(crate) struct RecordContrasts<'a> {
    pub(super) likelihood: &'a Likelihood<'a>,
    /// Each segment's lines in scaled units, not whitened.
    pub(super) spectra: &'a [Spectrum],
    pub(super) fit: &'a Fit,
    /// `G_r` and `g_r`, segment by segment.
    pub(super) systems: LocalSystems,
    /// `G` and `g`.
    pub(super) whole: LocalSystem,
    /// `V`, with `V'GV = I`.
    pub(super) root: DMatrix<f64>,
    /// Contrast for each record, ascending by record; empty for a single record.
    pub(crate) contrasts: Vec<RecordContrast>,
}

impl<'a> RecordContrasts<'a> {
    /// Compares the records (steps 1 and 2); `None` if an iteration does not converge.
    pub(crate) fn new(
        likelihood: &'a Likelihood<'a>,
        spectra: &'a [Spectrum],
        fit: &'a Fit,
    ) -> Option<Self> {
        let systems = LocalSystems::new(likelihood, fit)?;
        let whole = systems.whole();
        let dispersion = fit.dispersion(likelihood)?;
        let root = pseudo_inverse_root(whole.matrix.clone(), ROUNDING)?;
        let gradient = root.tr_mul(&whole.gradient);
        let records = likelihood.records();
        let contrasts = if records.len() < 2 {
            Vec::new()
        } else {
            each(likelihood.executor, records, |record| {
                let own = systems.of_record(record);
                let contrast = contrast(&own, &root, &gradient, dispersion)?;
                Some(RecordContrast { record, contrast })
            })
            .into_iter()
            .collect::<Option<Vec<_>>>()?
        };
        Some(Self {
            likelihood,
            spectra,
            fit,
            systems,
            whole,
            root,
            contrasts,
        })
    }

    /// Returns the caution about the record that contradicts the others, or about two records that
    /// contradict each other, each with its most likely fault (steps 3 and 4). `None` without a
    /// contradiction.
    pub(crate) fn caution(
        &self,
        is_in_gusts: bool,
        names: &ModelCautions<'_>,
    ) -> Option<IdentificationCaution> {
        // Step 3.
        let mut worst = self.contrasts.clone();
        worst.sort_by(|a, b| b.contrast.total_cmp(&a.contrast));
        let first = worst.first()?;
        let second = worst.get(1)?;
        let limit = if is_in_gusts {
            CONTRADICTS_IN_GUSTS
        } else {
            CONTRADICTS
        };
        if first.contrast.is_nan() || first.contrast <= limit {
            return None;
        }
        let is_alone = worst.len() > 2 && first.contrast >= ALONE * second.contrast;
        let mut suspects = vec![first.record];
        if !is_alone {
            suspects.push(second.record);
        }
        suspects.sort_unstable();
        // Step 4 for each suspect.
        let mut records = Vec::with_capacity(suspects.len());
        for record in suspects {
            records.push(ContradictingRecord {
                record,
                name: names.record_name(record),
                fault: self.fault(record, names.options),
            });
        }
        Some(IdentificationCaution::Contradiction {
            records,
            contrast: first.contrast,
        })
    }
}

/// Computes `F` for a record with the normal system `own` (steps 1 and 2); `root` is `V`,
/// `gradient` is `V'g` and `dispersion` is `phi`.
fn contrast(
    own: &LocalSystem,
    root: &DMatrix<f64>,
    gradient: &DVector<f64>,
    dispersion: f64,
) -> Option<f64> {
    // Step 1: `share` is a.
    let share = root.tr_mul(&(&own.matrix * root));
    // Step 2: `excess` is V'g_r - a V'g, the record's gradient beyond its share of the whole.
    let excess = root.tr_mul(&own.gradient) - &share * gradient;
    let eigen = share.try_symmetric_eigen(f64::EPSILON, 10_000)?;
    let excess_along = eigen.eigenvectors.tr_mul(&excess);
    let mut squares = Vec::new();
    for (c, eps) in excess_along.iter().zip(eigen.eigenvalues.iter()) {
        if LEAST_SHARE < *eps && *eps < LARGEST_SHARE {
            squares.push(c.powi(2) / (eps * (1.0 - eps)));
        }
    }
    let count = squares.len().max(1) as f64;
    Some(squares.iter().sum::<f64>() / (count * dispersion))
}
