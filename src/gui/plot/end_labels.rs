//! Labels in the right margin, at the heights where lines end.

use egui::{Align2, Color32, Rect, Ui, pos2};

use super::panel_text::caption_font;

/// Minimum distance between two labels \[pt\].
const LABEL_GAP: f32 = 14.0;
/// Minimum distance from the frame's corners \[pt\].
const MARGIN: f32 = 5.0;
/// Distance from the frame \[pt\].
const BESIDE: f32 = 6.0;

/// Label in the margin for a curve, for several curves or for a reference line.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EndLabel {
    /// Vertical screen position \[pt\].
    pub(super) y: f32,
    pub(super) text: String,
    pub(super) color: Color32,
}

/// Limits a vertical screen position to the margin beside `frame`.
pub(super) fn height_beside(frame: Rect, y: f32) -> f32 {
    y.clamp(frame.top() + MARGIN, frame.bottom() - MARGIN)
}

/// Paints the labels beside `frame` without overlap.
pub(super) fn paint_end_labels(ui: &Ui, frame: Rect, mut labels: Vec<EndLabel>) {
    labels.sort_by(|a, b| a.y.total_cmp(&b.y));
    spread(&mut labels, frame.bottom() - MARGIN);
    for label in labels {
        let at = pos2(frame.right() + BESIDE, label.y);
        let font = caption_font();
        ui.painter()
            .text(at, Align2::LEFT_CENTER, label.text, font, label.color);
    }
}

/// Returns as many labels as fit beside `frame`, from the first to the last at equal steps.
pub(super) fn labels_within(frame: Rect, labels: Vec<EndLabel>) -> Vec<EndLabel> {
    let room = ((frame.height() - 2.0 * MARGIN) / LABEL_GAP) as usize + 1;
    if labels.len() <= room {
        return labels;
    }
    if room < 2 {
        return labels.into_iter().take(room).collect();
    }
    let last = labels.len() - 1;
    (0..room)
        .map(|place| labels[place * last / (room - 1)].clone())
        .collect()
}

/// Moves labels, sorted by height, down until they no longer overlap, then up again if they leave
/// the plot.
fn spread(labels: &mut [EndLabel], bottom: f32) {
    for index in 1..labels.len() {
        labels[index].y = labels[index].y.max(labels[index - 1].y + LABEL_GAP);
    }
    let mut limit = bottom;
    for label in labels.iter_mut().rev() {
        label.y = label.y.min(limit);
        limit = label.y - LABEL_GAP;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_do_not_fit_are_thinned_from_the_first_to_the_last() {
        let labels: Vec<EndLabel> = (0..9)
            .map(|number| EndLabel {
                y: 0.0,
                text: number.to_string(),
                color: Color32::WHITE,
            })
            .collect();
        // Room for three labels at a distance of 14 between margins of 5.
        let frame = Rect::from_min_size(pos2(0.0, 0.0), egui::vec2(100.0, 40.0));
        let shown = labels_within(frame, labels);
        let texts: Vec<&str> = shown.iter().map(|label| label.text.as_str()).collect();
        assert_eq!(texts, ["0", "4", "8"]);
    }

    #[test]
    fn names_keep_clear_of_one_another_and_within_the_plot() {
        let mut labels = [80.0, 95.0, 96.0].map(|y| EndLabel {
            y,
            text: String::new(),
            color: Color32::WHITE,
        });
        spread(&mut labels, 100.0);
        assert_eq!(labels.map(|label| label.y), [72.0, 86.0, 100.0]);
    }
}
