//! Why held entries cannot all be held: which of them and which bounds are in each other's way.

use std::collections::VecDeque;

use super::*;
use crate::dataset::Pair;
use crate::units::{s_to_ms, telling, told_apart};

/// A smallest set of held entries and bounds that cannot hold together: without any one of them the rest can.
#[derive(Clone, Debug, PartialEq)]
pub struct Conflict {
    /// What is held: gains, or delays or signed delays in seconds.
    pub quantity: Quantity,
    /// The held entries: freeing any one of them resolves the conflict.
    pub entries: Vec<Pair>,
    /// The bounds as they are.
    pub bounds: Bounds,
    /// What is in the way.
    pub kind: ConflictKind,
}

/// How held entries and bounds exclude one another. Bounds that would do are rounded to three digits so that they still do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ConflictKind {
    /// The entries fix what two channels have together above what the upper bound allows both.
    AboveUpper {
        /// The two channels.
        channels: (Channel, Channel),
        /// The product of gains, or the sum of delays, that the entries ask for.
        asked: f64,
        /// Least upper bound that would do.
        upper: f64,
    },
    /// The entries fix what two channels have together below what the lower bound allows both: of delays, phase lead.
    BelowLower {
        /// The two channels.
        channels: (Channel, Channel),
        /// The product of gains, or the (negative) sum of delays, that the entries ask for.
        asked: f64,
        /// Greatest lower bound that would do; none for delays.
        lower: Option<f64>,
    },
    /// The entries fix the ratio of two gains, or the difference of two delays, above what the bounds allow.
    TooFarApart {
        /// The channel with the greater value.
        greater: Channel,
        /// The channel with the lesser value.
        lesser: Channel,
        /// The ratio or the difference that the entries ask for.
        asked: f64,
        /// Least upper bound that would do with the lower bound as it is.
        upper: f64,
        /// Greatest lower bound that would do with the upper bound as it is; none for delays.
        lower: Option<f64>,
    },
    /// The entries form a loop, and what they ask for disagrees: no bound helps.
    Loop {
        /// By how many dB the product round the loop misses 1, or by how many seconds the sum misses 0.
        mismatch: f64,
    },
    /// The entries cannot all be held; rounding hides which of them are to blame.
    Unclear,
}

impl Conflict {
    /// The channels whose bounds are in the way; none of a loop.
    pub fn channels(&self) -> Vec<Channel> {
        match self.kind {
            ConflictKind::AboveUpper { channels, .. } | ConflictKind::BelowLower { channels, .. } => {
                vec![channels.0, channels.1]
            }
            ConflictKind::TooFarApart { greater, lesser, .. } => vec![greater, lesser],
            ConflictKind::Loop { .. } | ConflictKind::Unclear => Vec::new(),
        }
    }

    /// Whether a lone entry asks for phase lead, which says everything.
    pub fn is_lone_lead(&self) -> bool {
        self.quantity == Quantity::Delay
            && self.entries.len() == 1
            && matches!(self.kind, ConflictKind::BelowLower { .. })
    }

    /// Whether it is a loop that disagrees by no more than `tolerance`, in dB or in seconds.
    pub(crate) fn agrees_within(&self, tolerance: f64) -> bool {
        matches!(self.kind, ConflictKind::Loop { mismatch } if mismatch.abs() <= tolerance)
    }

    /// By how much a loop of these entries disagrees, in words.
    fn mismatch_words(&self, mismatch: f64) -> String {
        if self.quantity.is_gain() {
            format!("{} dB", telling(mismatch.abs(), 1))
        } else {
            format!("{} ms", telling(s_to_ms(mismatch.abs()), 1))
        }
    }

    /// A loop that agrees within the tolerance, in words.
    pub fn agreement_words(&self, inputs: &[String], outputs: &[String]) -> String {
        let ConflictKind::Loop { mismatch } = self.kind else { return String::new() };
        let entries = pair_names(&self.entries, inputs, outputs);
        let (what, mismatch) = (self.quantity.looped(), self.mismatch_words(mismatch));
        format!(
            "{entries} form a loop: their {what} agree to {mismatch}, and count as agreeing; each is held at the nearest that does."
        )
    }

