//! What the engineer should know of an identified model, and what can be done about it (M14, section 10).

use super::{Caution, Signal, TRUSTED_COHERENCE, ValidationError};
use std::fmt;

/// Something that speaks against the model or a part of it, with what an action against it needs.
#[derive(Clone, Debug, PartialEq)]
pub enum IdentificationCaution {
    /// Something in the records themselves.
    Records(Caution),
    /// An input was not moved, or only together with others.
    NotSwept {
        /// The input.
        signal: Signal,
        /// Median partial coherence with the output that it moves most.
        partial_coherence: f64,
    },
    /// Inputs were moved together.
    MovedTogether {
        /// Median condition number of their spectral matrix.
        condition: f64,
    },
    /// An end of the band shows nothing: no input moves any output there.
    BandNotShown {
        /// The band asked for \[rad/s\].
        band: [f64; 2],
        /// The part of it that is shown \[rad/s\].
        shown: [f64; 2],
    },
    /// An output vibrates above the band, so that the projections were filtered lower.
    Vibration {
        /// The output.
        signal: Signal,
        /// Share of its variance above the cut-off \[%\].
        percent: f64,
        /// Cut-off \[rad/s\].
        cut_off: f64,
    },
    /// The model leaves much of all records.
    Inadequate {
        /// Cost per degree of freedom; 1 is adequate.
        cost: f64,
        /// Name of the record with most of it.
        record: String,
        /// The output with most of it.
        signal: Signal,
    },
    /// The model leaves much of one record.
    UnlikeRecord {
        /// Which record, counted from 0.
        record: usize,
        /// Its name.
        name: String,
        /// Its cost per degree of freedom; 1 is adequate.
        cost: f64,
    },
    /// Without one record the model is another.
    DecisiveRecord {
        /// Which record, counted from 0.
        record: usize,
        /// Its name.
        name: String,
        /// How much farther the model without it is than those without another (`J` over the median).
        ratio: f64,
    },
    /// A channel seems to be logged late in one record.
    Late {
        /// Which record, counted from 0.
        record: usize,
        /// Its name.
        name: String,
        /// The channel.
        signal: Signal,
        /// How late \[s\]; negative when it is early.
        delay_s: f64,
    },
    /// The criterion still falls at the highest order tried.
    OrderLimit {
        /// The highest order.
        order: usize,
        /// The band that is offered in place of this one \[rad/s\].
        narrower: [f64; 2],
    },
    /// The model fits what was held out less well than what it was fitted to.
    HeldOut {
        /// Cost per degree of freedom on the held-out records over that of the fit.
        ratio: f64,
    },
    /// The records weigh differently because their turbulence does.
    Reweighed {
        /// Greatest over least cost per degree of freedom before.
        ratio: f64,
    },
    /// The held-out records cannot be compared with the model in time.
    NotValidated {
        /// Why.
        why: ValidationError,
    },
    /// Responses that are not identified.
    PairsNotIdentified {
        /// Output and input of each.
        pairs: Vec<[Signal; 2]>,
    },
}

impl fmt::Display for IdentificationCaution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Records(caution) => caution.fmt(f),
            Self::NotSwept { signal, partial_coherence } => {
                write!(
                    f,
                    "{signal} was not swept, or only with another input (partial coherence {partial_coherence:.2}): "
                )?;
                f.write_str("its column is not identified")
            }
            Self::MovedTogether { condition } => {
                write!(f, "the inputs were not moved independently (condition number {condition:.0}): ")?;
                f.write_str("sweep them one after another")
            }
            Self::BandNotShown { band, shown } => {
                let above = (shown[1] < band[1]).then(|| format!("above {:.1} rad/s", shown[1]));
                let below = (shown[0] > band[0]).then(|| format!("below {:.2} rad/s", shown[0]));
                let places: Vec<String> = below.into_iter().chain(above).collect();
                write!(f, "{} no input moves any output enough to be seen ", places.join(" and "))?;
                write!(
                    f,
                    "(partial coherence below {TRUSTED_COHERENCE}): the models are guesses there. Narrow the band"
                )
            }
            Self::Vibration { signal, percent, cut_off } => {
                write!(
                    f,
                    "{percent:.0} % of {signal} is vibration above the band: CT-PBSID was run below {cut_off:.0} rad/s"
                )
            }
            Self::Inadequate { cost, record, signal } => {
                write!(
                    f,
                    "the model leaves {cost:.1} times what noise explains, most of it in {record} and in {signal}: "
                )?;
                f.write_str("non-linear, wrongly aligned in time, or a missing input")
            }
            Self::UnlikeRecord { name, cost, .. } => {
                write!(f, "{name} is unlike the others: the model leaves {cost:.1} times what noise explains. ")?;
                f.write_str("Another trim, a large amplitude or a gust: it can be left out")
            }
            Self::DecisiveRecord { name, ratio, .. } => {
                write!(
                    f,
                    "without {name} the model changes {ratio:.0} times more than without another record: look at it, "
                )?;
                f.write_str("or leave it out")
            }
            Self::Late { name, signal, delay_s, .. } => {
                let (size, how) = (1e3 * delay_s.abs(), if *delay_s < 0.0 { "early" } else { "late" });
                write!(f, "{name}: {signal} seems to be logged {size:.0} ms {how}. That delay can be taken out")
            }
            Self::OrderLimit { order, narrower } => {
                write!(
                    f,
                    "a higher order than {order} would fit still better: there is more in the band than that many "
                )?;
                write!(f, "states. Narrow the band, say to {:.1} rad/s", narrower[1])
            }
            Self::HeldOut { ratio } => {
                write!(f, "what was held out fits {ratio:.2} times less well than the records of the fit: ")?;
                f.write_str("the model may be fitted to their noise, or the aircraft was flown differently")
            }
            Self::Reweighed { ratio } => {
                write!(f, "the records are unlike in noise (by {ratio:.1}): they were weighed accordingly")
            }
            Self::NotValidated { why } => {
                write!(f, "the model was not compared with the held-out records in time: {why}")
            }
            Self::PairsNotIdentified { pairs } => {
                let names: Vec<_> = pairs.iter().map(|[output, input]| format!("{input} to {output}")).collect();
                let (last, most) = names.split_last().map_or(("", &[][..]), |(last, most)| (last.as_str(), most));
                let verb = if most.is_empty() { "is" } else { "are" };
                let and = if most.is_empty() { "" } else { " and " };
                write!(f, "{}{and}{last} {verb} not identified: one standard deviation is over 3 dB", most.join(", "))
            }
        }
    }
}
