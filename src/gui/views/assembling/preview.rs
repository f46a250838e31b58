//! Preview of the displayed model: a response selector, and a Bode plot of the selected response.

use egui::Ui;

use gdcm_model::assembly::{ChannelLabel, FoundModel};
use gdcm_plot::figure::axis::FrequencyUnit;

use super::preview_curve::{curve, pair};
use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::plot::quantity::BodeQuantity;
use crate::gui::plot::{BodeScene, bode_ui};
use crate::gui::state::assembling::{AssemblyState, DrawnPreview, Preview};
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::Palette;

/// Shows the displayed model's selected response as a Bode plot, with a selector for all its
/// responses; nothing without a model.
pub(super) fn preview_ui(
    ui: &mut Ui,
    assembly: &mut AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    // Keep the size: a panel without content would shrink.
    ui.set_min_size(ui.available_size());
    let band = assembly.assembly().rules().band;
    let Some(part) = assembly.assembly().parts().get(assembly.selected) else {
        return;
    };
    let found = part.found.clone();
    let count = (found.inputs.len() * found.outputs.len()).max(1);
    let response = assembly.preview.response.min(count - 1);
    let names: Vec<String> = (0..count)
        .map(|response| response_name(&found, response))
        .collect();
    response_choice_ui(ui, &names, response, commands);
    update_curves(&mut assembly.preview, &found, response, band);
    let Some(drawn) = &assembly.preview.drawn else {
        return;
    };
    let scene = BodeScene {
        quantity: BodeQuantity::RESPONSE_OF_FOUND_MODEL,
        unit: FrequencyUnit::default(),
        message: Some("This response cannot be computed: the model is incomplete or inconsistent"),
        ..BodeScene::new(&names[response], &drawn.curves, band)
    };
    bode_ui(ui, &scene, &mut assembly.preview.view, palette);
}

fn response_choice_ui(ui: &mut Ui, names: &[String], shown: usize, commands: &mut Vec<Command>) {
    let choices: Vec<(usize, &str, &str)> = names
        .iter()
        .enumerate()
        .map(|(response, name)| (response, name.as_str(), "Response shown"))
        .collect();
    let mut chosen = shown;
    choice_ui(ui, "Response of the preview", &mut chosen, &choices);
    if chosen != shown {
        commands.push(AssemblingCommand::ShowResponse(chosen).into());
    }
}

/// Recomputes the curve if another model or response has been selected, or if the model's content
/// or the band has changed.
fn update_curves(preview: &mut Preview, found: &FoundModel, response: usize, band: (f64, f64)) {
    let mut is_same_model = false;
    if let Some(drawn) = &preview.drawn {
        is_same_model = drawn.model.key() == found.key();
        if drawn.response == response && drawn.band == band && drawn.model == *found {
            return;
        }
    }
    let curves = curve(found, response, band).into_iter().collect();
    preview.drawn = Some(DrawnPreview {
        model: found.clone(),
        response,
        band,
        curves,
    });
    // A different model may have other frequencies, so `request_fit` also fits the frequency axis.
    if is_same_model {
        preview.view.request_refit();
    } else {
        preview.view.request_fit();
    }
}

/// Returns "LON → Q", with the channel names in the file.
fn response_name(found: &FoundModel, response: usize) -> String {
    let pair = pair(found, response);
    format!(
        "{} → {}",
        channel_name(&found.inputs, pair.input, "input"),
        channel_name(&found.outputs, pair.output, "output")
    )
}

/// Returns a channel's name; without a name, its side and its number, counted from 1.
fn channel_name(labels: &[ChannelLabel], index: usize, side: &str) -> String {
    if let Some(label) = labels.get(index)
        && let Some(name) = &label.name
    {
        return name.clone();
    }
    format!("{side} {}", index + 1)
}
