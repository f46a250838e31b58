//! Solution of equations (7) and (11), and of the program of signed delays (M15.4), with the convex
//! quadratic program: the gains or delays, and their proof of optimality.

use gdcm_model::dataset::{Pair, PairTable};
use gdcm_model::statistics::mean;
use gdcm_model::units::{s_to_ms, telling, told_apart};
use gdcm_numerics::{CscMatrix, DefaultSettings, convex_program};

use super::channels::{Channels, pair_name};
use super::components::{Components, Held, Placement, Reached, reach};
use super::conflict::{Conflict, ConflictKind, Remedy, clashes};
use super::problem::{
    Coordinate, GainObjective, Problem, ProblemError, Quantity, floor, objective,
};
use crate::correction::branch_and_bound::objective::{
    Curvature, Differentiable, Expansion, Newton, Objective,
};
use crate::correction::branch_and_bound::search::{
    Effort, Limit, Minima, ProofBudget, SearchStopped, search,
};

/// Whether the solution is known to be the global minimum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outcome {
    /// No feasible channels are better by more than the relative gap, which is at most 1e-9.
    Proven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
    },
    /// The search ended first: better solutions may exist, but none better by more than the
    /// relative gap.
    NotProven {
        /// `(objective - lower bound) / objective`.
        gap: f64,
        /// Limit that ended the search.
        limit: Limit,
    },
}

impl Outcome {
    /// `(objective - lower bound) / objective`.
    pub fn gap(self) -> f64 {
        match self {
            Outcome::Proven { gap } | Outcome::NotProven { gap, .. } => gap,
        }
    }

    /// Describes the outcome.
    pub fn words(self) -> String {
        match self {
            Outcome::Proven { .. } => {
                "Proven: no gains within the bounds that hold the held responses are better."
                    .to_owned()
            }
            Outcome::NotProven { gap, limit } => {
                let ended = match limit {
                    Limit::Work => "at its budget of work",
                    Limit::Memory => "at its budget of memory",
                    Limit::Rounding => "where rounding decides",
                };
                let percent = 100.0 * gap;
                format!(
                    "Not proven: gains that are up to {percent:.2} % better may exist; the search ended {ended}."
                )
            }
        }
    }
}

/// One local minimum of the objective.
#[derive(Clone, Debug, PartialEq)]
pub struct LocalMinimum {
    pub inputs: Vec<f64>,
    pub outputs: Vec<f64>,
    /// Objective at the minimum.
    pub objective: f64,
}

/// Proof of the least objective.
#[derive(Clone, Debug, PartialEq)]
pub struct Proof {
    /// Lower bound of the objective over all channels inside the bounds that meet the targets.
    pub lower_bound: f64,
    /// Whether the bound is a proof. The gap is relative to the objective, or to a billionth of
    /// `sum w G^2` where the objective is smaller: below that, rounding decides.
    pub outcome: Outcome,
    pub nodes: usize,
    /// Distinct local minima within 1 % of the objective, best first; the first is the solution.
    pub local_minima: Vec<LocalMinimum>,
    /// Whether the search has excluded any other local minimum within 1 %.
    pub all_minima: bool,
}

/// A constrained entry made infeasible by the bounds or by the other constrained entries.
#[derive(Clone, Debug, PartialEq)]
pub struct Unmatched {
    /// Constrained quantity: a gain, or a delay or a signed delay in seconds.
    pub quantity: Quantity,
    pub pair: Pair,
    /// Delta gain `G` or delta delay `D`; a negative `D` asks for phase lead.
    pub delta: f64,
    /// Product or sum to which the entry is constrained instead.
    pub target: f64,
    /// Excess over the delta: `20 log10 (target / delta)` dB of gain, negative where the correction
    /// is too weak; or `target - delta` seconds of delay, the additional lead that would be needed.
    pub excess: f64,
    /// The conflict; where the entry is not part of it, its miss is the compromise with the entries
    /// that are.
    pub why: Conflict,
}

impl Unmatched {
    /// Phase error in degrees that a missed delay leaves at `omega` rad/s: the reference less the
    /// corrected model.
    pub fn phase_left_deg(&self, omega: f64) -> f64 {
        (self.delta - self.target).to_degrees() * -omega
    }

