//! From what a dataset file says to the dataset, each error with its place.

use crate::dataset::{
    Band, BundleKind, Channel, Condition, Dataset, DatasetHeader, Dynamics, FlightState, MOST_CHANNELS, Model, Origin,
    Pair, PairTable,
};
use crate::io::content_fault::ContentFault;
use crate::io::flaw::Flaw;
use crate::io::place::Place;

use super::dynamics::{Matrices, state_space_or_response};
use super::schema::{BandText, ChannelText, ConditionText, DatasetText, IdentifiedText, PhysicsText};

/// Most conditions, and most models of a bundle: comparing names takes time that grows with the square.
const MOST_ENTRIES: usize = 5000;

/// The dataset, and a caution for each thing in it that is odd but harmless.
pub(super) fn dataset_of(text: DatasetText) -> Result<(Dataset, Vec<String>), Flaw> {
    check_count("inputs", text.inputs.len(), MOST_CHANNELS)?;
    check_count("outputs", text.outputs.len(), MOST_CHANNELS)?;
    check_count("conditions", text.conditions.len(), MOST_ENTRIES)?;
    let band = band_of(&text.frequency_band)?;
    let on_axis = on_axis_of(&text)?;
    let (outputs, inputs) = (text.outputs.len(), text.inputs.len());
    let header = DatasetHeader {
        name: text.name,
        description: text.description.unwrap_or_default(),
        inputs: text.inputs.into_iter().map(channel_of).collect(),
        outputs: text.outputs.into_iter().map(channel_of).collect(),
        on_axis,
        band,
    };
    let mut reader = Reader { outputs, inputs, cautions: Vec::new() };
    let conditions = text.conditions.into_iter().enumerate();
    let conditions =
        conditions.map(|(index, condition)| reader.condition(index + 1, condition)).collect::<Result<_, _>>()?;
    // These errors name the list or the condition themselves.
    let dataset = Dataset::new(header, conditions).map_err(|error| Flaw::new(Place::default(), error))?;
    Ok((dataset, reader.cautions))
}

fn check_count(list: &str, found: usize, most: usize) -> Result<(), Flaw> {
    if found > most { Err(Flaw::new(Place::entry(list), ContentFault::TooMany { most, found })) } else { Ok(()) }
}

fn channel_of(text: ChannelText) -> Channel {
    Channel { name: text.name, unit: text.unit, description: text.description.unwrap_or_default() }
}

fn band_of(text: &BandText) -> Result<Band, Flaw> {
    if text.unit != "rad/s" {
        let fault = ContentFault::Word { expected: "\"rad/s\"".to_owned(), found: text.unit.clone() };
        return Err(Flaw::new(Place::entry("frequency_band, unit"), fault));
    }
    Band::new(text.min, text.max).map_err(|error| Flaw::new(Place::entry("frequency_band"), error))
}

fn on_axis_of(text: &DatasetText) -> Result<PairTable<bool>, Flaw> {
    let mut table = PairTable::filled(text.outputs.len(), text.inputs.len(), false);
    for (index, (output, input)) in text.on_axis.iter().flatten().enumerate() {
        let flaw = |fault: ContentFault| Flaw::new(Place::entry(format!("on_axis, entry {}", index + 1)), fault);
        let find = |channels: &[ChannelText], kind: &'static str, name: &String| {
            let found = channels.iter().position(|channel| channel.name == *name);
            found.ok_or_else(|| flaw(ContentFault::UnknownChannel { kind, name: name.clone() }))
        };
        let pair = Pair::new(find(&text.outputs, "output", output)?, find(&text.inputs, "input", input)?);
        if std::mem::replace(&mut table[pair], true) {
            return Err(flaw(ContentFault::DuplicatePair { output: output.clone(), input: input.clone() }));
        }
    }
    Ok(table)
}

/// What the reading of conditions needs to know, and notes.
struct Reader {
    outputs: usize,
    inputs: usize,
    cautions: Vec<String>,
}

impl Reader {
    fn condition(&mut self, position: usize, text: ConditionText) -> Result<Condition, Flaw> {
        let place = Place::condition(position, text.id);
        for (list, found) in
            [("physics_models", text.physics_models.len()), ("identified_models", text.identified_models.len())]
        {
            if found > MOST_ENTRIES {
                return Err(Flaw::new(place.at(list), ContentFault::TooMany { most: MOST_ENTRIES, found }));
            }
        }
        let flight_state = FlightState {
            id: text.id,
            name: text.name,
            airspeed_kt: text.airspeed_kt,
            altitude: text.altitude,
            altitude_ft: text.altitude_ft,
            weight: text.weight,
            mass_kg: text.mass_kg,
        };
        let physics = text.physics_models.into_iter().enumerate();
        let physics: Vec<Model> =
            physics.map(|(index, model)| self.physics(&place, index + 1, model)).collect::<Result<_, _>>()?;
        let identified = text.identified_models.into_iter().enumerate();
        let identified: Vec<Model> =
            identified.map(|(index, model)| self.identified(&place, index + 1, model)).collect::<Result<_, _>>()?;
        Condition::new(flight_state, physics, identified).map_err(|error| Flaw::new(place, error))
    }

    fn physics(&self, condition: &Place, position: usize, text: PhysicsText) -> Result<Model, Flaw> {
        let place = condition.model(BundleKind::Physics, position, &text.name);
        if text.frequency_response.is_some() {
            return Err(Flaw::new(place.at("frequency_response"), ContentFault::MeasuredPhysics));
        }
        let perturbation = text.perturbation;
        let origin = match text.role.as_str() {
            "nominal" => Origin::Nominal { perturbation },
            "perturbed" => Origin::Perturbed { perturbation },
            _ => {
                let fault =
                    ContentFault::Word { expected: "\"nominal\" or \"perturbed\"".to_owned(), found: text.role };
                return Err(Flaw::new(place.at("role"), fault));
            }
        };
        let matrices = Matrices { a: text.a, b: text.b, c: text.c, d: text.d };
        let dynamics = Dynamics::StateSpace(matrices.state_space(&place, self.outputs, self.inputs)?);
        Ok(Model { name: text.name, origin, dynamics })
    }

    fn identified(&mut self, condition: &Place, position: usize, text: IdentifiedText) -> Result<Model, Flaw> {
        let place = condition.model(BundleKind::Identified, position, &text.name);
        let matrices = Matrices { a: text.a, b: text.b, c: text.c, d: text.d };
        let dynamics = state_space_or_response(matrices, text.frequency_response, &place, self.outputs, self.inputs)?;
        if let (Dynamics::StateSpace(model), Some(order)) = (&dynamics, text.order)
            && model.order() != order
        {
            let states = model.order();
            self.cautions.push(format!("{}order says {order}, the matrices have {states} states", place.before()));
        }
        let origin = Origin::Identified { method: text.method, order: text.order };
        Ok(Model { name: text.name, origin, dynamics })
    }
}
