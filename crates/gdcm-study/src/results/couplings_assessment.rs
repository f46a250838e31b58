//! What couplings gain and cost: error bars on their entries, J without and with them and with
//! conditions left out, moved poles, the loop's stability margin, the effect above the band
//! (M16.4).

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix};
use serde::Serialize;

use gdcm_method::couplings::problem::CouplingError;
use gdcm_method::couplings::{CouplingBars, LeftOutFit, LoopMargin, PoleShift};
use gdcm_model::dataset::{Band, ConditionId, Pair, PairTable};

use super::fitted_couplings::FittedCouplings;
use crate::decisions::settings::CouplingCorrection;

/// An assessment's result; without couplings, the fit's error.
pub type AssessedCouplings = Result<Arc<CouplingsAssessment>, CouplingError>;

/// An entry in `M~` or `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingEntry {
    pub value: f64,
    /// Its error bar's half-width; `None` with fewer than three conditions.
    pub half_width: Option<f64>,
    /// Jackknife standard deviation.
    pub deviation: Option<f64>,
    /// Whether the value is not distinguishable from the value without coupling.
    pub is_within_bar: bool,
}

/// The couplings' effect on a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionCouplings {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The physics representative's poles before and after, or why they are unknown.
    pub poles: Result<Vec<PoleShift>, String>,
    /// The least singular value of `I - K H` at [`CouplingsAssessment::omega`].
    pub singular_values: Vec<f64>,
    /// Least singular value from the band's lower end to ten times its top.
    pub margin: Option<LoopMargin>,
    /// `20 log10 |H~ - H| / |H|` at ten times the band, response by response.
    pub above_band_db: PairTable<Option<f64>>,
    /// J when the condition is left out, on-axis and off-axis; `None` where it is in no fit.
    pub left_out: Option<CouplingCost>,
    /// Kept physics models with matrices, other than the representative, whose loop cannot be
    /// closed, with the reason.
    pub refused: Vec<(String, String)>,
}

/// A kept physics model's pole with a positive real part that is absent without the couplings.
#[derive(Clone, Debug, PartialEq)]
pub struct UnstablePole {
    pub condition: ConditionId,
    pub model: String,
    /// Whether it represents its bundle.
    pub is_representative: bool,
    /// The pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Whether its frequency lies in the comparison band.
    pub is_in_band: bool,
}

/// What couplings gain and cost (M16.4).
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingsAssessment {
    pub couplings: CouplingCorrection,
    pub fitted: Arc<FittedCouplings>,
    /// The error bars' level.
    pub level: f64,
    pub band: Band,
    /// The fits without each condition in turn; empty with fewer than three conditions.
    pub left_out_fits: Vec<LeftOutFit>,
    /// J without and with the couplings.
    pub costs: CouplingCosts,
    /// Frequencies for the singular values \[rad/s\]: from a tenth to ten times the band.
    pub omega: Arc<[f64]>,
    /// Each analysed condition.
    pub conditions: BTreeMap<ConditionId, ConditionCouplings>,
    /// Every kept physics model's newly unstable poles.
    pub unstable: Vec<UnstablePole>,
    /// In how many conditions all constrained responses want lead that no channel provides: a
    /// feedback then acts as a substitute.
    pub want_leads: usize,
}

impl CouplingsAssessment {
    /// Returns the conditions' mean airspeed \[kt\], at which the mixing is reported where a single
    /// airspeed is needed.
    pub fn mean_airspeed_kt(&self) -> f64 {
        self.fitted.matrices().airspeeds().mean_kt
    }

    fn bars(&self, airspeed_kt: f64) -> Option<CouplingBars> {
        CouplingBars::of(&self.left_out_fits, airspeed_kt, self.level).ok()
    }

