//! Records against one another: which of them wants another model than the others, and what is wrong with it (M14.16).
//!
//! ```text
//! G = sum G_r, V'GV = I, at the optimum before records are weighed anew, for that hides who is wrong
//! 1  a = V'G_r V = Q diag(eps) Q';  the directions with 0.02 < eps < 0.98 are known to the record and to the others, nu of them
//! 2  c = Q'(V'g_r - a V'g);   F_r = sum c^2 / (eps (1 - eps)) / (nu phi): 1 where the record wants the model of the others
//! 3  of the record with the greatest F, columns of the residual d with the transient and theta projected out:
//!      all outputs late W jw Y,  an output late W e_o jw Y_o,  an input late -W G_j jw U_j,  a gain W e_o Y_o
//!      h = d'e - d'J G^+ g,  S = d'd - d'J G^+ J'd;  the one with the greatest h^2/S, of the value -h/S
//! ```
//!
//! What changes when a record is left out blames nobody: it says only that the record carries an axis alone.

use std::fmt;

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::ChannelRemedy;
use gdcm_model::executor::each;
use gdcm_model::simulation::Signal;

use super::blocks::BlockModel;
use super::cautions::{IdentificationCaution, late_or_early};
use super::diagnostics::Diagnostics;
use super::identify::Options;
use super::likelihood::{Likelihood, SegmentCost, SpectralLines, pseudo_inverse_root, whiten};
use super::normal_system::{NormalSystem, gradient_along};
use super::order::effective_parameters;
use super::refinement::Fit;
use super::spectrum::Spectrum;

/// Share of a direction that a record knows at least, and at most, so that it can be compared.
const KNOWN: (f64, f64) = (0.02, 0.98);
/// Share of the greatest eigenvalue of `G` below which a direction is a freedom of scale.
const FREEDOM_OF_SCALE: f64 = 1e-9;
/// `F` above which a record contradicts the others, and the same where gusts are fed back: they differ from flight to flight.
const CONTRADICTS: f64 = 4.0;
const CONTRADICTS_IN_GUSTS: f64 = 12.0;
/// `F` of the worst record over that of the second, from which it is the worst alone.
const ALONE: f64 = 1.5;
/// Share of the greatest gain within which one delay of all outputs goes before another fault.
const AS_GOOD: f64 = 0.98;

/// How near to -1 a factor is a turned sign: the gain of a turned output was found as -0.98 (M14.16).
const NEAR_A_SIGN: f64 = 0.3;

/// What is wrong with a record.
#[derive(Clone, Debug, PartialEq)]
pub enum RecordFault {
    /// All outputs are logged late \[s\]; negative: early.
    OutputsLate(f64),
    /// A channel is logged late \[s\]; negative: early.
    Late(Signal, f64),
    /// An output is to be multiplied by this.
    Gain(Signal, f64),
}

impl RecordFault {
    /// The channel, where it is of one.
    #[must_use]
    pub fn signal(&self) -> Option<&Signal> {
        match self {
            Self::OutputsLate(_) => None,
            Self::Late(signal, _) | Self::Gain(signal, _) => Some(signal),
        }
    }

    /// What puts it right, by channel; a factor near -1 is a sign, and nothing else.
    #[must_use]
    pub fn remedies(&self, outputs: &[Signal]) -> Vec<(Signal, ChannelRemedy)> {
        let late = |delay_s: f64| ChannelRemedy {
            delay_s,
            ..ChannelRemedy::NONE
        };
        match self {
            Self::OutputsLate(delay_s) => outputs
                .iter()
                .map(|output| (output.clone(), late(*delay_s)))
                .collect(),
            Self::Late(signal, delay_s) => vec![(signal.clone(), late(*delay_s))],
            Self::Gain(signal, factor) => {
                let is_sign = (factor + 1.0).abs() < NEAR_A_SIGN;
                let factor = if is_sign { -1.0 } else { *factor };
                vec![(
                    signal.clone(),
                    ChannelRemedy {
                        factor,
                        ..ChannelRemedy::NONE
                    },
                )]
            }
        }
    }

    /// How late \[s\], where it is a matter of time.
    #[must_use]
    pub fn delay_s(&self) -> Option<f64> {
        match self {
            Self::OutputsLate(delay_s) | Self::Late(_, delay_s) => Some(*delay_s),
            Self::Gain(..) => None,
        }
    }
}

