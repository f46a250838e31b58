use egui::vec2;

use super::*;
use crate::view::palette::{self, Palette};

#[derive(Default)]
struct Model {
    panels: Vec<GainPanel>,
    view: GainView,
    channels: ChannelsView,
    events: Vec<GainEvent>,
}

fn id(number: usize) -> ConditionId {
    ConditionId(number as i64)
}

fn dot(number: usize, airspeed_kt: f64, gain: f64) -> Dot {
    Dot {
        condition: id(number),
        label: (number + 1).to_string(),
        x: airspeed_kt,
        airspeed_kt,
        value: gain,
        bounds: None,
        shape: DotShape::of_class(number % 4),
        filled: number.is_multiple_of(2),
        selected: number == 2,
        chosen: true,
        held_out: false,
        bar: None,
        sentences: Vec::new(),
        detail: String::new(),
        figures: Vec::new(),
    }
}

fn panels(count: usize) -> Vec<GainPanel> {
    let panel = |k: usize| GainPanel {
        title: format!("PED → {k}"),
        dots: vec![dot(0, 45.0, 1.3), dot(1, 60.0, 0.9), dot(2, 120.0, 1.02), dot(3, 120.0, 1.0)],
        schedule: vec![[45.0, 1.2], [90.0, 1.0], [120.0, 0.95]],
        ..GainPanel::default()
    };
    (0..count).map(panel).collect()
}

fn net_gain_harness(panels: Vec<GainPanel>) -> Harness<'static, Model> {
    let model = Model { panels, ..Model::default() };
    let mut harness =
        Harness::builder().with_size(vec2(900.0, 230.0)).with_context_setup(palette::apply).build_ui_state(
            |ui, model: &mut Model| {
                let scene = NetGainScene { panels: &model.panels, message: None };
                let palette = Palette::of(ui.visuals());
                model.events.extend(net_gain_ui(ui, &scene, &mut model.view, &palette));
            },
            model,
        );
    harness.run();
    harness
}

#[test]
fn a_click_on_a_dot_names_its_condition() {
    let mut harness = net_gain_harness(panels(5));
    let at = harness.state().view.screen_position(4, id(1)).unwrap();
    click(&mut harness, at + vec2(3.0, 2.0));
    let events = &harness.state().events;
    assert_eq!(events.first(), Some(&GainEvent::ConditionHovered(Some(id(1)))));
    assert!(events.contains(&GainEvent::ConditionClicked(id(1))));
}

#[test]
fn of_two_dots_close_together_the_nearer_one_is_meant() {
    let mut harness = net_gain_harness(panels(5));
    for condition in [2, 3] {
        let at = harness.state().view.screen_position(0, id(condition)).unwrap();
        let outward = if condition == 2 { vec2(0.0, -3.0) } else { vec2(0.0, 3.0) };
        click(&mut harness, at + outward);
        assert!(harness.state().events.contains(&GainEvent::ConditionClicked(id(condition))));
    }
}

#[test]
fn every_panel_has_the_same_gain_axis() {
    let mut uneven = panels(3);
    uneven[1].dots[0].value = 2.0;
    let harness = net_gain_harness(uneven);
    let bounds = |panel| *harness.state().view.transform(panel).unwrap().bounds();
    assert_eq!(bounds(0), bounds(1));
    assert_eq!(bounds(0), bounds(2));
}

#[test]
fn dots_without_a_gain_are_left_out() {
    let mut broken = panels(2);
    broken[0].dots[1].value = f64::NAN;
    broken[1].schedule[1][1] = f64::NAN;
    net_gain_harness(broken);
    net_gain_harness(vec![GainPanel::default()]);
}

#[test]
fn more_panels_than_fit_can_be_scrolled_to() {
    let mut harness = net_gain_harness(panels(12));
    harness.set_size(vec2(500.0, 160.0));
    harness.run();
    let frame = *harness.state().view.transform(0).unwrap().frame();
    assert!(frame.width() > 70.0 && frame.height() > 50.0, "{frame:?}");
}

#[test]
fn a_channel_panel_answers_like_a_net_gain_panel() {
    let model = Model { panels: panels(4), ..Model::default() };
    let mut harness =
        Harness::builder().with_size(vec2(900.0, 600.0)).with_context_setup(palette::apply).build_ui_state(
            |ui, model: &mut Model| {
                let scene = ChannelsScene { inputs: &model.panels[..3], outputs: &model.panels, message: None };
                let palette = Palette::of(ui.visuals());
                model.events.extend(channels_ui(ui, &scene, &mut model.channels, &palette));
            },
            model,
        );
    harness.run();
    let at = harness.state().channels.outputs.screen_position(3, id(0)).unwrap();
    click(&mut harness, at);
    assert!(harness.state().events.contains(&GainEvent::ConditionClicked(id(0))));
}
