//! Names for helicopter modes (M17.3).
//!
//! ```text
//! if states are named: sum the participations by kind of state
//!    cyclic flap >= 0.4, an oscillation below 25 rad/s: regressing flap
//!    u, w, q, theta more than v, p, r, phi, psi, and at least 0.3:
//!       u, theta more than w, q: phugoid; any other oscillation: short period
//!       real, q more than w: pitch subsidence; any other real mode: heave
//!    otherwise v, p, r, phi, psi, if at least 0.3:
//!       oscillation: Dutch roll
//!       real, p at least half of these: roll subsidence; otherwise, below 1 rad/s: spiral
//! else by frequency and damping, a guess
//!    oscillation: below 0.6 rad/s phugoid; below 5 rad/s Dutch roll if the damping is below 0.4,
//!       else short period; below 25 rad/s regressing flap if the damping is above 0.2
//!    real: below 0.5 rad/s spiral; 1 to 10 rad/s roll subsidence
//! ```
//!
//! A state's *participation* is its share in a mode. A mode that meets no rule has no name.
//!
//! u, v, w are velocities along the body axes, p, q, r the angular rates about them, and phi,
//! theta, psi the bank, pitch and heading angles.
//!
//! G. D. Padfield, "Helicopter Flight Dynamics", 2nd ed. 2007, 4.3.

use std::fmt;

use serde::{Deserialize, Serialize};

use gdcm_model::response::Mode;

/// Cyclic flap participation at or above which a mode belongs to the rotor.
const FLAP_SHARE: f64 = 0.4;
/// Fuselage participation below which a mode belongs to actuators, sensors or inflow.
const FUSELAGE_SHARE: f64 = 0.3;
/// Frequency \[rad/s\] below which a flapping mode is regressing.
const FASTEST_REGRESSING_RAD_S: f64 = 25.0;
/// Frequency \[rad/s\] below which a real lateral mode without dominant roll rate is the spiral.
const FASTEST_SPIRAL_RAD_S: f64 = 1.0;
/// Roll rate's share in the lateral participation at or above which a real lateral mode is the roll
/// subsidence.
const ROLL_RATE_SHARE: f64 = 0.5;

/// A helicopter mode (Padfield 2007, 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ModeName {
    /// Long-term response: slow oscillation in speed and pitch attitude.
    Phugoid,
    /// Fast oscillation in pitch rate and incidence.
    ShortPeriod,
    /// Real pitch rate mode.
    PitchSubsidence,
    /// Real vertical speed mode.
    Heave,
    /// Lateral-directional oscillation.
    DutchRoll,
    /// Real roll rate mode.
    RollSubsidence,
    /// Slow real mode in bank and heading.
    Spiral,
    /// Main rotor, cyclic flap.
    RegressingFlap,
}

impl fmt::Display for ModeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Phugoid => "phugoid",
            Self::ShortPeriod => "short period",
            Self::PitchSubsidence => "pitch subsidence",
            Self::Heave => "heave",
            Self::DutchRoll => "Dutch roll",
            Self::RollSubsidence => "roll subsidence",
            Self::Spiral => "spiral",
            Self::RegressingFlap => "regressing flap",
        })
    }
}

/// What a mode's name is based on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum NamedBy {
    /// State participation.
    States,
    /// Frequency and damping only.
    Frequency,
}

impl ModeName {
    /// Names a mode: by state participation if `states` is not empty, otherwise by frequency and
    /// damping. `None` if this is inconclusive, or if the pole cannot be separated from another,
    /// for example with identical actuators.
    pub fn determine(mode: &Mode, states: &[String]) -> (Option<Self>, NamedBy) {
        if states.is_empty() {
            return (Self::by_frequency(mode), NamedBy::Frequency);
        }
        let shares = mode.participation.as_deref().unwrap_or_default();
        (Self::by_states(mode, shares, states), NamedBy::States)
    }

