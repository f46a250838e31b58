//! Mismatch of a response and its reference, frequency by frequency, with the weight of each
//! frequency (M4a).

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use gdcm_model::dataset::{Dynamics, Pair, PairTable};
use gdcm_model::response::curve_values::{centred_unwrap, coherence_at};
use gdcm_model::response::frequency_response::PolarCurve;
use gdcm_model::response::{GainDelay, wrap};
use gdcm_model::statistics::{median, weighted_median};

use super::cost::{Cost, CostAverage};

/// Difference of a simulated response from its reference, to be reduced by a gain and a delay.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// `|H_sim|_dB - |H_ref|_dB` at each frequency.
    pub magnitude_db: Vec<f64>,
    /// Principal value of `arg(H_sim conj H_ref)` \[rad\] at each frequency.
    pub phase: Vec<f64>,
    /// Weighted frequencies of the errors, if given by the reference's coherence (M4a); otherwise
    /// the errors cover the whole grid with equal weights.
    pub coherence_weights: Option<CoherenceWeights>,
    /// Angle \[rad\], a multiple of 2 pi, that is added to `Delta phi` after phase unwrapping; zero
    /// for the representatives (M13.1).
    pub turn: f64,
}

impl Mismatch {
    /// Computes the difference of `simulated` from `reference`, on the same frequencies.
    pub fn new(simulated: &PolarCurve, reference: &PolarCurve) -> Self {
        let differences = |a: &[f64], b: &[f64], of: fn(f64) -> f64| {
            a.iter().zip(b).map(|(a, b)| of(a - b)).collect()
        };
        Self {
            magnitude_db: differences(
                &simulated.magnitude_db,
                &reference.magnitude_db,
                |difference| difference,
            ),
            phase: differences(&simulated.phase, &reference.phase, wrap),
            coherence_weights: None,
            turn: 0.0,
        }
    }

    /// Restricts the difference to the weighted frequencies: all of them without coherence; `None`
    /// if no frequency has a weight (M4a).
    pub fn coherence_weighted(self, coherence_weights: Option<&CoherenceWeights>) -> Option<Self> {
        let Some(coherence_weights) = coherence_weights else {
            return Some(self);
        };
        let magnitude_db = coherence_weights.pick(&self.magnitude_db);
        let phase = coherence_weights.pick(&self.phase);
        (!coherence_weights.omega.is_empty()).then(|| Self {
            magnitude_db,
            phase,
            coherence_weights: Some(coherence_weights.clone()),
            turn: self.turn,
        })
    }

    /// Returns the frequencies \[rad/s\] of the errors: the whole grid or the weighted ones.
    pub fn omega<'a>(&'a self, grid: &'a [f64]) -> &'a [f64] {
        self.coherence_weights
            .as_ref()
            .map_or(grid, |weights| &weights.omega)
    }

    /// Returns the median over frequency, weighted if the frequencies have weights (M6, M4a).
    pub fn median(&self, values: &mut [f64]) -> f64 {
        match self.weights() {
            None => median(values),
            Some(weights) => weighted_median(values, weights),
        }
    }

    /// Spreads values at the frequencies of the errors over a grid of `points`; NaN at frequencies
    /// without weight.
    pub fn on_grid(&self, values: Vec<f64>, points: usize) -> Vec<f64> {
        match &self.coherence_weights {
            None => values,
            Some(coherence_weights) => coherence_weights.spread(&values, points),
        }
    }

    /// Returns the weight of each frequency, unless all weigh the same (M4a).
    pub fn weights(&self) -> Option<&[f64]> {
        self.coherence_weights
            .as_ref()
            .map(|weights| weights.weights.as_slice())
    }

    /// Computes J after a correction of the simulated response (M4, M10). The correction removes
    /// `omega tau` from the phase, and the principal value is used: a zero passed on the other side
    /// of the axis must not cost a whole turn.
    pub fn cost(&self, omega: &[f64], correction: GainDelay, average: CostAverage) -> Cost {
        let omega = self.omega(omega);
        let phase = correction.phases(&self.phase, omega).map(wrap);
        let magnitude = correction.magnitudes_db(&self.magnitude_db, omega);
        Cost::of(
            magnitude,
            phase,
            self.weights(),
            average,
            &mut Vec::with_capacity(omega.len()),
        )
    }

