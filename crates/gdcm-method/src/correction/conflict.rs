//! Conflicts: constrained entries and bounds that exclude one another, and changes that make all
//! constraints feasible.

use std::collections::{BTreeSet, VecDeque};

use gdcm_model::dataset::Pair;
use gdcm_model::units::{s_to_ms, telling, told_apart};

use super::channels::{Channel, pair_name, pair_names};
use super::components::{Components, Held, Placement, Reached, STRAIN};
use super::problem::{Bounds, Problem, Quantity, three_digits};
use crate::correction::branch_and_bound::search::{Effort, SearchStopped};

/// A minimal infeasible set of constrained entries and bounds: without any one of them the rest is
/// feasible.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// Constrained quantity: gains, or delays or signed delays in seconds.
    pub quantity: Quantity,
    /// The constrained entries: releasing any one of them resolves the conflict.
    pub entries: Vec<Pair>,
    /// The present bounds.
    pub bounds: Bounds,
    pub kind: ConflictKind,
}

/// Kind of conflict between constrained entries and bounds. Suggested bounds are rounded to three
/// digits so that they still suffice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConflictKind {
    /// The entries prescribe a net value of two channels above the value that the upper bound
    /// allows.
    AboveUpper {
        channels: (Channel, Channel),
        /// Product of gains, or sum of delays, prescribed by the entries.
        asked: f64,
        /// Least sufficient upper bound.
        upper: f64,
    },
    /// The entries prescribe a net value of two channels below the value that the lower bound
    /// allows: for delays, phase lead.
    BelowLower {
        channels: (Channel, Channel),
        /// Product of gains, or (negative) sum of delays, prescribed by the entries.
        asked: f64,
        /// Greatest sufficient lower bound; `None` for delays.
        lower: Option<f64>,
    },
    /// The entries prescribe a ratio of two gains, or a difference of two delays, above the range
    /// that the bounds allow.
    TooFarApart {
        /// The channel with the greater value.
        greater: Channel,
        /// The channel with the lesser value.
        lesser: Channel,
        /// Ratio or difference prescribed by the entries.
        asked: f64,
        /// Least sufficient upper bound with the present lower bound.
        upper: f64,
        /// Greatest sufficient lower bound with the present upper bound; `None` for delays.
        lower: Option<f64>,
    },
    /// The entries form a loop with contradictory targets: no bound helps.
    Loop {
        /// Deviation of the loop's product from 1 in dB, or of its sum from 0 in seconds.
        mismatch: f64,
    },
    /// The entries are infeasible together; rounding hides which of them are the cause.
    Unclear,
}

impl Conflict {
    /// Channels whose bounds take part in the conflict; none for a loop.
    pub fn channels(&self) -> Vec<Channel> {
        match self.kind {
            ConflictKind::AboveUpper { channels, .. }
            | ConflictKind::BelowLower { channels, .. } => {
                vec![channels.0, channels.1]
            }
            ConflictKind::TooFarApart {
                greater, lesser, ..
            } => vec![greater, lesser],
            ConflictKind::Loop { .. } | ConflictKind::Unclear => Vec::new(),
        }
    }

    /// Whether the conflict is a single entry that asks for phase lead.
    pub fn is_lone_lead(&self) -> bool {
        self.quantity == Quantity::Delay
            && self.entries.len() == 1
            && matches!(self.kind, ConflictKind::BelowLower { .. })
    }

    /// Whether it is a loop that disagrees by no more than `tolerance`, in dB or in seconds.
    pub(crate) fn agrees_within(&self, tolerance: f64) -> bool {
        matches!(self.kind, ConflictKind::Loop { mismatch } if mismatch.abs() <= tolerance)
    }

    /// Describes the sense and the size of a loop's mismatch.
    fn mismatch_words(&self, mismatch: f64) -> (&'static str, String) {
        if self.quantity.is_gain() {
            ("ratios", format!("{} dB", telling(mismatch.abs(), 1)))
        } else {
            (
                "delays",
                format!("{} ms", telling(s_to_ms(mismatch.abs()), 1)),
            )
        }
    }

