//! Interaction with a figure of gains: dots, columns, zooming and scrolling.

use egui::vec2;

use gdcm_plot::figure::axis::Axis;
use gdcm_plot::figure::figure::{Bars, Curve, Dot, DotShape, Dots, Plot};
use gdcm_plot::figure::marks::MarkId;
use gdcm_plot::figure::{Color, Figure, Panel, Range, Role as CurveRole};

use super::*;
use crate::gui::plot::viewed_range::ranges_of;
use crate::gui::widgets::palette;
use crate::gui::widgets::palette::Palette;

/// Test state: a figure with interactive dots, or with interactive columns if there are any.
#[derive(Default)]
struct PlotState {
    figure: Figure,
    columns: Vec<MarkId>,
    zooms: bool,
    view: FigureView,
    events: Vec<FigureEvent>,
}

/// Describes plots by their index.
struct Numbers;

impl FigureWords for Numbers {
    fn plot_name(&self, plot: usize) -> String {
        format!("plot {plot}")
    }
}

fn id(number: usize) -> MarkId {
    MarkId::Condition(ConditionId(number as i64))
}

fn panel(first_gain: f64) -> Panel {
    let airspeeds_kt = [45.0, 60.0, 120.0, 120.0];
    let gains = [first_gain, 0.9, 1.02, 1.0];
    let mut dots = Dots::new("optimum", DotShape::Circle, Color::INK);
    for (number, (x, y)) in airspeeds_kt.into_iter().zip(gains).enumerate() {
        dots.dots.push(Dot {
            x,
            y,
            label: (number + 1).to_string(),
            id: Some(id(number)),
        });
    }
    let schedule = Curve::new(
        "schedule",
        CurveRole::Scheduled.stroke(false),
        [45.0, 90.0, 120.0],
        [1.2, f64::NAN, 0.95],
    );
    Panel::new(
        Axis::linear("Airspeed [kt]"),
        Axis::linear("Gain [-]").including(1.0),
    )
    .with(schedule)
    .with(dots)
}

fn figure(count: usize) -> Figure {
    let plots =
        (0..count).map(|k| Plot::new(format!("PED → {k}")).panel(panel(1.3 + 0.2 * k as f64)));
    Figure::default()
        .plots(plots)
        .shared_x()
        .shared_y()
        .with_ranges()
}

fn harness(state: PlotState) -> Harness<'static, PlotState> {
    let builder = Harness::builder()
        .with_step_dt(0.02)
        .with_size(vec2(900.0, 230.0));
    let mut harness = builder.with_context_setup(palette::apply).build_ui_state(
        |ui, state: &mut PlotState| {
            let scene = FigureScene {
                selected: Some(id(2)),
                columns: &state.columns,
                zooms: state.zooms,
                ..FigureScene::new(
                    "gains",
                    &state.figure,
                    vec2(122.0, 120.0),
                    "Nothing to draw",
                    &Numbers,
                )
            };
            let palette = Palette::from_visuals(ui.visuals());
            state
                .events
                .extend(figure_ui(ui, &scene, &mut state.view, &palette));
        },
        state,
    );
    harness.run();
    harness
}

fn gains(count: usize) -> Harness<'static, PlotState> {
    harness(PlotState {
        figure: figure(count),
        ..PlotState::default()
    })
}

#[test]
fn a_click_on_a_dot_names_its_condition() {
    let mut harness = gains(5);
    let at = harness.state().view.screen_position(4, &id(1)).unwrap();
    click(&mut harness, at + vec2(3.0, 2.0));
    let events = &harness.state().events;
    assert_eq!(events.first(), Some(&FigureEvent::Pointed(id(1))));
    assert!(events.contains(&FigureEvent::Clicked(4, id(1), Modifiers::NONE)));
}

#[test]
fn the_nearer_of_two_close_dots_is_picked() {
    let mut harness = gains(5);
    for condition in [2, 3] {
        let at = harness
            .state()
            .view
            .screen_position(0, &id(condition))
            .unwrap();
        let outward = if condition == 2 {
            vec2(0.0, -3.0)
        } else {
            vec2(0.0, 3.0)
        };
        click(&mut harness, at + outward);
        assert!(harness.state().events.contains(&FigureEvent::Clicked(
            0,
            id(condition),
            Modifiers::NONE
        )));
    }
}

#[test]
fn every_plot_has_the_same_gain_axis() {
    let harness = gains(3);
    let bounds = |plot| *harness.state().view.transform(plot).unwrap().bounds();
    assert_eq!(bounds(0), bounds(1));
    assert_eq!(bounds(0), bounds(2));
    assert!(
        bounds(0).min()[1] < 0.9 && bounds(0).max()[1] > 1.7,
        "all gains are in view"
    );
}

