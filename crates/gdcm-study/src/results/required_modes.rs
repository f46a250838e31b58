//! The physics representative's modes, without and with the study's couplings, compared with the
//! identified representative's (M17.3). Only models with matrices have modes; measured responses
//! have none.
//!
//! A mode is a pole, or a conjugate pair of poles. Two modes match if their poles are close and
//! their shapes over the outputs alike. In names, *flown* denotes the identified representative.

use std::collections::BTreeMap;

use serde::Serialize;

use gdcm_method::correction::Pade;
use gdcm_method::requirements::mode_comparison::{
    ComparedMode, ModeTolerance, ModeValues, ModelModes, compare_modes,
};
use gdcm_method::requirements::{ModeName, ModeVerdict, NamedBy};
use gdcm_model::dataset::{BundleKind, ConditionId, Dynamics, Model};
use gdcm_model::response::Mode;
use gdcm_model::response::mode::modes_of;
use gdcm_model::response::pole_estimate::PoleEstimate;

use super::missing_finding::NoModes;
use super::requested_condition::RequestedCondition;
use super::requirement_role::RequirementRole;

/// Index of the physics model without couplings among the compared models.
const WITHOUT_COUPLINGS: usize = 0;
/// Index of the physics model with couplings, if there are any, among the compared models.
const WITH_COUPLINGS: usize = 1;

/// Poles of models identified from flight records, with standard deviations, by condition. They are
/// kept from an identification: a dataset stores the models without them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IdentifiedPoles(BTreeMap<ConditionId, Vec<PoleEstimate>>);

impl FromIterator<(ConditionId, Vec<PoleEstimate>)> for IdentifiedPoles {
    fn from_iter<T: IntoIterator<Item = (ConditionId, Vec<PoleEstimate>)>>(found: T) -> Self {
        Self(found.into_iter().collect())
    }
}

impl IdentifiedPoles {
    /// Returns a condition's poles; empty where no model was identified for it.
    fn poles(&self, condition: ConditionId) -> &[PoleEstimate] {
        match self.0.get(&condition) {
            Some(poles) => poles,
            None => &[],
        }
    }
}

/// A natural mode: a pole, or the one with positive imaginary part in a conjugate pair.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModeNumbers {
    pub model: String,
    /// The pole's real part \[rad/s\].
    pub pole_real_rad_s: f64,
    /// The pole's imaginary part \[rad/s\], not negative.
    pub pole_imaginary_rad_s: f64,
    #[serde(flatten)]
    pub values: ModeValues,
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub absent: BTreeMap<&'static str, NoModeValue>,
}

/// Why a mode lacks a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoModeValue {
    NotOscillating,
    /// The mode neither decays nor grows.
    NoDecay,
    PoleAtZero,
}

impl NoModeValue {
    /// Returns the stable code, for programs and tests.
    pub fn code(self) -> &'static str {
        match self {
            Self::NotOscillating => "not-oscillating",
            Self::NoDecay => "no-decay",
            Self::PoleAtZero => "pole-at-zero",
        }
    }
}

impl ModeNumbers {
    fn new(mode: &ComparedMode, model: &str) -> Self {
        let values = mode.values;
        let mut absent = BTreeMap::new();
        if values.period_s.is_none() {
            absent.insert("period_s", NoModeValue::NotOscillating);
        }
        if values.time_to_half_s.is_none() {
            absent.insert("time_to_half_s", NoModeValue::NoDecay);
        }
        if values.damping_ratio.is_none() {
            absent.insert("damping_ratio", NoModeValue::PoleAtZero);
        }
        Self {
            model: model.to_owned(),
            pole_real_rad_s: mode.pole.re,
            pole_imaginary_rad_s: mode.pole.im,
            values,
            absent,
        }
    }

    /// Returns the natural frequency: the pole's modulus \[rad/s\].
    pub fn modulus_rad_s(&self) -> f64 {
        self.pole_real_rad_s.hypot(self.pole_imaginary_rad_s)
    }

