//! How the normal equations order the unknowns (M16.2): the entries of the input mixing `M`, whose
//! diagonal may be a polynomial in the scaled airspeed, and of the feedback `K` from outputs to
//! inputs. A *fed-back* output is one with a column in `K`.

use super::unknown::Unknown;

/// The unknowns in equation order: first the unknowns in `M`, by input column, then the unknowns in
/// `K`.
pub(super) struct UnknownLayout {
    /// The unknowns `M_ji` by input column i: those that occur only in the equations for input i.
    pub(super) mixing: Vec<Vec<MixingUnknown>>,
    pub(super) feedback: Vec<FeedbackUnknown>,
}

/// A coefficient in `M_ji`, the share that input j receives from input i.
pub(super) struct MixingUnknown {
    /// Index among the unknowns.
    pub(super) index: usize,
    /// The input j.
    pub(super) to: usize,
    /// Power of the scaled airspeed; 0 off the diagonal.
    pub(super) power: i32,
}

/// An entry `K_jo`, the feedback from output o to input j.
pub(super) struct FeedbackUnknown {
    /// Index among the unknowns.
    pub(super) index: usize,
    /// The input j.
    pub(super) input: usize,
    /// The output o's index among the fed-back outputs.
    pub(super) fed_back: usize,
}

impl UnknownLayout {
    /// Sorts the unknowns for `inputs` inputs; `fed_back` are the outputs with a column in `K`.
    pub(super) fn new(unknowns: &[Unknown], inputs: usize, fed_back: &[usize]) -> Self {
        let mut layout = Self {
            mixing: (0..inputs).map(|_| Vec::new()).collect(),
            feedback: Vec::new(),
        };
        for (index, unknown) in unknowns.iter().enumerate() {
            match *unknown {
                Unknown::Mixing { to, from, power } => layout.mixing[from].push(MixingUnknown {
                    index,
                    to,
                    power: power as i32,
                }),
                Unknown::Feedback { input, output } => {
                    let position = fed_back.iter().position(|&known| known == output);
                    if let Some(fed_back) = position {
                        layout.feedback.push(FeedbackUnknown {
                            index,
                            input,
                            fed_back,
                        });
                    }
                }
            }
        }
        layout
    }
}
