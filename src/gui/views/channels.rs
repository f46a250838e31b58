//! Channel gains over airspeed.

use egui::{Align2, FontId, Rect, Ui, Vec2, pos2, vec2};

use gdcm_method::uncertainty::{Bar, Scalar};
use gdcm_model::units::s_to_ms;
use gdcm_plot::figure::gains::{Across, GainQuantity, Measure, channels_figure, quieten};
use gdcm_plot::figure::{Figure, MarkId, all_channels};
use gdcm_study::Edit;
use gdcm_study::results::uncertainty::Uncertainty;
use gdcm_words::ExplainTarget;

use super::net_gain::bars_switch_ui;
use crate::gui::commands::command::Command;
use crate::gui::panels::settings_panel::choice_ui;
use crate::gui::plot::curve_menu::NamedFigure;
use crate::gui::plot::figure_view::{figure_within_ui, rows};
use crate::gui::plot::{FigureEvent, FigureScene, FigureView, FigureWords, figure_ui};
use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Draws the selection of gains or delays and of airspeed or conditions, from right to left.
pub fn channels_header_ui(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let shown = state.display.channel_values;
    let (mut measure, mut across) = shown;
    let axes = [
        (Across::Airspeed, "over airspeed", "With the schedule"),
        (
            Across::Conditions,
            "over conditions",
            "Conditions side by side, in file order",
        ),
    ];
    choice_ui(ui, "Horizontal axis of the channels", &mut across, &axes);
    let figures = [
        (
            Measure::Gain,
            "gains",
            "Gain k of every channel, its bounds, and 1: no correction",
        ),
        (
            Measure::Delay,
            "delays",
            "Delay τ of every channel [ms], its bounds, and 0: no correction",
        ),
    ];
    choice_ui(ui, "Figure of the channels", &mut measure, &figures);
    bars_switch_ui(ui, state, ("bars", "bars of the channels"), commands);
    if (measure, across) != shown {
        commands.push(Command::ShowChannels(measure, across));
    }
}

const HEADING_HEIGHT: f32 = 20.0;
const GAP: f32 = 8.0;
/// Least size of a plot \[pt\].
const LEAST_PLOT: Vec2 = vec2(122.0, 120.0);

/// State of the channel plots between frames.
#[derive(Clone, Debug, Default)]
pub struct ChannelsView {
    /// Input channels.
    pub inputs: FigureView,
    /// Output channels.
    pub outputs: FigureView,
}

/// Draws gain or delay of every channel over airspeed (Figures 3 and 4): inputs above, outputs
/// below, on the same axes.
pub fn channels_view_ui(
    ui: &mut Ui,
    state: &mut State,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let mut view = std::mem::take(&mut state.display.channels);
    let plots = channel_plots(state);
    let mut inputs = plots.figure.clone();
    let mut outputs = plots.figure.clone();
    inputs.plots.truncate(state.dataset().inputs().len());
    outputs.plots.drain(..inputs.plots.len());
    let is_compact = plots.across == Across::Airspeed;
    if is_compact {
        let selected = MarkId::Condition(state.condition().id());
        [&mut inputs, &mut outputs]
            .into_iter()
            .for_each(|figure| quieten(figure, &selected, false));
    }
    if plots.figure.plots.is_empty() {
        let scene = plots.scene("channels", &plots.figure, state.results.absence());
        figure_ui(ui, &scene, &mut view.inputs, palette);
    }
    let rect = ui.available_rect_before_wrap();
    // Each half gets the height required by its rows.
    let half = vec2(rect.width(), 0.5 * rect.height());
    let [above, below] = [&inputs, &outputs].map(|figure| rows(figure, half, LEAST_PLOT) as f32);
    let (upper, lower) =
        rect.split_top_bottom_at_y(rect.top() + rect.height() * above / (above + below).max(1.0));
    for (name, rect, figure, first, view) in [
        ("Input channels", upper, &inputs, 0, &mut view.inputs),
        (
            "Output channels",
            lower,
            &outputs,
            inputs.plots.len(),
            &mut view.outputs,
        ),
    ] {
        if figure.plots.is_empty() {
            continue;
        }
        let place = pos2(rect.left() + 2.0, rect.top() + 0.5 * HEADING_HEIGHT);
        ui.painter().text(
            place,
            Align2::LEFT_CENTER,
            name,
            FontId::proportional(SMALL_SIZE),
            palette.dim_text,
        );
        let inner = Rect::from_min_max(
            rect.min + vec2(0.0, HEADING_HEIGHT),
            rect.max - vec2(0.0, GAP),
        );
        let scene = plots.scene(name, figure, state.results.absence());
        let scene = FigureScene {
            is_compact,
            words: (&plots, first),
            ..scene
        };
        let events = figure_within_ui(ui, inner, &scene, view, palette);
        commands.extend(
            events
                .into_iter()
                .filter_map(|event| gain_command(state, event)),
        );
    }
    ui.advance_cursor_after_rect(rect);
    state.display.channels = view;
}

