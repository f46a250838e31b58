//! Compares records with each other: contradictions and their causes (M14.16).
//!
//! ```text
//! theta independent entries of the model (`local_parameters`); phi dispersion (`Fit::dispersion`)
//! G_r, g_r normal equations of record r in theta, J Jacobian, e residual (`local_system`)
//! G = sum G_r,  g = sum g_r,  V'GV = I,  at the optimum before records are weighed by their noise,
//!    which would hide the wrong record
//! 1  a = V'G_r V = Q diag(eps) Q';  in the nu directions with 0.02 < eps < 0.98 both the
//!    record and the others hold information
//! 2  c = Q'(V'g_r - a V'g);   F_r = sum c^2 / (eps (1 - eps)) / (nu phi): 1 if the record agrees
//!    with the others' model
//! 3  a contradiction if the largest F exceeds 6, or 12 in gusts (with a caution about feedback).
//!    Suspect: the record with the largest F; and that with the second largest, if there is no
//!    third record or the largest is less than 1.5 times the second
//! 4  for each suspect, residual columns d with transient and theta projected out:
//!      all outputs late W jw Y,  an output late W e_o jw Y_o,
//!      an input late -W H_j jw U_j,  a gain W e_o Y_o
//!      (W whitening factor, e_o unit vector of output o, H_j the model's responses to input j)
//!      h = d'e - d'J G^+ g,  S = d'd - d'J G^+ J'd
//!    the fault with the largest h^2/S, but all outputs late if that has at least 98 % of it; its
//!    size is -h/S
//! ```
//!
//! If leaving a record out changes the model much, the record need not be wrong: it may be the only
//! one that excites an axis.

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::each;

use super::cautions::IdentificationCaution;
use super::model_cautions::ModelCautions;
use super::record_fault::{ContradictingRecord, RecordFault};
use crate::likelihood::cost::{Likelihood, SegmentCost};
use crate::likelihood::descent::Fit;
use crate::likelihood::gram_matrix::pseudo_inverse_root;
use crate::likelihood::local_system::{LocalSystem, LocalSystems};
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::{SpectralLines, whiten};
use crate::options::Options;
use crate::spectra::spectrum::Spectrum;

/// Minimum share `eps` of a direction's information that a record must hold to be compared in that
/// direction.
const LEAST_KNOWN: f64 = 0.02;
/// Largest share `eps` at which a record is compared, so that the others hold some information too.
const MOST_KNOWN: f64 = 0.98;
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
/// A delay common to all outputs is preferred to another fault if it explains at least this share
/// of the largest explained cost.
const AS_GOOD: f64 = 0.98;

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
    likelihood: &'a Likelihood<'a>,
    /// Each segment's lines in scaled units, not whitened.
    spectra: &'a [Spectrum],
    fit: &'a Fit,
    systems: LocalSystems,
    whole: LocalSystem,
    /// `V`, with `V'GV = I`.
    root: DMatrix<f64>,
    /// Contrast for each record, ascending by record; empty for a single record.
    pub(crate) contrasts: Vec<RecordContrast>,
}

/// `h` and `S` for a fault.
#[derive(Clone, Copy)]
struct FaultSums {
    h: f64,
    s: f64,
}

impl FaultSums {
    /// Returns `h^2/S`, the part of the cost that the fault explains.
    fn gain(self) -> f64 {
        if self.s > 0.0 {
            self.h * self.h / self.s
        } else {
            0.0
        }
    }
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

    /// Finds the fault that explains most of a record's residual (step 4); `None` if none can be
    /// computed, or if its size is not finite.
    pub(crate) fn fault(&self, record: usize, options: &Options) -> Option<RecordFault> {
        let faults = self.possible_faults(options);
        let sums = each(self.likelihood.executor, &faults, |fault| {
            self.sums(record, fault)
        });
        let mut found: Vec<(&RecordFault, FaultSums)> = Vec::new();
        for (fault, sums) in faults.iter().zip(sums) {
            if let Some(sums) = sums {
                found.push((fault, sums));
            }
        }
        let best = found
            .iter()
            .max_by(|a, b| a.1.gain().total_cmp(&b.1.gain()))?;
        let outputs_late = found.iter().find(|(fault, sums)| {
            matches!(fault, RecordFault::OutputsLate(_)) && sums.gain() >= AS_GOOD * best.1.gain()
        });
        let (fault, sums) = outputs_late.unwrap_or(best);
        let size = -sums.h / sums.s;
        if !size.is_finite() {
            return None;
        }
        Some(match fault {
            RecordFault::OutputsLate(_) => RecordFault::OutputsLate(size),
            RecordFault::Late(signal, _) => RecordFault::Late(signal.clone(), size),
            RecordFault::Gain(signal, _) => RecordFault::Gain(signal.clone(), 1.0 + size),
        })
    }