    /// Returns the values with their export names.
    pub fn quantities(&self) -> [(&'static str, Option<f64>); 5] {
        [
            ("pole_real_rad_s", Some(self.pole_real_rad_s)),
            ("pole_imaginary_rad_s", Some(self.pole_imaginary_rad_s)),
            ("period_s", self.values.period_s),
            ("time_to_half_s", self.values.time_to_half_s),
            ("damping_ratio", self.values.damping_ratio),
        ]
    }
}

/// An identified mode, and the physics modes that match it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModeFinding {
    pub condition: ConditionId,
    /// The condition's true airspeed \[kt\].
    pub airspeed_kt: f64,
    /// The mode's number in this condition, counted from 1 by increasing frequency.
    pub number: usize,
    /// Mode name; `None` if the states (the frequency and damping if no states are named) do not
    /// determine it, or if another mode keeps the same name.
    pub name: Option<ModeName>,
    /// Basis of the name; a name from frequency and damping alone is a guess.
    pub named_by: NamedBy,
    /// Verdict on the physics mode.
    pub verdict: ModeVerdict,
    pub identified: ModeNumbers,
    /// Standard deviations for the identified values; `None` if the model has no pole uncertainty,
    /// for example because it was read from a file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub identified_deviation: Option<ModeValues>,
    /// The physics representative's matching mode, if any.
    pub physics: Option<ModeNumbers>,
    /// Verdict on the physics mode with the study's couplings; `None` without couplings: gains and
    /// delays move no pole, so that [`Self::verdict`] applies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corrected_verdict: Option<ModeVerdict>,
    /// Matching mode with the couplings, if any; `None` also without couplings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corrected: Option<ModeNumbers>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<ModeTolerance>,
}

/// Compares the physics representative's modes, without and with couplings, with the identified
/// representative's.
///
/// # Errors
/// [`NoModes`] if a model is a measured response, if its modes cannot be computed, or if the
/// couplings cannot be applied.
pub(crate) fn mode_findings(
    requested: &RequestedCondition<'_>,
    identified_poles: &IdentifiedPoles,
) -> Result<Vec<ModeFinding>, NoModes> {
    let [physics, identified] =
        BundleKind::BOTH.map(|kind| requested.result.representative_model(kind));
    let physics_modes = known_modes(physics)?;
    let identified_modes = known_modes(identified)?;
    let coupled_modes = coupled_modes(requested, physics)?;
    let flown = ModelModes {
        modes: &identified_modes,
        states: &identified.states,
    };
    let models: Vec<ModelModes<'_>> = std::iter::once(&physics_modes)
        .chain(&coupled_modes)
        .map(|modes| ModelModes {
            modes,
            states: &physics.states,
        })
        .collect();
    let study = &requested.analysis.study;
    let rows = compare_modes(
        flown,
        &models,
        identified_poles.poles(requested.id()),
        study.settings.band,
        &study.requirements.mode_tolerances,
    );
    let mut findings = Vec::new();
    for row in rows {
        let matching = |model: usize| {
            let mode = row.models.get(model).copied().flatten()?;
            Some(ModeNumbers::new(&mode, &physics.name))
        };
        findings.push(ModeFinding {
            condition: requested.id(),
            airspeed_kt: requested.airspeed_kt(),
            number: findings.len() + 1,
            name: row.name,
            named_by: row.named_by,
            verdict: match row.verdicts.get(WITHOUT_COUPLINGS) {
                Some(verdict) => *verdict,
                None => ModeVerdict::NotPaired,
            },
            identified: ModeNumbers::new(&row.flown, &identified.name),
            identified_deviation: row.deviation,
            physics: matching(WITHOUT_COUPLINGS),
            corrected_verdict: row.verdicts.get(WITH_COUPLINGS).copied(),
            corrected: matching(WITH_COUPLINGS),
            tolerance: row.tolerance,
        });
    }
    Ok(findings)
}

/// Returns a physics model's modes with the study's couplings; `None` without couplings, and for a
/// measured response.
fn coupled_modes(
    requested: &RequestedCondition<'_>,
    physics: &Model,
) -> Result<Option<Vec<Mode>>, NoModes> {
    let Some(matrices) = physics.state_space() else {
        return Ok(None);
    };
    if requested.result.coupled.is_none() {
        return Ok(None);
    }
    let coupled = requested
        .result
        .coupled_model(matrices, Pade::default())
        .map_err(|why| NoModes::NotCoupled {
            model: physics.name.clone(),
            why,
        })?;
    let modes = modes_of(&Dynamics::StateSpace(coupled.into_owned())).map_err(|why| {
        NoModes::NotComputed {
            model: physics.name.clone(),
            is_coupled: true,
            why,
        }
    })?;
    Ok(Some(modes))
}

/// Returns a model's modes, or why they cannot be computed.
fn known_modes(model: &Model) -> Result<Vec<Mode>, NoModes> {
    if model.state_space().is_none() {
        return Err(NoModes::Measured {
            model: model.name.clone(),
        });
    }
    modes_of(&model.dynamics).map_err(|why| NoModes::NotComputed {
        model: model.name.clone(),
        is_coupled: false,
        why,
    })
}

