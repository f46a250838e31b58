//! Channels with reversed sign, and datasets with the reversal applied: bundles of different origin
//! may count a channel with opposite signs.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_method::correction::Channel;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::measured_response::{MeasuredResponse, MeasuredResponseError};
use gdcm_model::dataset::state_space::StateSpaceError;
use gdcm_model::dataset::{BundleKind, Condition, Dataset, Dynamics, Model, Pair, StateSpace};

use super::edit_refusal::EditRefusal;

/// The models in which a channel's sign is reversed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SignRole {
    /// Models in the identified bundles.
    Identified,
    /// Models in the physics bundles.
    Physics,
    All,
}

impl SignRole {
    pub const EACH: [Self; 3] = [Self::Identified, Self::Physics, Self::All];

    /// Returns the word used in files and command-line options.
    pub fn word(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Physics => "physics",
            Self::All => "all",
        }
    }

    /// Returns the models in words, for sentences: "the identified models".
    pub fn models(self) -> &'static str {
        match self {
            Self::Identified => "the identified models",
            Self::Physics => "the physics models",
            Self::All => "all models",
        }
    }

    /// Returns whether the sign is reversed in a bundle's models.
    pub fn covers(self, kind: BundleKind) -> bool {
        self == Self::All || self == kind.pick(Self::Physics, Self::Identified)
    }
}

/// Channels with reversed sign, with the models in which it is reversed.
pub type Signs = BTreeMap<Channel, SignRole>;

/// A channel with reversed sign, as stored in files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ReversedChannel {
    pub channel: String,
    pub side: ChannelSide,
    /// The models in which the sign is reversed.
    #[serde(rename = "of")]
    pub role: SignRole,
}

impl ReversedChannel {
    /// Returns the channel in a dataset; `None` where it does not exist.
    pub fn find(&self, dataset: &Dataset) -> Option<Channel> {
        let channels = match self.side {
            ChannelSide::Input => dataset.inputs(),
            ChannelSide::Output => dataset.outputs(),
        };
        let index = channels
            .iter()
            .position(|channel| channel.name == self.channel)?;
        Some(match self.side {
            ChannelSide::Input => Channel::Input(index),
            ChannelSide::Output => Channel::Output(index),
        })
    }
}

/// Returns the dataset with these channels' signs reversed: rows of C and D for an output, columns
/// of B and D for an input; for measured responses, all responses of the channel.
pub(crate) fn with_reversed_signs(
    dataset: &Arc<Dataset>,
    signs: &Signs,
) -> Result<Arc<Dataset>, EditRefusal> {
    let mut reversed = Arc::clone(dataset);
    if signs.is_empty() {
        return Ok(reversed);
    }
    for condition in dataset.conditions() {
        let refused = |why: String| EditRefusal::Models {
            condition: condition.id(),
            why,
        };
        let condition = reversed_condition(condition, signs).map_err(refused)?;
        let dataset = reversed.with_condition(condition);
        reversed = Arc::new(dataset.map_err(|error| refused(error.to_string()))?);
    }
    Ok(reversed)
}

/// Reverses the signs in both bundles, and in the *moved* models: physics models linearised again
/// with a changed physics parameter.
fn reversed_condition(condition: &Condition, signs: &Signs) -> Result<Condition, String> {
    let physics = reversed_models(condition, BundleKind::Physics, signs)?;
    let identified = reversed_models(condition, BundleKind::Identified, signs)?;
    let mut moved = condition.moved_models().to_vec();
    let physics_signs = BundleSigns {
        signs,
        kind: BundleKind::Physics,
    };
    for moved in &mut moved {
        moved.model.dynamics = physics_signs.applied_to(&moved.model.dynamics)?;
    }
    let state = condition.flight_state().clone();
    let reversed = Condition::new(state, physics, identified).map_err(|error| error.to_string())?;
    reversed
        .with_records(condition.records().to_vec())
        .and_then(|reversed| reversed.with_moved_models(moved))
        .map_err(|error| error.to_string())
}

fn reversed_models(
    condition: &Condition,
    kind: BundleKind,
    signs: &Signs,
) -> Result<Vec<Model>, String> {
    let signs = BundleSigns { signs, kind };
    let mut models = Vec::new();
    for model in condition.bundle(kind) {
        models.push(Model {
            dynamics: signs.applied_to(&model.dynamics)?,
            ..model.clone()
        });
    }
    Ok(models)
}

/// Channel signs in a bundle's models.
struct BundleSigns<'a> {
    signs: &'a Signs,
    kind: BundleKind,
}

impl BundleSigns<'_> {
    /// Returns -1 for a channel with reversed sign, otherwise 1.
    fn sign(&self, channel: Channel) -> f64 {
        match self.signs.get(&channel) {
            Some(role) if role.covers(self.kind) => -1.0,
            _ => 1.0,
        }
    }

    /// Returns the product of the two channel signs in a response.
    fn pair_sign(&self, pair: Pair) -> f64 {
        let [output, input] = Channel::of_pair(pair);
        self.sign(output) * self.sign(input)
    }

    fn applied_to(&self, dynamics: &Dynamics) -> Result<Dynamics, String> {
        match dynamics {
            Dynamics::StateSpace(model) => {
                let reversed = self.reversed_state_space(model);
                reversed
                    .map(Dynamics::StateSpace)
                    .map_err(|error| error.to_string())
            }
            Dynamics::Measured(response) => {
                let reversed = self.reversed_response(response);
                reversed
                    .map(Dynamics::Measured)
                    .map_err(|error| error.to_string())
            }
        }
    }

    fn reversed_state_space(&self, model: &StateSpace) -> Result<StateSpace, StateSpaceError> {
        let mut b = model.b().clone();
        let mut c = model.c().clone();
        let mut d = model.d().clone();
        for input in 0..model.inputs() {
            let sign = self.sign(Channel::Input(input));
            b.column_mut(input).scale_mut(sign);
            d.column_mut(input).scale_mut(sign);
        }
        for output in 0..model.outputs() {
            let sign = self.sign(Channel::Output(output));
            c.row_mut(output).scale_mut(sign);
            d.row_mut(output).scale_mut(sign);
        }
        StateSpace::new(model.a().clone(), b, c, d)?.timed(model.timing().clone())
    }

    fn reversed_response(
        &self,
        response: &MeasuredResponse,
    ) -> Result<MeasuredResponse, MeasuredResponseError> {
        let values = response.values();
        let re = values.map(|pair, values| {
            let sign = self.pair_sign(pair);
            values.iter().map(|value| sign * value.re).collect()
        });
        let im = values.map(|pair, values| {
            let sign = self.pair_sign(pair);
            values.iter().map(|value| sign * value.im).collect()
        });
        let reversed = MeasuredResponse::new(
            response.omega().to_vec(),
            &re,
            &im,
            response.coherence().cloned(),
        )?;
        let reversed = reversed.with_estimate(response.estimate())?;
        match response.valid_bands() {
            Some(bands) => reversed.with_valid_bands(bands.clone()),
            None => Ok(reversed),
        }
    }
}