    /// The conflict and what would resolve it, in words.
    pub fn words(&self, inputs: &[String], outputs: &[String]) -> String {
        let entries = pair_names(&self.entries, inputs, outputs);
        let (cannot, release) = match self.entries.len() {
            1 => ("cannot be held", "release it"),
            2 => ("cannot both be held", "release one of them"),
            _ => ("cannot all be held", "release one of them"),
        };
        match self.kind {
            ConflictKind::Loop { mismatch } => {
                let (what, mismatch) = (self.quantity.looped(), self.mismatch_words(mismatch));
                format!("{entries} form a loop: their {what} disagree by {mismatch}; {release}.")
            }
            ConflictKind::Unclear => format!("{entries} {cannot}; {release}."),
            ConflictKind::BelowLower { asked, .. } if self.is_lone_lead() => {
                let lead_ms = telling(s_to_ms(-asked), 1);
                format!("{entries} needs {lead_ms} ms of lead: a delay cannot give it; {release}.")
            }
            _ => format!("{entries} {cannot}: {} {release}.", self.bounds_words(inputs, outputs)),
        }
    }

    /// Which bounds are in the way and what they would have to be, up to the word before what else would do.
    fn bounds_words(&self, inputs: &[String], outputs: &[String]) -> String {
        const HELP: &str = "a larger R_max or a smaller n gives more";
        let name = |channel: Channel| format!("{}_{}", self.quantity.symbol(), channel.name(inputs, outputs));
        let names = |(first, second): (Channel, Channel)| (name(first), name(second));
        let apart_ms = |limit_s: f64, asked_s: f64| told_apart(s_to_ms(limit_s), s_to_ms(asked_s), 1);
        let Bounds { lower: low, upper: high } = self.bounds;
        match (self.kind, self.quantity) {
            (ConflictKind::AboveUpper { channels, asked, upper }, Quantity::Gain(_)) => {
                let ((first, second), (most, asked)) = (names(channels), told_apart(high.powi(2), asked, 3));
                format!(
                    "with gains <= {high:.3} the product {first} {second} is at most {most}, not {asked}; set the upper \
                     bound to {upper} or"
                )
            }
            (ConflictKind::AboveUpper { channels, asked, upper }, delay) => {
                let ((first, second), (most, asked)) = (names(channels), apart_ms(2.0 * high, asked));
                let of_delay = if delay == Quantity::SignedDelay { " of delay" } else { "" };
                format!(
                    "{first} and {second} give at most {most} ms{of_delay} together, not {asked}; set the upper bound to \
                     {upper} s or"
                )
            }
            (ConflictKind::BelowLower { channels, asked, lower }, Quantity::Gain(_)) => {
                let ((first, second), (least, asked)) = (names(channels), told_apart(low.powi(2), asked, 3));
                let lower = lower.unwrap_or(low);
                format!(
                    "with gains >= {low:.3} the product {first} {second} is at least {least}, not {asked}; set the lower \
                     bound to {lower} or"
                )
            }
            (ConflictKind::BelowLower { channels, asked, .. }, Quantity::Delay) => {
                let ((first, second), lead_ms) = (names(channels), telling(s_to_ms(-asked), 1));
                format!("{first} and {second} would have to give {lead_ms} ms of lead together, and a delay cannot;")
            }
            (ConflictKind::BelowLower { channels, asked, .. }, Quantity::SignedDelay) => {
                let ((first, second), (most, asked)) = (names(channels), apart_ms(-2.0 * low, -asked));
                format!("R_max lets {first} and {second} give {most} ms of lead together, not {asked}: {HELP}, or")
            }
            (ConflictKind::TooFarApart { greater, lesser, asked, upper, lower }, Quantity::Gain(_)) => {
                let ((greater, lesser), (most, asked)) = (names((greater, lesser)), told_apart(high / low, asked, 3));
                let lower = lower.unwrap_or(low);
                format!(
                    "with {greater} <= {high:.3} and {lesser} >= {low:.3} their ratio is at most {most}, not {asked}; set \
                     the upper bound to {upper}, or the lower bound to {lower}, or"
                )
            }
            (ConflictKind::TooFarApart { greater, lesser, asked, upper, .. }, Quantity::Delay) => {
                let ((greater, lesser), (most, asked)) = (names((greater, lesser)), apart_ms(high, asked));
                format!(
                    "{greater} cannot be {asked} ms above {lesser} with delays <= {most} ms; set the upper bound to {upper} s or"
                )
            }
            (ConflictKind::TooFarApart { greater, lesser, asked, upper, .. }, Quantity::SignedDelay) => {
                let ((greater, lesser), (most, asked)) = (names((greater, lesser)), apart_ms(high - low, asked));
                let (lead_ms, delay_ms) = (telling(s_to_ms(-low), 1), telling(s_to_ms(high), 1));
                format!(
                    "{greater} cannot be {asked} ms above {lesser}: with at most {lead_ms} ms of lead and {delay_ms} ms of delay a \
                     channel it is {most} ms; set the upper bound to {upper} s; {HELP}, or"
                )
            }
            (ConflictKind::Loop { .. } | ConflictKind::Unclear, _) => String::new(),
        }
    }
}