    /// Describes a loop that agrees within the tolerance.
    pub fn agreement_words(&self, inputs: &[String], outputs: &[String]) -> String {
        let ConflictKind::Loop { mismatch } = self.kind else {
            return String::new();
        };
        let entries = pair_names(&self.entries, inputs, outputs);
        let (what, mismatch) = self.mismatch_words(mismatch);
        format!(
            "{entries} form a loop: their {what} agree to {mismatch}, and count as agreeing; each is held at the nearest that does."
        )
    }

    /// Describes the conflict and its possible resolutions.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let entries = pair_names(&self.entries, inputs, outputs);
        let (cannot, release) = match self.entries.len() {
            1 => ("cannot be held", "release it"),
            2 => ("cannot both be held", "release one of them"),
            _ => ("cannot all be held", "release one of them"),
        };
        match self.kind {
            ConflictKind::Loop { mismatch } => {
                let (what, mismatch) = self.mismatch_words(mismatch);
                format!("{entries} form a loop: their {what} disagree by {mismatch}; {release}.")
            }
            ConflictKind::Unclear => format!("{entries} {cannot}; {release}."),
            ConflictKind::BelowLower { asked, .. } if self.is_lone_lead() => {
                let lead_ms = telling(s_to_ms(-asked), 1);
                format!("{entries} needs {lead_ms} ms of lead: a delay cannot give it; {release}.")
            }
            _ => format!(
                "{entries} {cannot}: {} {release}.",
                self.bounds_words(inputs, outputs)
            ),
        }
    }

    /// Describes the limiting bounds and their sufficient values, up to the word before the
    /// alternatives.
    fn bounds_words(&self, inputs: &[String], outputs: &[String]) -> String {
        const HELP: &str = "a larger R_max or a smaller n gives more";
        let name = |channel: Channel| {
            format!(
                "{}_{}",
                self.quantity.symbol(),
                channel.name(inputs, outputs)
            )
        };
        let names = |(first, second): (Channel, Channel)| (name(first), name(second));
        let apart_ms =
            |limit_s: f64, asked_s: f64| told_apart(s_to_ms(limit_s), s_to_ms(asked_s), 1);
        let Bounds {
            lower: low,
            upper: high,
        } = self.bounds;
        let product = |channels,
                       asked: f64,
                       (sign, bound, end): (&str, f64, &str),
                       (which, new): (&str, f64)| {
            let (first, second) = names(channels);
            let (limit, asked) = told_apart(bound.powi(2), asked, 3);
            format!(
                "with gains {sign} {bound:.3} the product {first} {second} is at {end} {limit}, not {asked}; set the {which} \
                 bound to {new} or"
            )
        };
        match (self.kind, self.quantity) {
            (
                ConflictKind::AboveUpper {
                    channels,
                    asked,
                    upper,
                },
                Quantity::Gain(_),
            ) => product(channels, asked, ("<=", high, "most"), ("upper", upper)),
            (
                ConflictKind::AboveUpper {
                    channels,
                    asked,
                    upper,
                },
                delay,
            ) => {
                let (first, second) = names(channels);
                let (most, asked) = apart_ms(2.0 * high, asked);
                let of_delay = if delay == Quantity::SignedDelay {
                    " of delay"
                } else {
                    ""
                };
                format!(
                    "{first} and {second} give at most {most} ms{of_delay} together, not {asked}; set the upper bound to \
                     {upper} s or"
                )
            }
            (
                ConflictKind::BelowLower {
                    channels,
                    asked,
                    lower,
                },
                Quantity::Gain(_),
            ) => product(
                channels,
                asked,
                (">=", low, "least"),
                ("lower", lower.unwrap_or(low)),
            ),
            (
                ConflictKind::BelowLower {
                    channels, asked, ..
                },
                Quantity::Delay,
            ) => {
                let (first, second) = names(channels);
                let lead_ms = telling(s_to_ms(-asked), 1);
                format!(
                    "{first} and {second} would have to give {lead_ms} ms of lead together, and a delay cannot;"
                )
            }
            (
                ConflictKind::BelowLower {
                    channels, asked, ..
                },
                Quantity::SignedDelay,
            ) => {
                let (first, second) = names(channels);
                let (most, asked) = apart_ms(-2.0 * low, -asked);
                format!(
                    "R_max lets {first} and {second} give {most} ms of lead together, not {asked}: {HELP}, or"
                )
            }
            (
                ConflictKind::TooFarApart {
                    greater,
                    lesser,
                    asked,
                    upper,
                    lower,
                },
                Quantity::Gain(_),
            ) => {
                let (greater, lesser) = names((greater, lesser));
                let (most, asked) = told_apart(high / low, asked, 3);
                let lower = lower.unwrap_or(low);
                format!(
                    "with {greater} <= {high:.3} and {lesser} >= {low:.3} their ratio is at most {most}, not {asked}; set \
                     the upper bound to {upper}, or the lower bound to {lower}, or"
                )
            }
            (
                ConflictKind::TooFarApart {
                    greater,
                    lesser,
                    asked,
                    upper,
                    ..
                },
                Quantity::Delay,
            ) => {
                let (greater, lesser) = names((greater, lesser));
                let (most, asked) = apart_ms(high, asked);
                format!(
                    "{greater} cannot be {asked} ms above {lesser} with delays <= {most} ms; set the upper bound to {upper} s or"
                )
            }
            (
                ConflictKind::TooFarApart {
                    greater,
                    lesser,
                    asked,
                    upper,
                    ..
                },
                Quantity::SignedDelay,
            ) => {
                let (greater, lesser) = names((greater, lesser));
                let (most, asked) = apart_ms(high - low, asked);
                let lead_ms = telling(s_to_ms(-low), 1);
                let delay_ms = telling(s_to_ms(high), 1);
                format!(
                    "{greater} cannot be {asked} ms above {lesser}: with at most {lead_ms} ms of lead and {delay_ms} ms of delay a \
                     channel it is {most} ms; set the upper bound to {upper} s; {HELP}, or"
                )
            }
            (ConflictKind::Loop { .. } | ConflictKind::Unclear, _) => String::new(),
        }
    }
}

