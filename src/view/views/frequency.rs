//! What the engineer does in a plot over frequency, as commands: the same in all of them.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use egui::Ui;
use gdcm_core::dataset::{Band, ModelId, Pair};
use gdcm_core::response::wrap;
use gdcm_core::study::{Edit, setting};
use gdcm_core::units::s_to_ms;
use gdcm_files::figure::{BodeOptions, ConditionSource};

use crate::view::command::Command;
use crate::view::curve_display::CurveCommand;
use crate::view::palette::Palette;
use crate::view::plot::{
    BodeCurve, BodeEvent, BodeQuantity, BodeScene, BodeView, Chip, CurveId, CurveWish, FrequencyUnit, Pane, Readout,
    ReadoutRow, Role, bode_ui, decimals,
};
use crate::view::state::State;

/// Draws a plot over frequency of the condition shown with what all of them have in common: cursors, what every role has there, chips.
/// Pushes what was done in it, and what the pointer means.
pub(super) fn frequency_plot_ui(
    ui: &mut Ui,
    state: &State,
    (scene, view): (BodeScene<'_>, &mut BodeView),
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let display = &state.display.curves;
    let (quantity, curves, unit) = (scene.quantity, scene.curves, state.display.unit);
    let at = (display.cursor, display.pinned.as_slice());
    let readout = if display.lists_values { cursor_readout(curves, quantity, unit, at) } else { None };
    let (chips, of_chips): (Vec<Chip>, Vec<Command>) = chips(state).into_iter().unzip();
    let scene = BodeScene {
        cursor: display.cursor,
        pinned: &display.pinned,
        readout: readout.as_ref(),
        hidden_roles: &display.hidden_roles,
        chips: &chips,
        unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        ..scene
    };
    for event in bode_ui(ui, &scene, view, palette) {
        commands.extend(match event {
            BodeEvent::Wished(id, CurveWish::CopyValues) => {
                curves.iter().find(|curve| curve.id == id).map(|curve| Command::CopyText(values(quantity, curve)))
            }
            BodeEvent::ChipClicked(index) => of_chips.get(index).cloned(),
            event => command_of(state, event),
        });
    }
    if let Some(CurveId::Model(id)) = view.hovered() {
        commands.push(Command::Hover(id.clone()));
    }
    commands.extend(view.pointed_omega().map(|omega| CurveCommand::PointAt(omega).into()));
}

fn command_of(state: &State, event: BodeEvent) -> Option<Command> {
    match event {
        BodeEvent::Clicked(CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        BodeEvent::TakenBack(CurveId::Model(id)) => {
            let rejected = state.study.is_rejected(&id);
            Some(Command::Forget(if rejected { Edit::Reject(id) } else { Edit::Restore(id) }))
        }
        BodeEvent::Isolated(CurveId::Model(id)) => Some(Command::Isolate(id)),
        BodeEvent::BandDragged { min, max } => Band::new(min, max).ok().map(|band| setting::BAND.to(band).into()),
        BodeEvent::BandReleased => Some(Command::EndEdit),
        BodeEvent::RoleToggled(role) => Some(CurveCommand::ToggleRole(role).into()),
        BodeEvent::RejectedBecause(CurveId::Model(model), reason) => Some(Edit::RejectBecause { model, reason }.into()),
        BodeEvent::Wished(id, wish) => wished(state, id, wish),
        BodeEvent::Boxed(curves) => {
            let models = curves.into_iter().filter_map(|curve| match curve {
                CurveId::Model(id) => Some(id),
                CurveId::Corrected | CurveId::Scheduled | CurveId::WithoutLeads => None,
            });
            Some(CurveCommand::Select(models.collect()).into())
        }
        BodeEvent::CursorPinned(omega) => Some(CurveCommand::PinCursor(omega).into()),
        BodeEvent::CursorsUnpinned => Some(CurveCommand::UnpinCursors.into()),
        BodeEvent::Hovered(_)
        | BodeEvent::Clicked(_)
        | BodeEvent::TakenBack(_)
        | BodeEvent::Isolated(_)
        | BodeEvent::RejectedBecause(..)
        | BodeEvent::ChipClicked(_) => None,
    }
}

fn reject_or_restore(state: &State, id: ModelId) -> Command {
    if state.study.is_rejected(&id) { Edit::Restore(id) } else { Edit::Reject(id) }.into()
}

/// What a wish about a curve asks for.
pub(super) fn wished(state: &State, id: CurveId, wish: CurveWish) -> Option<Command> {
    match (wish, id) {
        (CurveWish::Turn(by), id) => {
            Some(CurveCommand::Turn(state.condition().id(), state.display.pair, id, by).into())
        }
        (CurveWish::RejectOrRestore, CurveId::Model(id)) => Some(reject_or_restore(state, id)),
        (CurveWish::Pin, CurveId::Model(id)) => Some(Edit::Pin(id).into()),
        (CurveWish::Isolate, CurveId::Model(id)) => Some(Command::Isolate(id)),
        (CurveWish::Hide, CurveId::Model(id)) => Some(CurveCommand::HideModel(id).into()),
        (_, CurveId::Model(_) | CurveId::Corrected | CurveId::Scheduled | CurveId::WithoutLeads) => None,
    }
}

/// The numbers of a curve as text: a heading, then a line for each frequency, with tabs between.
fn values(quantity: BodeQuantity<'_>, curve: &BodeCurve) -> String {
    let mut text = format!(
        "{}\nω [rad/s]\t{}\t{}\n",
        curve.label,
        quantity.drawn_label(Pane::Magnitude),
        quantity.drawn_label(Pane::Phase)
    );
    let numbers = curve.omega.iter().zip(curve.magnitude_db.iter().zip(curve.phase_deg.iter()));
    for (omega, (magnitude, phase)) in numbers {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{omega}\t{magnitude}\t{phase}");
    }
    text
}

/// What holds for the plots over frequency now, with the command that ends it or acts on it.
fn chips(state: &State) -> Vec<(Chip, Command)> {
    let chip = |text: String, hint: &str, command: Command| (Chip { text, hint: hint.to_owned() }, command);
    let mut chips = Vec::new();
    if let Some(id) = &state.display.isolated {
        let hint = "Only this model is shown beside the representatives. Click, or Escape: show all";
        chips.push(chip(format!("Only {} ×", id.name), hint, Command::EndIsolation));
    }
    let curves = &state.display.curves;
    let of_condition = |id: &&ModelId| id.condition == state.condition().id();
    let selected: Vec<ModelId> = curves.selected.iter().filter(of_condition).cloned().collect();
    let (rejected, kept): (Vec<ModelId>, Vec<ModelId>) =
        selected.into_iter().partition(|id| state.study.is_rejected(id));
    let any_selected = !(rejected.is_empty() && kept.is_empty());
    if !kept.is_empty() {
        let hint = "Take the models that the box was drawn over out of their bundles";
        chips.push(chip(format!("Reject {}", counted(kept.len())), hint, Edit::RejectEach(kept).into()));
    }
    if !rejected.is_empty() {
        let hint = "Put the rejected models that the box was drawn over back";
        chips.push(chip(format!("Restore {}", counted(rejected.len())), hint, Edit::RestoreEach(rejected).into()));
    }
    if any_selected {
        let hint = "Leave them as they are (Escape)";
        chips.push(chip("Select none ×".to_owned(), hint, CurveCommand::Select(BTreeSet::new()).into()));
    }
    let hidden = curves.hidden_models.iter().filter(of_condition).count();
    if hidden > 0 {
        let hint = "Draw every model again";
        chips.push(chip(format!("{} hidden ×", counted(hidden)), hint, CurveCommand::ShowHidden.into()));
    }
    chips
}

fn counted(models: usize) -> String {
    if models == 1 { "1 model".to_owned() } else { format!("{models} models") }
}

/// What the curves of the condition shown are made of; none until its responses are there.
pub(in crate::view) fn condition_source(state: &State) -> Option<ConditionSource<'_>> {
    let schedule = state.analysis().and_then(|analysis| analysis.schedule.as_ref().ok());
    Some(ConditionSource { study: &state.study, analysis: state.shown(), schedule, curves: state.curves()? })
}

/// What of the responses is shown, and how: the same on paper.
pub(in crate::view) fn bode_options(state: &State) -> BodeOptions {
    let (display, curves) = (&state.display, &state.display.curves);
    BodeOptions {
        unit: display.unit,
        magnitude: curves.magnitude,
        phase: curves.phase,
        phase_error: curves.phase_error,
        turns: curves.turns.clone(),
        shows_muad: curves.shows_muad,
        zeros_of: display.show_zeros.then_some(display.pair),
        hidden: curves.hidden_roles.clone(),
        hidden_models: curves.hidden_models.clone(),
        isolated: display.isolated.clone().filter(|model| model.condition == state.condition().id()),
        ..BodeOptions::default()
    }
}

/// Every curve of one response in the condition shown; none until its responses are there.
pub(super) fn bode_curves(state: &mut State, pair: Pair) -> Vec<BodeCurve> {
    let mut cache = state.display.shapes.remove(&pair).unwrap_or_default();
    let options = bode_options(state);
    let curves = condition_source(state).map(|source| source.response_curves(pair, &options, &mut cache));
    let drawn = pointed_out(state, curves.unwrap_or_default());
    state.display.shapes.insert(pair, cache);
    drawn
}

/// What the fit sees of one response in the condition shown; none until its responses are there.
pub(super) fn error_curves(state: &mut State, pair: Pair, options: &BodeOptions) -> Vec<BodeCurve> {
    let mut cache = std::mem::take(&mut state.display.errors);
    let curves = condition_source(state).map(|source| source.error_curves(pair, options, &mut cache));
    let drawn = pointed_out(state, curves.unwrap_or_default());
    state.display.errors = cache;
    drawn
}

/// The curves with what they are in the window: those pointed at stand out, and what a click does is said.
fn pointed_out(state: &State, mut curves: Vec<BodeCurve>) -> Vec<BodeCurve> {
    for curve in &mut curves {
        match &curve.id {
            CurveId::Model(id) => {
                let is_selected = state.display.curves.selected.contains(id);
                curve.highlighted = is_selected || state.display.hovered.as_ref() == Some(id);
                let action = if curve.rejected { "click to restore" } else { "click to reject" };
                let separator = if curve.detail.is_empty() { "" } else { " · " };
                curve.detail = format!("{}{separator}{action}", curve.detail);
            }
            CurveId::Scheduled if state.others_are_older() => curve.label.push_str(" of older settings"),
            CurveId::Corrected | CurveId::Scheduled | CurveId::WithoutLeads => {}
        }
    }
    curves
}

/// The values of every role at the cursor \[rad/s\], or what changes between two marked frequencies; nothing without either.
pub fn cursor_readout(
    curves: &[BodeCurve],
    quantity: BodeQuantity<'_>,
    unit: FrequencyUnit,
    (cursor, pinned): (Option<f64>, &[f64]),
) -> Option<Readout> {
    let of_each = |row: &dyn Fn(&[&BodeCurve]) -> Vec<String>| -> Vec<ReadoutRow> {
        let members = |role: Role| -> Vec<&BodeCurve> {
            curves.iter().filter(|curve| !curve.hidden && curve.role.shown(curve.rejected) == role).collect()
        };
        let rows = Role::ALL.into_iter().map(|role| (role, members(role)));
        let present = rows.filter(|(_, members)| !members.is_empty());
        present.map(|(role, members)| ReadoutRow { role, cells: row(&members) }).collect()
    };
    if let [from, to] = *pinned {
        let heading = format!("{} → {}", unit.readout(from), unit.readout(to));
        let rows = of_each(&|members| change_cells(members, quantity, (from, to)));
        return Some(Readout { heading, columns: names(quantity, ["Δ", "Δ"]), rows });
    }
    let omega = cursor.or(pinned.first().copied())?;
    let heading = unit.readout(omega);
    let readout = match quantity {
        BodeQuantity::Error { .. } => {
            let rows = of_each(&|members| value_cells(members, quantity, omega).to_vec());
            Readout { heading, columns: names(quantity, ["", ""]), rows }
        }
        BodeQuantity::Response { .. } => {
            let reference = curves.iter().find(|curve| curve.role == Role::IdentifiedRepresentative);
            let rows = of_each(&|members| {
                let differences = difference_cells(members, reference, omega);
                value_cells(members, quantity, omega).into_iter().chain(differences).collect()
            });
            let mut columns = names(quantity, ["", ""]);
            columns.extend(["Δ dB", "Δ deg", "Δ ms"]);
            Readout { heading, columns, rows }
        }
    };
    Some(readout)
}

/// The columns of magnitude and phase.
fn names(quantity: BodeQuantity<'_>, marks: [&str; 2]) -> Vec<&'static str> {
    let is_change = !marks[0].is_empty();
    [Pane::Magnitude, Pane::Phase].map(|pane| quantity.column(pane, is_change)).to_vec()
}

/// One number of several curves: itself, or from where to where it goes.
fn cell(values: impl Iterator<Item = f64>, count: usize) -> String {
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|value| value.is_finite()) {
        (least, greatest) = (least.min(value), greatest.max(value));
    }
    match (least <= greatest, decimals(least, count), decimals(greatest, count)) {
        (false, ..) => "–".to_owned(),
        (true, least, greatest) if least == greatest => least,
        (true, least, greatest) => format!("{least}…{greatest}"),
    }
}

fn value_cells(members: &[&BodeCurve], quantity: BodeQuantity<'_>, omega: f64) -> [String; 2] {
    [Pane::Magnitude, Pane::Phase].map(|pane| {
        let values = members.iter().filter_map(|curve| curve.value_at(pane, omega));
        cell(values.map(|value| quantity.shown_value(pane, value)), quantity.decimals(pane))
    })
}

fn change_cells(members: &[&BodeCurve], quantity: BodeQuantity<'_>, (from, to): (f64, f64)) -> Vec<String> {
    let change = |pane| {
        let of = move |curve: &&BodeCurve| Some(curve.value_at(pane, to)? - curve.value_at(pane, from)?);
        cell(members.iter().filter_map(of), quantity.decimals(pane))
    };
    [Pane::Magnitude, Pane::Phase].map(change).to_vec()
}

/// Magnitude \[dB\] and phase \[deg\] less those of the reference, and the delay \[ms\] that the difference of phases means: its
/// principal value, for a single frequency knows no turns (M4).
fn difference_cells(members: &[&BodeCurve], reference: Option<&BodeCurve>, omega: f64) -> [String; 3] {
    let difference = |pane| {
        let of_reference = reference.and_then(|reference| reference.value_at(pane, omega));
        members.iter().filter_map(move |curve| Some(curve.value_at(pane, omega)? - of_reference?))
    };
    let phases: Vec<f64> = difference(Pane::Phase).map(|degrees| wrap(degrees.to_radians())).collect();
    [
        cell(difference(Pane::Magnitude), 2),
        cell(phases.iter().map(|phase| phase.to_degrees()), 1),
        cell(phases.iter().map(|phase| s_to_ms(phase / omega)), 1),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::plot::CurveId;
    use gdcm_core::dataset::{BundleKind, ConditionId, ModelId};

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
        ]
    }

    fn readout(pinned: &[f64]) -> Readout {
        let cursor = pinned.is_empty().then_some(1.0);
        let unit = FrequencyUnit::RadPerSecond;
        cursor_readout(&curves(), BodeQuantity::RESPONSE, unit, (cursor, pinned)).unwrap()
    }

    fn cells(readout: &Readout, role: Role) -> Vec<&str> {
        let row = readout.rows.iter().find(|row| row.role == role).unwrap();
        row.cells.iter().map(String::as_str).collect()
    }

    #[test]
    fn every_role_is_listed_with_its_difference_from_the_identified_model() {
        let readout = readout(&[]);
        assert_eq!(readout.columns, ["dB", "deg", "Δ dB", "Δ deg", "Δ ms"]);
        // 400° is a turn and 30° ahead of 10°: 30° at 1 rad/s are 523.6 ms.
        assert_eq!(cells(&readout, Role::Nominal), ["2.0", "400", "1.00", "30.0", "523.6"]);
        assert_eq!(cells(&readout, Role::IdentifiedRepresentative), ["1.0", "10", "0.00", "0.0", "0.0"]);
        assert_eq!(cells(&readout, Role::Perturbed)[0], "\u{2212}3.0…\u{2212}1.0", "of several models, the range");
    }

    #[test]
    fn between_two_marks_the_changes_are_listed() {
        let readout = readout(&[1.0, 4.0]);
        assert_eq!(readout.columns, ["Δ dB", "Δ deg"]);
        assert_eq!(cells(&readout, Role::Nominal), ["0.0", "\u{2212}90"]);
        assert_eq!(readout.heading, "ω 1.00 rad/s → ω 4.00 rad/s");
    }

    #[test]
    fn without_a_cursor_there_is_nothing_to_list() {
        let unit = FrequencyUnit::RadPerSecond;
        assert_eq!(cursor_readout(&curves(), BodeQuantity::RESPONSE, unit, (None, &[])), None);
    }
}
