//! Views of responses over frequency: the response in focus, large; its errors as used by the fit;
//! the same response in every condition; and every response of a condition, small.

use egui::{Align2, Pos2, Rect, Ui, vec2};

use gdcm_model::dataset::Pair;
use gdcm_model::number_format::decimals;
use gdcm_model::units::{number, ratio_to_db, s_to_ms};
use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::error::{muad_about, noticed};
use gdcm_plot::figure::responses::{airspeed_curves, uncertainty_bands};
use gdcm_study::AcrossRole;
use gdcm_study::jobs::curve_jobs::AcrossJob;
use gdcm_study::results::caution::Undefined;
use gdcm_study::stages::condition_curves::display_band;
use gdcm_words::caution::undefined_text;

use super::frequency::{
    bode_curves, bode_options, condition_source, error_curves, error_reference, frequency_plot_ui,
    wished,
};
use crate::gui::commands::command::Command;
use crate::gui::commands::display::DisplayCommand;
use crate::gui::commands::layout::LayoutCommand;
use crate::gui::commands::selection::SelectionCommand;
use crate::gui::plot::bode_event::BodeEvent;
use crate::gui::plot::bode_scene::{BodeBand, InvalidRegion, PaneNote};
use crate::gui::plot::curve_command::CurveCommand;
use crate::gui::plot::overview::{OverviewCell, OverviewEvent, OverviewScene, overview_ui};
use crate::gui::plot::pointed_curve::pointed_words;
use crate::gui::plot::quantity::{BodeQuantity, PhaseErrorUnit, ResponsePlace};
use crate::gui::plot::{BodeCurve, BodeScene, CurveId, Pane, Role, bode_ui};
use crate::gui::state::view::View;
use crate::gui::state::window_state::State;
use crate::gui::widgets::choices::choice_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Draws magnitude and phase of the response in focus, for every model of the displayed condition.
pub fn bode_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pair = state.display.selection.pair;
    let mut view = std::mem::take(&mut state.display.frequency.bode);
    let curves = bode_curves(state, pair);
    let title = state.dataset().pair_name(pair);
    let ratio_unit = ConditionSource::ratio_unit(state.dataset(), pair);
    let display = &state.display.curves;
    let quantity = BodeQuantity::Response {
        magnitude: display.magnitude,
        phase: display.phase,
        ratio_unit: &ratio_unit,
        place: ResponsePlace::Condition,
    };
    let band = state.study.settings.band;
    let bands = uncertainty_bands(state.dataset(), pair, &curves);
    let shows_bands = (!bands.is_empty()).then_some(display.shows_bands);
    let options = bode_options(state);
    let unnoticed = muad_about(&curves, &options);
    let source = condition_source(state);
    let coherence = source
        .as_ref()
        .map(|source| source.coherence_curves(pair, &options))
        .unwrap_or_default();
    let least_coherence = source
        .as_ref()
        .map_or(0.0, ConditionSource::least_coherence);
    let missing = missing_phase(&curves, (band.min(), band.max()));
    let invalid = invalid_region(state, &curves);
    let notes = notes(state, pair);
    let notes = notes
        .as_ref()
        .map_or([None; 2], |notes| [Some(&notes[0]), Some(&notes[1])]);
    let band = (band.min(), band.max());
    let message = state.curves_message();
    let scene = BodeScene {
        quantity,
        rules: &unnoticed,
        coherence: &coherence,
        least_coherence,
        bands: &bands,
        shows_bands,
        missing: missing.as_ref(),
        invalid: invalid.as_ref(),
        notes,
        message,
        ..BodeScene::new(&title, &curves, band)
    };
    frequency_plot_ui(ui, state, (scene, &mut view), palette, commands);
    state.display.frequency.error.share_frequencies(&view);
    state.display.frequency.bode = view;
    state.display.frequency.drawn = curves;
}

/// Returns the region where curves only illustrate the price of leads; `None` without leads
/// (M15.6).
fn invalid_region(state: &State, curves: &[BodeCurve]) -> Option<InvalidRegion> {
    let leads = &state.shown()?.compensated.as_ref()?.leads;
    leads.filters().iter().find_map(|(_, filter)| *filter)?;
    let last = |role: Role| {
        curves
            .iter()
            .find(|curve| !curve.hidden && curve.role == role)
            .map(|curve| &curve.omega)
    };
    let up_to = *last(Role::Corrected)?.last()?;
    let end = |role: Role| {
        let curve = curves
            .iter()
            .find(|curve| !curve.hidden && curve.role == role)?;
        curve.value_at(Pane::Magnitude, up_to)
    };
    let ends_db = end(Role::Corrected)
        .zip(end(Role::WithoutLeads))
        .map(|(with, without)| [with, without]);
    let words = format!(
        "not valid above {}",
        unit_words(state, state.study.settings.band.max())
    );
    Some(InvalidRegion {
        up_to,
        words,
        ends_db,
    })
}