#[test]
fn a_dot_without_a_gain_is_left_out() {
    let figure = Figure::default().plot(Plot::new("LON").panel(panel(f64::NAN)));
    let harness = harness(PlotState {
        figure,
        ..PlotState::default()
    });
    assert!(
        harness
            .state()
            .view
            .transform(0)
            .unwrap()
            .bounds()
            .is_valid()
    );
}

#[test]
fn more_plots_than_fit_can_be_scrolled_to() {
    let mut harness = gains(12);
    harness.set_size(vec2(500.0, 160.0));
    harness.run();
    let frame = *harness.state().view.transform(0).unwrap().frame();
    assert!(frame.width() > 60.0 && frame.height() > 50.0, "{frame:?}");
}

#[test]
fn a_click_on_a_column_names_it_and_its_plot() {
    let bars = Bars {
        name: String::new(),
        color: Color::INK,
        width: 0.6,
        bars: vec![[0.0, -20.0], [1.0, 4.0]],
        feet: Vec::new(),
        beside: 0.0,
    };
    let y = Axis::linear("").showing(Some(Range::new(-22.0, 8.0)));
    let panel = Panel::new(Axis::named("Condition", ["1", "3", "10"]), y).with(bars);
    let figure = Figure::default()
        .plot(Plot::new("LAT → P").panel(panel.clone()))
        .plot(Plot::new("LON → Q").panel(panel));
    let mut harness = harness(PlotState {
        figure,
        columns: vec![id(1), id(3), id(10)],
        ..PlotState::default()
    });
    for (column, condition) in [(1.0, 3), (2.0, 10)] {
        let at = harness.state().view.position(1, [column, -5.0]).unwrap();
        click(&mut harness, at);
        assert_eq!(
            harness.state().events.last(),
            Some(&FigureEvent::Pointed(id(condition)))
        );
        assert!(harness.state().events.contains(&FigureEvent::Clicked(
            1,
            id(condition),
            Modifiers::NONE
        )));
    }
}

#[test]
fn the_wheel_zooms_a_plot_and_a_double_click_beside_its_dots_shows_all() {
    let mut harness = harness(PlotState {
        figure: figure(1),
        zooms: true,
        ..PlotState::default()
    });
    let ranges = |harness: &Harness<'_, PlotState>| {
        ranges_of(harness.state().view.transform(0).unwrap().bounds())
    };
    let whole = ranges(&harness);
    assert_eq!(
        harness.state().view.ranges(0),
        None,
        "whole ranges follow the marks"
    );
    let at = harness.state().view.position(0, [90.0, 1.15]).unwrap();
    harness.hover_at(at);
    harness.step();
    harness.event(wheel(vec2(0.0, 400.0)));
    harness.run_steps(30);
    let zoomed = ranges(&harness);
    assert!(
        zoomed[0].width() < 0.6 * whole[0].width() && zoomed[1].width() < 0.6 * whole[1].width(),
        "{zoomed:?}"
    );
    double_click(&mut harness, at);
    harness.run();
    assert_eq!(ranges(&harness), whole);
    // A pinch is counted once, although egui_plot knows this gesture too.
    harness.hover_at(at);
    harness.step();
    harness.event(egui::Event::Zoom(1.25));
    harness.run_steps(3);
    for (pinched, whole) in ranges(&harness).into_iter().zip(whole) {
        assert!((whole.width() / pinched.width() - 1.25).abs() < 1e-3);
    }
}

#[test]
fn a_label_longer_than_its_axis_leaves_its_unit_alone() {
    let labelled = |label: &str| {
        Plot::new("").panel(Panel {
            y: Axis::linear(label),
            ..panel(1.3)
        })
    };
    let figure = Figure::default().plots(
        [
            "Rate [deg/s]",
            "What the models answer less what was flown, of all records [deg/s]",
        ]
        .map(labelled),
    );
    let harness = harness(PlotState {
        figure: figure.with_ranges(),
        ..PlotState::default()
    });
    let shapes = harness.output().shapes.iter();
    let upright = shapes.filter_map(|drawn| match &drawn.shape {
        egui::Shape::Text(text) if text.angle != 0.0 => Some(text.galley.text().to_owned()),
        _ => None,
    });
    assert_eq!(upright.collect::<Vec<_>>(), ["Rate [deg/s]", "[deg/s]"]);
}