/// A constrained entry that stage 1 missed: it requires `s_to - s_from` to be at least `weight`,
/// and gets less.
#[derive(Clone, Copy)]
struct Pull {
    from: usize,
    to: usize,
    weight: f64,
    pair: Pair,
}

impl Pull {
    /// The same entry in the opposite direction: the constraint is an equality.
    fn reversed(&self) -> Self {
        Self {
            from: self.to,
            to: self.from,
            weight: -self.weight,
            pair: self.pair,
        }
    }
}

/// Finds the smallest conflict behind each entry that stage 1 missed by more than `tolerance`, with
/// duplicates.
///
/// Stage 1 is a least squares problem, so the misses are a flow: the pull on a channel is passed on
/// by another missed entry or is stopped by an active bound. Every path of the flow from bound to
/// bound, and every loop of it, is an infeasible set, and every missed entry is on one (Farkas).
/// Where a part of that set is infeasible by itself, that part is the conflict, and the entry's own
/// miss is the compromise with it.
pub(crate) fn clashes(
    problem: &Problem,
    held: &Held,
    reached: &Reached,
    tolerance: f64,
    effort: &Effort<'_>,
) -> Result<Vec<(Pair, Conflict)>, SearchStopped> {
    let Some(point) = &reached.point else {
        return Ok(Vec::new());
    };
    let flow = Flow::new(problem, held, reached, point);
    let missed = |pull: &&Pull| pull.weight - (point[pull.to] - point[pull.from]) > tolerance;
    let mut clashes = Vec::new();
    for pull in flow.pulls.iter().filter(missed) {
        // Three searches over every pull of every channel.
        effort.spend((flow.pulls.len() * held.nodes()) as u64 / 8);
        effort.check()?;
        clashes.extend(flow.smallest_through(pull).map(|clash| (pull.pair, clash)));
    }
    Ok(clashes)
}