/// Builds a plot for each channel, inputs first: gain or delay in each condition's optimum, and the
/// schedule.
pub fn channel_plots(state: &State) -> GainPlots<'_> {
    let (measure, across) = state.display.channel_values;
    let channels = if state.analysis().is_some() {
        all_channels(state.dataset())
    } else {
        Vec::new()
    };
    let figure = state
        .analysis()
        .map(|analysis| {
            channels_figure(
                analysis,
                shown_uncertainty(state),
                &channels,
                (measure, across),
            )
        })
        .unwrap_or_default();
    let quantities = channels
        .into_iter()
        .map(|channel| GainQuantity::of_channel(channel, measure))
        .collect();
    GainPlots {
        state,
        figure: figure.with_ranges(),
        quantities,
        across,
    }
}

/// Returns the uncertainty of gains and delays, if error bars are shown.
pub(super) fn shown_uncertainty(state: &State) -> Option<&Uncertainty> {
    state
        .uncertainty()
        .filter(|_| !state.display.hide_bars)
        .map(AsRef::as_ref)
}

/// Plots of gains or delays, with their subjects.
pub struct GainPlots<'a> {
    pub(super) state: &'a State,
    /// Plots with a single panel each.
    pub figure: Figure,
    pub(super) quantities: Vec<GainQuantity>,
    pub(super) across: Across,
}

impl GainPlots<'_> {
    pub(super) fn scene<'b>(
        &'b self,
        name: &'static str,
        figure: &'b Figure,
        message: &'b str,
    ) -> FigureScene<'b> {
        FigureScene {
            selected: Some(MarkId::Condition(self.state.condition().id())),
            highlighted: self.state.display.hovered_condition.map(MarkId::Condition),
            ..FigureScene::new(name, figure, LEAST_PLOT, message, self)
        }
    }
}

