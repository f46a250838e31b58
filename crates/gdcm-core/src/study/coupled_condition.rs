//! A condition's physics models with the couplings of the study: the one place where what leaves takes them (M16.3).

use std::borrow::Cow;
use std::sync::Arc;

use crate::correction::{ChannelCorrection, CorrectedModel, Pade};
use crate::couplings::{CoupledModelError, PoleShift};
use crate::dataset::{BundleKind, Condition, StateSpace};
use crate::response::FrequencyResponse;

use super::{Analysis, Comparison, ConditionAnalysis, FittedCouplings};

/// What the couplings have changed of a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledCondition {
    /// The comparison of the models as they are, which decides on the representatives.
    pub before: Arc<Comparison>,
    /// The couplings.
    pub fitted: Arc<FittedCouplings>,
}

impl ConditionAnalysis {
    fn airspeed_kt(&self) -> f64 {
        self.condition.flight_state().airspeed_kt
    }

    /// `H~ = (I - H K)^-1 H M~` of a response of one of its physics models; the response itself without couplings.
    #[must_use]
    pub fn coupled_response<'a>(&self, physics: &'a FrequencyResponse) -> Cow<'a, FrequencyResponse> {
        match &self.coupled {
            None => Cow::Borrowed(physics),
            Some(coupled) => Cow::Owned(coupled.fitted.matrices().response(physics, self.airspeed_kt())),
        }
    }

    /// Where the couplings move the poles of the physics representative; nothing without couplings, and where it has no poles.
    #[must_use]
    pub fn pole_shifts(&self) -> Vec<PoleShift> {
        let representative = &self.condition.bundle(BundleKind::Physics)[self.comparison.physics.model];
        let shifts = self.coupled.as_ref().zip(representative.state_space()).map(|(coupled, of)| {
            coupled.fitted.matrices().pole_shifts(of, self.airspeed_kt(), Pade::default()).unwrap_or_default()
        });
        shifts.unwrap_or_default()
    }

    /// The matrices of one of its physics models with the couplings in them; the model itself without couplings. Delays of its own
    /// channels, which stand inside the loop, are then states: `pade` approximants, or whole samples.
    ///
    /// # Errors
    /// [`CoupledModelError`] where the loop through the feed-through cannot be computed with.
    pub fn coupled_model<'a>(
        &self,
        physics: &'a StateSpace,
        pade: Pade,
    ) -> Result<Cow<'a, StateSpace>, CoupledModelError> {
        match &self.coupled {
            None => Ok(Cow::Borrowed(physics)),
            Some(coupled) => coupled.fitted.matrices().model(physics, self.airspeed_kt(), pade).map(Cow::Owned),
        }
    }

    /// `M_O H~ M_I`: a physics model with the couplings, then with a correction of its channels.
    ///
    /// # Errors
    /// As [`ConditionAnalysis::coupled_model`], and where the correction's delays or leads cannot become states.
    pub fn corrected_model(
        &self,
        physics: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<CorrectedModel, CoupledModelError> {
        let coupled = self.coupled_model(physics, pade)?;
        Ok(CorrectedModel::of(&coupled, correction, pade)?)
    }
}

impl Analysis {
    /// `M_O H~ M_I` of a physics model of any condition: also of one that has no result of its own.
    ///
    /// # Errors
    /// As [`ConditionAnalysis::corrected_model`].
    pub fn corrected_model(
        &self,
        condition: &Condition,
        physics: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<CorrectedModel, CoupledModelError> {
        let airspeed_kt = condition.flight_state().airspeed_kt;
        match self.fitted_couplings() {
            None => Ok(CorrectedModel::of(physics, correction, pade)?),
            Some(fitted) => {
                Ok(CorrectedModel::of(&fitted.matrices().model(physics, airspeed_kt, pade)?, correction, pade)?)
            }
        }
    }
}