struct Flow<'a> {
    problem: &'a Problem,
    held: &'a Held,
    pulls: Vec<Pull>,
    at_lower: Vec<bool>,
    at_upper: Vec<bool>,
}

impl<'a> Flow<'a> {
    fn new(problem: &'a Problem, held: &'a Held, reached: &Reached, point: &[f64]) -> Self {
        let mut pulls = Vec::new();
        let mut net = vec![0.0; held.nodes()];
        for (&(pair, delta), (_, target)) in held.entries.iter().zip(&reached.targets) {
            let (input, output) = held.nodes_of(pair);
            let missing = delta - target;
            // A miss below this is the rounding of stage 1.
            if missing.abs() <= 1e-11 * (1.0 + delta.abs()) {
                continue;
            }
            let (from, to, weight) = if missing > 0.0 {
                (output, input, delta)
            } else {
                (input, output, -delta)
            };
            net[from] -= missing.abs();
            net[to] += missing.abs();
            pulls.push(Pull {
                from,
                to,
                weight,
                pair,
            });
        }
        let at_lower = (0..net.len())
            .map(|node| point[node] <= held.ends(node).0 && net[node] < 0.0)
            .collect();
        let at_upper = (0..net.len())
            .map(|node| point[node] >= held.ends(node).1 && net[node] > 0.0)
            .collect();
        Self {
            problem,
            held,
            pulls,
            at_lower,
            at_upper,
        }
    }

    /// Returns the shorter of the shortest loop and the shortest path from bound to bound through
    /// `pull`; a bound counts like an entry.
    fn smallest_through(&self, pull: &Pull) -> Option<Conflict> {
        let around = self.shortest(pull.to, |node| node == pull.from, false);
        let onward = self.shortest(pull.to, |node| self.at_upper[node], false);
        let back = self.shortest(pull.from, |node| self.at_lower[node], true);
        let path = back.zip(onward).map(|(back, onward)| {
            let before = back.into_iter().rev();
            before.chain([*pull]).chain(onward).collect::<Vec<Pull>>()
        });
        match (around, path) {
            (Some(around), Some(path)) if around.len() < path.len() + 2 => {
                Some(self.round(pull, around))
            }
            (_, Some(path)) => Some(
                self.smallest_part(&path, 0)
                    .unwrap_or_else(|| self.clash(&path)),
            ),
            (around, None) => Some(self.round(pull, around?)),
        }
    }

    fn round(&self, pull: &Pull, around: Vec<Pull>) -> Conflict {
        let pulls: Vec<Pull> = std::iter::once(*pull).chain(around).collect();
        if let Some(clash) = self.smallest_part(&pulls, pulls.len()) {
            return clash;
        }
        let Problem {
            quantity, bounds, ..
        } = *self.problem;
        let mismatch = quantity.difference(
            pulls.iter().map(|pull| pull.weight).sum(),
            self.problem.coordinate(),
        );
        let entries = pulls.iter().map(|pull| pull.pair).collect();
        Conflict {
            quantity,
            entries,
            bounds,
            kind: ConflictKind::Loop { mismatch },
        }
    }

    /// Returns the shortest proper run of the pulls that the bounds of its two ends do not allow.
    /// Runs may begin at the first `round` pulls and continue past the last into the first again.
    fn smallest_part(&self, pulls: &[Pull], round: usize) -> Option<Conflict> {
        let count = pulls.len();
        (1..count).find_map(|length| {
            let begins = if round > 0 { round } else { count - length + 1 };
            (0..begins).find_map(|begin| {
                let run: Vec<Pull> = (begin..begin + length)
                    .map(|index| pulls[index % count])
                    .collect();
                let back: Vec<Pull> = run.iter().rev().map(Pull::reversed).collect();
                [run, back]
                    .iter()
                    .find(|run| self.is_impossible(run))
                    .map(|run| self.clash(run))
            })
        })
    }