impl FigureWords for GainPlots<'_> {
    fn plot(&self, plot: usize) -> String {
        let of = &self.figure.plots[plot];
        let dots: usize = of.panels.iter().map(|panel| panel.dots().count()).sum();
        format!("{}, {dots} conditions", of.title)
    }

    fn dot(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let airspeed_kt = self
            .state
            .dataset()
            .condition(*id)?
            .flight_state()
            .airspeed_kt;
        let value = self.quantities[plot].measure().text(value);
        Some(format!(
            "{}, condition {id}: {value} at {airspeed_kt:.0} kt",
            self.figure.plots[plot].title
        ))
    }

    fn pointed(&self, plot: usize, id: &MarkId, [_, value]: [f64; 2]) -> Option<String> {
        let MarkId::Condition(id) = id else {
            return None;
        };
        let condition = self.state.dataset().condition(*id)?;
        let analysis = self.state.analysis()?;
        let of = self.quantities[plot];
        let airspeed_kt = condition.flight_state().airspeed_kt;
        let text = |value: f64| of.measure().text(value);
        let schedule = of.measure().schedule_of(analysis, self.across);
        let scheduled = schedule
            .map(|schedule| format!("scheduled {}", text(of.of(&schedule.at(airspeed_kt)))));
        let bounds = analysis.condition(*id).and_then(|result| of.bounds(result));
        let choice = analysis.study.choice(*id);
        let state = match (choice.held_out, choice.is_in_schedule()) {
            (true, _) => Some("held out of the schedule, to judge it".to_owned()),
            (false, false) => Some("not in the schedule".to_owned()),
            (false, true) => None,
        };
        let uncertainty = shown_uncertainty(self.state);
        let bar =
            uncertainty.and_then(|of_all| Some((of_all.bar(*id, of.scalar())?, of_all.level)));
        let words = [
            Some(format!("condition {id}, {airspeed_kt:.0} kt")),
            Some(format!("{} {}", self.figure.plots[plot].title, text(value))),
            bar.map(|(bar, level)| bar_words(bar, of.scalar(), level)),
            scheduled,
            bounds.map(|[lower, upper]| format!("bounds {} to {}", text(lower), text(upper))),
            state,
            Some("Ctrl+click: into the schedule, or out of it; right-click: explain".to_owned()),
        ];
        Some(words.into_iter().flatten().collect::<Vec<_>>().join(" · "))
    }

    fn questions(&self, plot: usize, id: &MarkId) -> Vec<NamedFigure> {
        let MarkId::Condition(id) = *id else {
            return Vec::new();
        };
        match self.quantities[plot] {
            GainQuantity::NetGain(pair) => {
                vec![(
                    format!("Net gain, condition {id}"),
                    ExplainTarget::NetGain(id, pair),
                )]
            }
            GainQuantity::Delay(channel) => vec![
                ("Delay".to_owned(), ExplainTarget::Delay(id, channel)),
                (
                    "Bound of the delays".to_owned(),
                    ExplainTarget::DelayBound(id),
                ),
            ],
            GainQuantity::Gain(channel) => {
                let airspeed_kt = self
                    .state
                    .dataset()
                    .condition(id)
                    .map(|of| of.flight_state().airspeed_kt);
                let gain = [
                    ("Gain".to_owned(), ExplainTarget::Gain(id, channel)),
                    (
                        "Bounds of the gains".to_owned(),
                        ExplainTarget::GainBounds(id),
                    ),
                ];
                let scheduled = airspeed_kt.map(|at| {
                    (
                        "Scheduled gain".to_owned(),
                        ExplainTarget::ScheduledGain(channel, at),
                    )
                });
                gain.into_iter().chain(scheduled).collect()
            }
        }
    }
}

/// Returns the command of a click in a plot over airspeed.
pub(super) fn gain_command(state: &State, event: FigureEvent) -> Option<Command> {
    match event {
        FigureEvent::Clicked(_, MarkId::Condition(condition), keys) if keys.command => {
            let scheduled = !state.study.choice(condition).scheduled;
            Some(
                Edit::SetScheduled {
                    condition,
                    scheduled,
                }
                .into(),
            )
        }
        FigureEvent::Clicked(_, MarkId::Condition(condition), _) => {
            Some(Command::SelectCondition(condition))
        }
        FigureEvent::Asked(figure) => Some(Command::Explain(Some(figure))),
        FigureEvent::Told(words) => Some(Command::Tell(words)),
        FigureEvent::Pointed(MarkId::Condition(condition)) => {
            Some(Command::HoverCondition(condition))
        }
        FigureEvent::Clicked(..) | FigureEvent::Pointed(_) => None,
    }
}

/// Describes an error bar: "± 3.3 % (90 %): trim 78 %, identification 22 % of the variance".
pub fn bar_words(bar: &Bar, scalar: Scalar, level: f64) -> String {
    let remarks = bar.remarks().join(", ");
    let Some(half) = bar.half_width(level) else {
        return format!("no bar: {remarks}");
    };
    let half = if scalar.is_delay() {
        format!("± {:.1} ms", s_to_ms(half))
    } else {
        format!("± {:.1} %", 100.0 * half)
    };
    let trim = 100.0 * bar.trim_share().unwrap_or_default();
    let mut words = format!(
        "{half} ({:.0} %): trim {trim:.0} %, identification {:.0} % of the variance",
        100.0 * level,
        100.0 - trim
    );
    if !remarks.is_empty() {
        words.push_str(&format!("; {remarks}"));
    }
    if bar.left_out > 0 {
        words.push_str(&format!("; {} swaps without this figure", bar.left_out));
    }
    words
}
