//! Icons for the start page's cards, drawn as lines.

use egui::{Color32, Rect, Stroke, Ui, pos2};

pub(super) fn sheet_icon(ui: &Ui, place: Rect, color: Color32) {
    let left = place.left() + 4.0;
    let right = place.right() - 4.0;
    let top = place.top() + 1.0;
    let bottom = place.bottom() - 1.0;
    let fold = right - 6.0;
    let outline = [
        pos2(fold, top),
        pos2(left, top),
        pos2(left, bottom),
        pos2(right, bottom),
        pos2(right, top + 6.0),
        pos2(fold, top),
    ];
    ui.painter().line(outline.to_vec(), Stroke::new(1.8, color));
    ui.painter().line(
        vec![
            pos2(fold, top),
            pos2(fold, top + 6.0),
            pos2(right, top + 6.0),
        ],
        Stroke::new(1.8, color),
    );
}

pub(super) fn folder_icon(ui: &Ui, place: Rect, color: Color32) {
    let left = place.left() + 1.0;
    let right = place.right() - 1.0;
    let top = place.top() + 3.0;
    let bottom = place.bottom() - 3.0;
    let outline = [
        (left, top),
        (left + 7.0, top),
        (left + 10.0, top + 3.0),
        (right, top + 3.0),
        (right, bottom),
        (left, bottom),
        (left, top),
    ];
    ui.painter().line(
        outline.map(|(x, y)| pos2(x, y)).to_vec(),
        Stroke::new(1.8, color),
    );
}

pub(super) fn wave_icon(ui: &Ui, place: Rect, color: Color32) {
    let path = (0..=24).map(|step| {
        let part = step as f32 / 24.0;
        let height = (part * 2.0 * std::f32::consts::TAU).sin() * 0.35 * place.height();
        pos2(
            place.left() + part * place.width(),
            place.center().y - height,
        )
    });
    ui.painter().line(path.collect(), Stroke::new(1.8, color));
}