    /// Names a mode by the kinds of the participating states; `shares` holds their indices and
    /// participations.
    fn by_states(mode: &Mode, shares: &[(usize, f64)], states: &[String]) -> Option<Self> {
        use StateKind::{CyclicFlap, P, Phi, Psi, Q, R, Theta, U, V, W};

        let shares = KindShares { shares, states };
        let cyclic_flap = shares.sum(&[CyclicFlap]);
        let is_slow_enough = mode.frequency_rad_s < FASTEST_REGRESSING_RAD_S;
        if cyclic_flap >= FLAP_SHARE && mode.oscillates() && is_slow_enough {
            return Some(Self::RegressingFlap);
        }
        let longitudinal = shares.sum(&[U, W, Q, Theta]);
        let lateral = shares.sum(&[V, P, R, Phi, Psi]);
        if longitudinal.max(lateral) < FUSELAGE_SHARE {
            return None;
        }
        match (longitudinal > lateral, mode.oscillates()) {
            // `_`: also for two real poles, into which the oscillation can split.
            (true, _) if shares.sum(&[U, Theta]) > shares.sum(&[W, Q]) => Some(Self::Phugoid),
            (true, true) => Some(Self::ShortPeriod),
            (true, false) if shares.sum(&[Q]) > shares.sum(&[W]) => Some(Self::PitchSubsidence),
            (true, false) => Some(Self::Heave),
            (false, true) => Some(Self::DutchRoll),
            (false, false) if shares.sum(&[P]) >= ROLL_RATE_SHARE * lateral => {
                Some(Self::RollSubsidence)
            }
            (false, false) if mode.frequency_rad_s < FASTEST_SPIRAL_RAD_S => Some(Self::Spiral),
            (false, false) => None,
        }
    }

    /// Guesses a name from frequencies \[rad/s\] and dampings that are typical for helicopters.
    fn by_frequency(mode: &Mode) -> Option<Self> {
        let damping = mode.damping_ratio?;
        match (mode.oscillates(), mode.frequency_rad_s) {
            (true, ..0.6) => Some(Self::Phugoid),
            (true, 0.6..5.0) if damping < 0.4 => Some(Self::DutchRoll),
            (true, 0.6..5.0) => Some(Self::ShortPeriod),
            (true, 5.0..FASTEST_REGRESSING_RAD_S) if damping > 0.2 => Some(Self::RegressingFlap),
            (false, ..0.5) => Some(Self::Spiral),
            (false, 1.0..10.0) => Some(Self::RollSubsidence),
            _ => None,
        }
    }
}

/// How much named states participate in a mode.
struct KindShares<'a> {
    /// Each participating state's index and participation.
    shares: &'a [(usize, f64)],
    states: &'a [String],
}

impl KindShares<'_> {
    /// Sums the participation over these kinds.
    fn sum(&self, kinds: &[StateKind]) -> f64 {
        self.shares
            .iter()
            .filter(|(state, _)| {
                let name = self.states.get(*state);
                let kind = name.and_then(|name| StateKind::from_name(name));
                kind.is_some_and(|kind| kinds.contains(&kind))
            })
            .map(|(_, share)| share)
            .sum()
    }
}

/// Physical quantity that a state represents; only the quantities that distinguish modes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum StateKind {
    /// Velocity along the longitudinal body axis.
    U,
    /// Velocity along the lateral body axis, or sideslip.
    V,
    /// Velocity along the vertical body axis, or incidence.
    W,
    /// Roll rate.
    P,
    /// Pitch rate.
    Q,
    /// Yaw rate.
    R,
    /// Bank angle.
    Phi,
    /// Pitch angle.
    Theta,
    /// Heading.
    Psi,
    CyclicFlap,
}

