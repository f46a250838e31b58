//! Views over frequency: the response in focus, the model errors in this response, the same
//! response in every condition, and all responses in a condition.

use egui::{Align2, Pos2, Rect, Ui, vec2};

use gdcm_model::dataset::{Band, Pair};
use gdcm_model::number_format::decimals;
use gdcm_model::units::{number, ratio_to_db, s_to_ms};
use gdcm_plot::figure::ConditionSource;
use gdcm_plot::figure::error::{muad_about, noticed};
use gdcm_plot::figure::responses::{AirspeedResponse, uncertainty_bands};
use gdcm_study::AcrossRole;
use gdcm_study::jobs::curve_jobs::AcrossJob;
use gdcm_study::results::caution::Undefined;
use gdcm_study::stages::condition_curves::display_band;
use gdcm_words::caution::undefined_text;

use super::frequency::{
    FrequencyPlot, bode_curves, bode_options, condition_source, error_curves, error_reference,
    wish_command,
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

/// Draws magnitude and phase of the response in focus, for every model in the displayed condition.
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
    let shows_bands = if bands.is_empty() {
        None
    } else {
        Some(display.shows_bands)
    };
    let options = bode_options(state);
    let unnoticed = muad_about(&curves, &options);
    let mut coherence = Vec::new();
    let mut least_coherence = 0.0;
    if let Some(source) = condition_source(state) {
        coherence = source.coherence_curves(pair, &options);
        least_coherence = source.least_coherence();
    }
    let missing = missing_phase(&curves, band);
    let invalid = invalid_region(state, &curves);
    let notes = effect_notes(state, pair);
    let scene = BodeScene {
        quantity,
        rules: &unnoticed,
        coherence: &coherence,
        least_coherence,
        bands: &bands,
        shows_bands,
        missing: missing.as_ref(),
        invalid: invalid.as_ref(),
        notes: match &notes {
            Some([magnitude, phase]) => [Some(magnitude), Some(phase)],
            None => [None; 2],
        },
        message: state.curves_message(),
        ..BodeScene::new(&title, &curves, (band.min(), band.max()))
    };
    let plot = FrequencyPlot {
        state,
        scene,
        view: &mut view,
        palette,
    };
    plot.ui(ui, commands);
    state.display.frequency.error.share_frequencies(&view);
    state.display.frequency.bode = view;
    state.display.frequency.drawn = curves;
}

/// Returns the curve with this role, unless it is hidden.
fn drawn_curve(curves: &[BodeCurve], role: Role) -> Option<&BodeCurve> {
    curves
        .iter()
        .find(|curve| !curve.hidden && curve.role == role)
}

/// Returns the region above the band in which the corrected model is not valid and only shows the
/// gain added by leads; `None` without leads (M15.6).
fn invalid_region(state: &State, curves: &[BodeCurve]) -> Option<InvalidRegion> {
    let leads = &state.shown()?.compensated.as_ref()?.leads;
    leads.filters().iter().find_map(|(_, filter)| *filter)?;
    let corrected = drawn_curve(curves, Role::Corrected)?;
    let up_to = *corrected.omega.last()?;
    Some(InvalidRegion {
        up_to,
        words: format!(
            "not valid above {}",
            frequency_words(state, state.study.settings.band.max())
        ),
        ends_db: lead_ends_db(corrected, curves, up_to),
    })
}

/// Returns the magnitudes \[dB\] of the corrected model with and without leads at `omega`
/// \[rad/s\].
fn lead_ends_db(corrected: &BodeCurve, curves: &[BodeCurve], omega: f64) -> Option<[f64; 2]> {
    let without = drawn_curve(curves, Role::WithoutLeads)?;
    Some([
        corrected.value_at(Pane::Magnitude, omega)?,
        without.value_at(Pane::Magnitude, omega)?,
    ])
}

/// Returns the area between corrected and identified phase within the band.
fn missing_phase(curves: &[BodeCurve], band: Band) -> Option<BodeBand> {
    let corrected = drawn_curve(curves, Role::Corrected)?;
    let identified = drawn_curve(curves, Role::IdentifiedRepresentative)?;
    let mut omega = vec![band.min()];
    for &inner in corrected.omega.iter() {
        if (band.min()..=band.max()).contains(&inner) {
            omega.push(inner);
        }
    }
    omega.push(band.max());
    let phase_deg = omega
        .iter()
        .map(|&omega| {
            [corrected, identified]
                .map(|curve| curve.value_at(Pane::Phase, omega).unwrap_or(f64::NAN))
        })
        .collect();
    Some(BodeBand {
        magnitude_db: vec![[f64::NAN; 2]; omega.len()],
        omega,
        phase_deg,
    })
}