    /// Returns `M~`, m x m, at an airspeed, with its error bars.
    pub fn mixing(&self, airspeed_kt: f64) -> DMatrix<CouplingEntry> {
        let values = self.fitted.matrices().normalised_mixing(airspeed_kt);
        let bars = self.bars(airspeed_kt);
        let bars = bars.as_ref().map(|bars| MatrixBars {
            half_widths: &bars.mixing,
            quantile: bars.quantile,
        });
        entries(&values, bars, |to, from| to == from)
    }

    /// Returns `K`, m x p, with its error bars.
    pub fn feedback(&self) -> DMatrix<CouplingEntry> {
        let bars = self.bars(self.mean_airspeed_kt());
        let bars = bars.as_ref().map(|bars| MatrixBars {
            half_widths: &bars.feedback,
            quantile: bars.quantile,
        });
        entries(self.fitted.matrices().feedback(), bars, |_, _| false)
    }

    /// Counts the newly unstable poles whose frequency lies in the comparison band, over all kept
    /// physics models.
    pub fn unstable_in_band(&self) -> usize {
        self.unstable.iter().filter(|pole| pole.is_in_band).count()
    }

    /// Returns the decisive costs: with conditions left out, or by the schedule where none is left
    /// out.
    pub fn deciding_cost(&self) -> CouplingCost {
        self.costs.left_out.unwrap_or(self.costs.scheduled)
    }
}

/// Error bars on a matrix's entries.
struct MatrixBars<'a> {
    half_widths: &'a DMatrix<f64>,
    /// Student's quantile: half-width over standard deviation.
    quantile: f64,
}

/// Builds entries from values and their error bars; `is_fixed` marks the values that are not
/// unknowns.
fn entries(
    values: &DMatrix<f64>,
    bars: Option<MatrixBars<'_>>,
    is_fixed: impl Fn(usize, usize) -> bool,
) -> DMatrix<CouplingEntry> {
    DMatrix::from_fn(values.nrows(), values.ncols(), |row, column| {
        let value = values[(row, column)];
        let mut entry = CouplingEntry {
            value,
            half_width: None,
            deviation: None,
            is_within_bar: value == 0.0 && !is_fixed(row, column),
        };
        if let Some(bars) = &bars {
            let half_width = bars.half_widths[(row, column)];
            entry.half_width = Some(half_width);
            entry.deviation = Some(half_width / bars.quantile);
            entry.is_within_bar |= value.abs() <= half_width && !is_fixed(row, column);
        }
        entry
    })
}

impl ConditionCouplings {
    /// Returns the marked response that couplings change most above the band, and the change
    /// \[dB\].
    pub fn most_changed_above_band(&self, marked: &PairTable<bool>) -> Option<(Pair, f64)> {
        let known = marked
            .marked()
            .filter_map(|pair| Some((pair, self.above_band_db[pair]?)));
        known.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Mean J on-axis and off-axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AxisCost {
    /// Over the on-axis responses; `None` where none can be compared.
    pub on_axis: Option<f64>,
    /// Over the off-axis responses.
    pub others: Option<f64>,
}

/// Mean J without and with couplings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CouplingCost {
    pub without: AxisCost,
    pub with: AxisCost,
}

/// Mean J over the conditions, for each response that can be compared both without and with
/// couplings (M16.4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CouplingCosts {
    /// Of the uncorrected physics representatives.
    pub uncorrected: AxisCost,
    /// Of each condition's own correction.
    pub own: CouplingCost,
    /// Of the schedule at each condition's airspeed.
    pub scheduled: CouplingCost,
    /// Of conditions left out: couplings, channel delays and schedule found without each condition
    /// in turn; `None` with fewer than three.
    pub left_out: Option<CouplingCost>,
}

impl CouplingCost {
    /// Greatest off-axis J, relative to that without couplings, at which couplings are worthwhile.
    const WORTH: f64 = 0.9;

    /// Returns whether couplings reduce the off-axis J by at least a tenth.
    pub fn is_worth_it(&self) -> bool {
        match (self.with.others, self.without.others) {
            (Some(with), Some(without)) => with <= Self::WORTH * without,
            _ => false,
        }
    }
}
