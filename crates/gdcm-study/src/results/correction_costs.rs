//! J without and with a correction to the physics models: couplings (M16.4) or physics parameters
//! (M18.5).

use serde::Serialize;

/// Mean J on-axis and off-axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AxisCost {
    /// Mean over the on-axis responses; `None` where none can be compared.
    pub on_axis: Option<f64>,
    /// Mean over the off-axis responses; `None` where none can be compared.
    pub others: Option<f64>,
}

/// Mean J without and with a correction to the physics models.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CorrectionCost {
    pub without: AxisCost,
    pub with: AxisCost,
}

/// Mean J over the conditions and over the responses that can be compared both without and with the
/// correction (M16.4, M18.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CorrectionCosts {
    /// The uncorrected physics representatives' J.
    pub uncorrected: AxisCost,
    /// J under each condition's own correction.
    pub own: CorrectionCost,
    /// J under the schedule at each condition's airspeed.
    pub scheduled: CorrectionCost,
    /// J in each condition, with correction, channel delays and schedule fitted to the others;
    /// `None` where no condition can be left out.
    pub left_out: Option<CorrectionCost>,
}

impl CorrectionCost {
    /// Maximum ratio of off-axis J with the correction to off-axis J without, at which the
    /// correction is worthwhile.
    const WORTH: f64 = 0.9;

    /// Returns whether the correction reduces the off-axis J by at least a tenth.
    pub fn is_worth_it(&self) -> bool {
        match (self.with.others, self.without.others) {
            (Some(with), Some(without)) => with <= Self::WORTH * without,
            _ => false,
        }
    }
}