    /// Describes the miss; for a delay with the remaining phase at `omega_top`, the top of the band
    /// in rad/s.
    pub fn words(&self, omega_top: f64, inputs: &[String], outputs: &[String]) -> String {
        let pair = pair_name(self.pair, inputs, outputs);
        if let Quantity::Gain(_) = self.quantity {
            let (target, delta) = told_apart(self.target, self.delta, 3);
            let sign = if self.excess > 0.0 { "+" } else { "" };
            return format!(
                "{pair} is held at {target} instead of {delta} ({sign}{} dB).",
                telling(self.excess, 1)
            );
        }
        if self.quantity == Quantity::SignedDelay && self.delta < 0.0 {
            let (target, delta) = told_apart(s_to_ms(-self.target), s_to_ms(-self.delta), 1);
            let left = telling(self.phase_left_deg(omega_top).abs(), 0);
            return format!(
                "{pair} gets {target} of the {delta} ms of lead it wants; {left}° of phase error remain at {omega_top} rad/s."
            );
        }
        let lead_ms = 1e3 * self.excess;
        let left = telling(self.phase_left_deg(omega_top).abs(), 0);
        let why = if self.why.is_lone_lead() && self.why.entries == [self.pair] {
            format!(
                "{pair} needs {} ms of lead: a delay cannot give it",
                telling(lead_ms, 1)
            )
        } else if lead_ms > 0.0 {
            format!(
                "{pair} gets {} ms more delay than it needs",
                telling(lead_ms, 1)
            )
        } else {
            format!("{pair} lacks {} ms of delay", telling(-lead_ms, 1))
        };
        format!("{why}; {left}° of phase error remain at {omega_top} rad/s.")
    }
}

/// The channel gains of equation (7), the channel delays of equation (11) or the signed delays of
/// M15.4 in seconds, with the proof.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    pub quantity: Quantity,
    /// Value of each input channel, m.
    pub inputs: Vec<f64>,
    /// Value of each output channel, p.
    pub outputs: Vec<f64>,
    /// The objective: in squared ratios, in squared dB, or in s².
    pub objective: f64,
    pub proof: Proof,
    /// Product or sum to which each entry is constrained, p x m: its delta where that is feasible
    /// (M8 and M9, stage 1).
    pub targets: PairTable<Option<f64>>,
    /// Whether every constrained entry meets its delta, within 1e-8 of its logarithm, or of the
    /// greatest delay in the problem (or a nanosecond, where that is more); or within the tolerance
    /// of [`Problem::agreement`](super::problem::Problem::agreement) where a loop of entries
    /// requires it.
    pub matched: bool,
    /// The constrained entries that miss their delta.
    pub unmatched: Vec<Unmatched>,
    /// The loops of constrained entries that disagree by no more than the tolerance: each is
    /// constrained to the nearest consistent values.
    pub agreeing: Vec<Conflict>,
    /// Each infeasible set of constrained entries and bounds, without duplicates; loops first, then
    /// by number of entries.
    pub conflicts: Vec<Conflict>,
    /// Single changes that would make every constrained entry feasible, where some are not.
    pub remedy: Option<Remedy>,
}

impl Solution {
    /// Gain, delay or signed delay of each channel.
    pub fn channels(&self) -> Channels<f64> {
        Channels {
            inputs: self.inputs.clone(),
            outputs: self.outputs.clone(),
        }
    }
}

/// Residual in natural logarithms, or as a fraction of the greatest delay in the problem, below
/// which a constrained entry counts as matched (M8).
const MATCHED: f64 = 1e-8;

/// Residual \[s\] below which a constrained delay counts as matched, however small the delays of
/// the problem are: the rounding difference of two equal phases is not a delay. At the highest
/// frequency of a band, 1e5 rad/s, it is 0.006 degrees.
const MATCHED_DELAY_S: f64 = 1e-9;

/// Residual in the coordinate of a problem below which a constrained entry counts as matched.
fn matched_within(coordinate: Coordinate) -> f64 {
    match coordinate {
        Coordinate::Logarithm => MATCHED,
        Coordinate::Time { unit_s } => MATCHED.max(MATCHED_DELAY_S / unit_s),
    }
}

