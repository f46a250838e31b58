//! A model's modes: poles, natural frequency, damping, and state participation.
//!
//! ```text
//! 1  balance A, or A - I in discrete time; A = Q T Q^H, T triangular with the eigenvalues on its
//!    diagonal (schur_form.rs)
//! 2  for each eigenvalue lambda: the pole is lambda; in discrete time ln(1 + lambda) / sample time
//!    (s_plane.rs)
//! 3  participation of the states, and residues of the outputs, from its eigenvectors (eigenvectors.rs)
//! 4  the conjugate of a pole above the real axis: conjugate residues, the same participation
//! ```

use nalgebra::Complex;

use super::balancing::balance;
use super::eigenvectors::Eigenvectors;
pub use super::eigenvectors::NearDefective;
use super::large_entry::LargeEntry;
use super::s_plane::SPlane;
use super::schur_form::SchurForm;
use crate::dataset::{Dynamics, StateSpace};

/// Rounding error in an eigenvalue, relative to the state count times the norm of A.
const ROUNDING_PER_STATE: f64 = 4.0 * f64::EPSILON;

/// A natural mode: a pole of the model, and the motion that belongs to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Pole `lambda` \[rad/s\].
    pub pole: Complex<f64>,
    /// Undamped natural frequency `|lambda|` \[rad/s\].
    pub frequency_rad_s: f64,
    /// `-Re lambda / |lambda|`, negative for a growing mode; `None` for a pole at zero.
    pub damping_ratio: Option<f64>,
    /// `-1 / Re lambda` \[s\], negative for a growing mode; `None` for a mode that neither grows
    /// nor decays.
    pub time_constant_s: Option<f64>,
    /// State participation (state index, share) in descending order, with the sum 1; or the reason
    /// why it is unavailable.
    pub participation: Result<Vec<(usize, f64)>, NearDefective>,
    /// Each output's residue for all inputs together: its magnitude is the norm of the output's row
    /// in the residue matrix, its phase is relative to the other outputs. `None` for a
    /// near-defective pole.
    pub residues: Option<Vec<Complex<f64>>>,
}

/// Reason why a model's modes are unavailable.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ModesError {
    #[error("{0}")]
    TooLarge(LargeEntry),
    #[error("the eigenvalues of the matrix A were not found: the iteration does not converge")]
    NotConverged,
}

impl ModesError {
    /// Returns the stable code by which scripts and tests distinguish the errors.
    pub fn code(&self) -> &'static str {
        match self {
            Self::TooLarge(..) => "too-large",
            Self::NotConverged => "not-converged",
        }
    }
}

impl Mode {
    fn new(
        pole: Complex<f64>,
        participation: Result<Vec<(usize, f64)>, NearDefective>,
        residues: Option<Vec<Complex<f64>>>,
    ) -> Self {
        let frequency_rad_s = pole.norm();
        Self {
            pole,
            frequency_rad_s,
            damping_ratio: if frequency_rad_s > 0.0 {
                Some(-pole.re / frequency_rad_s)
            } else {
                None
            },
            time_constant_s: if pole.re != 0.0 {
                Some(-1.0 / pole.re)
            } else {
                None
            },
            participation,
            residues,
        }
    }

    /// Returns whether the mode oscillates: a complex pole. In discrete time this includes a single
    /// real pole `z < 0`, whose response alternates in sign from sample to sample.
    pub fn oscillates(&self) -> bool {
        self.pole.im != 0.0
    }
}