    /// Whether the run needs more than the difference between the least value of its first node and
    /// the greatest value of its last.
    fn is_impossible(&self, run: &[Pull]) -> bool {
        let (Some(first), Some(last)) = (run.first(), run.last()) else {
            return false;
        };
        let needed: f64 = run.iter().map(|pull| pull.weight).sum();
        needed - (self.held.ends(last.to).1 - self.held.ends(first.from).0) > STRAIN
    }

    /// Conflict of a path from a node at its least value to a node at its greatest.
    fn clash(&self, path: &[Pull]) -> Conflict {
        let needed: f64 = path.iter().map(|pull| pull.weight).sum();
        let start = path.first().map_or(0, |pull| pull.from);
        let end = path.last().map_or(0, |pull| pull.to);
        let quantity = self.problem.quantity;
        let bounds = self.problem.bounds;
        let coordinate = self.problem.coordinate();
        let movable = |lower: f64| {
            quantity
                .has_lower_bound()
                .then(|| three_digits(lower, f64::floor))
        };
        let kind = match (self.channel(start), self.channel(end)) {
            (first @ Channel::Output(_), last @ Channel::Input(_)) => ConflictKind::AboveUpper {
                channels: (last, first),
                asked: coordinate.value(needed),
                upper: three_digits(coordinate.value(0.5 * needed), f64::ceil),
            },
            (first @ Channel::Input(_), last @ Channel::Output(_)) => ConflictKind::BelowLower {
                channels: (first, last),
                asked: coordinate.value(-needed),
                lower: movable(coordinate.value(-0.5 * needed)),
            },
            (lesser @ Channel::Input(_), greater @ Channel::Input(_)) | (greater, lesser) => {
                let asked = coordinate.value(needed);
                let upper = three_digits(quantity.net(bounds.lower, asked), f64::ceil);
                let lower = if quantity.is_gain() {
                    bounds.upper / asked
                } else {
                    bounds.upper - asked
                };
                ConflictKind::TooFarApart {
                    greater,
                    lesser,
                    asked,
                    upper,
                    lower: movable(lower),
                }
            }
        };
        let mut entries: Vec<Pair> = path.iter().map(|pull| pull.pair).collect();
        entries.sort();
        Conflict {
            quantity,
            entries,
            bounds,
            kind,
        }
    }

    fn channel(&self, node: usize) -> Channel {
        let inputs = self.held.inputs;
        if node < inputs {
            Channel::Input(node)
        } else {
            Channel::Output(node - inputs)
        }
    }

    /// Returns the shortest sequence of pulls from `start` along (or against) their direction to a
    /// node that satisfies `ends`, in the order walked.
    fn shortest(
        &self,
        start: usize,
        ends: impl Fn(usize) -> bool,
        against: bool,
    ) -> Option<Vec<Pull>> {
        let mut came_by: Vec<Option<Pull>> = vec![None; self.held.nodes()];
        let mut queue = VecDeque::from([start]);
        while let Some(node) = queue.pop_front() {
            if ends(node) {
                let mut walked = Vec::new();
                let mut at = node;
                while at != start {
                    let pull = came_by[at]?;
                    at = if against { pull.to } else { pull.from };
                    walked.push(pull);
                }
                walked.reverse();
                return Some(walked);
            }
            for pull in &self.pulls {
                let (leaves, enters) = if against {
                    (pull.to, pull.from)
                } else {
                    (pull.from, pull.to)
                };
                if leaves == node && enters != start && came_by[enters].is_none() {
                    came_by[enters] = Some(*pull);
                    queue.push_back(enters);
                }
            }
        }
        None
    }
}

/// Single changes that each make all constrained entries feasible at their delta; empty where
/// several changes are needed.
#[derive(Clone, Debug, PartialEq)]
pub struct Remedy {
    /// Constrained quantity: gains, or delays in seconds.
    pub quantity: Quantity,
    /// Least sufficient upper bound with the present lower bound, rounded up to three digits.
    pub upper: Option<f64>,
    /// Greatest sufficient lower bound with the present upper bound, rounded down to three digits;
    /// `None` for delays.
    pub lower: Option<f64>,
    /// The constrained entries of which each is sufficient when released alone.
    pub free: Vec<Pair>,
}

