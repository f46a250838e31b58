//! The displayed model's response as a Bode plot.

use std::sync::Arc;

use egui::Ui;
use nalgebra::Complex;

use gdcm_model::assembly::{ChannelLabel, FoundModel};
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Dynamics, ModelId, Pair, StateSpace};
use gdcm_model::response::frequency_response::ResponseShape;
use gdcm_model::response::{FrequencyGrid, PreparedModel};
use gdcm_plot::figure::axis::FrequencyUnit;

use crate::gui::commands::assembling::AssemblingCommand;
use crate::gui::commands::command::Command;
use crate::gui::plot::quantity::BodeQuantity;
use crate::gui::plot::{BodeCurve, BodeScene, CurveId, Role, bode_ui};
use crate::gui::state::assembling::{AssemblyState, DrawnPreview, Preview};
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::Palette;

/// Number of points on the curve of a model.
const POINTS: usize = 300;
/// Factor by which the curve extends beyond the comparison band at either end.
const BEYOND: f64 = 3.0;

/// Shows the Bode plot of a response, and a selector of all responses of the model.
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

/// Recomputes the curve if another model or response has been selected.
fn update_curves(preview: &mut Preview, found: &FoundModel, response: usize, band: (f64, f64)) {
    let key = found.key();
    let mut is_same_model = false;
    if let Some(drawn) = &preview.drawn {
        is_same_model = drawn.model == key;
        if is_same_model && drawn.response == response {
            return;
        }
    }
    let curves = curve(found, response, band).into_iter().collect();
    preview.drawn = Some(DrawnPreview {
        model: key,
        response,
        curves,
    });
    // A different model may have other frequencies, so `request_fit` also fits the frequency axis.
    if is_same_model {
        preview.view.request_refit();
    } else {
        preview.view.request_fit();
    }
}

/// Returns the pair of a response, whose index is `output * inputs + input`.
fn pair(found: &FoundModel, response: usize) -> Pair {
    let inputs = found.inputs.len().max(1);
    Pair::new(response / inputs, response % inputs)
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

/// Returns the name of a channel; without a name, its side and its number, counted from 1.
fn channel_name(labels: &[ChannelLabel], index: usize, side: &str) -> String {
    if let Some(label) = labels.get(index)
        && let Some(name) = &label.name
    {
        return name.clone();
    }
    format!("{side} {}", index + 1)
}

struct PairResponse {
    /// Frequencies \[rad/s\].
    omega: Vec<f64>,
    values: Vec<Complex<f64>>,
}

fn curve(found: &FoundModel, response: usize, band: (f64, f64)) -> Option<BodeCurve> {
    let PairResponse { omega, values } = match found.response() {
        Some(_) => measured_response(found, response)?,
        None => model_response(found, pair(found, response), band)?,
    };
    let shape = ResponseShape::new(&values);
    let model = ModelId::new(ConditionId(0), BundleKind::Physics, found.key());
    Some(BodeCurve {
        id: CurveId::Model(model),
        label: found.key(),
        detail: found.words(),
        role: Role::Representative,
        rejected: false,
        highlighted: false,
        hidden: false,
        omega: Arc::from(omega),
        magnitude_db: shape.magnitude_db,
        phase_deg: shape.phase_deg,
    })
}

/// Returns a response measured in the file, in which the values of each pair are contiguous and the
/// pairs are ordered as in [`pair`]; `None` without measured responses.
fn measured_response(found: &FoundModel, response: usize) -> Option<PairResponse> {
    let measured = found.response()?;
    let count = measured.omega.len();
    let range = response * count..(response + 1) * count;
    let re = measured.re.values.get(range.clone())?;
    let im = measured.im.values.get(range)?;
    let values = re.iter().zip(im).map(|(re, im)| Complex::new(*re, *im));
    Some(PairResponse {
        omega: measured.omega.clone(),
        values: values.collect(),
    })
}

/// Computes the response of a state-space model over the extended band; `None` if the matrices are
/// incomplete or inconsistent.
fn model_response(found: &FoundModel, pair: Pair, band: (f64, f64)) -> Option<PairResponse> {
    let [a, b, c, d] = found.draft.matrices.clone();
    let model = StateSpace::new(a?, b?, c?, d?)
        .ok()?
        .timed(found.draft.timing.clone())
        .ok()?;
    let wide = Band::new(band.0 / BEYOND, band.1 * BEYOND).ok()?;
    let grid = FrequencyGrid::logarithmic(wide, POINTS);
    let response = PreparedModel::of(&Dynamics::StateSpace(model)).response(&grid);
    Some(PairResponse {
        omega: grid.omega().to_vec(),
        values: response.curve(pair).to_vec(),
    })
}
