//! Summary costs for a model in a condition (M17.4): mean J, weighted rms error in time, Theil's
//! coefficients, and the share of the band inside the MUAD envelopes.
//!
//! ```text
//! J:      J_mag + J_phase after the correction, averaged over the on-axis responses and over all
//!         (M4)
//! J_rms:  weighted rms of y - y^ over all outputs together (rms_cost)
//! Theil:  rms(y - y^) / (rms y + rms y^) for each output, with rms y and rms y^ about the mean
//!         of y (M14.6)
//! MUAD:   1 - sum ln(b/a) / ln(omega_N/omega_1) over the ranges (a, b) in which the error leaves
//!         an envelope
//! ```
//!
//! MUAD is the maximum unnoticeable added dynamics: envelopes in magnitude and phase inside which
//! pilots do not notice an error. `y` are the flown and `y^` the simulated outputs; the band
//! extends from `omega_1` to `omega_N`.
//!
//! MUAD: MIL-STD-1797A, appendix A, 4.2.1.2.

use gdcm_model::dataset::{Channel, Pair, PairTable};
use gdcm_model::response::{GainDelay, wrap};
use gdcm_model::simulation::Validation;
use gdcm_model::statistics::mean;

use super::rms_cost::RmsCost;
use crate::fidelity::{CostAverage, Mismatch, ranges_outside};

/// A model in a condition, compared with flight.
#[derive(Clone, Copy)]
pub struct SummarySource<'a> {
    /// Difference between the model and the identified representative, per response; `None` where
    /// no comparison exists.
    pub mismatch: &'a PairTable<Option<Mismatch>>,
    /// Correction per response; `None` without a positive net gain.
    pub correction: &'a dyn Fn(Pair) -> Option<GainDelay>,
    pub on_axis: &'a PairTable<bool>,
    /// Band frequencies \[rad/s\], ascending.
    pub omega: &'a [f64],
    /// How J averages over frequency.
    pub average: CostAverage,
    /// The model's comparison with a flight record, if any.
    pub validation: Option<&'a Validation>,
    pub outputs: &'a [Channel],
}

/// Summary costs for a model in a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    pub cost: OnAxisAndAll,
    /// `J_rms`; `None` without a record, or if no output has a weight.
    pub rms: Option<RmsCost>,
    /// Theil's coefficient by output, 0 to 1; empty without a record, `None` if flown and simulated
    /// output are constant and equal.
    pub theil: Vec<Option<f64>>,
    /// Mean over responses: share of the band inside MUAD, 0 to 1.
    pub muad: OnAxisAndAll,
}

impl Summary {
    /// Computes J and the MUAD share under the correction in `source`; the other costs are those of
    /// its `validation`.
    pub fn compute(source: &SummarySource<'_>) -> Self {
        let SummarySource {
            mismatch,
            correction,
            on_axis,
            omega,
            average,
            validation,
            outputs,
        } = *source;
        let costs = mismatch.map(|pair, mismatch| {
            let correction = correction(pair)?;
            let cost = mismatch.as_ref()?.cost(omega, correction, average);
            Some(cost.total())
        });
        let muad_shares =
            mismatch.map(|pair, mismatch| muad_share(mismatch.as_ref()?, omega, correction(pair)?));
        Self {
            cost: OnAxisAndAll::average(&costs, on_axis),
            rms: validation.and_then(|validation| RmsCost::compute(&validation.windows, outputs)),
            theil: validation
                .map(|validation| validation.theil.clone())
                .unwrap_or_default(),
            muad: OnAxisAndAll::average(&muad_shares, on_axis),
        }
    }
}

/// Means over the on-axis responses and over all responses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OnAxisAndAll {
    /// Mean over the on-axis responses; `None` if none of them has a value.
    pub on_axis: Option<f64>,
    /// Mean over all responses; `None` if none of them has a value.
    pub all: Option<f64>,
}

impl OnAxisAndAll {
    /// Averages the values; responses without a value are skipped.
    pub fn average(values: &PairTable<Option<f64>>, on_axis: &PairTable<bool>) -> Self {
        let mut all_values = Vec::new();
        let mut on_axis_values = Vec::new();
        for (pair, value) in values.iter() {
            let Some(value) = *value else { continue };
            all_values.push(value);
            if on_axis.get(pair) == Some(&true) {
                on_axis_values.push(value);
            }
        }
        Self {
            on_axis: mean_or_none(&on_axis_values),
            all: mean_or_none(&all_values),
        }
    }
}

