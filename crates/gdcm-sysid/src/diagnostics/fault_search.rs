//! Finds the fault that explains why a record contradicts the others (M14.16).
//!
//! ```text
//! e residual of the record, J its Jacobian in the model's parameters theta, both whitened
//!    (`local_system`);   G, g normal equations of all records
//! V with V'GV = I, so that G^+ = VV'
//! 1  for each possible fault the column d, the change of e when a fault of size 1 is corrected:
//!      all outputs late W jw Y,  an output late W e_o jw Y_o,
//!      an input late -W H_j jw U_j,  a gain W e_o Y_o
//!      (Y, U spectra of outputs and inputs, w frequency, W whitening factor, e_o unit vector of
//!      output o, H_j the model's responses to input j)
//!    with the transient projected out
//! 2  with theta projected out too:   h = d'e - d'J G^+ g,   S = d'd - d'J G^+ J'd
//! 3  h^2/S is the cost that the fault explains. The fault with the largest, but all outputs late
//!    if that has at least 98 % of it; its size is -h/S
//! ```

use nalgebra::{Complex, DMatrix, DVector};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::executor::each;

use super::record_contrast::RecordContrasts;
use super::record_fault::RecordFault;
use crate::likelihood::cost::SegmentCost;
use crate::likelihood::schur_model::SchurModel;
use crate::likelihood::spectral_lines::{SpectralLines, whiten};
use crate::options::Options;
use crate::spectra::spectrum::Spectrum;

/// A delay common to all outputs is preferred to another fault if it explains at least this share
/// of the largest explained cost; a smaller share names single channels less often. With a single
/// output, its own delay explains the same.
const AS_GOOD: f64 = 0.98;

/// A fault's products with theta projected out (step 2).
#[derive(Clone, Copy)]
struct FaultProducts {
    /// `h`, the product of the fault's column with the residual.
    with_residual: f64,
    /// `S`, the column's square.
    square: f64,
}

impl FaultProducts {
    /// Returns `h^2/S`, the part of the cost that the fault explains.
    fn explained_cost(self) -> f64 {
        if self.square > 0.0 {
            self.with_residual * self.with_residual / self.square
        } else {
            0.0
        }
    }
}

impl RecordContrasts<'_> {
    /// Finds the fault that explains most of a record's residual (steps 1 to 3); `None` if none can
    /// be computed, or if its size is not finite.
    pub(crate) fn fault(&self, record: usize, options: &Options) -> Option<RecordFault> {
        let faults = self.possible_faults(options);
        // Steps 1 and 2.
        let products_of_faults = each(self.likelihood.executor, &faults, |fault| {
            self.products(record, fault)
        });
        let mut computed: Vec<(&RecordFault, FaultProducts)> = Vec::new();
        for (fault, products) in faults.iter().zip(products_of_faults) {
            if let Some(products) = products {
                computed.push((fault, products));
            }
        }
        // Step 3.
        let best = computed
            .iter()
            .max_by(|a, b| a.1.explained_cost().total_cmp(&b.1.explained_cost()))?;
        let outputs_late = computed.iter().find(|(fault, products)| {
            matches!(fault, RecordFault::OutputsLate(_))
                && products.explained_cost() >= AS_GOOD * best.1.explained_cost()
        });
        let (fault, products) = outputs_late.unwrap_or(best);
        let size = -products.with_residual / products.square;
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

    /// Computes `h` and `S` for a fault in a record (steps 1 and 2); `None` if the transients
    /// cannot be projected out.
    fn products(&self, record: usize, fault: &RecordFault) -> Option<FaultProducts> {
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
            let effect = effect_of_correction(fault, lines, spectrum, model);
            let column = lines.without_transient(model, &resolvents, &effect)?;
            with_residual += column.dotc(&part.residual).re;
            square += column.norm_squared();
            let with_column = SegmentCost {
                residual: column,
                ..part.clone()
            };
            with_parameters += self.systems.products_with(lines, model, &with_column);
        }
        // V'J'd and V'g.
        let in_directions = self.root.tr_mul(&with_parameters);
        let gradient = self.root.tr_mul(&self.whole.gradient);
        Some(FaultProducts {
            with_residual: with_residual - in_directions.dot(&gradient),
            square: square - in_directions.norm_squared(),
        })
    }
}

/// Returns the change of the whitened residual when a fault of size 1 is corrected (step 1),
/// outputs x lines.
fn effect_of_correction(
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
                let input_rate = derivative * spectrum.inputs[(signal.index, k)];
                let response = model.response(omega);
                for (to, g) in raw.iter_mut().zip(response.column(signal.index).iter()) {
                    *to = -g * input_rate;
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