/// One held entry that stage 1 had to pull: it asks that `s_to - s_from` be at least `weight`, and gets less.
#[derive(Clone, Copy)]
struct Pull {
    from: usize,
    to: usize,
    weight: f64,
    pair: Pair,
}

impl Pull {
    /// The same entry asked the other way round: it is an equation.
    fn reversed(&self) -> Self {
        Self { from: self.to, to: self.from, weight: -self.weight, pair: self.pair }
    }
}

/// The smallest clash behind each entry that stage 1 missed by more than `tolerance`, with repeats.
///
/// Stage 1 is a least squares problem, so the misses are a flow: what pulls at a channel is passed on by another missed entry or
/// is stopped by an active bound. Every path of the flow from bound to bound, and every loop of it, is a set that
/// cannot hold, and every missed entry is on one (Farkas). Where a part of that set cannot hold by itself, that part is the
/// clash, and the entry's own miss is the compromise with it.
pub(crate) fn clashes(
    problem: &Problem,
    held: &Held,
    reached: &Reached,
    tolerance: f64,
    effort: &Effort<'_>,
) -> Result<Vec<(Pair, Conflict)>, SearchStopped> {
    let Some(point) = &reached.point else { return Ok(Vec::new()) };
    let flow = Flow::new(problem, held, reached, point);
    let missed = |pull: &&Pull| pull.weight - (point[pull.to] - point[pull.from]) > tolerance;
    let mut clashes = Vec::new();
    for pull in flow.pulls.iter().filter(missed) {
        // Three searches over every pull of every channel.
        effort.spend((flow.pulls.len() * flow.at_lower.len()) as u64 / 8);
        effort.check()?;
        clashes.extend(flow.smallest_through(pull).map(|clash| (pull.pair, clash)));
    }
    Ok(clashes)
}

struct Flow<'a> {
    problem: &'a Problem,
    inputs: usize,
    range: (f64, f64),
    pulls: Vec<Pull>,
    at_lower: Vec<bool>,
    at_upper: Vec<bool>,
}

impl<'a> Flow<'a> {
    fn new(problem: &'a Problem, held: &Held, reached: &Reached, point: &[f64]) -> Self {
        let nodes = held.inputs + held.outputs;
        let (inputs, range) = (held.inputs, held.range);
        let mut flow = Self { problem, inputs, range, pulls: Vec::new(), at_lower: vec![], at_upper: vec![] };
        let mut net = vec![0.0; nodes];
        for ((pair, delta), (_, target)) in held.entries.iter().zip(&reached.targets) {
            let (input, output) = (pair.input, held.inputs + pair.output);
            let missing = delta - target;
            // Below this a miss is the rounding of stage 1.
            if missing.abs() <= 1e-11 * (1.0 + delta.abs()) {
                continue;
            }
            let (from, to, weight) = if missing > 0.0 { (output, input, *delta) } else { (input, output, -delta) };
            net[from] -= missing.abs();
            net[to] += missing.abs();
            flow.pulls.push(Pull { from, to, weight, pair: *pair });
        }
        flow.at_lower = (0..nodes).map(|node| point[node] <= flow.ends(node).0 && net[node] < 0.0).collect();
        flow.at_upper = (0..nodes).map(|node| point[node] >= flow.ends(node).1 && net[node] > 0.0).collect();
        flow
    }

    /// The shorter of the shortest loop and the shortest path from bound to bound through `pull`; a bound counts like an entry.
    fn smallest_through(&self, pull: &Pull) -> Option<Conflict> {
        let around = self.shortest(pull.to, |node| node == pull.from, false);
        let onward = self.shortest(pull.to, |node| self.at_upper[node], false);
        let back = self.shortest(pull.from, |node| self.at_lower[node], true);
        let path = back.zip(onward).map(|(back, onward)| {
            let before = back.into_iter().rev();
            before.chain([*pull]).chain(onward).collect::<Vec<Pull>>()
        });
        match (around, path) {
            (Some(around), Some(path)) if around.len() < path.len() + 2 => Some(self.round(pull, around)),
            (_, Some(path)) => Some(self.smallest_part(&path, 0).unwrap_or_else(|| self.clash(&path))),
            (around, None) => Some(self.round(pull, around?)),
        }
    }

