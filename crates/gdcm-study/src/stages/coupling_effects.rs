//! Effects of the couplings on a condition: its poles, the feedback loop, and the response above
//! the band (M16.4). H is the physics representative's response, K the feedback from outputs to
//! inputs; near a singular `I - K H` the closed loop rings. H~ is the response with the couplings.
//!
//! ```text
//! 1  smallest singular value of I - K H, from a tenth of the band's lower end to ten times its
//!    upper end; margin of the loop: its minimum from the band's lower end on
//! 2  |H~ - H| / |H| in dB at ten times the band's upper end, response by response
//! 3  poles of every kept physics model, without and with couplings: shifts of the representative,
//!    newly unstable poles of all
//! ```

use gdcm_method::correction::Pade;
use gdcm_method::correction::lead_price::ABOVE_BAND;
use gdcm_method::couplings::response_change::relative_change_db;
use gdcm_method::couplings::{LoopMargin, PoleShift};
use gdcm_model::dataset::{Band, BundleKind, Model};
use gdcm_model::progress::{Cancelled, Progress};
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::response::{FrequencyGrid, PreparedModel};

use crate::decisions::study::Study;
use crate::results::analysis::ConditionAnalysis;
use crate::results::couplings_assessment::{
    ConditionCouplings, NoPoles, RefusedModel, UnstablePole,
};
use crate::results::fitted_couplings::CoupledCondition;

/// Numbers of frequencies for the singular values: below the band, and from its lower end to ten
/// times its upper end (2 % apart for the example's band).
const MARGIN_POINTS: [usize; 2] = [60, 300];

/// Returns the grid from a tenth of the band's lower end to ten times its upper end; the lower end
/// itself is a grid point.
pub(super) fn margin_grid(band: Band) -> FrequencyGrid {
    let [below, above] = MARGIN_POINTS;
    let mut omega = log_spaced(band.min() / ABOVE_BAND, band.min(), below);
    omega.pop();
    omega.extend(log_spaced(band.min(), ABOVE_BAND * band.max(), above));
    FrequencyGrid::at(omega)
}

/// The couplings' effect on a condition, and its newly unstable poles.
pub(super) struct ConditionEffect {
    pub(super) couplings: ConditionCouplings,
    pub(super) unstable: Vec<UnstablePole>,
}

/// Computes the couplings' effect on a condition; `grid` is [`margin_grid`].
///
/// # Errors
/// [`Cancelled`] soon after `progress` requests it.
pub(super) fn condition_effect(
    study: &Study,
    result: &ConditionAnalysis,
    grid: &FrequencyGrid,
    progress: &dyn Progress,
) -> Result<ConditionEffect, Cancelled> {
    let Some(coupled) = &result.coupled else {
        // Does not occur: all results of an analysis with couplings have them.
        return Err(Cancelled);
    };
    let representative = result.representative_model(BundleKind::Physics);
    let response = PreparedModel::new(&representative.dynamics).response(grid);
    // Step 1.
    let singular_values = coupled.fitted.matrices().least_singular_values(&response);
    let from_band = grid
        .omega()
        .partition_point(|omega| *omega < study.settings.band.min());
    let margin = LoopMargin::find(&singular_values[from_band..], &grid.omega()[from_band..]);
    // Step 2. The grid's last frequency is ten times the band's upper end.
    let above_band_db = relative_change_db(
        &response,
        &result.coupled_response(&response),
        grid.len() - 1,
    );
    // Step 3.
    let poles = condition_poles(study, result, coupled, progress)?;
    Ok(ConditionEffect {
        couplings: ConditionCouplings {
            airspeed_kt: result.condition.flight_state().airspeed_kt,
            poles: poles.representative,
            singular_values,
            margin,
            above_band_db,
            left_out: None,
            refused: poles.refused,
        },
        unstable: poles.unstable,
    })
}

/// Poles in a condition's kept physics models, without and with couplings.
struct ConditionPoles {
    /// The representative's poles, or why they are unavailable.
    representative: Result<Vec<PoleShift>, NoPoles>,
    /// Newly unstable poles in every kept model.
    unstable: Vec<UnstablePole>,
    /// The other kept state-space models whose poles with couplings are unavailable.
    refused: Vec<RefusedModel>,
}

/// Computes the kept physics models' poles; the representative's also if it is rejected.
fn condition_poles(
    study: &Study,
    result: &ConditionAnalysis,
    coupled: &CoupledCondition,
    progress: &dyn Progress,
) -> Result<ConditionPoles, Cancelled> {
    let id = result.condition.id();
    let band = study.settings.band;
    let rejected = &study.choice(id).physics.rejected;
    let mut poles = ConditionPoles {
        representative: Ok(Vec::new()),
        unstable: Vec::new(),
        refused: Vec::new(),
    };
    let models = result.condition.bundle(BundleKind::Physics);
    for (index, model) in models.iter().enumerate() {
        if progress.cancelled() {
            return Err(Cancelled);
        }
        let is_representative = index == result.comparison.physics.model;
        if rejected.contains(&model.name) && !is_representative {
            continue;
        }
        let shifts = pole_shifts(result, coupled, model);
        for shift in shifts.iter().flatten() {
            if shift.is_newly_unstable() {
                poles.unstable.push(UnstablePole {
                    condition: id,
                    model: model.name.clone(),
                    is_representative,
                    pole: shift.after,
                    is_in_band: (band.min()..=band.max()).contains(&shift.after.norm()),
                });
            }
        }
        if is_representative {
            poles.representative = shifts;
        } else if let Err(NoPoles::Failed(why)) = shifts {
            poles.refused.push(RefusedModel {
                model: model.name.clone(),
                why,
            });
        }
    }
    Ok(poles)
}

/// Returns a model's poles without and with couplings, or why they cannot be computed.
fn pole_shifts(
    result: &ConditionAnalysis,
    coupled: &CoupledCondition,
    model: &Model,
) -> Result<Vec<PoleShift>, NoPoles> {
    let matrices = model.state_space().ok_or(NoPoles::Measured)?;
    let airspeed_kt = result.condition.flight_state().airspeed_kt;
    coupled
        .fitted
        .matrices()
        .pole_shifts(matrices, airspeed_kt, Pade::default())
        .map_err(NoPoles::Failed)
}