/// Finds the channel gains (equation (7), M8), delays (equation (11), M9) or signed delays (M15.4)
/// with the least objective, with a proof that no others are better.
///
/// Entries that the bounds or their own loops make infeasible are constrained to the nearest
/// feasible products or sums (least squares in logarithms, or in seconds), and reported.
///
/// ```
/// use gdcm_method::correction::solve::solve;
/// use gdcm_method::correction::{Bounds, Outcome, Problem, ProofBudget};
/// use gdcm_model::dataset::{Pair, PairTable};
///
/// let delta_gains = [[1.2, 0.8], [0.9, 1.1]];
/// let delta = PairTable::from_fn(2, 2, |pair| Some(delta_gains[pair.output][pair.input]));
/// let held = PairTable::from_fn(2, 2, |pair| pair == Pair::new(0, 0));
/// let problem = Problem::gains(delta, held, Bounds { lower: 0.5, upper: 2.0 });
/// let solution = solve(&problem, ProofBudget::default(), &|| false)?;
/// assert!((solution.outputs[0] * solution.inputs[0] - 1.2).abs() < 1e-12);
/// assert!(matches!(solution.proof.outcome, Outcome::Proven { .. }));
/// # Ok::<(), gdcm_method::correction::problem::ProblemError>(())
/// ```
///
/// # Errors
/// [`ProblemError`] where the problem is not well posed ([`Problem::check`]), and
/// [`ProblemError::Stopped`] as soon as `stop`, polled about every half millisecond, returns true.
pub fn solve(
    problem: &Problem,
    budget: ProofBudget,
    stop: &dyn Fn() -> bool,
) -> Result<Solution, ProblemError> {
    problem.check()?;
    let effort = Effort::new(stop);
    let held = Held::of(problem);
    let coordinate = problem.coordinate();
    let reached = reach(&held, |nearest| {
        minimise(nearest, problem.quantity, &effort)
    })?;
    let objective = objective(problem, &reached.components);
    let start = start(&objective, problem.quantity)?;
    let mut found = search(&objective, &start, budget, floor(problem), &effort)?;
    for (scales, _) in &mut found.minima {
        settle(problem.quantity, &reached.components, &objective, scales);
    }
    let proof = proof(problem, &reached.components, found);
    let (agreeing, unmatched): (Vec<Unmatched>, Vec<Unmatched>) =
        misses(problem, &held, &reached, &effort)?
            .into_iter()
            .partition(|miss| {
                miss.why.agrees_within(problem.agreement) && miss.excess.abs() <= problem.agreement
            });
    let conflicts = conflicts_of(&unmatched);
    let remedy = Remedy::new(
        problem,
        &settled_loops(&held, &reached, &agreeing),
        &conflicts,
        &effort,
    )?;
    let mut targets = PairTable::filled(held.outputs, held.inputs, None);
    for (pair, target) in &reached.targets {
        targets[*pair] = Some(coordinate.value(*target));
    }
    let LocalMinimum {
        inputs,
        outputs,
        objective,
    } = proof.local_minima[0].clone();
    Ok(Solution {
        quantity: problem.quantity,
        inputs,
        outputs,
        objective,
        proof,
        targets,
        matched: unmatched.is_empty(),
        agreeing: conflicts_of(&agreeing),
        remedy,
        unmatched,
        conflicts,
    })
}

/// Start of Newton's method: for delays next to the minimum, which it then reaches exactly, with
/// the active bounds.
fn start(objective: &Objective, quantity: Quantity) -> Result<Vec<f64>, ProblemError> {
    if quantity.is_gain() {
        Ok(objective.nearest_to_zero())
    } else {
        interior_point(objective)
    }
}

/// Minimum of a sum of squares.
fn minimise(
    objective: &Objective,
    quantity: Quantity,
    effort: &Effort<'_>,
) -> Result<Vec<f64>, ProblemError> {
    let mut scales = start(objective, quantity)?;
    let bounds = (objective.lower.as_slice(), objective.upper.as_slice());
    Newton::new(objective.scales(), effort).minimise(objective, bounds, &mut scales, |_, _| false);
    effort.check()?;
    Ok(scales)
}

