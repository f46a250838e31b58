//! Channels whose models are turned: one side counts them positive the other way round. Their models are turned where the study takes
//! them, so that nothing else has to know of it.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::correction::Channel;
use crate::dataset::{
    BundleKind, ChannelSide, Condition, Dataset, Dynamics, MeasuredResponse, Model, Pair, StateSpace,
};

use super::{EditRefusal, Study};

/// Whose models of a channel are turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SignRole {
    /// Those of the identified bundles.
    Identified,
    /// Those of the physics bundles.
    Physics,
    /// All.
    All,
}

impl SignRole {
    /// Every role.
    pub const EACH: [Self; 3] = [Self::Identified, Self::Physics, Self::All];

    /// Its word in files and options.
    pub fn word(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Physics => "physics",
            Self::All => "all",
        }
    }

    /// The models, in words.
    pub fn models(self) -> &'static str {
        match self {
            Self::Identified => "the identified models",
            Self::Physics => "the physics models",
            Self::All => "all models",
        }
    }

    /// Whether the models of a bundle are turned.
    pub fn covers(self, kind: BundleKind) -> bool {
        matches!((self, kind), (Self::All, _) | (Self::Physics, BundleKind::Physics))
            || (self, kind) == (Self::Identified, BundleKind::Identified)
    }
}

/// The channels that are turned.
pub type Signs = BTreeMap<Channel, SignRole>;

/// A turned channel as files say it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TurnedChannel {
    /// Its name.
    pub channel: String,
    /// Whether it is an input or an output.
    pub side: ChannelSide,
    /// Whose models are turned.
    pub of: SignRole,
}

impl TurnedChannel {
    /// The channel in a dataset, where it has it.
    pub fn find(&self, dataset: &Dataset) -> Option<Channel> {
        let (channels, of): (_, fn(usize) -> Channel) = match self.side {
            ChannelSide::Input => (dataset.inputs(), Channel::Input),
            ChannelSide::Output => (dataset.outputs(), Channel::Output),
        };
        channels.iter().position(|channel| channel.name == self.channel).map(of)
    }
}

impl Study {
    /// The channels that are turned, by their names.
    pub fn turned_channels(&self) -> Vec<TurnedChannel> {
        let (inputs, outputs) = self.dataset.names_of_channels();
        let turned = |(channel, of): (&Channel, &SignRole)| TurnedChannel {
            channel: channel.name(&inputs, &outputs),
            side: if matches!(channel, Channel::Input(_)) { ChannelSide::Input } else { ChannelSide::Output },
            of: *of,
        };
        self.signs.iter().map(turned).collect()
    }
}

/// The dataset with the models of these channels turned: of an output its rows of C and D, of an input its columns of B and D, of
/// measured responses all of the channel.
pub(super) fn turned(dataset: &Arc<Dataset>, signs: &Signs) -> Result<Arc<Dataset>, EditRefusal> {
    let mut turned = Arc::clone(dataset);
    for condition in dataset.conditions().iter().filter(|_| !signs.is_empty()) {
        let refused = |why: String| EditRefusal::Models { condition: condition.id(), why };
        let models = turned_condition(condition, signs).map_err(refused)?;
        turned = Arc::new(turned.with_condition(models).map_err(|error| refused(error.to_string()))?);
    }
    Ok(turned)
}

fn turned_condition(condition: &Condition, signs: &Signs) -> Result<Condition, String> {
    let bundle = |kind| -> Result<Vec<Model>, String> {
        let sign = |channel: Channel| {
            if signs.get(&channel).is_some_and(|role| role.covers(kind)) { -1.0 } else { 1.0 }
        };
        let models = condition.bundle(kind).iter();
        models.map(|model| Ok(Model { dynamics: turned_dynamics(&model.dynamics, sign)?, ..model.clone() })).collect()
    };
    let (physics, identified) = (bundle(BundleKind::Physics)?, bundle(BundleKind::Identified)?);
    let turned = Condition::new(condition.flight_state().clone(), physics, identified);
    turned.and_then(|turned| turned.with_records(condition.records().to_vec())).map_err(|error| error.to_string())
}

fn turned_dynamics(dynamics: &Dynamics, sign: impl Fn(Channel) -> f64) -> Result<Dynamics, String> {
    match dynamics {
        Dynamics::StateSpace(model) => {
            let (mut b, mut c, mut d) = (model.b().clone(), model.c().clone(), model.d().clone());
            for input in 0..model.inputs() {
                b.column_mut(input).scale_mut(sign(Channel::Input(input)));
                d.column_mut(input).scale_mut(sign(Channel::Input(input)));
            }
            for output in 0..model.outputs() {
                c.row_mut(output).scale_mut(sign(Channel::Output(output)));
                d.row_mut(output).scale_mut(sign(Channel::Output(output)));
            }
            let turned = StateSpace::new(model.a().clone(), b, c, d).map_err(|error| error.to_string())?;
            Ok(Dynamics::StateSpace(turned.timed(model.timing().clone()).map_err(|error| error.to_string())?))
        }
        Dynamics::Measured(response) => {
            let sign = |pair: Pair| Channel::of(pair).into_iter().map(&sign).product::<f64>();
            let values = response.values();
            let re = values.map(|pair, values| values.iter().map(|value| sign(pair) * value.re).collect());
            let im = values.map(|pair, values| values.iter().map(|value| sign(pair) * value.im).collect());
            let turned = MeasuredResponse::new(response.omega().to_vec(), &re, &im, response.coherence().cloned());
            let turned = turned.map_err(|error| error.to_string())?.with_estimate(response.estimate());
            Ok(Dynamics::Measured(match response.valid_bands() {
                Some(bands) => turned.with_valid_bands(bands.clone()).map_err(|error| error.to_string())?,
                None => turned,
            }))
        }
    }
}