/// A mode in a role's model, with its verdict.
pub struct RoleMode<'a> {
    pub numbers: Option<&'a ModeNumbers>,
    pub verdict: ModeVerdict,
}

impl ModeFinding {
    /// Returns the flown mode's counterpart in a role's model. Gains and delays move no pole:
    /// without couplings, a corrected model has the physics model's modes.
    pub fn of_role(&self, role: RequirementRole) -> RoleMode<'_> {
        match (role, self.corrected_verdict) {
            (RequirementRole::Corrected | RequirementRole::Scheduled, Some(verdict)) => RoleMode {
                numbers: self.corrected.as_ref(),
                verdict,
            },
            _ => RoleMode {
                numbers: self.physics.as_ref(),
                verdict: self.verdict,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use gdcm_method::requirements::ModeVerdict;
    use gdcm_method::requirements::mode_pairing::LARGEST_PAIR_DISTANCE;

    use super::*;
    use crate::execution::Execution;
    use crate::jobs::couplings_tests::EXAMPLE;
    use crate::results::requirements::requirements_of;

    #[test]
    fn modes_of_the_example_are_paired_and_named_once_and_within_the_distance() {
        let found = requirements_of(
            &EXAMPLE.analysis,
            &IdentifiedPoles::default(),
            &Execution::sequential(),
        )
        .unwrap();
        let least = EXAMPLE.analysis.study.settings.band.min();
        let pole =
            |of: &ModeNumbers| nalgebra::Complex::new(of.pole_real_rad_s, of.pole_imaginary_rad_s);
        for condition in EXAMPLE.analysis.conditions.keys() {
            let modes = || found.modes.iter().filter(|of| of.condition == *condition);
            let mut names: Vec<ModeName> = modes().filter_map(|of| of.name).collect();
            let count = names.len();
            names.sort_unstable();
            names.dedup();
            assert_eq!(names.len(), count, "condition {condition}");
            let mut partners: Vec<_> = Vec::new();
            for mode in modes() {
                let Some(physics) = &mode.physics else {
                    assert_eq!(mode.verdict, ModeVerdict::NotPaired);
                    continue;
                };
                let flown = pole(&mode.identified);
                let physics = pole(physics);
                let largest = flown.norm().max(physics.norm()).max(least);
                assert!(
                    (flown - physics).norm() <= LARGEST_PAIR_DISTANCE * largest,
                    "{condition}: {flown} {physics}"
                );
                assert!(
                    !partners.contains(&physics),
                    "condition {condition}: {physics} twice"
                );
                partners.push(physics);
            }
            assert!(
                modes().any(|of| of.name == Some(ModeName::DutchRoll) && of.physics.is_some()),
                "{condition}"
            );
        }
        assert!(
            found.modes.iter().any(|of| of.physics.is_none()),
            "some flown poles are no helicopter's"
        );
    }

    #[test]
    fn a_mode_whose_deviation_is_beyond_the_tolerance_is_not_determined() {
        let of = |known: &IdentifiedPoles| {
            requirements_of(&EXAMPLE.analysis, known, &Execution::sequential()).unwrap()
        };
        let unknown = of(&IdentifiedPoles::default());
        let judged = |mode: &&ModeFinding| {
            matches!(mode.verdict, ModeVerdict::Within | ModeVerdict::Outside)
        };
        let mode = unknown
            .modes
            .iter()
            .find(judged)
            .expect("a Dutch roll within the band");
        assert_eq!(mode.identified_deviation, None);
        let verdict = |sd: f64, moved: f64| {
            let numbers = &mode.identified;
            let pole = nalgebra::Complex::new(
                numbers.pole_real_rad_s * moved,
                numbers.pole_imaginary_rad_s * moved,
            );
            let estimate = PoleEstimate {
                pole,
                sd_re: sd * pole.norm(),
                sd_im: sd * pole.norm(),
                determined: true,
            };
            let found = of(&IdentifiedPoles::from_iter([(
                mode.condition,
                vec![estimate],
            )]));
            let same = found
                .modes
                .iter()
                .find(|of| (of.condition, of.number) == (mode.condition, mode.number))
                .unwrap();
            (same.verdict, same.identified_deviation.is_some())
        };
        assert_eq!(verdict(1e-3, 1.0), (mode.verdict, true));
        assert_eq!(verdict(0.4, 1.0), (ModeVerdict::NotDetermined, true));
        assert_eq!(
            verdict(0.4, 1.1),
            (mode.verdict, false),
            "an estimate of another model says nothing"
        );
    }
}
