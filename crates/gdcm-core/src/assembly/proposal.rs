//! Rules proposed for models that no rules were made for yet.

use super::channel_alias::same_channel;
use super::found_model::{ChannelLabel, FoundModel};
use super::rules::{ChannelRule, Rules};

/// The responses that matter in a helicopter, output and input (the paper's Table 2).
const ON_AXIS: [(&str, &str); 5] = [("P", "LAT"), ("Q", "LON"), ("R", "PED"), ("NY", "PED"), ("NZ", "COL")];

/// Rules with the channels that the models have, by their own names and units, the standard patterns, and the on-axis responses of
/// a helicopter as far as there are such channels. What the files do not say stays open.
pub fn proposed_rules(name: &str, models: &[FoundModel]) -> Rules {
    let inputs = channels(models, "input", |model| &model.inputs);
    let outputs = channels(models, "output", |model| &model.outputs);
    let find = |channels: &[ChannelRule], name: &str| {
        channels.iter().find(|channel| same_channel(&channel.name, name)).map(|channel| channel.name.clone())
    };
    let on_axis =
        ON_AXIS.iter().filter_map(|(output, input)| Some((find(&outputs, output)?, find(&inputs, input)?))).collect();
    Rules { name: name.to_owned(), inputs, outputs, on_axis, ..Rules::default() }
}

/// Channels with names of their own, in the order of the model that has most of them; those of other models that it lacks behind.
fn channels(models: &[FoundModel], side: &str, of: fn(&FoundModel) -> &Vec<ChannelLabel>) -> Vec<ChannelRule> {
    let named = |model: &FoundModel| of(model).iter().filter(|label| label.name.is_some()).count();
    let mut order: Vec<&FoundModel> = models.iter().collect();
    order.sort_by_key(|model| std::cmp::Reverse(named(model)));
    let first_is_measured = order.first().is_some_and(|model| model.response().is_some());
    let mut channels: Vec<ChannelRule> = Vec::new();
    for model in order {
        // Models with matrices have all channels of the dataset; measured responses may have one each.
        let is_open = channels.is_empty() || (model.response().is_some() && first_is_measured);
        for label in of(model) {
            let Some(name) = &label.name else { continue };
            let unit = label.unit.clone().unwrap_or_default();
            let known = channels.iter().position(|channel| same_channel(&channel.name, name));
            match known.map(|known| &mut channels[known]) {
                Some(known) if known.unit.is_empty() => known.unit = unit,
                Some(_) => {}
                None if is_open => channels.push(ChannelRule { unit, ..ChannelRule::named(name) }),
                None => {}
            }
        }
    }
    // Matrices without names have all channels of the dataset, whatever a measured response beside them is called.
    let all_unnamed = models.iter().filter(|model| model.response().is_none()).all(|model| named(model) == 0);
    if channels.is_empty() || all_unnamed {
        let count = models.iter().map(|model| of(model).len()).max().unwrap_or(0);
        let missing = channels.len() + 1..=count;
        channels.extend(missing.map(|number| ChannelRule::named(format!("{side} {number}"))));
    }
    channels
}
