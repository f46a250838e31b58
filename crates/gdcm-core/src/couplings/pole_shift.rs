//! How mixing and feedback move the poles of a physics model (M16.4).

use nalgebra::Complex;

use super::{CoupledModelError, CouplingMatrices};
use crate::correction::Pade;
use crate::dataset::StateSpace;
use crate::fidelity::{ModeTrack, mode_tracks};
use crate::response::{Mode, ModesError, modes};

/// One pole of the coupled model and the one of the physics model in whose place it is; of a conjugate pair one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoleShift {
    /// Before \[rad/s\]; none where the coupled model has states more (the delays inside its loop).
    pub before: Option<Complex<f64>>,
    /// After \[rad/s\].
    pub after: Complex<f64>,
}

/// Why the poles of a coupled model are not known.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PoleShiftError {
    /// There is no coupled model.
    #[error(transparent)]
    Model(#[from] CoupledModelError),
    /// No eigenvalues can be computed.
    #[error(transparent)]
    Modes(#[from] ModesError),
}

impl PoleShift {
    /// How far the pole moved \[rad/s\].
    pub fn distance_rad_s(&self) -> Option<f64> {
        self.before.map(|before| (self.after - before).norm())
    }

    /// Whether it has a positive real part that it did not have before.
    pub fn is_newly_unstable(&self) -> bool {
        self.after.re > 0.0 && self.before.is_none_or(|before| before.re <= 0.0)
    }
}

impl CouplingMatrices {
    /// Every pole of a physics model with mixing and feedback, rising in `|lambda|`, matched to those without so that the sum of the
    /// distances is least; of discrete time as `s = ln z / T`.
    ///
    /// # Errors
    /// [`PoleShiftError`] where there is no coupled model, or no eigenvalues.
    pub fn pole_shifts(
        &self,
        physics: &StateSpace,
        airspeed_kt: f64,
        pade: Pade,
    ) -> Result<Vec<PoleShift>, PoleShiftError> {
        let (before, after) = (modes(physics)?, modes(&self.model(physics, airspeed_kt, pade)?)?);
        Ok(shifts(&before, &after))
    }
}

fn shifts(before: &[Mode], after: &[Mode]) -> Vec<PoleShift> {
    let tracks = mode_tracks(&[before, after], 1);
    let shift = |track: ModeTrack| PoleShift {
        before: track.modes[0].map(|mode| before[mode].pole),
        after: after[track.reference].pole,
    };
    tracks.into_iter().map(shift).collect()
}
