//! Scalar results with error bars (M13): `G` and `D` are the gain and delay that a response needs,
//! `k` and `tau` those of a channel, `k_o k_i` the net gain of output `o` and input `i`.

use std::collections::BTreeMap;
use std::ops::Index;

use gdcm_model::dataset::Pair;

use crate::correction::Channel;

/// The values of a condition's scalars; `None` for a scalar that does not exist.
pub type Figures = ScalarTable<Option<f64>>;

/// A condition's scalar result, `q` in M13.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scalar {
    /// `ln G`.
    Gain(Pair),
    /// `D` \[s\] by eq. (9).
    Delay(Pair),
    /// `D` \[s\] from the line through the phase (M15.2).
    BandDelay(Pair),
    /// `ln k_o k_i`.
    NetGain(Pair),
    /// `ln k`.
    ChannelGain(Channel),
    /// `tau` \[s\].
    ChannelDelay(Channel),
}

impl Scalar {
    /// Returns whether the scalar is a time \[s\]; otherwise it is a gain's natural logarithm.
    pub fn is_delay(self) -> bool {
        matches!(
            self,
            Self::Delay(_) | Self::BandDelay(_) | Self::ChannelDelay(_)
        )
    }
}

/// An entry for each of a condition's scalars.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarTable<T>(BTreeMap<Scalar, T>);

impl<T> ScalarTable<T> {
    /// Builds a table from the entry for each scalar, for `outputs` x `inputs` responses.
    pub fn from_fn(outputs: usize, inputs: usize, mut entry: impl FnMut(Scalar) -> T) -> Self {
        Self(
            scalars(outputs, inputs)
                .into_iter()
                .map(|scalar| (scalar, entry(scalar)))
                .collect(),
        )
    }

    /// Iterates over the scalars with their entries.
    pub fn iter(&self) -> impl Iterator<Item = (Scalar, &T)> {
        self.0.iter().map(|(scalar, entry)| (*scalar, entry))
    }

    /// Builds a table from this table's entries.
    pub fn map<U>(&self, mut entry: impl FnMut(Scalar, &T) -> U) -> ScalarTable<U> {
        ScalarTable(
            self.iter()
                .map(|(scalar, value)| (scalar, entry(scalar, value)))
                .collect(),
        )
    }
}

impl<T> Index<Scalar> for ScalarTable<T> {
    type Output = T;

    fn index(&self, scalar: Scalar) -> &T {
        &self.0[&scalar]
    }
}

/// Lists all scalars: first for the responses, then for the channels.
fn scalars(outputs: usize, inputs: usize) -> Vec<Scalar> {
    let of_response = [
        Scalar::Gain,
        Scalar::Delay,
        Scalar::BandDelay,
        Scalar::NetGain,
    ];
    let of_channel = [Scalar::ChannelGain, Scalar::ChannelDelay];
    let mut scalars = Vec::new();
    for scalar in of_response {
        for output in 0..outputs {
            scalars.extend((0..inputs).map(|input| scalar(Pair::new(output, input))));
        }
    }
    for scalar in of_channel {
        scalars.extend(Channel::inputs_then_outputs(inputs, outputs).map(scalar));
    }
    scalars
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scalar_has_its_own_entry() {
        let table = ScalarTable::from_fn(3, 2, |scalar| scalar);
        for (scalar, entry) in table.iter() {
            assert_eq!((*entry, table[scalar]), (scalar, scalar));
        }
        assert_eq!(table.iter().count(), 4 * 6 + 2 * 5);
    }
}