    /// Returns the remaining difference after multiplying the simulated response by a factor with
    /// these magnitudes \[dB\] and phases \[rad\] at each frequency of the grid (M15.5).
    pub fn multiplied(&self, magnitude_db: &[f64], phase: &[f64]) -> Self {
        let weights = self.coherence_weights.as_ref();
        let on = |own: &[f64], factor: &[f64], of: fn(f64) -> f64| -> Vec<f64> {
            let sums = |factor: &[f64]| {
                own.iter()
                    .zip(factor)
                    .map(|(own, factor)| of(own + factor))
                    .collect()
            };
            weights.map_or_else(|| sums(factor), |weights| sums(&weights.pick(factor)))
        };
        Self {
            magnitude_db: on(&self.magnitude_db, magnitude_db, |sum| sum),
            phase: on(&self.phase, phase, wrap),
            coherence_weights: weights.cloned(),
            turn: self.turn,
        }
    }

    /// Whether the unwrapped `Delta phi` of M3 exceeds half a turn somewhere, so that M6b chooses
    /// the turns.
    pub fn leaves_half_a_turn(&self) -> bool {
        self.unwrapped().iter().any(|phase| phase.abs() > PI)
    }

    /// Returns `Delta phi(sim, ref)` \[rad\] by M3.
    fn unwrapped(&self) -> Vec<f64> {
        let mut phase = self.phase.clone();
        centred_unwrap(&mut phase, &mut Vec::new());
        phase
    }

    /// Returns `Delta phi(sim, ref)` \[rad\], whose slope over `omega` is the delay: by M3 if it
    /// stays within half a turn, otherwise at each frequency the turn nearest to the best-fitting
    /// pure delay (M6b).
    pub fn phase_difference(&self, omega: &[f64]) -> Vec<f64> {
        let mut phase = self.unwrapped();
        let omega = self.omega(omega);
        if phase.iter().any(|phase| phase.abs() > PI) {
            let delay_s = nearest_pure_delay_s(&phase, omega);
            for (phase, omega) in phase.iter_mut().zip(omega) {
                *phase += TAU * ((omega * delay_s - *phase) / TAU).round();
            }
        }
        if self.turn != 0.0 {
            phase.iter_mut().for_each(|phase| *phase += self.turn);
        }
        phase
    }

    /// Returns the median \[rad\] of `Delta phi` over its frequencies.
    pub fn median_phase(&self, omega: &[f64]) -> f64 {
        median(&mut self.phase_difference(omega))
    }

    /// Shifts the phase by whole turns so that its median is nearest to `median_phase` \[rad\]:
    /// aligns a swapped pair with the representatives (M13.1).
    pub fn align_branch(mut self, omega: &[f64], median_phase: f64) -> Self {
        self.turn += TAU * ((median_phase - self.median_phase(omega)) / TAU).round();
        self
    }
}

/// Returns the delay \[s\] among -0.600, -0.599 ... 0.600 with the largest `L = sum cos(phase -
/// omega delay)`, the first of equal ones (M6b).
///
/// ```text
/// 1  L at every 16th delay
/// 2  |dL / d delay| <= sum omega: only about those from which L could rise to the greatest of 1, every delay is looked at
/// ```
fn nearest_pure_delay_s(phase: &[f64], omega: &[f64]) -> f64 {
    const STEPS: i32 = 600;
    const STEP_S: f64 = 1e-3;
    const COARSE: i32 = 16;
    let delay_s = |step: i32| STEP_S * f64::from(step);
    let coarse: Vec<i32> = (-STEPS..=STEPS + COARSE / 2)
        .step_by(COARSE as usize)
        .collect();
    let known = likenesses(
        phase,
        omega,
        [delay_s(-STEPS), delay_s(COARSE)],
        coarse.len(),
    );
    let greatest = known.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // Half a coarse step away; a relative 1e-9 exceeds the rounding error of the sums.
    let rise = delay_s(COARSE / 2) * omega.iter().map(|omega| omega.abs()).sum::<f64>()
        + 1e-9 * phase.len() as f64;
    let mut best = (f64::NEG_INFINITY, 0.0);
    for (step, _) in coarse
        .into_iter()
        .zip(known)
        .filter(|(_, known)| known + rise >= greatest)
    {
        let from = (step - COARSE / 2).max(-STEPS);
        let count = (step + COARSE / 2).min(STEPS + 1) - from;
        let near = likenesses(phase, omega, [delay_s(from), STEP_S], count as usize);
        for (likeness, step) in near.into_iter().zip(from..) {
            if likeness > best.0 {
                best = (likeness, delay_s(step));
            }
        }
    }
    best.1
}