/// Remaining magnitude difference \[dB\] below which the magnitudes count as matched.
const MATCHED_DB: f64 = 0.05;
/// Remaining delay \[s\] below which the phases count as matched.
const MATCHED_S: f64 = 0.5e-3;

/// Returns the notes in the magnitude and phase panes: J before and after the correction, and the
/// gain and delay that the correction leaves uncorrected.
fn effect_notes(state: &State, pair: Pair) -> Option<[PaneNote; 2]> {
    let shown = state.shown()?;
    let change = shown.cost[pair]?;
    let is_constrained = shown.held()[pair];
    let left_db = ratio_to_db(shown.wanted_gain(pair)? / shown.correction.net_gain(pair));
    let left_s = shown.wanted_delay_s(pair)? - shown.correction.net_delay_s(pair);
    let magnitude = PaneNote {
        cost: cost_change(change.uncorrected.magnitude, change.corrected.magnitude),
        verdict: if left_db.abs() < MATCHED_DB {
            "matched".to_owned()
        } else {
            format!("{} dB left", decimals(left_db, 1))
        },
        warns: is_constrained && left_db.abs() >= MATCHED_DB,
    };
    let phase = PaneNote {
        cost: cost_change(change.uncorrected.phase, change.corrected.phase),
        verdict: delay_verdict(state, left_s),
        warns: is_constrained && left_s.abs() >= MATCHED_S,
    };
    Some([magnitude, phase])
}

/// Formats "J 13.4 → 0.3".
fn cost_change(before: f64, after: f64) -> String {
    format!("J {} → {}", decimals(before, 1), decimals(after, 1))
}

/// Formats a remaining delay as "lags by 66 ms, 46° at 12 rad/s"; the corrected model lags if
/// `left_s` is negative.
fn delay_verdict(state: &State, left_s: f64) -> String {
    if left_s.abs() < MATCHED_S {
        return "matched".to_owned();
    }
    let verb = if left_s < 0.0 { "lags" } else { "leads" };
    let top = state.study.settings.band.max();
    let at_top_deg = (left_s * top).to_degrees().abs();
    format!(
        "{verb} by {} ms, {}° at {}",
        decimals(s_to_ms(left_s.abs()), 0),
        decimals(at_top_deg, 0),
        frequency_words(state, top)
    )
}

/// Formats a frequency \[rad/s\] in the displayed unit.
fn frequency_words(state: &State, omega: f64) -> String {
    let unit = state.display.curves.unit;
    format!("{} {}", number(unit.of_omega(omega)), unit.symbol())
}

/// Draws the ratio and phase difference of every kept physics model and of the corrected model to
/// the identified model, in the response in focus.
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
    let rules = match condition_source(state) {
        Some(source) => source.error_references(pair, &options, &curves),
        None => Vec::new(),
    };
    let reference = error_reference(&curves);
    let strips = noticed(&curves, &options);
    let title = state.dataset().pair_name(pair);
    let message = error_message(state, pair);
    let quantity = BodeQuantity::Error {
        phase: options.phase_error,
    };
    let band = state.study.settings.band;
    let mut omega_range = None;
    if let Some(curves) = state.curves()
        && let (Some(first), Some(last)) = (curves.grid.omega().first(), curves.grid.omega().last())
    {
        omega_range = Some((*first, *last));
    }
    let scene = BodeScene {
        quantity,
        rules: &rules,
        reference: reference.as_ref(),
        strips: &strips,
        omega_range,
        message: Some(&message),
        ..BodeScene::new(&title, &curves, (band.min(), band.max()))
    };
    let plot = FrequencyPlot {
        state,
        scene,
        view: &mut view,
        palette,
    };
    plot.ui(ui, commands);
    state.display.frequency.bode.share_frequencies(&view);
    state.display.frequency.error = view;
    state.display.frequency.drawn_errors = curves;
}