impl StateKind {
    /// Recognises a state by its name ("q \[rad/s\]", "theta", "b1c_dot", "a (lon flap)"); `None`
    /// for any other state.
    fn from_name(name: &str) -> Option<Self> {
        let lower = name.to_lowercase();
        if lower.contains("flap") {
            return Some(Self::CyclicFlap);
        }
        let end = lower.find([' ', '[', '(']).unwrap_or(lower.len());
        let word: String = lower[..end]
            .chars()
            .filter(|letter| *letter != '_')
            .collect();
        Some(match word.trim_end_matches("dot") {
            "u" | "ub" | "vx" => Self::U,
            "v" | "vb" | "vy" | "beta" => Self::V,
            "w" | "wb" | "vz" | "alpha" => Self::W,
            "p" | "pb" => Self::P,
            "q" | "qb" => Self::Q,
            "r" | "rb" => Self::R,
            "phi" | "bank" => Self::Phi,
            "theta" => Self::Theta,
            "psi" | "heading" => Self::Psi,
            "a1" | "b1" | "a1s" | "b1s" | "a1c" | "b1c" | "beta1c" | "beta1s" | "betac"
            | "betas" => Self::CyclicFlap,
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};

    use gdcm_model::dataset::StateSpace;
    use gdcm_model::response::modes;

    use super::*;

    /// Modes of `dx/dt = a x`, without inputs and outputs.
    fn uncontrolled_modes(a: DMatrix<f64>) -> Vec<Mode> {
        let n = a.nrows();
        modes(
            &StateSpace::new(
                a,
                DMatrix::zeros(n, 1),
                DMatrix::zeros(1, n),
                DMatrix::zeros(1, 1),
            )
            .unwrap(),
        )
        .unwrap()
    }

    fn named(a: DMatrix<f64>, states: &[&str]) -> Vec<(Option<ModeName>, NamedBy)> {
        let states: Vec<String> = states.iter().map(|name| (*name).to_owned()).collect();
        uncontrolled_modes(a)
            .iter()
            .map(|mode| ModeName::determine(mode, &states))
            .collect()
    }

    #[test]
    fn modes_are_named_by_the_states_that_take_part() {
        use ModeName::*;
        // Decoupled blocks: a slow pair u and theta, a pair w and q, lags p and phi.
        let a = dmatrix![
            0.0, -0.1, 0.0, 0.0, 0.0, 0.0;
            0.1, 0.0, 0.0, 0.0, 0.0, 0.0;
            0.0, 0.0, -1.0, 2.0, 0.0, 0.0;
            0.0, 0.0, -2.0, -1.0, 0.0, 0.0;
            0.0, 0.0, 0.0, 0.0, -4.0, 0.0;
            0.0, 0.0, 0.0, 0.0, 0.0, -0.02];
        let found = named(a, &["u [m/s]", "theta", "w", "q (rad/s)", "p", "phi"]);
        let names = [
            Spiral,
            Phugoid,
            Phugoid,
            ShortPeriod,
            ShortPeriod,
            RollSubsidence,
        ];
        assert_eq!(found, names.map(|name| (Some(name), NamedBy::States)));
    }

    #[test]
    fn states_of_actuators_leave_a_mode_without_a_name() {
        let pair = dmatrix![-16.0, 14.0; -14.0, -16.0];
        assert_eq!(
            named(pair.clone(), &["act_lon", "act_lon_dot"])[0],
            (None, NamedBy::States)
        );
        // Two identical actuators cannot be separated; frequency is not used if states are named.
        let twice = dmatrix![-6.0, 5.0, 1.0, 0.0; -5.0, -6.0, 0.0, 1.0; 0.0, 0.0, -6.0, 5.0; 0.0, 0.0, -5.0, -6.0];
        assert_eq!(
            named(twice, &["act_lon", "act_lon_dot", "act_lat", "act_lat_dot"])[0],
            (None, NamedBy::States)
        );
        assert_eq!(
            named(pair.clone() * 0.4, &["b1s", "p"])[0].0,
            Some(ModeName::RegressingFlap)
        );
        assert_eq!(
            named(pair.clone() * 0.1, &["v", "r"])[0].0,
            Some(ModeName::DutchRoll)
        );
        assert_eq!(
            named(pair.clone() * 0.4, &["a (lon flap)", "beta_1s_dot"])[0].0,
            Some(ModeName::RegressingFlap)
        );
    }

    fn lag(rate: f64) -> DMatrix<f64> {
        dmatrix![-rate]
    }

    fn pair(re: f64, im: f64) -> DMatrix<f64> {
        dmatrix![re, im; -im, re]
    }

    #[test]
    fn without_names_of_states_frequency_and_damping_guess() {
        use ModeName::*;
        for (a, name) in [
            (lag(0.05), Some(Spiral)),
            (lag(3.0), Some(RollSubsidence)),
            (lag(40.0), None),
            (pair(0.02, 0.3), Some(Phugoid)),
            (pair(-0.4, 2.0), Some(DutchRoll)),
            (pair(-1.5, 1.5), Some(ShortPeriod)),
            (pair(-6.0, 5.0), Some(RegressingFlap)),
            (lag(0.0), None),
        ] {
            assert_eq!(named(a.clone(), &[])[0], (name, NamedBy::Frequency), "{a}");
        }
    }
}
