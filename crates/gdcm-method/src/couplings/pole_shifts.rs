//! How mixing of the inputs and feedback from outputs to inputs shift a physics model's poles
//! (M16.4).

use nalgebra::Complex;

use gdcm_model::dataset::StateSpace;
use gdcm_model::response::mode::ModesError;
use gdcm_model::response::modes;

use super::coupled_model::CoupledModelError;
use super::coupling_matrices::CouplingMatrices;
use crate::correction::Pade;
use crate::fidelity::mode_tracks;

impl CouplingMatrices {
    /// Returns a physics model's poles with mixing and feedback, in ascending `|lambda|`. They are
    /// matched to the poles without coupling so that the sum of distances is minimal. Discrete-time
    /// poles are converted by `s = ln z / T`.
    ///
    /// # Errors
    /// [`PoleShiftError`] if the coupled model or its eigenvalues are unavailable.
    pub fn pole_shifts(
        &self,
        physics: &StateSpace,
        airspeed_kt: f64,
        pade: Pade,
    ) -> Result<Vec<PoleShift>, PoleShiftError> {
        PoleShift::between(physics, &self.model(physics, airspeed_kt, pade)?)
    }
}

/// A coupled model's pole and its counterpart in the physics model; conjugate pairs are counted
/// once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleShift {
    /// Pole without coupling \[rad/s\]; `None` for an additional state, from the Padé approximation
    /// of a delay inside the loop.
    pub before: Option<Complex<f64>>,
    /// Pole with coupling \[rad/s\].
    pub after: Complex<f64>,
}

/// Reasons why a coupled model's poles are unavailable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoleShiftError {
    #[error(transparent)]
    Model(#[from] CoupledModelError),
    #[error(transparent)]
    Modes(#[from] ModesError),
}

impl PoleShift {
    /// Returns the poles of `after` in ascending `|lambda|`, matched to the poles of `before` so
    /// that the sum of distances is minimal.
    ///
    /// # Errors
    /// [`PoleShiftError::Modes`] if the eigenvalues are unavailable.
    pub fn between(before: &StateSpace, after: &StateSpace) -> Result<Vec<Self>, PoleShiftError> {
        /// Positions of the two models in the list that is tracked.
        const BEFORE: usize = 0;
        const AFTER: usize = 1;
        let modes_before = modes(before)?;
        let modes_after = modes(after)?;
        // `after` is the reference, so that each of its poles has a track, also one without a
        // counterpart.
        let tracks = mode_tracks(&[&modes_before, &modes_after], AFTER);
        let mut shifts = Vec::with_capacity(tracks.len());
        for track in tracks {
            shifts.push(Self {
                before: track.modes[BEFORE].map(|mode| modes_before[mode].pole),
                after: modes_after[track.reference].pole,
            });
        }
        Ok(shifts)
    }
}

impl PoleShiftError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Model(error) => error.code(),
            Self::Modes(error) => error.code(),
        }
    }
}

impl PoleShift {
    /// Returns the distance between both poles \[rad/s\]; `None` for an additional state.
    pub fn distance_rad_s(&self) -> Option<f64> {
        Some((self.after - self.before?).norm())
    }

    /// Returns whether coupling moved the pole into the right half-plane; true also for an
    /// additional state's unstable pole.
    pub fn is_newly_unstable(&self) -> bool {
        let was_unstable = self.before.is_some_and(|before| before.re > 0.0);
        self.after.re > 0.0 && !was_unstable
    }
}
