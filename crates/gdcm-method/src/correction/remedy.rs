//! Remedies: single changes that make all constrained entries feasible. A constrained entry
//! prescribes the gain or delay that two channels together give a response. A change moves one
//! bound on the channels, or releases one entry: it is then no longer constrained.

use std::collections::BTreeSet;

use gdcm_model::dataset::Pair;

use super::branch_and_bound::effort::{Effort, SearchStopped};
use super::components::{ACCEPTED_INFEASIBILITY, Components, Placement};
use super::conflict::Conflict;
use super::constraints::Constraints;
use super::interval::Interval;
use super::problem::Problem;
use super::quantity::Quantity;
use super::three_digits::three_digits;

/// Rounding error in a range end, relative to `1 + |low| + |high|`.
const RANGE_ROUNDING: f64 = 1e-12;

/// Single changes that each make all constrained entries feasible at their delta; empty if several
/// changes are needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Remedy {
    /// Constrained quantity: gains, delays \[s\] or signed delays \[s\].
    pub quantity: Quantity,
    /// Minimum sufficient upper bound if the lower bound is unchanged, rounded up to three digits;
    /// `None` if no upper bound suffices.
    pub upper: Option<f64>,
    /// Maximum sufficient lower bound if the upper bound is unchanged, rounded down to three
    /// digits; `None` if no lower bound suffices, and for delays, whose lower bound is fixed.
    pub lower: Option<f64>,
    /// Constrained entries to free: releasing any one of them alone is sufficient.
    pub free: Vec<Pair>,
}

impl Remedy {
    /// Finds the remedy for conflicts between the `constraints` of `problem`; `None` without
    /// conflicts.
    ///
    /// ```text
    /// 1  free: each entry of a conflict without which all others are feasible
    /// 2  upper, lower: the end of the range that suffices with the other end unchanged
    ///    (`SufficientRange`); none if a loop is inconsistent, or if both ends would have to move
    /// 3  rounded outwards to three digits, and never narrower than the present bounds
    /// ```
    pub(crate) fn new(
        problem: &Problem,
        constraints: &Constraints,
        conflicts: &[Conflict],
        effort: &Effort<'_>,
    ) -> Result<Option<Self>, SearchStopped> {
        if conflicts.is_empty() {
            return Ok(None);
        }
        // Step 1
        let free = sufficient_releases(constraints, conflicts, effort)?;
        let coordinate = problem.coordinate();
        // Step 2
        let sufficient = SufficientRange::new(constraints);
        // Step 3. `max`, `min`: leave a bound unchanged if it is already sufficient.
        let upper = sufficient
            .high
            .map(|high| three_digits(coordinate.value(high), f64::ceil).max(problem.bounds.upper));
        let lower = if problem.quantity.has_lower_bound() {
            sufficient.low.map(|low| {
                three_digits(coordinate.value(low), f64::floor).min(problem.bounds.lower)
            })
        } else {
            None
        };
        Ok(Some(Self {
            quantity: problem.quantity,
            upper,
            lower,
            free,
        }))
    }

    /// Returns whether no single change is sufficient.
    pub fn is_empty(&self) -> bool {
        self.upper.is_none() && self.lower.is_none() && self.free.is_empty()
    }
}

/// Finds the conflicting entries whose release alone makes all other entries feasible.
fn sufficient_releases(
    constraints: &Constraints,
    conflicts: &[Conflict],
    effort: &Effort<'_>,
) -> Result<Vec<Pair>, SearchStopped> {
    let suspects: BTreeSet<Pair> = conflicts
        .iter()
        .flat_map(|conflict| conflict.entries.iter().copied())
        .collect();
    let mut sufficient = Vec::new();
    for pair in suspects {
        // Work: `Components::new` examines up to every entry at every channel, which counts as an
        // eighth of a term evaluation.
        effort.spend((constraints.nodes() * constraints.entries.len()) as u64 / 8);
        effort.check()?;
        let mut others = constraints.entries.clone();
        others.retain(|entry| entry.pair != pair);
        if Components::new(&constraints.with_entries(others)).are_possible() {
            sufficient.push(pair);
        }
    }
    Ok(sufficient)
}

/// Sufficient ends for the channels' coordinate range, each with the other end unchanged.
///
/// In a component with the scale `s` and offsets `a` (inputs) and `b` (outputs), the coordinates
/// are `a + s` and `-(b + s)` ([`Components`]). Some `s` places them all in `low ..= high` if and
/// only if
///
/// ```text
/// high - low  >=  max a - min a,  max b - min b     (width)
/// low         <=  (min a - max b) / 2               (lowest pair: lowest input and lowest output)
/// high        >=  (max a - min b) / 2               (highest pair)
/// ```
///
/// The sum over a pair, such as `min a - max b`, does not depend on `s`; half of it is the mean of
/// the pair's two coordinates, which must be in the range.
#[derive(Default)]
struct SufficientRange {
    /// Maximum sufficient lower end.
    low: Option<f64>,
    /// Minimum sufficient upper end.
    high: Option<f64>,
}

impl SufficientRange {
    /// Finds both ends; both are `None` if a loop is inconsistent, which no other bounds resolve.
    fn new(constraints: &Constraints) -> Self {
        let components = Components::new(constraints);
        for entry in &constraints.entries {
            let mismatch = (components.sum(entry.pair) - entry.sum).abs();
            if mismatch > ACCEPTED_INFEASIBILITY || mismatch.is_nan() {
                return Self::default();
            }
        }
        let nodes = components.nodes();
        // Over all components: required width, end required by the lowest pair, and by the highest.
        let mut widest = 0.0_f64;
        let mut lowest = f64::INFINITY;
        let mut highest = f64::NEG_INFINITY;
        for component in 0..components.count() {
            // Skip a component without inputs or outputs: it is a single channel, which is always
            // feasible.
            let Some(inputs) = offset_range(nodes.inputs, component) else {
                continue;
            };
            let Some(outputs) = offset_range(nodes.outputs, component) else {
                continue;
            };
            widest = widest.max(inputs.width().max(outputs.width()));
            lowest = lowest.min(0.5 * (inputs.low - outputs.high));
            highest = highest.max(0.5 * (inputs.high - outputs.low));
        }
        // Changing one end is sufficient only if the pairs do not require the other end to move.
        let Interval { low, high } = constraints.range;
        let rounding = RANGE_ROUNDING * (1.0 + low.abs() + high.abs());
        let mut sufficient = Self::default();
        if highest <= high + rounding {
            sufficient.low = Some(low.min(high - widest).min(lowest));
        }
        if lowest >= low - rounding {
            sufficient.high = Some(high.max(low + widest).max(highest));
        }
        sufficient
    }
}

/// Returns the offset range over a component's nodes; `None` if no node belongs to it.
fn offset_range(nodes: &[Placement], component: usize) -> Option<Interval> {
    let mut range: Option<Interval> = None;
    for node in nodes {
        if node.component != component {
            continue;
        }
        let offset = node.offset.value;
        range = Some(match range {
            None => Interval {
                low: offset,
                high: offset,
            },
            Some(range) => Interval {
                low: range.low.min(offset),
                high: range.high.max(offset),
            },
        });
    }
    range
}