/// Draws the selector between phase differences \[deg\] and equivalent delays \[ms\].
pub fn error_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut unit = state.display.curves.phase_error;
    let units = [
        (PhaseErrorUnit::Degree, "Δφ", "Phase differences [deg]"),
        (
            PhaseErrorUnit::Millisecond,
            "Δφ/ω",
            "Equivalent delay of each phase difference [ms]",
        ),
    ];
    choice_ui(ui, "Phase error", &mut unit, &units);
    if unit != state.display.curves.phase_error {
        commands.push(CurveCommand::DrawPhaseErrors(unit).into());
    }
}

/// Returns the message shown if there are no error curves.
pub fn error_message(state: &State, pair: Pair) -> String {
    let name = state.dataset().pair_name(pair);
    let undefined = match state.shown() {
        Some(shown) => shown.comparison.undefined[pair],
        None => None,
    };
    match undefined {
        Some(Undefined::NotCoherent) => {
            format!(
                "{name} is not compared: {}",
                undefined_text(Undefined::NotCoherent)
            )
        }
        Some(_) => {
            format!(
                "{name} is not compared: a representative has no values of this response \
                within the band"
            )
        }
        None => match state.curves_message() {
            Some(message) => message.to_owned(),
            None => "Nothing to compare in the band".to_owned(),
        },
    }
}

/// Number of steps in the colour key of the airspeeds.
const KEY_STEPS: u8 = 24;
const KEY_SIZE: egui::Vec2 = vec2(96.0, 8.0);

/// Draws the selector of the models and the colour key of the airspeed, from right to left.
pub fn across_header_ui(
    ui: &mut Ui,
    state: &State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut role = state.display.frequency.across_role;
    let roles = AcrossRole::ALL.map(|role| (role, role.name(), "Model drawn for each condition"));
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
    let view = &state.display.frequency.across;
    if let Some(words) = pointed_words(view, &curves, quantity, unit) {
        commands.push(SelectionCommand::Tell(words).into());
    }
    if let Some(transform) = view.transform(Pane::Magnitude)
        && !curves.is_empty()
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

/// Fits the value axes in each frame until the curves of a newly selected response or model are
/// available.
fn fit_across(state: &mut State) {
    let asked = (
        state.display.selection.pair,
        state.display.frequency.across_role,
    );
    if state.display.frequency.across_fitted == Some(asked) {
        return;
    }
    state.display.frequency.across.request_refit();
    // Until then, the previous curves are drawn, and the fit must be repeated.
    if let Some((job, _)) = &state.results.across
        && job.models == across_job(state).models
    {
        state.display.frequency.across_fitted = Some(asked);
    }
}

/// Number of frequencies on each curve.
const POINTS: usize = 300;

/// Returns the job that computes the responses in the view: a model of each condition.
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
    let mut cached = std::mem::take(&mut state.display.frequency.across_shapes);
    let response = AirspeedResponse {
        dataset: state.dataset(),
        analysis: state.analysis(),
        role: state.display.frequency.across_role,
        pair: state.display.selection.pair,
        responses: &curves,
    };
    let mut drawn = response.curves(&mut cached);
    for curve in &mut drawn {
        curve.highlighted =
            matches!(&curve.id, CurveId::Model(id) if id.condition == state.condition().id());
        curve.detail.push_str(" · click to show the condition");
    }
    state.display.frequency.across_shapes = cached;
    drawn
}

/// Draws every response in the displayed condition; a click shows a response in the Bode view.
pub fn overview_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let pairs: Vec<Pair> = state.dataset().on_axis().pairs().collect();
    let mut curves: Vec<Vec<BodeCurve>> = Vec::new();
    for &pair in &pairs {
        let mut drawn = bode_curves(state, pair);
        drawn.retain(|curve| !curve.hidden);
        curves.push(drawn);
    }
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
            OverviewEvent::Wished(id, wish) => commands.extend(wish_command(state, id, wish)),
            OverviewEvent::Hovered(_) | OverviewEvent::Isolated(_) => {}
        }
    }
}

/// Returns "J 75→61": J of the uncorrected physics representative, and of the fully corrected
/// model. Empty unless both are available.
fn cost_note(state: &State, pair: Pair) -> String {
    let Some(shown) = state.shown() else {
        return String::new();
    };
    let before = shown.before_couplings().representative.cost[pair];
    match (before, shown.cost[pair]) {
        (Some(before), Some(change)) => {
            format!("J {:.0}→{:.0}", before.total(), change.corrected.total())
        }
        _ => String::new(),
    }
}
