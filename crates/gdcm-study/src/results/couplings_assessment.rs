//! Benefit and cost of couplings: error bars on their entries, J without and with them and for
//! conditions left out, pole shifts, the loop's stability margin, effect above the band (M16.4).
//!
//! `M~` is the normalised mixing between the inputs, `K` the feedback from outputs to inputs, `H`
//! and `H~` the physics model's response without and with them (M16). J is the cost of a response's
//! mismatch to the identified model (M4).

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Complex, DMatrix};

use gdcm_method::couplings::problem::CouplingError;
use gdcm_method::couplings::{CouplingBars, LeftOutFit, LoopMargin, PoleShift, PoleShiftError};
use gdcm_model::dataset::{Band, ConditionId, Pair, PairTable};

use super::correction_costs::{CorrectionCost, CorrectionCosts};
use super::fitted_couplings::FittedCouplings;
use crate::decisions::settings::CouplingCorrection;

/// Assessment, or the error that stopped the coupling fit.
pub type AssessedCouplings = Result<Arc<CouplingsAssessment>, CouplingError>;

/// An entry in `M~` or `K`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CouplingEntry {
    pub value: f64,
    /// Error bar half-width; `None` with fewer than three left-out fits.
    pub half_width: Option<f64>,
    /// Jackknife standard deviation.
    pub deviation: Option<f64>,
    /// Whether the entry may be 0 (no coupling): its value is 0, or its error bar includes 0;
    /// `false` on the diagonal of `M~`, which is 1 by definition.
    pub may_be_zero: bool,
}

/// The couplings' effect on a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionCouplings {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The physics representative's poles before and after, or why they are unavailable.
    pub poles: Result<Vec<PoleShift>, NoPoles>,
    /// Minimum singular value of `I - K H` at each frequency in [`CouplingsAssessment::omega`].
    pub singular_values: Vec<f64>,
    /// Minimum of `singular_values` from the band's lower end to ten times its upper end.
    pub margin: Option<LoopMargin>,
    /// `20 log10 |H~ - H| / |H|` at ten times the band's upper end, response by response.
    pub above_band_db: PairTable<Option<f64>>,
    /// J without and with the couplings when the condition is left out of the fit; `None` if it is
    /// not used in the fit or could not be left out.
    pub left_out: Option<CorrectionCost>,
    /// The other kept state-space physics models for which poles with couplings are unavailable,
    /// for example because the feedback loop cannot be closed.
    pub refused: Vec<RefusedModel>,
}

/// Why a physics model's poles without and with couplings are unavailable.
#[derive(Clone, Debug, PartialEq)]
pub enum NoPoles {
    /// The model is a measured response.
    Measured,
    /// The coupled model or its eigenvalues are unavailable.
    Failed(PoleShiftError),
}

impl NoPoles {
    /// Returns the stable code, for programs and tests.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Measured => "model-measured",
            Self::Failed(_) => "poles-failed",
        }
    }
}

/// A state-space physics model whose poles with couplings are unavailable.
#[derive(Clone, Debug, PartialEq)]
pub struct RefusedModel {
    pub model: String,
    pub why: PoleShiftError,
}

/// A pole with a positive real part in a kept physics model, absent without the couplings.
#[derive(Clone, Debug, PartialEq)]
pub struct UnstablePole {
    pub condition: ConditionId,
    pub model: String,
    /// Whether the model represents its bundle.
    pub is_representative: bool,
    /// The pole \[rad/s\].
    pub pole: Complex<f64>,
    /// Whether the pole's frequency lies in the comparison band.
    pub is_in_band: bool,
}

/// Benefit and cost of couplings (M16.4).
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingsAssessment {
    pub couplings: CouplingCorrection,
    pub fitted: Arc<FittedCouplings>,
    /// Confidence level for the error bars.
    pub level: f64,
    pub band: Band,
    /// The fits without each condition in turn, where they succeeded; empty with fewer than three
    /// conditions.
    pub left_out_fits: Vec<LeftOutFit>,
    /// J without and with the couplings.
    pub costs: CorrectionCosts,
    /// Frequencies for the singular values \[rad/s\]: from a tenth of the band's lower end to ten
    /// times its upper end.
    pub omega: Arc<[f64]>,
    /// Effect of the couplings on each analysed condition.
    pub conditions: BTreeMap<ConditionId, ConditionCouplings>,
    /// Newly unstable poles in all kept physics models.
    pub unstable: Vec<UnstablePole>,
    /// Number of conditions in which leads are offered but not used
    /// ([`ConditionAnalysis::offer`](super::analysis::ConditionAnalysis::offer)): feedback may then
    /// make up for the missing lead.
    pub unused_lead_offers: usize,
}

impl CouplingsAssessment {
    /// Returns the conditions' mean airspeed \[kt\], at which the mixing is reported where a single
    /// airspeed is needed.
    pub fn mean_airspeed_kt(&self) -> f64 {
        self.fitted.matrices().airspeeds().mean_kt
    }

    fn bars(&self, airspeed_kt: f64) -> Option<CouplingBars> {
        CouplingBars::from_fits(&self.left_out_fits, airspeed_kt, self.level).ok()
    }

    /// Returns `M~`, inputs x inputs, at an airspeed, with its error bars.
    pub fn mixing(&self, airspeed_kt: f64) -> DMatrix<CouplingEntry> {
        let values = self.fitted.matrices().normalised_mixing(airspeed_kt);
        let bars = self.bars(airspeed_kt);
        let bars = bars.as_ref().map(|bars| MatrixBars {
            half_widths: &bars.mixing,
            quantile: bars.quantile,
        });
        // The diagonal is 1 by the normalisation, not fitted.
        entries(&values, bars, |to, from| to == from)
    }

    /// Returns `K`, inputs x outputs, with its error bars.
    pub fn feedback(&self) -> DMatrix<CouplingEntry> {
        // Only the bars of the mixing depend on the airspeed.
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

    /// Returns J without and with couplings, by which their benefit is judged: for conditions left
    /// out, or under the schedule where none was left out.
    pub fn deciding_cost(&self) -> CorrectionCost {
        self.costs.left_out.unwrap_or(self.costs.scheduled)
    }
}

/// Error bars on a matrix's entries.
struct MatrixBars<'a> {
    half_widths: &'a DMatrix<f64>,
    /// Student's quantile: ratio of half-width to standard deviation.
    quantile: f64,
}

/// Builds entries from values and their error bars; `is_fixed` marks values that are not fitted.
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
            may_be_zero: value == 0.0 && !is_fixed(row, column),
        };
        if let Some(bars) = &bars {
            let half_width = bars.half_widths[(row, column)];
            entry.half_width = Some(half_width);
            entry.deviation = Some(half_width / bars.quantile);
            entry.may_be_zero |= value.abs() <= half_width && !is_fixed(row, column);
        }
        entry
    })
}

impl ConditionCouplings {
    /// Returns the marked response with the largest change due to couplings above the band, and
    /// that change \[dB\].
    pub fn most_changed_above_band(&self, marked: &PairTable<bool>) -> Option<(Pair, f64)> {
        let known = marked
            .marked()
            .filter_map(|pair| Some((pair, self.above_band_db[pair]?)));
        known.max_by(|a, b| a.1.total_cmp(&b.1))
    }
}