impl fmt::Display for RecordFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let late =
            |delay_s: f64| format!("{:.0} ms {}", 1e3 * delay_s.abs(), late_or_early(delay_s));
        match self {
            Self::OutputsLate(delay_s) => {
                write!(f, "all its outputs are logged {}", late(*delay_s))
            }
            Self::Late(signal, delay_s) => write!(f, "{signal} is logged {}", late(*delay_s)),
            Self::Gain(signal, factor) if *factor < 0.0 => {
                write!(f, "{signal} has the other sign (times {factor:.2})")
            }
            Self::Gain(signal, factor) => write!(f, "{signal} is to be multiplied by {factor:.2}"),
        }
    }
}

/// How far a record wants another model than the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordContrast {
    /// Which, counted from 0.
    pub record: usize,
    /// `F`: 1 where it wants the same.
    pub contrast: f64,
}

/// A record that contradicts others.
#[derive(Clone, Debug, PartialEq)]
pub struct ContradictingRecord {
    /// Which, counted from 0.
    pub record: usize,
    /// Its name.
    pub name: String,
    /// What is wrong with it where it is the wrong one, as far as it can be told.
    pub fault: Option<RecordFault>,
}

/// The records of a fit that is the optimum of its likelihood.
pub(super) struct RecordContrasts<'a> {
    likelihood: &'a Likelihood<'a>,
    /// The lines in scaled units, not whitened, one for each segment of the likelihood.
    spectra: &'a [Spectrum],
    fit: &'a Fit,
    whole: NormalSystem,
    /// `V`.
    root: DMatrix<f64>,
    /// Of each record, ascending by number.
    pub(super) contrasts: Vec<RecordContrast>,
}

impl<'a> RecordContrasts<'a> {
    /// The contrasts; none where an iteration does not end.
    pub(super) fn of(
        likelihood: &'a Likelihood<'a>,
        spectra: &'a [Spectrum],
        fit: &'a Fit,
    ) -> Option<Self> {
        let systems = fit.systems(likelihood)?;
        let whole = NormalSystem::sum(fit.model.parameters(), &systems);
        let spare = likelihood
            .freedom(fit.model.order())
            .checked_sub(effective_parameters(fit))
            .filter(|spare| *spare > 0)?;
        let dispersion = fit.cost / spare as f64;
        let root = pseudo_inverse_root(whole.matrix.clone(), FREEDOM_OF_SCALE)?;
        let gradient = root.tr_mul(&whole.gradient);
        let records = likelihood.records();
        let contrast = |&record: &usize| {
            let own = likelihood.system_of(record, &systems);
            let share = root.tr_mul(&(&own.matrix * &root));
            let wanted = root.tr_mul(&own.gradient) - &share * &gradient;
            let eigen = share.try_symmetric_eigen(f64::EPSILON, 10_000)?;
            let along = eigen.eigenvectors.tr_mul(&wanted);
            let compared: Vec<f64> = (0..along.len())
                .filter(|&k| KNOWN.0 < eigen.eigenvalues[k] && eigen.eigenvalues[k] < KNOWN.1)
                .map(|k| along[k].powi(2) / (eigen.eigenvalues[k] * (1.0 - eigen.eigenvalues[k])))
                .collect();
            let contrast =
                compared.iter().sum::<f64>() / (compared.len().max(1) as f64 * dispersion);
            Some(RecordContrast { record, contrast })
        };
        let contrasts = match records.len() {
            0 | 1 => Vec::new(),
            _ => each(likelihood.executor, &records, contrast)
                .into_iter()
                .collect::<Option<Vec<_>>>()?,
        };
        Some(Self {
            likelihood,
            spectra,
            fit,
            whole,
            root,
            contrasts,
        })
    }

    /// The record that contradicts the others, or the two that contradict one another, each with what would be wrong with it.
    pub(super) fn caution(
        &self,
        in_gusts: bool,
        names: &Diagnostics,
    ) -> Option<IdentificationCaution> {
        let mut worst = self.contrasts.clone();
        worst.sort_by(|a, b| b.contrast.total_cmp(&a.contrast));
        let first = worst.first()?;
        let second = worst.get(1)?;
        let limit = if in_gusts {
            CONTRADICTS_IN_GUSTS
        } else {
            CONTRADICTS
        };
        if first.contrast.is_nan() || first.contrast <= limit {
            return None;
        }
        let alone = worst.len() > 2 && first.contrast >= ALONE * second.contrast;
        let mut records: Vec<usize> = worst
            .iter()
            .take(if alone { 1 } else { 2 })
            .map(|of| of.record)
            .collect();
        records.sort_unstable();
        let named = |record| {
            let name = names.record_name(record);
            let fault = self.fault(record, names.options);
            ContradictingRecord {
                record,
                name,
                fault,
            }
        };
        let records = records.into_iter().map(named).collect();
        Some(IdentificationCaution::Contradiction {
            records,
            contrast: first.contrast,
        })
    }