/// Computes `sum cos(phase - omega delay)` for `count` delays from `first_s` \[s\] on, `step_s`
/// apart.
fn likenesses(phase: &[f64], omega: &[f64], [first_s, step_s]: [f64; 2], count: usize) -> Vec<f64> {
    // Rotated from one delay to the next: a sum of cosines takes a dozen times as long.
    let turned = |(phase, omega): (&f64, &f64)| Complex::from_polar(1.0, phase - omega * first_s);
    let mut left: Vec<Complex<f64>> = phase.iter().zip(omega).map(turned).collect();
    let turns: Vec<Complex<f64>> = omega
        .iter()
        .map(|omega| Complex::from_polar(1.0, -omega * step_s))
        .collect();
    let mut found = Vec::with_capacity(count);
    for _ in 0..count {
        found.push(left.iter().map(|left| left.re).sum());
        left.iter_mut()
            .zip(&turns)
            .for_each(|(left, turn)| *left *= turn);
    }
    found
}

/// The frequencies of one response with sufficient coherence, each with its weight.
#[derive(Clone, Debug, PartialEq)]
pub struct CoherenceWeights {
    /// Indices on the grid, ascending.
    places: Vec<usize>,
    /// The weighted frequencies \[rad/s\].
    pub omega: Vec<f64>,
    /// `W` at each of them.
    pub weights: Vec<f64>,
}

/// Returns `W = [1.58 (1 - e^(-gamma^2))]^2` for a coherence `gamma^2` from 0 to 1 (Tischler &
/// Remple, "Aircraft and Rotorcraft System Identification", 2nd ed. 2012, chapter 11): 0.9975 at 1,
/// 0.508 at 0.6.
pub fn coherence_weight(coherence: f64) -> f64 {
    (1.58 * (1.0 - (-coherence).exp())).powi(2)
}

impl CoherenceWeights {
    /// Selects the frequencies of `omega` \[rad/s\] with a coherence of at least `threshold` in the
    /// valid band of the response.
    pub fn of(
        omega: &[f64],
        coherence: &[f64],
        threshold: f64,
        valid_band: Option<[f64; 2]>,
    ) -> Self {
        let mut coherence_weights = Self {
            places: Vec::new(),
            omega: Vec::new(),
            weights: Vec::new(),
        };
        let is_valid =
            |omega: f64| valid_band.is_none_or(|[low, high]| (low..=high).contains(&omega));
        for (place, (&omega, &coherence)) in omega.iter().zip(coherence).enumerate() {
            let weight = coherence_weight(coherence);
            // A zero weight would count in N' and nowhere else.
            if coherence >= threshold && weight > 0.0 && is_valid(omega) {
                coherence_weights.places.push(place);
                coherence_weights.omega.push(omega);
                coherence_weights.weights.push(weight);
            }
        }
        coherence_weights
    }

    /// Returns the weights of every response of a model; `None` without coherence, so that all
    /// frequencies weigh the same.
    pub fn of_model(
        dynamics: &Dynamics,
        omega: &[f64],
        threshold: Option<f64>,
    ) -> Option<PairTable<Self>> {
        let (Dynamics::Measured(response), Some(threshold)) = (dynamics, threshold) else {
            return None;
        };
        let valid_band = |pair: Pair| response.valid_bands().map(|bands| bands[pair]);
        let coherence = coherence_at(response, omega)?;
        Some(
            coherence
                .map(|pair, coherence| Self::of(omega, coherence, threshold, valid_band(pair))),
        )
    }