fn mean_or_none(values: &[f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    Some(mean(values))
}

/// Returns the share of the band, in `ln omega`, in which a response error stays inside both MUAD
/// envelopes after `correction`; `None` with fewer than two frequencies.
pub fn muad_share(mismatch: &Mismatch, omega: &[f64], correction: GainDelay) -> Option<f64> {
    let omega = mismatch.omega(omega);
    let (&first, &last) = omega.first().zip(omega.last())?;
    if first >= last {
        return None;
    }
    let error_db: Vec<f64> = correction
        .magnitudes_db(&mismatch.magnitude_db, omega)
        .collect();
    let error_deg: Vec<f64> = correction
        .phases(&mismatch.phase, omega)
        .map(|phase| wrap(phase).to_degrees())
        .collect();
    let outside: f64 = ranges_outside(omega, &error_db, &error_deg)
        .iter()
        .map(|(from, to)| (to / from).ln())
        .sum();
    Some((1.0 - outside / (last / first).ln()).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use gdcm_model::response::frequency_grid::log_spaced;
    use gdcm_model::units::db_to_ratio;

    use super::*;

    fn omega() -> Vec<f64> {
        log_spaced(0.5, 12.0, 200)
    }

    fn mismatch(magnitude_db: f64, delay_s: f64) -> Mismatch {
        let phase = omega().iter().map(|omega| wrap(-omega * delay_s)).collect();
        Mismatch {
            magnitude_db: vec![magnitude_db; 200],
            phase,
            coherence_weights: None,
            turn: 0.0,
        }
    }

    fn outputs() -> [Channel; 3] {
        [("P", "deg/s"), ("NZ", "m/s^2"), ("T", "N")].map(|(name, unit)| Channel::new(name, unit))
    }

    #[test]
    fn a_model_without_error_is_inside_everywhere_and_costs_nothing() {
        let table = PairTable::filled(1, 1, Some(mismatch(0.0, 0.0)));
        let on_axis = PairTable::filled(1, 1, true);
        let source = SummarySource {
            mismatch: &table,
            correction: &|_| Some(GainDelay::NONE),
            on_axis: &on_axis,
            omega: &omega(),
            average: CostAverage::Median,
            validation: None,
            outputs: &outputs(),
        };
        let summary = Summary::compute(&source);
        assert_eq!(
            (summary.cost.all, summary.muad.on_axis, summary.rms),
            (Some(0.0), Some(1.0), None)
        );
        assert!(summary.theil.is_empty());
    }

    #[test]
    fn the_share_inside_is_that_of_the_band_in_log_frequency() {
        // 2 dB exceed the upper magnitude between about 2 and 6 rad/s (muad.rs).
        let omega = omega();
        let two_db = mismatch(2.0, 0.0);
        let ranges = ranges_outside(&omega, &[2.0; 200], &[0.0; 200]);
        let expected = 1.0 - (ranges[0].1 / ranges[0].0).ln() / 24.0_f64.ln();
        assert!((muad_share(&two_db, &omega, GainDelay::NONE).unwrap() - expected).abs() < 1e-14);
        assert_eq!(
            muad_share(&two_db, &omega, GainDelay::new(db_to_ratio(-2.0), 0.0)),
            Some(1.0)
        );
        assert_eq!(
            muad_share(&mismatch(60.0, 0.0), &omega, GainDelay::NONE),
            Some(0.0)
        );
        // A lead of 0.25 s, which the correction removes including its whole turns.
        let lead = mismatch(0.0, -0.25);
        let share = muad_share(&lead, &omega, GainDelay::NONE).unwrap();
        assert!(share < 0.5, "{share}");
        assert_eq!(
            muad_share(&lead, &omega, GainDelay::new(1.0, 0.25)),
            Some(1.0)
        );
        let single_point = Mismatch {
            magnitude_db: vec![0.0],
            phase: vec![0.0],
            coherence_weights: None,
            turn: 0.0,
        };
        assert_eq!(muad_share(&single_point, &[1.0], GainDelay::NONE), None);
    }

    #[test]
    fn means_leave_undefined_values_out() {
        let values = PairTable::from_fn(2, 2, |pair| {
            [[Some(1.0), Some(5.0)], [None, Some(3.0)]][pair.output][pair.input]
        });
        let on_axis = PairTable::from_fn(2, 2, |pair| pair.output == pair.input);
        assert_eq!(
            OnAxisAndAll::average(&values, &on_axis),
            OnAxisAndAll {
                on_axis: Some(2.0),
                all: Some(3.0)
            }
        );
        let nothing = OnAxisAndAll::average(&PairTable::filled(2, 2, None), &on_axis);
        assert_eq!(nothing, OnAxisAndAll::default());
    }

    #[test]
    fn a_correction_without_a_positive_gain_leaves_a_response_out() {
        let table = PairTable::from_fn(1, 2, |_| Some(mismatch(2.0, 0.0)));
        let on_axis = PairTable::from_fn(1, 2, |pair| pair.input == 0);
        let correction = |pair: Pair| (pair.input == 1).then_some(GainDelay::NONE);
        let source = SummarySource {
            mismatch: &table,
            correction: &correction,
            on_axis: &on_axis,
            omega: &omega(),
            average: CostAverage::Mean,
            validation: None,
            outputs: &outputs(),
        };
        let summary = Summary::compute(&source);
        // 20 W_g 2^2 = 80, by M4.
        assert_eq!((summary.cost.on_axis, summary.muad.on_axis), (None, None));
        assert!((summary.cost.all.unwrap() - 80.0).abs() < 1e-12);
    }
}