    /// What is wrong with a record, by the fault that explains most of what the model leaves of it.
    pub(super) fn fault(&self, record: usize, options: &Options) -> Option<RecordFault> {
        let (outputs, inputs) = self.fit.model.d.shape();
        let output = |index| options.signal(ChannelSide::Output, index);
        let input = |index| options.signal(ChannelSide::Input, index);
        let faults: Vec<RecordFault> = std::iter::once(RecordFault::OutputsLate(0.0))
            .chain((0..outputs).map(|index| RecordFault::Late(output(index), 0.0)))
            // One input that is early is the same as all outputs late.
            .chain(
                (0..inputs)
                    .filter(|_| inputs > 1)
                    .map(|index| RecordFault::Late(input(index), 0.0)),
            )
            .chain((0..outputs).map(|index| RecordFault::Gain(output(index), 1.0)))
            .collect();
        let sums = each(self.likelihood.executor, &faults, |fault| {
            self.sums(record, fault)
        });
        let gain = |sums: &(f64, f64)| {
            if sums.1 > 0.0 {
                sums.0 * sums.0 / sums.1
            } else {
                0.0
            }
        };
        let found: Vec<(RecordFault, (f64, f64))> = faults
            .into_iter()
            .zip(sums)
            .filter_map(|(fault, sums)| Some((fault, sums?)))
            .collect();
        let best = found
            .iter()
            .max_by(|a, b| gain(&a.1).total_cmp(&gain(&b.1)))?;
        let all = found
            .iter()
            .find(|(fault, _)| matches!(fault, RecordFault::OutputsLate(_)))
            .filter(|of| gain(&of.1) >= AS_GOOD * gain(&best.1));
        let (fault, (h, s)) = all.unwrap_or(best);
        let size = -h / s;
        size.is_finite().then(|| match fault {
            RecordFault::OutputsLate(_) => RecordFault::OutputsLate(size),
            RecordFault::Late(signal, _) => RecordFault::Late(signal.clone(), size),
            RecordFault::Gain(signal, _) => RecordFault::Gain(signal.clone(), 1.0 + size),
        })
    }

    /// `h` and `S` of a fault of a record.
    fn sums(&self, record: usize, fault: &RecordFault) -> Option<(f64, f64)> {
        let model = &self.fit.model;
        let mut with_residual = 0.0;
        let mut square = 0.0;
        let mut with_parameters = DVector::zeros(model.parameters());
        for ((lines, part), spectrum) in self
            .likelihood
            .segments
            .iter()
            .zip(&self.fit.parts)
            .zip(self.spectra)
        {
            if lines.record != record {
                continue;
            }
            let column = lines.without_transient(model, &fault.column(lines, spectrum, model))?;
            with_residual += column.dotc(&part.residual).re;
            square += column.norm_squared();
            with_parameters += gradient_along(
                lines,
                model,
                &SegmentCost {
                    residual: column,
                    ..part.clone()
                },
            );
        }
        let known = self.root.tr_mul(&with_parameters);
        let optimum = self.root.tr_mul(&self.whole.gradient);
        Some((
            with_residual - known.dot(&optimum),
            square - known.norm_squared(),
        ))
    }
}

impl RecordFault {
    /// What it adds to the whitened residual, outputs x lines, but for its size and sign.
    fn column(
        &self,
        lines: &SpectralLines,
        spectrum: &Spectrum,
        model: &BlockModel,
    ) -> DMatrix<Complex<f64>> {
        let (outputs, count) = lines.outputs.shape();
        let mut column = DMatrix::zeros(outputs, count);
        for (k, (&omega, weight)) in lines.omega.iter().zip(&lines.weights).enumerate() {
            let turn = Complex::new(0.0, omega);
            let mut raw = vec![Complex::default(); outputs];
            match self {
                Self::OutputsLate(_) => {
                    raw.iter_mut()
                        .zip(spectrum.outputs.column(k).iter())
                        .for_each(|(to, y)| *to = turn * y);
                }
                Self::Late(
                    Signal {
                        role: ChannelSide::Output,
                        index,
                        ..
                    },
                    _,
                ) => {
                    raw[*index] = turn * spectrum.outputs[(*index, k)];
                }
                Self::Late(
                    Signal {
                        role: ChannelSide::Input,
                        index,
                        ..
                    },
                    _,
                ) => {
                    let moved = turn * spectrum.inputs[(*index, k)];
                    raw.iter_mut()
                        .zip(model.response(omega).column(*index).iter())
                        .for_each(|(to, g)| *to = -g * moved);
                }
                Self::Gain(signal, _) => raw[signal.index] = spectrum.outputs[(signal.index, k)],
            }
            whiten(weight, &raw, |o, value| column[(o, k)] = value);
        }
        column
    }
}
