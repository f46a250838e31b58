//! Physics models with an analysis's couplings: the only source of coupled models for exports
//! (M16.3 in `docs/couplings.md`).
//!
//! ```text
//! H~ = (I - H K)^-1 H M~       H   response of a physics model, outputs x inputs
//!                              M~  mixing of the inputs at the airspeed of the condition
//!                              K   feedback of outputs to inputs, the same at every airspeed
//! M_O H~ M_I                   M_O, M_I  corrections of the output and the input channels
//! ```

use std::borrow::Cow;
use std::sync::Arc;

use gdcm_method::correction::corrected_model::CorrectedModel;
use gdcm_method::correction::{ChannelCorrection, Pade};
use gdcm_method::couplings::{CoupledModelError, PoleShift};
use gdcm_model::dataset::{BundleKind, Condition, StateSpace};
use gdcm_model::response::FrequencyResponse;

use super::analysis::{Analysis, ConditionAnalysis};
use super::fitted_couplings::FittedCouplings;

impl ConditionAnalysis {
    fn airspeed_kt(&self) -> f64 {
        self.condition.flight_state().airspeed_kt
    }

    /// Returns `H~ = (I - H K)^-1 H M~` for a physics model; `H` itself without couplings.
    #[must_use]
    pub fn coupled_response<'a>(
        &self,
        physics: &'a FrequencyResponse,
    ) -> Cow<'a, FrequencyResponse> {
        match &self.coupled {
            None => Cow::Borrowed(physics),
            Some(coupled) => Cow::Owned(
                coupled
                    .fitted
                    .matrices()
                    .response(physics, self.airspeed_kt()),
            ),
        }
    }

    /// Returns the pole shifts due to the couplings, for the physics representative; empty without
    /// couplings, and where the model has no poles or they cannot be computed.
    #[must_use]
    pub fn pole_shifts(&self) -> Vec<PoleShift> {
        let representative = self.representative_model(BundleKind::Physics).state_space();
        let (Some(coupled), Some(representative)) = (&self.coupled, representative) else {
            return Vec::new();
        };
        coupled
            .fitted
            .matrices()
            .pole_shifts(representative, self.airspeed_kt(), Pade::default())
            .unwrap_or_default()
    }

    /// Returns a physics model's matrices with the couplings; the model itself without couplings.
    /// The model's input and output delays lie inside the feedback loop and become states: `pade`
    /// approximants, or delays by whole samples in discrete time.
    ///
    /// # Errors
    /// [`CoupledModelError`] if the loop through the feed-through is singular or ill-conditioned,
    /// if the channel delays cannot become states, or if a resulting matrix is not finite.
    pub fn coupled_model<'a>(
        &self,
        physics: &'a StateSpace,
        pade: Pade,
    ) -> Result<Cow<'a, StateSpace>, CoupledModelError> {
        let fitted = self.coupled.as_ref().map(|coupled| &coupled.fitted);
        coupled_model(fitted, physics, self.airspeed_kt(), pade)
    }

    /// Returns `M_O H~ M_I`: a physics model with the couplings, and then with the channel gains,
    /// delays and leads in `correction`.
    ///
    /// # Errors
    /// As for [`ConditionAnalysis::coupled_model`], and where the correction's delays or leads
    /// cannot become states.
    pub fn corrected_model(
        &self,
        physics: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<CorrectedModel, CoupledModelError> {
        let coupled = self.coupled_model(physics, pade)?;
        Ok(CorrectedModel::new(&coupled, correction, pade)?)
    }
}

impl Analysis {
    /// Returns `M_O H~ M_I` for a physics model in any condition, even one without a result.
    ///
    /// # Errors
    /// As for [`ConditionAnalysis::corrected_model`].
    pub fn corrected_model(
        &self,
        condition: &Condition,
        physics: &StateSpace,
        correction: &ChannelCorrection,
        pade: Pade,
    ) -> Result<CorrectedModel, CoupledModelError> {
        let airspeed_kt = condition.flight_state().airspeed_kt;
        let coupled = coupled_model(self.fitted_couplings(), physics, airspeed_kt, pade)?;
        Ok(CorrectedModel::new(&coupled, correction, pade)?)
    }
}

/// Returns a physics model with the couplings in its matrices; the model itself without couplings.
fn coupled_model<'a>(
    fitted: Option<&Arc<FittedCouplings>>,
    physics: &'a StateSpace,
    airspeed_kt: f64,
    pade: Pade,
) -> Result<Cow<'a, StateSpace>, CoupledModelError> {
    match fitted {
        None => Ok(Cow::Borrowed(physics)),
        Some(fitted) => fitted
            .matrices()
            .model(physics, airspeed_kt, pade)
            .map(Cow::Owned),
    }
}