    /// Spreads values at these frequencies over a grid of `points`, NaN elsewhere.
    pub fn spread(&self, values: &[f64], points: usize) -> Vec<f64> {
        let mut spread = vec![f64::NAN; points];
        self.places
            .iter()
            .zip(values)
            .for_each(|(&place, &value)| spread[place] = value);
        spread
    }

    /// Picks the values at these frequencies from one value per grid point.
    pub(super) fn pick(&self, values: &[f64]) -> Vec<f64> {
        self.places.iter().map(|&place| values[place]).collect()
    }
}

#[cfg(test)]
mod tests {
    use gdcm_model::units::db_to_ratio;

    use super::*;

    fn curve(gain_db: f64, delay_s: f64, omega: &[f64]) -> PolarCurve {
        PolarCurve {
            magnitude_db: vec![gain_db; omega.len()],
            phase: omega.iter().map(|omega| wrap(-omega * delay_s)).collect(),
        }
    }

    #[test]
    fn the_right_gain_and_delay_leave_no_cost() {
        let omega: Vec<f64> = (1..60).map(|k| 0.2 * f64::from(k)).collect();
        let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &curve(2.0, 0.4, &omega));
        assert!(
            mismatch
                .cost(&omega, GainDelay::NONE, CostAverage::Mean)
                .total()
                > 100.0
        );
        // Squares of rounding errors of angles up to 12 * 0.4 rad.
        assert!(
            mismatch
                .cost(
                    &omega,
                    GainDelay::new(db_to_ratio(2.0), 0.4),
                    CostAverage::Mean
                )
                .total()
                < 1e-20
        );
    }

    #[test]
    fn a_response_that_leads_has_a_positive_phase_difference() {
        let omega = [1.0, 2.0];
        let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &curve(0.0, 0.1, &omega));
        let phase = mismatch.phase_difference(&omega);
        assert!(
            phase
                .iter()
                .zip(omega)
                .all(|(phase, omega)| (phase - 0.1 * omega).abs() < 1e-15)
        );
    }

    #[test]
    fn a_zero_passed_on_the_other_side_costs_no_turn_and_leaves_the_delay_of_the_others() {
        // 70 ms of lag, and from 2 rad/s a turn in the other direction within a few frequencies.
        let omega: Vec<f64> = (1..=120).map(|k| 0.1 * f64::from(k)).collect();
        let turn = |omega: f64| TAU / (1.0 + (-40.0 * (omega - 2.0)).exp());
        let phase = omega
            .iter()
            .map(|omega| wrap(-0.07 * omega + turn(*omega)))
            .collect();
        let mismatch = Mismatch {
            magnitude_db: vec![0.0; 120],
            phase,
            coherence_weights: None,
            turn: 0.0,
        };
        let cost = mismatch.cost(&omega, GainDelay::new(1.0, -0.07), CostAverage::Median);
        // Squares of the remainder of the turn at 6 rad/s: e^-160.
        assert!(cost.phase < 1e-20, "{cost:?}");
        let delays = mismatch
            .phase_difference(&omega)
            .into_iter()
            .zip(&omega)
            .map(|(phase, omega)| phase / omega);
        let mut delays: Vec<f64> = delays.collect();
        assert!((gdcm_model::statistics::median(&mut delays) + 0.07).abs() < 1e-12);
    }

    #[test]
    fn frequencies_that_do_not_count_move_neither_the_cost_nor_the_branch() {
        let omega: Vec<f64> = (1..=240).map(|k| 0.1 * f64::from(k)).collect();
        let mut reference = curve(1.0, 0.3, &omega);
        // Only noise from 5 to 8 rad/s.
        for (k, phase) in reference.phase.iter_mut().enumerate().take(80).skip(50) {
            *phase = wrap(2.3 * (k * k) as f64);
            reference.magnitude_db[k] = 40.0;
        }
        let coherence: Vec<f64> = (0..240)
            .map(|k| if (50..80).contains(&k) { 0.1 } else { 0.8 })
            .collect();
        let coherence_weights = CoherenceWeights::of(&omega, &coherence, 0.6, None);
        let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &reference)
            .coherence_weighted(Some(&coherence_weights))
            .unwrap();
        let phase = mismatch.phase_difference(&omega);
        let left = mismatch.omega(&omega);
        assert_eq!((phase.len(), left.len()), (210, 210));
        assert!(
            phase
                .iter()
                .zip(left)
                .all(|(phase, omega)| (phase - 0.3 * omega).abs() < 1e-13)
        );
        let right = GainDelay::new(db_to_ratio(1.0), 0.3);
        assert!(mismatch.cost(&omega, right, CostAverage::Mean).total() < 1e-20);
        let nothing = CoherenceWeights::of(&omega, &[0.0; 240], 0.6, None);
        assert_eq!(mismatch.coherence_weighted(Some(&nothing)), None);
    }

    proptest::proptest! {
        #[test]
        fn no_delay_of_all_is_more_like_the_phase(
            phase in proptest::collection::vec(-20.0..20.0, 1..60),
            most in 0.5..40.0,
            slope in -0.7..0.7,
        ) {
            let omega: Vec<f64> = (1..=phase.len()).map(|k| most * k as f64 / phase.len() as f64).collect();
            for scatter in [1.0, 0.05] {
                let phase: Vec<f64> = phase.iter().zip(&omega).map(|(phase, omega)| scatter * phase + slope * omega).collect();
                let likeness = |delay_s: f64| -> f64 {
                    phase.iter().zip(&omega).map(|(phase, omega)| (phase - omega * delay_s).cos()).sum()
                };
                let greatest = (-600..=600).map(|step| likeness(1e-3 * f64::from(step))).fold(f64::NEG_INFINITY, f64::max);
                let found = nearest_pure_delay_s(&phase, &omega);
                // Sums of at most 60 cosines of angles of some hundreds differ in the last digits.
                proptest::prop_assert!(likeness(found) >= greatest - 1e-10, "{} s", found);
            }
        }
    }

    #[test]
    fn a_long_pure_delay_is_found_whatever_turns_it_takes() {
        let omega: Vec<f64> = (1..=240).map(|k| 0.1 * f64::from(k)).collect();
        for delay_s in [-0.6, -0.4375, 0.31, 0.6] {
            let mismatch = Mismatch::new(&curve(0.0, 0.0, &omega), &curve(0.0, delay_s, &omega));
            let phase = mismatch.phase_difference(&omega);
            // A few rounding errors of angles up to 0.6 * 24 rad.
            assert!(
                phase
                    .iter()
                    .zip(&omega)
                    .all(|(phase, omega)| (phase - delay_s * omega).abs() < 1e-13),
                "{delay_s}"
            );
        }
    }
}

#[cfg(test)]
mod counted_tests {
    use super::*;

    #[test]
    fn what_is_under_the_threshold_or_outside_the_valid_band_is_left_out() {
        let omega = [1.0, 2.0, 3.0, 4.0, 5.0];
        let coherence = [1.0, 0.59, 0.6, 0.9, f64::NAN];
        let coherence_weights = CoherenceWeights::of(&omega, &coherence, 0.6, Some([1.5, 4.0]));
        assert_eq!(coherence_weights.omega, [3.0, 4.0]);
        assert_eq!(
            coherence_weights.weights,
            [coherence_weight(0.6), coherence_weight(0.9)]
        );
        assert_eq!(
            coherence_weights.pick(&[10.0, 20.0, 30.0, 40.0, 50.0]),
            [30.0, 40.0]
        );
        let spread = coherence_weights.spread(&[30.0, 40.0], 5);
        assert!(
            spread[2..4] == [30.0, 40.0]
                && [0, 1, 4]
                    .iter()
                    .all(|place: &usize| spread[*place].is_nan())
        );
        assert!(
            CoherenceWeights::of(&omega, &[0.0; 5], 0.0, None)
                .omega
                .is_empty(),
            "nothing was measured"
        );
    }
}