impl Remedy {
    /// Finds the remedy for `held`, the constrained entries of `problem` with these conflicts;
    /// `None` where there is no conflict.
    pub(crate) fn new(
        problem: &Problem,
        held: &Held,
        conflicts: &[Conflict],
        effort: &Effort<'_>,
    ) -> Result<Option<Self>, SearchStopped> {
        if conflicts.is_empty() {
            return Ok(None);
        }
        let quantity = problem.quantity;
        let coordinate = problem.coordinate();
        let suspects: BTreeSet<Pair> = conflicts
            .iter()
            .flat_map(|conflict| conflict.entries.iter().copied())
            .collect();
        let mut free = Vec::new();
        for pair in suspects {
            // Each channel is placed by a walk along the constrained entries.
            effort.spend((held.nodes() * held.entries.len()) as u64 / 8);
            effort.check()?;
            let others = held
                .entries
                .iter()
                .filter(|(other, _)| *other != pair)
                .copied()
                .collect();
            if Components::new(&Held {
                entries: others,
                ..*held
            })
            .are_possible()
            {
                free.push(pair);
            }
        }
        let [lower, upper] = range_that_does(held);
        // A bound that is not the obstacle stays unchanged.
        let upper = upper.map(|upper| {
            three_digits(coordinate.value(upper), f64::ceil).max(problem.bounds.upper)
        });
        let lower = lower.map(|lower| {
            three_digits(coordinate.value(lower), f64::floor).min(problem.bounds.lower)
        });
        Ok(Some(Self {
            quantity,
            upper,
            lower: lower.filter(|_| quantity.has_lower_bound()),
            free,
        }))
    }

    /// Describes the remedies; empty where there is none.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let unit = if self.quantity.is_gain() { "" } else { " s" };
        let upper = self
            .upper
            .map(|upper| format!("an upper bound of {upper}{unit}"));
        let lower = self
            .lower
            .map(|lower| format!("a lower bound of {lower}{unit}"));
        let free = self
            .free
            .iter()
            .map(|&pair| format!("freeing {}", pair_name(pair, inputs, outputs)));
        let ways: Vec<String> = upper.into_iter().chain(lower).chain(free).collect();
        if ways.is_empty() {
            String::new()
        } else {
            format!("Any one of these lets all be held: {}.", ways.join("; "))
        }
    }
}

/// Greatest lower and least upper end of the channels' range that suffice, each with the other end
/// unchanged, in coordinates; `None` where a loop of constrained entries does not close.
fn range_that_does(held: &Held) -> [Option<f64>; 2] {
    let (low, high) = held.range;
    let components = Components::new(held);
    if !held
        .entries
        .iter()
        .all(|&(pair, sum)| (components.sum(pair) - sum).abs() <= STRAIN)
    {
        return [None; 2];
    }
    let (inputs, outputs) = components.sides();
    let mut widest = 0.0_f64;
    let mut lowest = f64::INFINITY;
    let mut highest = f64::NEG_INFINITY;
    for component in 0..components.count() {
        // A component without inputs or outputs is a single channel, which is always feasible.
        let ends = ends_of(inputs, component).zip(ends_of(outputs, component));
        let Some(((least_input, most_input), (least_output, most_output))) = ends else {
            continue;
        };
        widest = widest.max((most_input - least_input).max(most_output - least_output));
        lowest = lowest.min(0.5 * (least_input - most_output));
        highest = highest.max(0.5 * (most_input - least_output));
    }
    let rounding = 1e-12 * (1.0 + low.abs() + high.abs());
    [
        (highest <= high + rounding).then(|| low.min(high - widest).min(lowest)),
        (lowest >= low - rounding).then(|| high.max(low + widest).max(highest)),
    ]
}

/// Least and greatest offset of the nodes of one component.
fn ends_of(nodes: &[Placement], component: usize) -> Option<(f64, f64)> {
    let offsets = nodes
        .iter()
        .filter(|node| node.component == component)
        .map(|node| node.offset.value);
    offsets
        .clone()
        .reduce(f64::min)
        .zip(offsets.reduce(f64::max))
}
