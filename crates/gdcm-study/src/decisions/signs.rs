//! Channels with reversed sign, and datasets with the reversal applied.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_method::correction::Channel;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::{BundleKind, Condition, Dataset, Dynamics, Model, Pair, StateSpace};

use super::edit_refusal::EditRefusal;

/// The models whose sign of a channel is reversed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SignRole {
    /// The models of the identified bundles.
    Identified,
    /// The models of the physics bundles.
    Physics,
    All,
}

impl SignRole {
    /// Every role.
    pub const EACH: [Self; 3] = [Self::Identified, Self::Physics, Self::All];

    /// Returns the word in files and options.
    pub fn word(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Physics => "physics",
            Self::All => "all",
        }
    }

    /// Returns the models in words.
    pub fn models(self) -> &'static str {
        match self {
            Self::Identified => "the identified models",
            Self::Physics => "the physics models",
            Self::All => "all models",
        }
    }

    /// Returns whether the sign is reversed in the models of a bundle.
    pub fn covers(self, kind: BundleKind) -> bool {
        self == Self::All || self == kind.pick(Self::Physics, Self::Identified)
    }
}

/// The channels with reversed sign.
pub type Signs = BTreeMap<Channel, SignRole>;

/// A channel with reversed sign, as stored in files.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TurnedChannel {
    pub channel: String,
    pub side: ChannelSide,
    pub of: SignRole,
}

impl TurnedChannel {
    /// Returns the channel in a dataset, where it exists.
    pub fn find(&self, dataset: &Dataset) -> Option<Channel> {
        let (channels, of): (_, fn(usize) -> Channel) = match self.side {
            ChannelSide::Input => (dataset.inputs(), Channel::Input),
            ChannelSide::Output => (dataset.outputs(), Channel::Output),
        };
        channels
            .iter()
            .position(|channel| channel.name == self.channel)
            .map(of)
    }
}

/// Returns the dataset with the signs of these channels reversed: for an output its rows of C and
/// D, for an input its columns of B and D, for measured responses every response of the channel.
pub(crate) fn turned(dataset: &Arc<Dataset>, signs: &Signs) -> Result<Arc<Dataset>, EditRefusal> {
    let mut turned = Arc::clone(dataset);
    for condition in dataset.conditions().iter().filter(|_| !signs.is_empty()) {
        let refused = |why: String| EditRefusal::Models {
            condition: condition.id(),
            why,
        };
        let models = turned_condition(condition, signs).map_err(refused)?;
        turned = Arc::new(
            turned
                .with_condition(models)
                .map_err(|error| refused(error.to_string()))?,
        );
    }
    Ok(turned)
}

fn turned_condition(condition: &Condition, signs: &Signs) -> Result<Condition, String> {
    let bundle = |kind| -> Result<Vec<Model>, String> {
        let sign = |channel: Channel| {
            if signs.get(&channel).is_some_and(|role| role.covers(kind)) {
                -1.0
            } else {
                1.0
            }
        };
        let models = condition.bundle(kind).iter();
        models
            .map(|model| {
                Ok(Model {
                    dynamics: turned_dynamics(&model.dynamics, sign)?,
                    ..model.clone()
                })
            })
            .collect()
    };
    let physics = bundle(BundleKind::Physics)?;
    let identified = bundle(BundleKind::Identified)?;
    let turned = Condition::new(condition.flight_state().clone(), physics, identified);
    turned
        .and_then(|turned| turned.with_records(condition.records().to_vec()))
        .map_err(|error| error.to_string())
}

fn turned_dynamics(dynamics: &Dynamics, sign: impl Fn(Channel) -> f64) -> Result<Dynamics, String> {
    match dynamics {
        Dynamics::StateSpace(model) => {
            let mut b = model.b().clone();
            let mut c = model.c().clone();
            let mut d = model.d().clone();
            for input in 0..model.inputs() {
                b.column_mut(input).scale_mut(sign(Channel::Input(input)));
                d.column_mut(input).scale_mut(sign(Channel::Input(input)));
            }
            for output in 0..model.outputs() {
                c.row_mut(output).scale_mut(sign(Channel::Output(output)));
                d.row_mut(output).scale_mut(sign(Channel::Output(output)));
            }
            let turned =
                StateSpace::new(model.a().clone(), b, c, d).map_err(|error| error.to_string())?;
            Ok(Dynamics::StateSpace(
                turned
                    .timed(model.timing().clone())
                    .map_err(|error| error.to_string())?,
            ))
        }
        Dynamics::Measured(response) => {
            let sign = |pair: Pair| Channel::of(pair).into_iter().map(&sign).product::<f64>();
            let values = response.values();
            let re = values
                .map(|pair, values| values.iter().map(|value| sign(pair) * value.re).collect());
            let im = values
                .map(|pair, values| values.iter().map(|value| sign(pair) * value.im).collect());
            let turned = MeasuredResponse::new(
                response.omega().to_vec(),
                &re,
                &im,
                response.coherence().cloned(),
            );
            let turned = turned.and_then(|turned| turned.with_estimate(response.estimate()));
            let turned = turned.map_err(|error| error.to_string())?;
            Ok(Dynamics::Measured(match response.valid_bands() {
                Some(bands) => turned
                    .with_valid_bands(bands.clone())
                    .map_err(|error| error.to_string())?,
                None => turned,
            }))
        }
    }
}