/// The limit `alpha -> 0+`: sets a free common scale where the outputs are nearest to a gain of 1
/// or to zero delay (the inputs, where there is no output); for signed delays where the sum of all
/// their squares is least.
fn settle(quantity: Quantity, components: &Components, objective: &Objective, scales: &mut [f64]) {
    objective.shift_floating_pieces(scales, |piece, scales| {
        let (inputs, outputs) = components.channels(scales);
        let of_piece = |nodes: &[Placement], values: &[f64]| -> Vec<f64> {
            let pairs = nodes.iter().zip(values);
            pairs
                .filter(|(node, _)| piece.contains(&node.component))
                .map(|(_, value)| *value)
                .collect()
        };
        let (input_nodes, output_nodes) = components.sides();
        let inputs = of_piece(input_nodes, &inputs);
        let outputs = of_piece(output_nodes, &outputs);
        if quantity.regularises_inputs() {
            let apart = outputs.iter().sum::<f64>() - inputs.iter().sum::<f64>();
            return apart / (inputs.len() + outputs.len()).max(1) as f64;
        }
        match (quantity, outputs.is_empty(), inputs.is_empty()) {
            (_, true, true) => 0.0,
            (_, true, false) => -mean(&inputs),
            (Quantity::Gain(GainObjective::Ratio), false, _) => {
                let (sum, square) = outputs.iter().fold((0.0, 0.0), |(sum, square), x| {
                    (sum + x.exp(), square + (2.0 * x).exp())
                });
                (square / sum).ln()
            }
            (_, false, _) => mean(&outputs),
        }
    });
}

/// Gains or delays of the inputs and of the outputs at these scales, exactly on the bounds they
/// reach.
fn channels_at(problem: &Problem, components: &Components, scales: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let bounds = problem.bounds;
    let coordinate = problem.coordinate();
    let low = coordinate.of(bounds.lower);
    let high = coordinate.of(bounds.upper);
    // A few roundings of coordinates of this size.
    let rounding = 16.0 * f64::EPSILON * (1.0 + low.abs().max(high.abs()));
    let value = |at: &f64| {
        if (at - low).abs() <= rounding {
            bounds.lower
        } else if (at - high).abs() <= rounding {
            bounds.upper
        } else {
            coordinate.value(*at).clamp(bounds.lower, bounds.upper)
        }
    };
    let (inputs, outputs) = components.channels(scales);
    (
        inputs.iter().map(value).collect(),
        outputs.iter().map(value).collect(),
    )
}

/// Converts the result of the search to gains or delays.
fn proof(problem: &Problem, components: &Components, found: Minima) -> Proof {
    let minimum = |(scales, _): &(Vec<f64>, f64)| {
        let (inputs, outputs) = channels_at(problem, components, scales);
        let objective = problem.objective_at(&inputs, &outputs);
        LocalMinimum {
            inputs,
            outputs,
            objective,
        }
    };
    let local_minima: Vec<LocalMinimum> = found.minima.iter().map(minimum).collect();
    let outcome = match found.limit {
        None => Outcome::Proven { gap: found.gap },
        Some(limit) => Outcome::NotProven {
            gap: found.gap,
            limit,
        },
    };
    let lower_bound = problem
        .coordinate()
        .objective(found.lower_bound)
        .min(local_minima[0].objective);
    Proof {
        lower_bound,
        outcome,
        nodes: found.nodes,
        local_minima,
        all_minima: found.all_minima,
    }
}

/// The constrained entries that stage 1 could not match, each with its conflict.
fn misses(
    problem: &Problem,
    held: &Held,
    reached: &Reached,
    effort: &Effort<'_>,
) -> Result<Vec<Unmatched>, SearchStopped> {
    let quantity = problem.quantity;
    let coordinate = problem.coordinate();
    let tolerance = matched_within(coordinate);
    let clashes = clashes(problem, held, reached, tolerance, effort)?;
    let why = |pair: Pair| match clashes.iter().find(|(missed, _)| *missed == pair) {
        Some((_, clash)) => clash.clone(),
        None => Conflict {
            quantity,
            entries: held.entries.iter().map(|(pair, _)| *pair).collect(),
            bounds: problem.bounds,
            kind: ConflictKind::Unclear,
        },
    };
    let entries = held.entries.iter().zip(&reached.targets);
    let missed = entries.filter(|((_, delta), (_, target))| (target - delta).abs() > tolerance);
    let missed = missed.map(|((pair, delta_at), (_, target_at))| {
        let delta = coordinate.value(*delta_at);
        let target = coordinate.value(*target_at);
        let excess = if quantity.is_gain() {
            quantity.difference(target_at - delta_at, coordinate)
        } else {
            target - delta
        };
        Unmatched {
            quantity,
            pair: *pair,
            delta,
            target,
            excess,
            why: why(*pair),
        }
    });
    Ok(missed.collect())
}

