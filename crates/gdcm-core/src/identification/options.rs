//! What an identification is asked for.

use super::{Preparation, Role, Signal};

/// The band, the channels, which records are held out, and what is tried. The defaults are those of M14, section 9: fixed on
/// five conditions of the example, and right on the other six, on fresh noise and on half the data.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Lower and upper end of the band \[rad/s\].
    pub band: [f64; 2],
    /// The channels, and how they are prepared.
    pub preparation: Preparation,
    /// Records that no model is fitted to, counted from 0: they judge the model.
    pub held_out: Vec<usize>,
    /// Orders that are tried.
    pub orders: Vec<usize>,
    /// Laguerre poles over the upper end of the band.
    pub poles: Vec<f64>,
    /// Past windows: Laguerre projections that predict the next.
    pub pasts: Vec<usize>,
}

impl Options {
    /// The defaults for a band \[rad/s\] and channels.
    #[must_use]
    pub fn new(band: [f64; 2], preparation: Preparation) -> Self {
        Self {
            band,
            preparation,
            held_out: Vec::new(),
            orders: (8..=24).step_by(2).collect(),
            poles: vec![0.375, 0.54, 0.75],
            pasts: vec![8, 10, 12, 16],
        }
    }

    /// A channel by its place, with its name.
    pub(super) fn signal(&self, role: Role, index: usize) -> Signal {
        let channels = if role == Role::Input { &self.preparation.inputs } else { &self.preparation.outputs };
        Signal { role, index, name: channels.get(index).map_or_else(String::new, |channel| channel.name.clone()) }
    }

    /// Lowest line used \[rad/s\]: half the lower end of the band.
    pub(super) fn lowest(&self) -> f64 {
        0.5 * self.band[0]
    }

    /// Highest line used \[rad/s\]: 4/3 of the upper end of the band.
    pub(super) fn highest(&self) -> f64 {
        4.0 / 3.0 * self.band[1]
    }
}