/// Returns the area between the phases of the corrected and of the identified model, within the
/// band \[rad/s\].
fn missing_phase(curves: &[BodeCurve], (min, max): (f64, f64)) -> Option<BodeBand> {
    let of_role = |role: Role| {
        curves
            .iter()
            .find(|curve| !curve.hidden && curve.role == role)
    };
    let corrected = of_role(Role::Corrected)?;
    let identified = of_role(Role::IdentifiedRepresentative)?;
    let within = corrected
        .omega
        .iter()
        .copied()
        .filter(|omega| (min..=max).contains(omega));
    let omega: Vec<f64> = [min].into_iter().chain(within).chain([max]).collect();
    let value = |curve: &BodeCurve, omega| curve.value_at(Pane::Phase, omega).unwrap_or(f64::NAN);
    let phase_deg = omega
        .iter()
        .map(|omega| [value(corrected, *omega), value(identified, *omega)])
        .collect();
    Some(BodeBand {
        magnitude_db: vec![[f64::NAN; 2]; omega.len()],
        omega,
        phase_deg,
    })
}

/// Returns J of magnitude and phase before and after the correction, and the remainder in words.
fn notes(state: &State, pair: Pair) -> Option<[PaneNote; 2]> {
    let shown = state.shown()?;
    let change = shown.cost[pair]?;
    let is_held = shown.held()[pair];
    let cost =
        |before: f64, after: f64| format!("J {} → {}", decimals(before, 1), decimals(after, 1));
    let left_db = ratio_to_db(shown.wanted_gain(pair)? / shown.correction.net_gain(pair));
    let magnitude = PaneNote {
        cost: cost(change.uncorrected.magnitude, change.corrected.magnitude),
        verdict: match left_db.abs() < 0.05 {
            true => "matched".to_owned(),
            false => format!("{} dB left", decimals(left_db, 1)),
        },
        warns: is_held && left_db.abs() >= 0.05,
    };
    let left_s = shown.wanted_delay_s(pair)? - shown.correction.net_delay_s(pair);
    let top = state.study.settings.band.max();
    let verdict = if left_s.abs() < 0.5e-3 {
        "matched".to_owned()
    } else {
        let verb = if left_s < 0.0 { "lags" } else { "leads" };
        let at_top = decimals((left_s * top).to_degrees().abs(), 0);
        format!(
            "{verb} by {} ms, {at_top}° at {}",
            decimals(s_to_ms(left_s.abs()), 0),
            unit_words(state, top)
        )
    };
    let phase = PaneNote {
        cost: cost(change.uncorrected.phase, change.corrected.phase),
        verdict,
        warns: is_held && left_s.abs() >= 0.5e-3,
    };
    Some([magnitude, phase])
}

fn unit_words(state: &State, omega: f64) -> String {
    let unit = state.display.curves.unit;
    format!("{} {}", number(unit.of_omega(omega)), unit.symbol())
}

/// Draws the errors of the response in focus for every kept physics model, beside the errors left
/// by the correction.
pub fn error_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pair = state.display.selection.pair;
    let mut view = std::mem::take(&mut state.display.frequency.error);
    let options = bode_options(state);
    let curves = error_curves(state, pair, &options);
    let rules = condition_source(state)
        .map(|source| source.error_references(pair, &options, &curves))
        .unwrap_or_default();
    let reference = error_reference(&curves);
    let strips = noticed(&curves, &options);
    let title = state.dataset().pair_name(pair);
    let message = error_message(state, pair);
    let quantity = BodeQuantity::Error {
        phase: options.phase_error,
    };
    let band = state.study.settings.band;
    let grid = state.curves().map(|curves| curves.grid.omega());
    let scene = BodeScene {
        quantity,
        rules: &rules,
        reference: reference.as_ref(),
        strips: &strips,
        omega_range: grid.and_then(|omega| Some((*omega.first()?, *omega.last()?))),
        message: Some(&message),
        ..BodeScene::new(&title, &curves, (band.min(), band.max()))
    };
    frequency_plot_ui(ui, state, (scene, &mut view), palette, commands);
    state.display.frequency.bode.share_frequencies(&view);
    state.display.frequency.error = view;
    state.display.frequency.drawn_errors = curves;
}

