//! Events of the plots over frequency as commands, shared by all of these plots.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use egui::Ui;

use gdcm_method::fidelity::summand;
use gdcm_model::dataset::{Band, BundleKind, ModelId, Pair};
use gdcm_model::response::wrap;
use gdcm_model::units::telling;
use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::axis::FrequencyUnit;
use gdcm_plot::figure::bode::BodeOptions;
use gdcm_study::Edit;
use gdcm_study::decisions::setting;

use super::compare::overlaid_analysis;
use crate::gui::commands::command::Command;
use crate::gui::commands::output::OutputCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::commands::study::StudyCommand;
use crate::gui::plot::bode_event::{BodeEvent, CurveWish};
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::drawn_curves::PANES;
use crate::gui::plot::legend::Chip;
use crate::gui::plot::pointed_curve::pointed_words;
use crate::gui::plot::quantity::{BodeQuantity, ValueUnit};
use crate::gui::plot::readout::{Readout, ReadoutCell};
use crate::gui::plot::{BodeCurve, BodeScene, BodeView, CurveId, Pane, Role, bode_ui};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::Palette;

/// Draws a plot over frequency of the displayed condition with the common elements: cursors, values
/// of every role at the cursor, chips. Pushes the resulting commands and the description of the
/// element under the pointer.
pub(super) fn frequency_plot_ui(
    ui: &mut Ui,
    state: &State,
    (scene, view): (BodeScene<'_>, &mut BodeView),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let display = &state.display.curves;
    let quantity = scene.quantity;
    let curves = scene.curves;
    let unit = state.display.curves.unit;
    let at = (display.cursor, display.pinned.as_slice());
    let readout = display
        .lists_values
        .then(|| cursor_readout(curves, (quantity, unit), at, scene.band))
        .flatten();
    let (chips, of_chips): (Vec<Chip>, Vec<Command>) = chips(state).into_iter().unzip();
    let scene = BodeScene {
        cursor: display.cursor,
        pinned: &display.pinned,
        crossings: &display.crossings,
        readout: readout.as_ref(),
        hidden_roles: Some(&display.hidden_roles),
        raised: display.raised,
        names_curves: state.display.layout.is_wide && scene.quantity.is_of_condition(),
        chips: &chips,
        unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        ..scene
    };
    for event in bode_ui(ui, &scene, view, palette) {
        commands.extend(match event {
            BodeEvent::Wished(id, CurveWish::CopyValues) => curves
                .iter()
                .find(|curve| curve.id == id)
                .map(|curve| Command::Output(OutputCommand::CopyText(values(quantity, curve)))),
            BodeEvent::ChipClicked(index) => of_chips.get(index).cloned(),
            event => command_of(state, event),
        });
    }
    if let Some(CurveId::Model(id)) = &view.hovered {
        commands.push(SelectionCommand::Hover(id.clone()).into());
    }
    commands.extend(
        pointed_words(view, curves, quantity, unit)
            .map(|value| Command::Selection(SelectionCommand::Tell(value))),
    );
    commands.extend(
        view.pointed_omega
            .map(|omega| CurveCommand::PointAt(omega).into()),
    );
}

fn command_of(state: &State, event: BodeEvent) -> Option<Command> {
    match event {
        BodeEvent::Clicked(CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        BodeEvent::TakenBack(CurveId::Model(id)) => {
            let rejected = state.study.is_rejected(&id);
            Some(Command::Study(StudyCommand::Forget(if rejected {
                Edit::Reject(id)
            } else {
                Edit::Restore(id)
            })))
        }
        BodeEvent::Isolated(CurveId::Model(id)) => {
            Some(Command::Selection(SelectionCommand::Isolate(id)))
        }
        BodeEvent::BandDragged { min, max } => Band::new(min, max)
            .ok()
            .map(|band| setting::BAND.to(band).into()),
        BodeEvent::BandReleased => Some(Command::Study(StudyCommand::EndEdit)),
        BodeEvent::Display(command) => Some(command.into()),
        BodeEvent::RejectedBecause(CurveId::Model(model), reason) => {
            Some(Edit::RejectBecause { model, reason }.into())
        }
        BodeEvent::Wished(id, wish) => wished(state, id, wish),
        BodeEvent::Boxed(curves) => {
            let model = |curve| {
                if let CurveId::Model(id) = curve {
                    Some(id)
                } else {
                    None
                }
            };
            Some(CurveCommand::Select(curves.into_iter().filter_map(model).collect()).into())
        }
        BodeEvent::Hovered(_)
        | BodeEvent::Clicked(_)
        | BodeEvent::TakenBack(_)
        | BodeEvent::Isolated(_)
        | BodeEvent::RejectedBecause(..)
        | BodeEvent::ChipClicked(_) => None,
    }
}

fn reject_or_restore(state: &State, id: ModelId) -> Command {
    if state.study.is_rejected(&id) {
        Edit::Restore(id)
    } else {
        Edit::Reject(id)
    }
    .into()
}

/// Returns the command for a wish about a curve.
pub(super) fn wished(state: &State, id: CurveId, wish: CurveWish) -> Option<Command> {
    match (wish, id) {
        (CurveWish::Turn(by), id) => Some(
            CurveCommand::Turn(state.condition().id(), state.display.selection.pair, id, by).into(),
        ),
        (CurveWish::RejectOrRestore, CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        (CurveWish::Pin, CurveId::Model(id)) => Some(Edit::Pin(id).into()),
        (CurveWish::Isolate, CurveId::Model(id)) => {
            Some(Command::Selection(SelectionCommand::Isolate(id)))
        }
        (CurveWish::Hide, CurveId::Model(id)) => Some(CurveCommand::HideModel(id).into()),
        _ => None,
    }
}

/// Formats the numbers of a curve as text: a heading, then a tab-separated line for each frequency.
fn values(quantity: BodeQuantity<'_>, curve: &BodeCurve) -> String {
    let [magnitude, phase] = PANES.map(|pane| quantity.drawn_label(pane));
    let mut text = format!("{}\nω [rad/s]\t{magnitude}\t{phase}\n", curve.label);
    let numbers = curve
        .omega
        .iter()
        .zip(curve.magnitude_db.iter().zip(curve.phase_deg.iter()));
    for (omega, (magnitude, phase)) in numbers {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{omega}\t{magnitude}\t{phase}");
    }
    text
}

/// Returns the current restrictions of the plots over frequency, each with the command that ends it
/// or acts on it.
fn chips(state: &State) -> Vec<(Chip, Command)> {
    let chip = |text: String, hint: &str, command: Command| {
        (
            Chip {
                text,
                hint: hint.to_owned(),
            },
            command,
        )
    };
    let mut chips = Vec::new();
    if let Some(id) = &state.display.selection.isolated {
        let hint =
            "Only this model is shown beside the representatives. Click, or Escape: show all";
        chips.push(chip(
            format!("Only {} ×", id.name),
            hint,
            Command::Selection(SelectionCommand::EndIsolation),
        ));
    }
    let curves = &state.display.curves;
    let of_condition = |id: &&ModelId| id.condition == state.condition().id();
    let selected: Vec<ModelId> = curves
        .selected
        .iter()
        .filter(of_condition)
        .cloned()
        .collect();
    let (rejected, kept): (Vec<ModelId>, Vec<ModelId>) = selected
        .into_iter()
        .partition(|id| state.study.is_rejected(id));
    let any_selected = !(rejected.is_empty() && kept.is_empty());
    if !kept.is_empty() {
        let hint = "Take the models that the box was drawn over out of their bundles";
        chips.push(chip(
            format!("Reject {}", counted(kept.len())),
            hint,
            Edit::RejectEach(kept).into(),
        ));
    }
    if !rejected.is_empty() {
        let hint = "Put the rejected models that the box was drawn over back";
        chips.push(chip(
            format!("Restore {}", counted(rejected.len())),
            hint,
            Edit::RestoreEach(rejected).into(),
        ));
    }
    if any_selected {
        let hint = "Leave them as they are (Escape)";
        chips.push(chip(
            "Select none ×".to_owned(),
            hint,
            CurveCommand::Select(BTreeSet::new()).into(),
        ));
    }
    if !curves.crossings.is_empty() {
        let unit = state.display.curves.unit;
        let names = curves
            .crossings
            .iter()
            .map(|(name, omega)| format!("{name} {}", telling(unit.of_omega(*omega), 2)));
        let text = format!(
            "{} {} ×",
            names.collect::<Vec<_>>().join(" · "),
            unit.symbol()
        );
        let hint = "The frequencies marked. Click: take the marks away";
        chips.push(chip(text, hint, CurveCommand::UnpinCursors.into()));
    }
    let hidden = curves.hidden_models.iter().filter(of_condition).count();
    if hidden > 0 {
        let hint = "Draw every model again";
        chips.push(chip(
            format!("{} hidden ×", counted(hidden)),
            hint,
            CurveCommand::ShowHidden.into(),
        ));
    }
    chips
}

fn counted(models: usize) -> String {
    if models == 1 {
        "1 model".to_owned()
    } else {
        format!("{models} models")
    }
}

/// Returns the source of the displayed condition's curves; `None` until its responses are
/// available.
pub(in crate::gui) fn condition_source(state: &State) -> Option<ConditionSource<'_>> {
    let schedule = state
        .analysis()
        .and_then(|analysis| analysis.schedule.as_ref().ok());
    let condition = state.condition().id();
    let variant = overlaid_analysis(state)
        .and_then(|(name, analysis)| Some((name, analysis.condition(condition)?)));
    Some(ConditionSource {
        study: &state.study,
        analysis: state.shown(),
        schedule,
        curves: state.curves()?,
        variant,
    })
}

/// Returns the displayed parts of the responses and their form, the same as on paper.
pub(in crate::gui) fn bode_options(state: &State) -> BodeOptions {
    let display = &state.display;
    let curves = &state.display.curves;
    BodeOptions {
        unit: display.curves.unit,
        magnitude: curves.magnitude,
        phase: curves.phase,
        phase_error: curves.phase_error,
        turns: curves.turns.clone(),
        shows_muad: curves.shows_muad,
        crossings: curves.crossings.clone(),
        zeros_of: display.poles.show_zeros.then_some(display.selection.pair),
        hidden: curves.hidden_roles.clone(),
        hidden_models: curves.hidden_models.clone(),
        isolated: display
            .selection
            .isolated
            .clone()
            .filter(|model| model.condition == state.condition().id()),
        ..BodeOptions::default()
    }
}

/// Returns every curve of a response in the displayed condition; empty until its responses are
/// available.
pub(in crate::gui) fn bode_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let mut cache = state
        .display
        .frequency
        .shapes
        .remove(&pair)
        .unwrap_or_default();
    let options = bode_options(state);
    let curves =
        condition_source(state).map(|source| source.response_curves(pair, &options, &mut cache));
    let drawn = pointed_out(state, curves.unwrap_or_default(), None);
    state.display.frequency.shapes.insert(pair, cache);
    drawn
}

/// Returns the errors of a response, as used by the fit, in the displayed condition; empty until
/// its responses are available.
pub(super) fn error_curves(state: &mut State, pair: Pair, options: &BodeOptions) -> Vec<BodeCurve> {
    let mut cache = std::mem::take(&mut state.display.frequency.errors);
    let curves =
        condition_source(state).map(|source| source.error_curves(pair, options, &mut cache));
    let curves = curves.unwrap_or_default();
    let reference = error_reference(&curves);
    let drawn = pointed_out(state, curves, reference.as_ref());
    state.display.frequency.errors = cache;
    drawn
}

/// Returns the curve of the identified model among errors: it is zero everywhere, and the others
/// are read against it.
pub(super) fn error_reference(curves: &[BodeCurve]) -> Option<CurveId> {
    let is_identified = |curve: &&BodeCurve| matches!(&curve.id, CurveId::Model(id) if id.bundle == BundleKind::Identified);
    curves
        .iter()
        .find(is_identified)
        .map(|curve| curve.id.clone())
}

/// Adds interaction to the curves: emphasis of the curve under the pointer, and a description of
/// the effect of a click, which has none on the reference.
fn pointed_out(
    state: &State,
    mut curves: Vec<BodeCurve>,
    reference: Option<&CurveId>,
) -> Vec<BodeCurve> {
    for curve in &mut curves {
        match &curve.id {
            CurveId::Model(id) if reference == Some(&curve.id) => {
                curve.highlighted = state.display.selection.hovered.as_ref() == Some(id);
                let separator = if curve.detail.is_empty() { "" } else { " · " };
                curve
                    .detail
                    .push_str(&format!("{separator}the reference of the errors"));
            }
            CurveId::Model(id) => {
                let is_selected = state.display.curves.selected.contains(id);
                curve.highlighted =
                    is_selected || state.display.selection.hovered.as_ref() == Some(id);
                let action = if curve.rejected {
                    "click to restore"
                } else {
                    "click to reject"
                };
                let separator = if curve.detail.is_empty() { "" } else { " · " };
                curve.detail = format!("{}{separator}{action}", curve.detail);
            }
            CurveId::Scheduled if state.others_are_older() => {
                curve.label.push_str(" of older settings")
            }
            _ => {}
        }
    }
    curves
}

/// Roles whose values are reported.
const TOLD: [Role; 4] = [
    Role::Nominal,
    Role::IdentifiedRepresentative,
    Role::Corrected,
    Role::Scheduled,
];

/// Returns the values of the heavy curves at the pointer or at a marked frequency \[rad/s\];
/// without either, at the frequency of the largest error within the band. For two marked
/// frequencies, the change between them.
pub fn cursor_readout(
    curves: &[BodeCurve],
    (quantity, unit): (BodeQuantity<'_>, FrequencyUnit),
    (cursor, pinned): (Option<f64>, &[f64]),
    band: (f64, f64),
) -> Option<Readout> {
    let of_role = |role: Role| {
        curves
            .iter()
            .find(|curve| !curve.hidden && curve.role == role)
    };
    let told = TOLD
        .into_iter()
        .filter_map(|role| Some((role, of_role(role)?)));
    let frequency = |omega: f64| unit.readout(omega).trim_start_matches("ω ").to_owned();
    if let [from, to] = *pinned {
        let change =
            |curve: &BodeCurve, pane| Some(curve.value_at(pane, to)? - curve.value_at(pane, from)?);
        let cell = |(role, curve): (Role, &BodeCurve)| ReadoutCell {
            role: Some(role),
            name: format!("Δ {}", role.name()),
            values: PANES.map(|pane| change_text(quantity, pane, change(curve, pane))),
            warns: [false; 2],
        };
        let frequency = format!(
            "{} → {}",
            unit.readout(from).trim_start_matches("ω "),
            frequency(to)
        );
        let heading = "change between marks".to_owned();
        let cells = told.map(cell).collect();
        return Some(Readout {
            heading,
            frequency,
            cells,
        });
    }
    let pair = of_role(Role::Corrected).zip(of_role(Role::IdentifiedRepresentative));
    let (heading, omega) = match (cursor, pinned) {
        (Some(omega), _) => ("ω at the pointer", omega),
        (None, [omega, ..]) => ("ω at the mark", *omega),
        (None, []) => ("ω of the largest error", largest_error(pair?, band)?),
    };
    let cell = |(role, curve): (Role, &BodeCurve)| ReadoutCell {
        role: Some(role),
        name: if curve.rejected {
            format!("{}, rejected", role.name())
        } else {
            role.name().to_owned()
        },
        values: PANES.map(|pane| {
            curve
                .value_at(pane, omega)
                .map_or("–".to_owned(), |value| quantity.unit(pane).readout(value))
        }),
        warns: [false; 2],
    };
    let mut cells: Vec<ReadoutCell> = told.map(cell).collect();
    if let (BodeQuantity::Response { .. }, Some((corrected, identified))) = (quantity, pair) {
        cells.push(difference_cell(quantity, (corrected, identified), omega));
    }
    Some(Readout {
        heading: heading.to_owned(),
        frequency: frequency(omega),
        cells,
    })
}

fn change_text(quantity: BodeQuantity<'_>, pane: Pane, change: Option<f64>) -> String {
    // The ratio of two ratios is a difference of decibels.
    let unit = match quantity.unit(pane) {
        ValueUnit::Ratio => ValueUnit::Decibel,
        unit => unit,
    };
    change.map_or("–".to_owned(), |change| unit.readout(change))
}

/// Returns the corrected minus the identified model: decibels, and the principal value of the
/// phases, because a single frequency does not define turns (M4). Warns from 1 dB and from 10
/// degrees on; below, J is small.
fn difference_cell(
    quantity: BodeQuantity<'_>,
    (corrected, identified): (&BodeCurve, &BodeCurve),
    omega: f64,
) -> ReadoutCell {
    let difference =
        |pane| Some(corrected.value_at(pane, omega)? - identified.value_at(pane, omega)?);
    let magnitude = difference(Pane::Magnitude);
    let phase = difference(Pane::Phase).map(|degrees| wrap(degrees.to_radians()).to_degrees());
    let above = |value: Option<f64>, limit: f64| value.is_some_and(|value| value.abs() >= limit);
    ReadoutCell {
        role: None,
        name: "corrected − identified".to_owned(),
        values: [
            change_text(quantity, Pane::Magnitude, magnitude),
            change_text(quantity, Pane::Phase, phase),
        ],
        warns: [above(magnitude, 1.0), above(phase, 10.0)],
    }
}

/// Returns the frequency within the band at which the integrand of J is greatest (M4).
fn largest_error(
    (corrected, identified): (&BodeCurve, &BodeCurve),
    (min, max): (f64, f64),
) -> Option<f64> {
    let error = |omega: f64| {
        let [db, deg] = PANES
            .map(|pane| Some(corrected.value_at(pane, omega)? - identified.value_at(pane, omega)?));
        let deg = wrap(deg?.to_radians()).to_degrees();
        Some(summand(db?, deg))
    };
    let within = corrected
        .omega
        .iter()
        .copied()
        .filter(|omega| (min..=max).contains(omega));
    let errors = within.filter_map(|omega| Some((omega, error(omega)?)));
    errors
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(omega, _)| omega)
}

#[cfg(test)]
mod tests {
    use gdcm_model::dataset::{BundleKind, ConditionId, ModelId};

    use super::*;
    use crate::gui::plot::CurveId;

    fn flat(name: &str, role: Role, magnitude_db: f64, phase_deg: f64) -> BodeCurve {
        BodeCurve {
            id: CurveId::Model(ModelId::new(ConditionId(1), BundleKind::Physics, name)),
            label: name.to_owned(),
            detail: String::new(),
            role,
            rejected: false,
            highlighted: false,
            hidden: false,
            omega: vec![1.0, 4.0].into(),
            magnitude_db: vec![magnitude_db; 2].into(),
            phase_deg: vec![phase_deg, phase_deg - 90.0].into(),
        }
    }

    fn curves() -> Vec<BodeCurve> {
        vec![
            flat("a", Role::Perturbed, -3.0, 0.0),
            flat("b", Role::Perturbed, -1.0, 0.0),
            flat("n", Role::Nominal, 2.0, 400.0),
            flat("i", Role::IdentifiedRepresentative, 1.0, 10.0),
            flat("c", Role::Corrected, 2.5, 400.0),
        ]
    }

    const BAND: (f64, f64) = (0.5, 12.0);

    fn readout(cursor: Option<f64>, pinned: &[f64]) -> Readout {
        let shown = (BodeQuantity::RESPONSE, FrequencyUnit::RadPerSecond);
        cursor_readout(&curves(), shown, (cursor, pinned), BAND).unwrap()
    }

    fn values(readout: &Readout, name: &str) -> [String; 2] {
        readout
            .cells
            .iter()
            .find(|cell| cell.name == name)
            .unwrap()
            .values
            .clone()
    }

    #[test]
    fn the_heavy_curves_are_told_and_what_the_correction_leaves() {
        let readout = readout(Some(1.0), &[]);
        assert_eq!(
            (readout.heading.as_str(), readout.frequency.as_str()),
            ("ω at the pointer", "1.00 rad/s")
        );
        assert_eq!(values(&readout, "nominal"), ["2.0 dB", "400°"]);
        assert_eq!(values(&readout, "identified"), ["1.0 dB", "10°"]);
        // 400° is a turn and 30° ahead of 10°.
        assert_eq!(
            values(&readout, "corrected − identified"),
            ["1.5 dB", "30°"]
        );
        assert_eq!(readout.cells.last().unwrap().warns, [true, true]);
    }

    #[test]
    fn between_two_marks_the_changes_are_listed() {
        let readout = readout(None, &[1.0, 4.0]);
        assert_eq!(values(&readout, "Δ nominal"), ["0.0 dB", "\u{2212}90°"]);
        assert_eq!(readout.frequency, "1.00 rad/s → 4.00 rad/s");
    }

    #[test]
    fn without_a_pointer_the_largest_error_in_the_band_is_told() {
        let mut curves = curves();
        let shown = (BodeQuantity::RESPONSE, FrequencyUnit::RadPerSecond);
        let corrected = curves
            .iter_mut()
            .find(|curve| curve.role == Role::Corrected)
            .unwrap();
        corrected.magnitude_db = vec![1.0, 9.0].into();
        let readout = cursor_readout(&curves, shown, (None, &[]), BAND).unwrap();
        assert_eq!(
            (readout.heading.as_str(), readout.frequency.as_str()),
            ("ω of the largest error", "4.00 rad/s")
        );
        assert_eq!(
            cursor_readout(&curves, shown, (None, &[]), (5.0, 12.0)),
            None,
            "nothing is within the band"
        );
    }
}
