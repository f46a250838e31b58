//! Benefit of the physics parameters: J, channel delays and couplings without and with them, J for
//! conditions left out, and reruns (M18.5, M18.6).
//!
//! A parameter is a named quantity of the physics model; it *moves* the physics models by its
//! value. A *rerun* is a model linearised again with several parameters moved, which checks the
//! prediction. J is the mismatch cost (M4).

use std::collections::BTreeMap;
use std::sync::Arc;

use gdcm_method::correction::Channels;
use gdcm_method::couplings::PoleShift;
use gdcm_model::dataset::{Band, ConditionId};

use super::applied_physics::AppliedPhysics;
use super::correction_costs::{AxisCost, CorrectionCost, CorrectionCosts};
use super::couplings_assessment::NoPoles;
use super::fitted_couplings::FittedCouplings;
use super::physics_findings::PhysicsFailure;
use super::rerun_check::RerunCheck;
use super::response_shapes::ResponseShapes;
use super::without_and_with::WithoutAndWith;
use crate::decisions::physics_settings::PhysicsCorrection;

/// Assessment, or why the parameters are unavailable.
pub type AssessedPhysics = Result<Arc<PhysicsAssessment>, PhysicsFailure>;

/// Diagnosis and benefit of the physics parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct PhysicsAssessment {
    /// The parameters applied in [`Self::costs`].
    pub correction: PhysicsCorrection,
    /// Values, models and, unless set by hand, the diagnosis.
    pub applied: Arc<AppliedPhysics>,
    /// Confidence level for the intervals.
    pub level: f64,
    pub band: Band,
    /// Frequencies for [`ConditionPhysics::responses`] \[rad/s\].
    pub omega: Arc<[f64]>,
    /// J without and with the parameters, each with the study's other corrections.
    pub costs: CorrectionCosts,
    /// The moved physics representatives' J without any other correction.
    pub moved_uncorrected: AxisCost,
    /// Effect on each analysed condition.
    pub conditions: BTreeMap<ConditionId, ConditionPhysics>,
    /// Couplings fitted without the parameters, if the study requests couplings.
    pub couplings_without: Option<Arc<FittedCouplings>>,
    /// Couplings fitted with the parameters applied.
    pub couplings_with: Option<Arc<FittedCouplings>>,
    /// The dataset's reruns against the predictions for their values.
    pub reruns: Vec<RerunCheck>,
}

/// The parameters' effect on a condition.
#[derive(Clone, Debug, PartialEq)]
pub struct ConditionPhysics {
    /// True airspeed \[kt\].
    pub airspeed_kt: f64,
    /// Signed channel delays without and with the parameters \[s\]; leads are negative.
    pub delays_s: WithoutAndWith<Channels<f64>>,
    /// The physics representative's poles before and after, or why they are unavailable.
    pub poles: Result<Vec<PoleShift>, NoPoles>,
    /// Responses before and after, the most improved first; empty if the condition's physics models
    /// are not moved.
    pub responses: Vec<ResponseShapes>,
    /// The condition's J with parameters and schedule fitted to the others; `None` if the condition
    /// takes no part in the fit or could not be left out.
    pub left_out: Option<CorrectionCost>,
}

impl PhysicsAssessment {
    /// Returns the channels' mean signed delays over the conditions, without and with the parameters
    /// \[s\]; `None` without conditions.
    pub fn mean_delays_s(&self) -> Option<WithoutAndWith<Channels<f64>>> {
        let first = self.conditions.values().next()?;
        let mut mean = first.delays_s.clone();
        for channels in [&mut mean.without, &mut mean.with] {
            for delay_s in channels.inputs.iter_mut().chain(&mut channels.outputs) {
                *delay_s = 0.0;
            }
        }
        let share = 1.0 / self.conditions.len() as f64;
        for condition in self.conditions.values() {
            add(&mut mean.without, &condition.delays_s.without, share);
            add(&mut mean.with, &condition.delays_s.with, share);
        }
        Some(mean)
    }
}

/// Adds `share` times the delays in `other`.
fn add(channels: &mut Channels<f64>, other: &Channels<f64>, share: f64) {
    for (delay_s, other) in channels.inputs.iter_mut().zip(&other.inputs) {
        *delay_s += share * other;
    }
    for (delay_s, other) in channels.outputs.iter_mut().zip(&other.outputs) {
        *delay_s += share * other;
    }
}
