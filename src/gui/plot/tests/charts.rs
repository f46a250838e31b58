//! Interaction with the charts of a group.

use egui::{Id, Rect, vec2};
use egui_plot::{PlotBounds, PlotMemory};

use super::*;
use crate::gui::plot::chart::{Chart, ChartAxis, ChartLine};
use crate::gui::plot::chart_view::chart_ui;
use crate::gui::widgets::palette::{self, Palette};

const TITLES: [&str; 2] = ["one", "other"];
const SIZE: egui::Vec2 = vec2(600.0, 200.0);

/// Returns two stacked charts with 10,000 samples of `y = x` and of `y = -x` from 0 to 100; the
/// state holds the visible bounds of each.
fn harness() -> Harness<'static, Vec<PlotBounds>> {
    let line = |slope: f64| -> Arc<[[f64; 2]]> {
        (0..10_000)
            .map(|k| 0.01 * f64::from(k))
            .map(|x| [x, slope * x])
            .collect()
    };
    let lines = [line(1.0), line(-1.0)];
    let draw = move |ui: &mut egui::Ui, visible: &mut Vec<PlotBounds>| {
        let palette = Palette::from_visuals(ui.visuals());
        let corner = ui.max_rect().min;
        visible.clear();
        for (row, (title, points)) in TITLES.into_iter().zip(&lines).enumerate() {
            let mut chart = Chart::new(title, ChartAxis::Linear, "", "");
            chart.group = Some(Id::unique("group"));
            chart.fits_values = true;
            let color = palette.text;
            chart.lines.push(ChartLine {
                points: Arc::clone(points),
                color,
                width: 1.0,
                dash: None,
            });
            let rect = Rect::from_min_size(corner + vec2(0.0, row as f32 * SIZE.y), SIZE);
            chart_ui(ui, rect, &chart, &palette);
            let memory = PlotMemory::load(ui.ctx(), ui.make_persistent_id((title, chart.group)))
                .expect("it was drawn");
            visible.push(*memory.transform().bounds());
        }
    };
    let mut harness = Harness::builder()
        .with_step_dt(0.02)
        .with_size(vec2(620.0, 420.0))
        .with_context_setup(palette::apply)
        .build_ui_state(draw, Vec::new());
    harness.run();
    harness
}

#[test]
fn the_wheel_zooms_the_time_of_every_chart_and_the_values_in_view_fill_each() {
    let mut harness = harness();
    let whole = harness.state().clone();
    assert!(
        whole[0].min()[0] <= 0.0 && whole[0].max()[0] >= 99.99,
        "{whole:?}"
    );
    let at = Pos2::new(300.0, 100.0);
    harness.hover_at(at);
    harness.step();
    // 21 notches of 40 pt, each of which zooms by a factor of 1.1.
    harness.event(wheel(vec2(0.0, 840.0)));
    harness.run_steps(40);
    let zoomed = harness.state().clone();
    let [left, right] = [zoomed[0].min()[0], zoomed[0].max()[0]];
    assert!(
        (10.0..20.0).contains(&(right - left)),
        "a factor of e^2: {left} to {right}"
    );
    assert_eq!([zoomed[1].min()[0], zoomed[1].max()[0]], [left, right]);
    for (visible, slope) in zoomed.iter().zip([1.0, -1.0]) {
        let mut ends = [slope * left, slope * right];
        ends.sort_by(f64::total_cmp);
        let margin = 0.15 * (right - left);
        assert!(
            (visible.min()[1] - ends[0]).abs() < margin
                && (visible.max()[1] - ends[1]).abs() < margin,
            "{visible:?}"
        );
    }
    double_click(&mut harness, at);
    harness.run();
    assert_eq!(harness.state(), &whole, "a double click shows all");
}

#[test]
fn zooming_out_of_a_chart_over_time_ends_at_its_data() {
    let mut harness = harness();
    let whole = harness.state().clone();
    harness.hover_at(Pos2::new(400.0, 100.0));
    harness.step();
    harness.event(wheel(vec2(0.0, 400.0)));
    harness.run_steps(40);
    assert!(
        harness.state()[0].width() < 0.5 * whole[0].width(),
        "{:?}",
        harness.state()
    );
    harness.event(wheel(vec2(0.0, -4000.0)));
    harness.run_steps(80);
    // The axis ends at the data again, as before the first turn of the wheel.
    assert!(
        (harness.state()[0].width() / whole[0].width() - 1.0).abs() < 1e-6,
        "{:?}",
        harness.state()
    );
}

#[test]
fn dragging_moves_the_time_of_every_chart_and_the_values_follow() {
    let mut harness = harness();
    let whole = harness.state().clone();
    let from = Pos2::new(300.0, 100.0);
    drag(
        &mut harness,
        &[from, from + vec2(-60.0, 40.0), from + vec2(-120.0, 80.0)],
        PointerButton::Primary,
    );
    harness.run();
    let moved = harness.state().clone();
    assert!(
        moved[0].min()[0] > 10.0 && moved[1].min()[0] == moved[0].min()[0],
        "{moved:?}"
    );
    let widths = [&whole, &moved].map(|visible| visible[0].width());
    assert!((widths[0] - widths[1]).abs() < 1e-6);
    // The values fit the samples from the start of the view to the last sample (`y = x`).
    assert!(
        (moved[0].min()[1] - moved[0].min()[0]).abs() < 10.0
            && (moved[0].max()[1] - 100.0).abs() < 10.0
    );
}
