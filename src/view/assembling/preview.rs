//! The response of the model shown, as soon as it is chosen.

use std::sync::Arc;

use egui::Ui;
use nalgebra::Complex;

use crate::view::plot::{BodeCurve, BodeQuantity, BodeScene, BodeView, CurveId, FrequencyUnit, Role, bode_ui};
use crate::view::{Command, Palette, choice_ui};
use gdcm_core::assembly::{ChannelLabel, FoundModel};
use gdcm_core::dataset::Band;
use gdcm_core::dataset::{BundleKind, ConditionId, Dynamics, ModelId, Pair, StateSpace};
use gdcm_core::response::{FrequencyGrid, PreparedModel, ResponseShape};

use super::{AssemblingCommand, AssemblyState};

/// Frequencies of the curve.
const POINTS: usize = 300;
/// How far the curve reaches beyond the band of comparison on either side, as a factor.
const BEYOND: f64 = 3.0;

/// The response drawn, kept while the model and the choice stay.
#[derive(Debug, Default)]
pub struct Preview {
    /// Place of the response: `output * inputs + input`, in the file's own order.
    pub response: usize,
    view: BodeView,
    drawn: Option<(String, usize, Vec<BodeCurve>)>,
}

/// The response of the model shown, and which one.
pub(super) fn preview_ui(ui: &mut Ui, assembly: &mut AssemblyState, palette: &Palette, commands: &mut Vec<Command>) {
    // A panel without content would shrink.
    ui.set_min_size(ui.available_size());
    let (selected, band) = (assembly.selected, assembly.assembly().rules().band);
    let Some(found) = assembly.assembly().parts().get(selected).map(|part| part.found.clone()) else { return };
    let count = (found.inputs.len() * found.outputs.len()).max(1);
    let place = assembly.preview.response.min(count - 1);
    let names: Vec<String> = (0..count).map(|place| pair_name(&found, place)).collect();
    let choices: Vec<(usize, &str, &str)> =
        names.iter().enumerate().map(|(place, name)| (place, name.as_str(), "Response shown")).collect();
    let mut chosen = place;
    choice_ui(ui, "Response of the preview", &mut chosen, &choices);
    if chosen != place {
        commands.push(AssemblingCommand::ShowResponse(chosen).into());
    }
    let key = found.key();
    if assembly.preview.drawn.as_ref().is_none_or(|(of, at, _)| (of, *at) != (&key, place)) {
        let is_other_model = assembly.preview.drawn.as_ref().is_none_or(|(of, ..)| *of != key);
        assembly.preview.drawn = Some((key, place, curve(&found, place, band).into_iter().collect()));
        // A measured response may be at other frequencies than the model shown before.
        if is_other_model {
            assembly.preview.view.request_fit();
        } else {
            assembly.preview.view.request_refit();
        }
    }
    let Some((_, _, curves)) = &assembly.preview.drawn else { return };
    let scene = BodeScene {
        quantity: BodeQuantity::RESPONSE_OF_FOUND_MODEL,
        unit: FrequencyUnit::default(),
        message: Some("This response cannot be computed"),
        ..BodeScene::of(&names[place], curves, band)
    };
    bode_ui(ui, &scene, &mut assembly.preview.view, palette);
}

/// "LON → Q", in the file's own names.
fn pair_name(found: &FoundModel, place: usize) -> String {
    let inputs = found.inputs.len().max(1);
    let name = |labels: &[ChannelLabel], index: usize, side: &str| {
        labels.get(index).and_then(|label| label.name.clone()).unwrap_or_else(|| format!("{side} {}", index + 1))
    };
    format!("{} → {}", name(&found.inputs, place % inputs, "input"), name(&found.outputs, place / inputs, "output"))
}

fn curve(found: &FoundModel, place: usize, band: (f64, f64)) -> Option<BodeCurve> {
    let pair = Pair::new(place / found.inputs.len().max(1), place % found.inputs.len().max(1));
    let (omega, values) = match found.response() {
        Some(response) => {
            let count = response.omega.len();
            let range = place * count..(place + 1) * count;
            let parts = response.re.values.get(range.clone())?.iter().zip(response.im.values.get(range)?);
            (response.omega.clone(), parts.map(|(re, im)| Complex::new(*re, *im)).collect::<Vec<_>>())
        }
        None => {
            let [a, b, c, d] = found.draft.matrices.clone();
            let model = StateSpace::new(a?, b?, c?, d?).ok()?.timed(found.draft.timing.clone()).ok()?;
            let wide = Band::new(band.0 / BEYOND, band.1 * BEYOND).ok()?;
            let grid = FrequencyGrid::logarithmic(wide, POINTS);
            let response = PreparedModel::of(&Dynamics::StateSpace(model)).response(&grid);
            (grid.omega().to_vec(), response.curve(pair).to_vec())
        }
    };
    let shape = ResponseShape::of(&values);
    Some(BodeCurve {
        id: CurveId::Model(ModelId::new(ConditionId(0), BundleKind::Physics, found.key())),
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