    /// Lists the faults that a record may have, with delay 0 or factor 1.
    fn possible_faults(&self, options: &Options) -> Vec<RecordFault> {
        let (outputs, inputs) = self.fit.model.d().shape();
        let mut faults = vec![RecordFault::OutputsLate(0.0)];
        for output in 0..outputs {
            faults.push(RecordFault::Late(
                options.signal(ChannelSide::Output, output),
                0.0,
            ));
        }
        // With a single input, its delay is equivalent to the opposite delay in all outputs.
        if inputs > 1 {
            for input in 0..inputs {
                faults.push(RecordFault::Late(
                    options.signal(ChannelSide::Input, input),
                    0.0,
                ));
            }
        }
        for output in 0..outputs {
            faults.push(RecordFault::Gain(
                options.signal(ChannelSide::Output, output),
                1.0,
            ));
        }
        faults
    }

    /// Computes `h` and `S` for a fault in a record; `None` if they are not finite.
    fn sums(&self, record: usize, fault: &RecordFault) -> Option<FaultSums> {
        let model = &self.fit.model;
        let resolvents = self.likelihood.resolvents(model);
        let mut with_residual = 0.0;
        let mut square = 0.0;
        let mut with_parameters = DVector::zeros(self.systems.parameters.count());
        let segments = self.likelihood.segments.iter().zip(&self.fit.parts);
        for ((lines, part), spectrum) in segments.zip(self.spectra) {
            if lines.record != record {
                continue;
            }
            let effect = residual_effect(fault, lines, spectrum, model);
            let column = lines.without_transient(model, &resolvents, &effect)?;
            with_residual += column.dotc(&part.residual).re;
            square += column.norm_squared();
            let extra = SegmentCost {
                residual: column,
                ..part.clone()
            };
            with_parameters += self.systems.products_with(lines, model, &extra);
        }
        let known = self.root.tr_mul(&with_parameters);
        let optimum = self.root.tr_mul(&self.whole.gradient);
        Some(FaultSums {
            h: with_residual - known.dot(&optimum),
            s: square - known.norm_squared(),
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
    // Step 1: `share` is a; step 2: `excess` is V'g_r - a V'g.
    let share = root.tr_mul(&(&own.matrix * root));
    let excess = root.tr_mul(&own.gradient) - &share * gradient;
    let eigen = share.try_symmetric_eigen(f64::EPSILON, 10_000)?;
    let along = eigen.eigenvectors.tr_mul(&excess);
    let mut compared = Vec::new();
    for (c, eps) in along.iter().zip(eigen.eigenvalues.iter()) {
        if LEAST_KNOWN < *eps && *eps < MOST_KNOWN {
            compared.push(c.powi(2) / (eps * (1.0 - eps)));
        }
    }
    let count = compared.len().max(1) as f64;
    Some(compared.iter().sum::<f64>() / (count * dispersion))
}

/// Returns how a unit fault changes the whitened residual, outputs x lines.
fn residual_effect(
    fault: &RecordFault,
    lines: &SpectralLines,
    spectrum: &Spectrum,
    model: &SchurModel,
) -> DMatrix<Complex<f64>> {
    let (outputs, count) = lines.outputs.shape();
    let mut effect = DMatrix::zeros(outputs, count);
    for (k, (&omega, weight)) in lines.omega.iter().zip(&lines.weights).enumerate() {
        let derivative = Complex::new(0.0, omega);
        let mut raw = vec![Complex::default(); outputs];
        match fault {
            RecordFault::OutputsLate(_) => {
                for (to, y) in raw.iter_mut().zip(spectrum.outputs.column(k).iter()) {
                    *to = derivative * y;
                }
            }
            RecordFault::Late(signal, _) if signal.role == ChannelSide::Output => {
                raw[signal.index] = derivative * spectrum.outputs[(signal.index, k)];
            }
            RecordFault::Late(signal, _) => {
                let moved = derivative * spectrum.inputs[(signal.index, k)];
                let response = model.response(omega);
                for (to, g) in raw.iter_mut().zip(response.column(signal.index).iter()) {
                    *to = -g * moved;
                }
            }
            RecordFault::Gain(signal, _) => {
                raw[signal.index] = spectrum.outputs[(signal.index, k)];
            }
        }
        whiten(weight, &raw, |o, value| effect[(o, k)] = value);
    }
    effect
}