/// Draws the selection of the unit of phase differences.
pub fn error_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut unit = state.display.curves.phase_error;
    let units = [
        (PhaseErrorUnit::Degree, "Δφ", "Phase differences in degrees"),
        (
            PhaseErrorUnit::Millisecond,
            "Δφ/ω",
            "The delay [ms] that would make up for each phase difference",
        ),
    ];
    choice_ui(ui, "Phase error", &mut unit, &units);
    if unit != state.display.curves.phase_error {
        commands.push(CurveCommand::DrawPhaseErrors(unit).into());
    }
}

/// Returns the message shown instead of missing errors.
pub fn error_message(state: &State, pair: Pair) -> String {
    match state.shown() {
        Some(shown) if shown.comparison.undefined[pair] == Some(Undefined::NotCoherent) => {
            format!(
                "{} is not compared: {}",
                state.dataset().pair_name(pair),
                undefined_text(Undefined::NotCoherent)
            )
        }
        Some(shown) if shown.comparison.undefined[pair].is_some() => {
            let name = state.dataset().pair_name(pair);
            format!(
                "{name} is not compared: one of the representatives has no such response in the band"
            )
        }
        _ => state
            .curves_message()
            .unwrap_or("Nothing to compare in the band")
            .to_owned(),
    }
}

/// Steps of the colour key for airspeeds.
const KEY_STEPS: u8 = 24;
const KEY_SIZE: egui::Vec2 = vec2(96.0, 8.0);

/// Draws the selection of the model in each condition and the colour key, from right to left.
pub fn across_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut role = state.display.frequency.across_role;
    let roles = AcrossRole::ALL.map(|role| {
        (
            role,
            role.name(),
            "The model of each condition that is drawn",
        )
    });
    choice_ui(ui, "Model of each condition", &mut role, &roles);
    if role != state.display.frequency.across_role {
        commands.push(DisplayCommand::ShowAcross(role).into());
    }
    let (least, most) = state.dataset().airspeed_range_kt();
    ui.label(palette.small(format!("{most:.0} kt")));
    let (rect, _) = ui.allocate_exact_size(KEY_SIZE, egui::Sense::hover());
    paint_key(ui, rect, palette);
    ui.label(palette.small(format!("{least:.0} kt")));
}

/// Paints the colours from the slowest condition to the fastest.
fn paint_key(ui: &Ui, rect: Rect, palette: &Palette) {
    let width = rect.width() / f32::from(KEY_STEPS);
    for step in 0..KEY_STEPS {
        let corner = Pos2::new(rect.left() + width * f32::from(step), rect.top());
        let role = Role::OfAirspeed(step.saturating_mul(u8::MAX / (KEY_STEPS - 1)));
        let color = palette.role_style(role, false).color;
        ui.painter().rect_filled(
            Rect::from_min_size(corner, vec2(width + 0.5, rect.height())),
            0.0,
            color,
        );
    }
}

/// Draws magnitude and phase of the response in focus for a model of every condition; a click
/// selects a condition.
pub fn across_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let curves = across_curves(state);
    fit_across(state);
    let band = state.study.settings.band;
    let title = state.dataset().pair_name(state.display.selection.pair);
    let quantity = BodeQuantity::RESPONSE_OF_EVERY_CONDITION;
    let unit = state.display.curves.unit;
    let scene = BodeScene {
        quantity,
        unit,
        stale: state.results.is_stale(ui.input(|input| input.time)),
        message: Some(state.results.absence()),
        ..BodeScene::new(&title, &curves, (band.min(), band.max()))
    };
    for event in bode_ui(ui, &scene, &mut state.display.frequency.across, palette) {
        if let BodeEvent::Clicked(CurveId::Model(id)) = event {
            commands.push(SelectionCommand::SelectCondition(id.condition).into());
        }
    }
    commands.extend(
        pointed_words(&state.display.frequency.across, &curves, quantity, unit)
            .map(|value| Command::Selection(SelectionCommand::Tell(value))),
    );
    if let Some(transform) = state
        .display
        .frequency
        .across
        .transform(Pane::Magnitude)
        .filter(|_| !curves.is_empty())
    {
        let place = transform.frame().right_top() + vec2(-8.0, 6.0);
        ui.painter().text(
            place,
            Align2::RIGHT_TOP,
            title,
            egui::FontId::proportional(SMALL_SIZE),
            palette.text,
        );
    }
}