    fn round(&self, pull: &Pull, around: Vec<Pull>) -> Conflict {
        let pulls: Vec<Pull> = std::iter::once(*pull).chain(around).collect();
        if let Some(clash) = self.smallest_part(&pulls, pulls.len()) {
            return clash;
        }
        let Problem { quantity, bounds, .. } = *self.problem;
        let mismatch = quantity.difference(pulls.iter().map(|pull| pull.weight).sum(), self.problem.coordinate());
        let entries = pulls.iter().map(|pull| pull.pair).collect();
        Conflict { quantity, entries, bounds, kind: ConflictKind::Loop { mismatch } }
    }

    /// The shortest run of the pulls, less than all of them, that the bounds of its two ends do not allow. Runs may begin at the
    /// first `round` pulls and go on past the last into the first ones again.
    fn smallest_part(&self, pulls: &[Pull], round: usize) -> Option<Conflict> {
        let count = pulls.len();
        (1..count).find_map(|length| {
            let begins = if round > 0 { round } else { count - length + 1 };
            (0..begins).find_map(|begin| {
                let run: Vec<Pull> = (begin..begin + length).map(|index| pulls[index % count]).collect();
                let back: Vec<Pull> = run.iter().rev().map(Pull::reversed).collect();
                [run, back].iter().find(|run| self.is_impossible(run)).map(|run| self.clash(run))
            })
        })
    }

    /// Whether the run needs more than there is between the least value of its first node and the greatest of its last.
    fn is_impossible(&self, run: &[Pull]) -> bool {
        let (Some(first), Some(last)) = (run.first(), run.last()) else {
            return false;
        };
        let needed: f64 = run.iter().map(|pull| pull.weight).sum();
        needed - (self.ends(last.to).1 - self.ends(first.from).0) > STRAIN
    }

    /// Least and greatest value of a node: an output's is minus its channel's.
    fn ends(&self, node: usize) -> (f64, f64) {
        let (low, high) = self.range;
        if node < self.inputs { (low, high) } else { (-high, -low) }
    }

    /// The clash of a path from a node at its least value to one at its greatest.
    fn clash(&self, path: &[Pull]) -> Conflict {
        let needed: f64 = path.iter().map(|pull| pull.weight).sum();
        let (start, end) = (path.first().map_or(0, |pull| pull.from), path.last().map_or(0, |pull| pull.to));
        let (quantity, bounds, coordinate) = (self.problem.quantity, self.problem.bounds, self.problem.coordinate());
        let movable = |lower: f64| quantity.has_lower_bound().then(|| three_digits_down(lower));
        let kind = match (self.channel(start), self.channel(end)) {
            (first @ Channel::Output(_), last @ Channel::Input(_)) => ConflictKind::AboveUpper {
                channels: (last, first),
                asked: coordinate.value(needed),
                upper: three_digits_up(coordinate.value(0.5 * needed)),
            },
            (first @ Channel::Input(_), last @ Channel::Output(_)) => ConflictKind::BelowLower {
                channels: (first, last),
                asked: coordinate.value(-needed),
                lower: movable(coordinate.value(-0.5 * needed)),
            },
            (lesser @ Channel::Input(_), greater @ Channel::Input(_)) | (greater, lesser) => {
                let asked = coordinate.value(needed);
                let upper = three_digits_up(quantity.net(bounds.lower, asked));
                let lower = if quantity.is_gain() { bounds.upper / asked } else { bounds.upper - asked };
                ConflictKind::TooFarApart { greater, lesser, asked, upper, lower: movable(lower) }
            }
        };
        let mut entries: Vec<Pair> = path.iter().map(|pull| pull.pair).collect();
        entries.sort();
        Conflict { quantity, entries, bounds, kind }
    }

    fn channel(&self, node: usize) -> Channel {
        if node < self.inputs { Channel::Input(node) } else { Channel::Output(node - self.inputs) }
    }

    /// Fewest pulls from `start` along (or against) their direction to a node that `ends`, in the order walked.
    fn shortest(&self, start: usize, ends: impl Fn(usize) -> bool, against: bool) -> Option<Vec<Pull>> {
        let mut came_by: Vec<Option<Pull>> = vec![None; self.at_lower.len()];
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
                let (leaves, enters) = if against { (pull.to, pull.from) } else { (pull.from, pull.to) };
                if leaves == node && enters != start && came_by[enters].is_none() {
                    came_by[enters] = Some(*pull);
                    queue.push_back(enters);
                }
            }
        }
        None
    }
}