/// The constraints, with the entries of agreeing loops at their targets.
fn settled_loops(held: &Held, reached: &Reached, agreeing: &[Unmatched]) -> Held {
    let is_settled = |pair: Pair| agreeing.iter().any(|miss| miss.pair == pair);
    let entries = held.entries.iter().zip(&reached.targets);
    let entries = entries.map(|(asked, target)| if is_settled(asked.0) { *target } else { *asked });
    Held {
        entries: entries.collect(),
        ..*held
    }
}

/// Distinct conflicts behind the misses.
fn conflicts_of(unmatched: &[Unmatched]) -> Vec<Conflict> {
    let mut conflicts: Vec<Conflict> = Vec::new();
    for miss in unmatched {
        let same = |known: &Conflict| {
            known.entries.len() == miss.why.entries.len()
                && known
                    .entries
                    .iter()
                    .all(|pair| miss.why.entries.contains(pair))
        };
        if !conflicts.iter().any(same) {
            conflicts.push(miss.why.clone());
        }
    }
    conflicts.sort_by_key(|conflict| {
        (
            !matches!(conflict.kind, ConflictKind::Loop { .. }),
            conflict.entries.len(),
        )
    });
    conflicts
}

/// Returns a point within about 1e-9 of the minimum of a sum of squares over its box, by clarabel's
/// interior point method.
///
/// # Errors
/// [`ProblemError::Program`] where clarabel does not report the problem as solved ("almost solved"
/// is not).
pub(crate) fn interior_point(objective: &Objective) -> Result<Vec<f64>, ProblemError> {
    let mut scales = objective.lower.clone();
    let free: Vec<usize> = (0..objective.scales())
        .filter(|&index| objective.lower[index] < objective.upper[index])
        .collect();
    if !free.is_empty() {
        for (position, value) in solve_program(objective, &free)?.into_iter().enumerate() {
            let index = free[position];
            scales[index] = value.clamp(objective.lower[index], objective.upper[index]);
        }
    }
    Ok(scales)
}

/// `min s' P s / 2 + q' s` over `lower <= s <= upper` of the free scales; the others stay where
/// they are.
fn solve_program(objective: &Objective, free: &[usize]) -> Result<Vec<f64>, ProblemError> {
    let size = free.len();
    let scales = objective.scales();
    // Slope and curvature where the free scales are 0: the objective is a sum of squares.
    let mut origin = objective.lower.clone();
    free.iter().for_each(|&index| origin[index] = 0.0);
    let mut at = Expansion::zero(scales);
    objective.expand(&origin, Curvature::True, &mut at);
    let slope: Vec<f64> = free.iter().map(|&index| at.gradient[index]).collect();
    let row = |row: usize| free.iter().map(move |column| row * scales + column);
    let quadratic = CscMatrix::from(
        free.iter()
            .map(|&index| row(index).map(|entry| &at.hessian[entry])),
    )
    .to_triu();
    let columns = (0..=size).map(|column| 2 * column).collect();
    let rows = (0..size)
        .flat_map(|column| [column, size + column])
        .collect();
    let signs = (0..size).flat_map(|_| [1.0, -1.0]).collect();
    let sides = CscMatrix::new(2 * size, size, columns, rows, signs);
    let upper = free.iter().map(|&index| objective.upper[index]);
    let ends: Vec<f64> = upper
        .chain(free.iter().map(|&index| -objective.lower[index]))
        .collect();
    let settings = DefaultSettings {
        verbose: false,
        presolve_enable: false,
        ..DefaultSettings::default()
    };
    convex_program(&quadratic, &slope, &sides, &ends, settings)
        .map_err(|reason| ProblemError::Program { reason })
}
