//! Bars that divide the net gains' scatter among its sources: trim, identification, and unexplained
//! (M13.5: docs/error-bars.md). *× expected* is the scatter relative to the one that trim and
//! identification would cause.

use egui::{
    Align2, Color32, FontId, Painter, Rect, Response, RichText, Sense, Ui, WidgetInfo, pos2, vec2,
};

use gdcm_method::uncertainty::VarianceDecomposition;
use gdcm_study::results::uncertainty::Uncertainty;

use crate::gui::state::window_state::State;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Bar height \[pt\].
const BAR_HEIGHT: f32 = 15.0;
/// Width for the labels before the bars \[pt\].
const LABEL_WIDTH: f32 = 170.0;
/// Width for the texts after the bars \[pt\].
const TEXT_WIDTH: f32 = 400.0;
/// Minimum bar width \[pt\].
const LEAST_BAR: f32 = 60.0;

pub(super) struct ScatterBars<'a> {
    pub(super) uncertainty: &'a Uncertainty,
    pub(super) palette: &'a Palette,
}

impl ScatterBars<'_> {
    /// Draws two stacked bars for each response: the scatter at equal airspeed and about the
    /// schedule.
    pub(super) fn ui(&self, ui: &mut Ui, state: &State) {
        ui.horizontal(|ui| {
            let heading = RichText::new("Sources of the scatter");
            ui.label(heading.size(SMALL_SIZE).strong());
            let names = ["trim", "identification", "unexplained"];
            for (name, color) in names.into_iter().zip(source_colors(self.palette)) {
                let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), Sense::hover());
                ui.painter().rect_filled(rect, 2.0, color);
                ui.label(self.palette.small(name));
            }
        });
        for scatter in &self.uncertainty.scatter {
            let name = state.dataset().pair_name(scatter.pair);
            let same_airspeed = scatter.same_airspeed.as_ref();
            self.scatter_ui(ui, &format!("{name} at equal airspeed"), same_airspeed);
            let about_schedule = scatter.about_schedule.as_ref();
            self.scatter_ui(ui, &format!("{name} about the schedule"), about_schedule);
            ui.add_space(3.0);
        }
        ui.add_space(6.0);
    }

    /// Draws a row for one kind of scatter: its name, a bar divided among its sources, and its
    /// values.
    fn scatter_ui(&self, ui: &mut Ui, name: &str, decomposition: Option<&VarianceDecomposition>) {
        let size = vec2(ui.available_width(), BAR_HEIGHT + 3.0);
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let words = match decomposition {
            Some(decomposition) => scatter_words(decomposition, self.uncertainty.level),
            None => "no degrees of freedom".to_owned(),
        };
        name_label(&response, format!("{name}: {words}"));
        let painter = ui.painter();
        let font = FontId::proportional(SMALL_SIZE);
        painter.text(
            rect.left_center(),
            Align2::LEFT_CENTER,
            name,
            font.clone(),
            self.palette.dim_text,
        );
        let left = rect.left() + LABEL_WIDTH;
        let right = (rect.right() - TEXT_WIDTH).max(left + LEAST_BAR);
        let values = painter.text(
            pos2(right + 8.0, rect.center().y),
            Align2::LEFT_CENTER,
            &words,
            font,
            self.palette.text,
        );
        let top = rect.top() + 1.0;
        let bar = Rect::from_x_y_ranges(left..=right, top..=top + BAR_HEIGHT);
        self.paint_shares(painter, bar, decomposition);
        if values.right() > rect.right() {
            response.on_hover_text(format!("{name}: {words}"));
        }
    }

    /// Paints the variance shares for trim, identification and unexplained, from left to right.
    fn paint_shares(
        &self,
        painter: &Painter,
        bar: Rect,
        decomposition: Option<&VarianceDecomposition>,
    ) {
        let Some(shares) = decomposition.and_then(VarianceDecomposition::shares) else {
            return;
        };
        let mut from = bar.left();
        for (share, color) in shares.into_iter().zip(source_colors(self.palette)) {
            let to = from + bar.width() * share as f32;
            let area = Rect::from_x_y_ranges(from..=to, bar.y_range());
            painter.rect_filled(area, 0.0, color);
            from = to;
        }
    }
}

/// Gives a painted text an accessible name for screen readers.
fn name_label(response: &Response, name: String) {
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, &name));
}

/// Returns the colours for trim, identification and unexplained variance.
fn source_colors(palette: &Palette) -> [Color32; 3] {
    [palette.perturbed, palette.identified, palette.nominal]
}

/// Formats "scatter 6.2 % (sd); 2.7 × expected; unexplained 5.8 % (90 %: 3.6 to 11.6)".
fn scatter_words(decomposition: &VarianceDecomposition, level: f64) -> String {
    let mut words = format!("scatter {:.1} % (sd)", 100.0 * decomposition.scatter.sqrt());
    if let Some(ratio) = decomposition.ratio() {
        words.push_str(&format!("; {ratio:.1} × expected"));
    }
    words.push_str(&format!(
        "; unexplained {:.1} %",
        100.0 * decomposition.unexplained().sqrt()
    ));
    if let Some([low, high]) = decomposition.unexplained_interval(level) {
        words.push_str(&format!(
            " ({:.0} %: {:.1} to {:.1})",
            100.0 * level,
            100.0 * low,
            100.0 * high
        ));
    }
    words
}
