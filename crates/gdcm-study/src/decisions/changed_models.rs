//! Models of a study that differ from those in its dataset's file: identified models adopted into a
//! condition, and channels with reversed sign. The study applies the changes when it adopts the
//! models, so that no other code depends on them.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use gdcm_method::correction::Channel;
use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::condition::{ConditionError, ConditionRecord};
use gdcm_model::dataset::measured_response::MeasuredResponse;
use gdcm_model::dataset::model::Origin;
use gdcm_model::dataset::{
    BundleKind, Condition, ConditionId, Dataset, Dynamics, Model, Pair, StateSpace,
};
use gdcm_sysid::identification::Identification;

use super::edit::EditRefusal;
use super::study::{BundleChoice, Study};

/// Selection of the models of an identification.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OfferedModels {
    /// The refined model, its neighbours in order, and the models without each record (M14, section
    /// 5).
    pub refined: bool,
    /// CT-PBSID without refinement.
    pub unrefined: bool,
    /// The measured response itself, with its coherence (M4a).
    pub measured: bool,
}

impl OfferedModels {
    /// The bundle that M14 passes to M5.
    pub const REFINED: Self = Self {
        refined: true,
        unrefined: false,
        measured: false,
    };
    /// The bundle that M14 passes to M5, and CT-PBSID without refinement.
    pub const WITH_UNREFINED: Self = Self {
        refined: true,
        unrefined: true,
        measured: false,
    };
    /// The measured response alone.
    pub const MEASURED: Self = Self {
        refined: false,
        unrefined: false,
        measured: true,
    };
}

/// Models identified from flight records, and the records.
#[derive(Clone, Debug, PartialEq)]
pub struct AdoptedModels {
    pub models: Vec<Model>,
    pub records: Vec<ConditionRecord>,
}

impl AdoptedModels {
    /// Returns the selectable models of an identification of `records`, the recommended model
    /// first.
    pub fn of(
        found: &Identification,
        offered: OfferedModels,
        records: Vec<ConditionRecord>,
    ) -> Self {
        let mut models = Vec::new();
        if offered.refined {
            models.extend(
                std::iter::once(&found.refined)
                    .chain(&found.bundle)
                    .cloned(),
            );
        }
        if offered.unrefined {
            models.push(found.unrefined.clone());
        }
        if let Some(response) = found.measured.measured().filter(|_| offered.measured) {
            let method = Some("local polynomial method".to_owned());
            let origin = Origin::Identified {
                method,
                order: None,
            };
            let source = found.unrefined.source.clone();
            models.push(Model {
                source,
                ..Model::new("measured", origin, Dynamics::Measured(response))
            });
        }
        Self { models, records }
    }

    /// Returns the dataset with these models as the identified bundle of a condition, and these
    /// records added to the condition's.
    ///
    /// # Errors
    /// [`EditRefusal::NoCondition`], and [`EditRefusal::Models`] where the models do not fit the
    /// condition.
    pub fn put_into(&self, dataset: &Dataset, id: ConditionId) -> Result<Dataset, EditRefusal> {
        let before = dataset
            .condition(id)
            .ok_or(EditRefusal::NoCondition { condition: id })?;
        let refused = |why: String| EditRefusal::Models { condition: id, why };
        // A condition without identified models is valid, but an empty set of models replaces
        // nothing.
        if self.models.is_empty() {
            let error = ConditionError::EmptyBundle(BundleKind::Identified);
            return Err(refused(error.to_string()));
        }
        let condition = before.with_identified(self.models.clone(), self.records.clone());
        let condition = condition.map_err(|error| refused(error.to_string()))?;
        dataset
            .with_condition(condition)
            .map_err(|error| refused(error.to_string()))
    }
}

impl Study {
    /// Returns the dataset of the file, without adopted models and reversed signs.
    pub fn file_dataset(&self) -> &Arc<Dataset> {
        self.file.as_ref().unwrap_or(&self.dataset)
    }

    /// Returns the models adopted instead of those of the file, condition by condition.
    pub fn taken_models(&self) -> impl Iterator<Item = (ConditionId, &Arc<AdoptedModels>)> {
        self.taken.iter().map(|(id, models)| (*id, models))
    }

    /// Adopts models into all of these conditions, or into none. Decisions about removed models are
    /// dropped.
    pub(crate) fn take_models(
        &mut self,
        taken: &[(ConditionId, Arc<AdoptedModels>)],
    ) -> Result<(), EditRefusal> {
        let mut models = self.taken.clone();
        models.extend(taken.iter().cloned());
        self.rebuild(models, self.signs.clone())
    }

    /// Restores the models of the file in a condition.
    pub(crate) fn return_models(&mut self, condition: ConditionId) -> Result<(), EditRefusal> {
        let mut models = self.taken.clone();
        models.remove(&condition);
        self.rebuild(models, self.signs.clone())
    }

    /// Reverses the sign of a channel's models, or restores it.
    pub(crate) fn set_sign(
        &mut self,
        channel: Channel,
        of: Option<SignRole>,
    ) -> Result<(), EditRefusal> {
        if !Channel::all_of(&self.dataset).any(|known| known == channel) {
            return Err(EditRefusal::NoChannel { channel });
        }
        let mut signs = self.signs.clone();
        signs.remove(&channel);
        signs.extend(of.map(|of| (channel, of)));
        self.rebuild(self.taken.clone(), signs)
    }

    /// Returns the dataset of the file with these models in its conditions, then with reversed
    /// signs.
    fn rebuild(
        &mut self,
        models: BTreeMap<ConditionId, Arc<AdoptedModels>>,
        signs: Signs,
    ) -> Result<(), EditRefusal> {
        let file = Arc::clone(self.file_dataset());
        let mut dataset = Arc::clone(&file);
        for (id, taken) in &models {
            dataset = Arc::new(taken.put_into(&dataset, *id)?);
        }
        self.dataset = turned(&dataset, &signs)?;
        self.file = (!models.is_empty() || !signs.is_empty()).then_some(file);
        (self.taken, self.signs) = (models, signs);
        self.forget_absent_models();
        Ok(())
    }

    /// Drops decisions about identified models that the dataset no longer has, also in the
    /// variants.
    fn forget_absent_models(&mut self) {
        let dataset = Arc::clone(&self.dataset);
        let is_there = |id: ConditionId, name: &str| {
            dataset
                .condition(id)
                .is_some_and(|condition| condition.position(BundleKind::Identified, name).is_some())
        };
        let of_variants = self
            .variants
            .iter_mut()
            .map(|variant| &mut Arc::make_mut(variant).choices);
        for (id, choice) in of_variants.chain([&mut self.choices]).flatten() {
            choice.identified.retain(|name| is_there(*id, name));
        }
    }
}

impl BundleChoice {
    fn retain(&mut self, is_there: impl Fn(&str) -> bool) {
        self.rejected.retain(|name| is_there(name));
        self.reasons.retain(|name, _| is_there(name));
        self.pinned = self.pinned.take().filter(|name| is_there(name));
    }
}

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

impl Study {
    /// Returns the channels with reversed sign, by name.
    pub fn turned_channels(&self) -> Vec<TurnedChannel> {
        let turned = |(channel, of): (&Channel, &SignRole)| TurnedChannel {
            channel: channel.name_in(&self.dataset),
            side: if matches!(channel, Channel::Input(_)) {
                ChannelSide::Input
            } else {
                ChannelSide::Output
            },
            of: *of,
        };
        self.signs.iter().map(turned).collect()
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