/// Computes a model's modes, one per pole, in ascending `|lambda|`. In a conjugate pair the pole
/// above the real axis comes first, and the other is its exact conjugate. A pole below the matrix's
/// rounding error is set to zero.
///
/// Discrete-time poles are given as `s = ln z / T`; poles at `z = 0`, which vanish within one
/// sample, have no `s` and are omitted (M2a). Channel delays do not move poles.
///
/// # Errors
/// [`ModesError`] if the eigenvalues cannot be computed.
pub fn modes(model: &StateSpace) -> Result<Vec<Mode>, ModesError> {
    if let Some(entry) = LargeEntry::find(model) {
        return Err(ModesError::TooLarge(entry));
    }
    let plane = SPlane::new(model);
    // Step 1.
    let mut a = plane.matrix(model.a());
    let mut b = model.b().clone();
    let mut c = model.c().clone();
    balance(&mut a, &mut b, &mut c);
    let form = SchurForm::new(&a).ok_or(ModesError::NotConverged)?;
    let rounding = ROUNDING_PER_STATE * a.nrows() as f64 * a.norm();
    let mut modes: Vec<Mode> = Vec::with_capacity(a.nrows());
    // The last mode above the real axis, until its conjugate, the next eigenvalue, has been added.
    let mut upper_mode: Option<Mode> = None;
    for (index, eigenvalue) in form.eigenvalues().into_iter().enumerate() {
        if let Some(upper) = upper_mode.take() {
            // Step 4.
            let residues = upper
                .residues
                .map(|residues| residues.iter().map(Complex::conj).collect());
            modes.push(Mode::new(upper.pole.conj(), upper.participation, residues));
            continue;
        }
        let eigenvalue = if eigenvalue.norm() <= rounding {
            Complex::from(0.0)
        } else {
            eigenvalue
        };
        // Step 2.
        let Some(pole) = plane.value(eigenvalue) else {
            continue;
        };
        // Step 3.
        let vectors = Eigenvectors::new(&form, index);
        let residues = vectors
            .as_ref()
            .ok()
            .map(|vectors| vectors.residues(&b, &c));
        let mode = Mode::new(
            pole,
            vectors.map(|vectors| vectors.participation()),
            residues,
        );
        if eigenvalue.im > 0.0 {
            upper_mode = Some(mode.clone());
        }
        modes.push(mode);
    }
    modes.sort_by(|a, b| {
        let by_size = a.frequency_rad_s.total_cmp(&b.frequency_rad_s);
        by_size
            .then(a.pole.re.total_cmp(&b.pole.re))
            .then(b.pole.im.total_cmp(&a.pole.im))
    });
    Ok(modes)
}

/// Computes the [`modes`] of a model given by matrices; empty for a measured response, which has no
/// states.
///
/// # Errors
/// [`ModesError`], as in [`modes`].
pub fn modes_of(dynamics: &Dynamics) -> Result<Vec<Mode>, ModesError> {
    match dynamics {
        Dynamics::StateSpace(model) => modes(model),
        Dynamics::Measured(_) => Ok(Vec::new()),
    }
}