/// Fits the plot across conditions once the curves of another response or model are available.
fn fit_across(state: &mut State) {
    let asked = (
        state.display.selection.pair,
        state.display.frequency.across_role,
    );
    if state.display.frequency.across_fitted == Some(asked) {
        return;
    }
    state.display.frequency.across.request_refit();
    // Until then the previous models' curves are drawn.
    let models = across_job(state).models;
    if state
        .results
        .across
        .as_ref()
        .is_some_and(|(job, _)| job.models == models)
    {
        state.display.frequency.across_fitted = Some(asked);
    }
}

/// Number of frequencies of each curve.
const POINTS: usize = 300;

/// Returns the job of the responses needed by the view: a model of each condition.
pub fn across_job(state: &State) -> AcrossJob {
    let grid = (display_band(state.study.settings.band), POINTS);
    AcrossJob::of(
        &state.study.dataset,
        state.analysis(),
        state.display.frequency.across_role,
        grid,
    )
}

/// Returns the curves of the response in focus for a model of each condition; empty until the
/// responses are available.
pub fn across_curves(state: &mut State) -> Vec<BodeCurve> {
    let Some(curves) = state.across().cloned() else {
        return Vec::new();
    };
    let pair = state.display.selection.pair;
    let mut cached = std::mem::take(&mut state.display.frequency.across_shapes);
    let made_of = (state.dataset(), state.analysis());
    let role = state.display.frequency.across_role;
    let mut drawn = airspeed_curves(made_of, role, pair, &curves, &mut cached);
    for curve in &mut drawn {
        curve.highlighted =
            matches!(&curve.id, CurveId::Model(id) if id.condition == state.condition().id());
        curve.detail.push_str(" · click to show the condition");
    }
    state.display.frequency.across_shapes = cached;
    drawn
}

/// Draws every response of the displayed condition; a click brings a response into focus.
pub fn overview_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pairs: Vec<Pair> = state.dataset().on_axis().pairs().collect();
    let curves: Vec<Vec<BodeCurve>> = pairs
        .iter()
        .map(|&pair| {
            bode_curves(state, pair)
                .into_iter()
                .filter(|curve| !curve.hidden)
                .collect()
        })
        .collect();
    let cells: Vec<OverviewCell<'_>> = pairs
        .iter()
        .zip(&curves)
        .map(|(&pair, curves)| OverviewCell {
            pair,
            curves,
            constrained: state.study.settings.constrained[pair],
            selected: pair == state.display.selection.pair,
            note: cost_note(state, pair),
        })
        .collect();
    let (inputs, outputs) = state.dataset().names_of_channels();
    let band = state.study.settings.band;
    let scene = OverviewScene {
        inputs: &inputs,
        outputs: &outputs,
        cells: &cells,
        band: (band.min(), band.max()),
        message: Some(state.results.absence()),
    };
    for event in overview_ui(ui, &scene, &mut state.display.frequency.overview, palette) {
        match event {
            OverviewEvent::PairClicked(pair) => {
                commands.push(SelectionCommand::FocusPair(pair).into());
                commands.push(LayoutCommand::ShowView(View::Bode).into());
            }
            OverviewEvent::Hovered(CurveId::Model(id)) => {
                commands.push(SelectionCommand::Hover(id).into())
            }
            OverviewEvent::Told(words) => commands.push(SelectionCommand::Tell(words).into()),
            OverviewEvent::Isolated(CurveId::Model(id)) => {
                commands.push(SelectionCommand::Isolate(id).into())
            }
            OverviewEvent::Wished(id, wish) => commands.extend(wished(state, id, wish)),
            OverviewEvent::Hovered(_) | OverviewEvent::Isolated(_) => {}
        }
    }
}

/// Returns "J 75→61": J of the uncorrected physics representative and of the fully corrected model.
fn cost_note(state: &State, pair: Pair) -> String {
    let cost = state.shown().and_then(|shown| {
        shown.before_couplings().representative.cost[pair]
            .zip(shown.cost[pair].map(|change| change.corrected))
    });
    cost.map_or(String::new(), |(before, after)| {
        format!("J {:.0}→{:.0}", before.total(), after.total())
    })
}