/// Returns the eigenvalues of A, computed without balancing: \[rad/s\] in continuous time, but `z`
/// in discrete time, unlike the poles of [`modes`]. Returns `None` if the Schur iteration does not
/// converge.
#[must_use]
pub fn poles(model: &StateSpace) -> Option<Vec<Complex<f64>>> {
    let schur =
        nalgebra::Schur::try_new(model.a().clone(), f64::EPSILON, 100 * (model.order() + 1))?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, dmatrix};
    use proptest::prelude::*;

    use super::*;
    use crate::dataset::state_space::Timing;

    fn model(a: DMatrix<f64>) -> StateSpace {
        let n = a.nrows();
        StateSpace::new(
            a,
            DMatrix::zeros(n, 1),
            DMatrix::zeros(1, n),
            DMatrix::zeros(1, 1),
        )
        .unwrap()
    }

    #[test]
    fn an_oscillator_and_a_lag_have_the_modes_of_the_textbook() {
        // Block diagonal: x'' + 2 0.3 4 x' + 16 x = 0 and x' = -0.5 x.
        let found = modes(&model(
            dmatrix![0.0, 1.0, 0.0; -16.0, -2.4, 0.0; 0.0, 0.0, -0.5],
        ))
        .unwrap();
        assert_eq!(found.len(), 3);
        assert_eq!(
            (found[0].pole, found[0].time_constant_s),
            (Complex::new(-0.5, 0.0), Some(2.0))
        );
        assert_eq!(found[0].participation.as_ref().unwrap()[0], (2, 1.0));
        assert!((found[1].frequency_rad_s - 4.0).abs() < 1e-14 && found[1].pole.im > 0.0);
        assert!((found[1].damping_ratio.unwrap() - 0.3).abs() < 1e-15);
        assert_eq!(found[2].pole, found[1].pole.conj());
        // |w_i v_i| is the same for position and speed of an oscillator.
        for &(_, share) in &found[1].participation.as_ref().unwrap()[..2] {
            assert!((share - 0.5).abs() < 1e-14);
        }
    }

    #[test]
    fn an_integrator_is_a_pole_at_zero_without_a_time_constant() {
        let found = modes(&model(dmatrix![0.0, 1.0; 0.0, -2.0])).unwrap();
        assert_eq!(
            (found[0].pole, found[0].time_constant_s),
            (Complex::from(0.0), None)
        );
        assert_eq!(
            (found[0].damping_ratio, found[0].frequency_rad_s),
            (None, 0.0)
        );
    }

    #[test]
    fn poles_that_share_an_eigenvector_have_no_participation() {
        let found = modes(&model(
            dmatrix![-1.0, 1.0, 0.0; 0.0, -1.0, 0.0; 0.0, 0.0, -3.0],
        ))
        .unwrap();
        let why = found[0].participation.as_ref().unwrap_err();
        assert!(why.movement > 1e15, "{why}");
        assert_eq!(
            found[2].participation.as_ref().unwrap()[0],
            (2, 1.0),
            "the third is by itself"
        );
        let apart = modes(&model(dmatrix![-1.0, 1.0; 0.0, -1.001])).unwrap();
        assert!(
            apart[0].participation.is_ok(),
            "poles a thousandth apart can be told from one another"
        );
    }

    #[test]
    fn discrete_time_modes_equal_the_sampled_modes() {
        // e^(A T) for the oscillator and the lag above, T = 0.02 s; a state whose sign alternates,
        // and a state that vanishes within a sample.
        let sampled = (dmatrix![0.0, 1.0, 0.0; -16.0, -2.4, 0.0; 0.0, 0.0, -0.5] * 0.02).exp();
        let mut a = DMatrix::zeros(5, 5);
        a.view_mut((0, 0), (3, 3)).copy_from(&sampled);
        a[(3, 3)] = -1.0;
        let timing = Timing {
            sample_time_s: Some(0.02),
            ..Timing::default()
        };
        let found = modes(&model(a).timed(timing).unwrap()).unwrap();
        let imaginary = (16.0_f64 - 1.44).sqrt();
        let alternating = 50.0 * std::f64::consts::PI;
        let expected = [
            (-0.5, 0.0),
            (-1.2, imaginary),
            (-1.2, -imaginary),
            (0.0, alternating),
        ];
        assert_eq!(found.len(), 4, "the pole at z = 0 has no s");
        for (mode, (re, im)) in found.iter().zip(expected) {
            // Tolerance: the matrix exponential has a rounding error of about 1e-16, and
            // `s = ln z / T` amplifies it 50 times.
            assert!(
                (mode.pole - Complex::new(re, im)).norm() < 1e-12,
                "{} {re} {im}",
                mode.pole
            );
        }
    }

    #[test]
    fn models_without_states_have_no_modes_and_large_entries_are_refused() {
        assert_eq!(modes(&model(DMatrix::zeros(0, 0))), Ok(Vec::new()));
        assert!(matches!(
            modes(&model(dmatrix![1e80])),
            Err(ModesError::TooLarge(_))
        ));
    }

    proptest! {
        #[test]
        fn units_of_the_states_change_neither_poles_nor_participation(
            entries in prop::collection::vec(-2.0_f64..2.0, 25), exponents in prop::collection::vec(-12_i32..12, 5),
        ) {
            let a = DMatrix::from_vec(5, 5, entries);
            // Scaling by powers of two causes no rounding.
            let scaled = DMatrix::from_fn(5, 5, |row, column| a[(row, column)] * 2.0_f64.powi(exponents[row] - exponents[column]));
            let plain = modes(&model(a.clone())).unwrap();
            let scaled = modes(&model(scaled)).unwrap();
            for mode in &plain {
                let Ok(shares) = &mode.participation else { continue };
                let near = |other: &&Mode| (other.pole - mode.pole).norm();
                let same = scaled.iter().min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
                // Tolerance: rounding errors of 1e-16 times a displacement of at most 1e6, mostly 1
                // to 100.
                prop_assert!(near(&same) < 1e-8, "{} {}", same.pole, mode.pole);
                let Ok(others) = &same.participation else { continue };
                let share_of = |state: usize| others.iter().find(|(other, _)| *other == state).map_or(0.0, |(_, share)| *share);
                let alone = plain.iter().all(|other| other.pole == mode.pole || (other.pole - mode.pole).norm() > 1e-3);
                prop_assert!(!alone || shares.iter().all(|(state, share)| (share - share_of(*state)).abs() < 1e-6));
            }
        }
    }
}
