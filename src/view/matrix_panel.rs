//! The constraint matrix: every response with G, D and J, held or free.

use egui::{
    Align2, Color32, FontId, Key, Rect, Response, RichText, Role, ScrollArea, Sense, Stroke, StrokeKind, Ui,
    WidgetInfo, pos2, vec2,
};

use gdcm_core::correction::Channel;
use gdcm_core::dataset::Pair;
use gdcm_core::fidelity::{ACCEPTABLE, INDISTINGUISHABLE};
use gdcm_core::study::{ConditionAnalysis, Edit, ExplainTarget, SignRole, Undefined};
use gdcm_core::uncertainty::Scalar;
use gdcm_core::units::s_to_ms;

use super::views::bar_words;
use super::{
    Command, Palette, Region, SMALL_SIZE, State, Sureness, TableKind, check_ui, entries_ui, gain_conflict_marks,
    named_switch, question_menu_ui, region_ui, table_heading_ui, toggle_costs, turn_entry,
};

const CELL_HEIGHT: f32 = 50.0;
const LEAST_CELL_WIDTH: f32 = 58.0;
const ROW_LABEL_WIDTH: f32 = 30.0;
const HEADER_HEIGHT: f32 = 18.0;
const LOCK_SIZE: f32 = 15.0;
/// The middle of G is so far from the left and from the right edge of its cell at least, beside the box and the bar \[pt\].
const GAIN_PLACES: [f32; 2] = [34.0, 44.0];
/// In a narrower cell the bar has no room beside G, and is told where the pointer is \[pt\].
const LEAST_WITH_BAR: f32 = 74.0;
/// Two values of D this far apart \[s\] stand beside one another.
const APART_S: f64 = 2e-3;

/// Every response as a cell. A click on the cell chooses the response for the large plot; a click on its box, a double click or
/// the space bar holds or releases it; a right-click offers more.
pub fn matrix_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let heading = ("Constraints", "G · delay · J before→after");
    table_heading_ui(ui, palette, heading, TableKind::Matrix, commands);
    region_ui(ui, Region::Matrix, |ui| cells_ui(ui, state, palette, commands));
}

fn cells_ui(ui: &mut Ui, state: &State, palette: &Palette, commands: &mut Vec<Command>) {
    let (outputs, inputs) = (state.dataset().outputs(), state.dataset().inputs());
    let room = (ui.available_width() - ROW_LABEL_WIDTH) / inputs.len() as f32;
    let width = room.max(LEAST_CELL_WIDTH);
    let size = vec2(ROW_LABEL_WIDTH + width * inputs.len() as f32, HEADER_HEIGHT + CELL_HEIGHT * outputs.len() as f32);
    let (in_conflict, blamed) = state.shown().map(gain_conflict_marks).unwrap_or_default();
    let name_color = |channel| {
        if blamed.contains(&channel) { palette.warning } else { palette.dim_text }
    };
    ScrollArea::horizontal().id_salt("constraint matrix").show(ui, |ui| {
        let (area, _) = ui.allocate_exact_size(size, Sense::hover());
        for (input, channel) in inputs.iter().enumerate() {
            let x = area.left() + ROW_LABEL_WIDTH + width * (input as f32 + 0.5);
            label(
                ui,
                pos2(x, area.top() + 0.5 * HEADER_HEIGHT),
                Align2::CENTER_CENTER,
                &channel.name,
                name_color(Channel::Input(input)),
            );
        }
        for (output, channel) in outputs.iter().enumerate() {
            let top = area.top() + HEADER_HEIGHT + CELL_HEIGHT * output as f32;
            let place = pos2(area.left() + ROW_LABEL_WIDTH - 6.0, top + 0.5 * CELL_HEIGHT);
            label(ui, place, Align2::RIGHT_CENTER, &channel.name, name_color(Channel::Output(output)));
            for input in 0..inputs.len() {
                let left = area.left() + ROW_LABEL_WIDTH + width * input as f32;
                let rect = Rect::from_min_size(pos2(left, top), vec2(width, CELL_HEIGHT));
                let pair = Pair { output, input };
                Cell::of(state, pair, in_conflict.contains(&pair)).ui(ui, rect, palette, commands);
            }
        }
    });
}

fn label(ui: &Ui, place: egui::Pos2, align: Align2, text: &str, color: Color32) {
    ui.painter().text(place, align, text, FontId::proportional(SMALL_SIZE), color);
}

struct Cell<'a> {
    pair: Pair,
    name: String,
    focused: bool,
    on_axis: bool,
    constrained: bool,
    fitted: bool,
    /// Whether it is not matched, or keeps others from being matched.
    in_conflict: bool,
    shown: Option<&'a ConditionAnalysis>,
    state: &'a State,
    sureness: Sureness<'a>,
    /// What holding or freeing it would cost, in words; empty until that is known.
    toggle_costs: Vec<String>,
}

impl<'a> Cell<'a> {
    fn of(state: &'a State, pair: Pair, in_conflict: bool) -> Self {
        Self {
            pair,
            name: state.dataset().pair_name(pair),
            focused: state.display.pair == pair,
            on_axis: state.dataset().on_axis()[pair],
            constrained: state.study.settings.constrained[pair],
            fitted: !state.study.settings.ignored[pair],
            in_conflict,
            shown: state.shown(),
            state,
            sureness: state.sureness(),
            toggle_costs: toggle_costs(state, pair),
        }
    }

    fn gain(&self) -> Option<f64> {
        self.shown?.wanted_gain(self.pair)
    }

    /// The D that is not fitted: of the band (M15.2), or of eq. (9) where the delays are fitted to the band.
    fn other_delay_s(&self) -> Option<f64> {
        let delta = &self.shown?.comparison.delta;
        let (median_s, band_s) = (delta.delay_s[self.pair]?, delta.band_delay_s[self.pair]?);
        Some(if self.shown?.wanted_delay_s(self.pair) == Some(band_s) { median_s } else { band_s })
    }

    /// Why it has no G, once that is known.
    fn undefined(&self) -> Option<Undefined> {
        self.shown?.comparison.undefined[self.pair]
    }

    fn is_undefined(&self) -> bool {
        self.undefined().is_some()
    }

    fn ui(&self, ui: &mut Ui, rect: Rect, palette: &Palette, commands: &mut Vec<Command>) {
        let response = ui.interact(rect, ui.scope_id().with(("cell", self.pair)), Sense::click());
        let response = named_switch(response, Role::Button, self.focused, format!("Response {}", self.name));
        if response.gained_focus() {
            response.scroll_to_me(None);
        }
        self.paint(ui, rect, &response, palette);
        let lock = self.lock_ui(ui, rect, palette);
        let space = response.has_focus() && ui.input(|input| input.key_pressed(Key::Space));
        if lock.clicked() || response.double_clicked() || space {
            if self.constrained || !self.is_undefined() {
                commands.push(Edit::Hold(self.pair, !self.constrained).into());
            }
        } else if response.clicked() {
            commands.push(Command::FocusPair(self.pair));
        }
        response.context_menu(|ui| self.menu_ui(ui, commands));
        response.on_hover_ui(|ui| self.tooltip_ui(ui));
    }

    fn lock_ui(&self, ui: &mut Ui, rect: Rect, palette: &Palette) -> Response {
        let place = Rect::from_min_size(rect.min + vec2(3.0, 3.0), vec2(LOCK_SIZE, LOCK_SIZE));
        let response = ui.interact(place.expand(2.0), ui.scope_id().with(("hold", self.pair)), Sense::click());
        let name = format!("Hold {}", self.name);
        response.widget_info(|| WidgetInfo::selected(Role::CheckBox, !self.is_undefined(), self.constrained, &name));
        let square = place.shrink(2.5);
        let color = if response.hovered() || response.has_focus() { palette.text } else { palette.dim_text };
        if self.constrained {
            ui.painter().rect_filled(square, 2.0, palette.accent);
            let stroke = Stroke::new(1.6, palette.on_accent());
            let tick = [
                square.left_center() + vec2(2.0, 0.3),
                square.center() + vec2(-0.7, 2.4),
                square.right_top() + vec2(-1.8, 2.6),
            ];
            ui.painter().line(tick.to_vec(), stroke);
        } else if !self.is_undefined() {
            ui.painter().rect_stroke(square, 2.0, Stroke::new(1.0, color), StrokeKind::Inside);
        }
        let hint = match (self.undefined(), self.constrained) {
            (Some(why), _) => format!("{} cannot be held: {}", self.name, why),
            (_, true) => "Held exactly; click to release it".to_owned(),
            (_, false) => "Released; click to hold it exactly".to_owned(),
        };
        response.on_hover_text(hint)
    }

    fn paint(&self, ui: &Ui, rect: Rect, response: &Response, palette: &Palette) {
        let painter = ui.painter();
        let inner = rect.shrink(0.5);
        let fill = match (self.constrained, response.hovered()) {
            (true, _) => palette.selected,
            (false, true) => palette.raised,
            (false, false) => Color32::TRANSPARENT,
        };
        painter.rect_filled(inner, 0.0, fill);
        painter.rect_stroke(inner, 0.0, Stroke::new(1.0, palette.line), StrokeKind::Inside);
        if self.on_axis {
            painter.rect_stroke(rect.shrink(2.0), 2.0, Stroke::new(1.2, palette.dim_text), StrokeKind::Inside);
        }
        if self.in_conflict {
            painter.rect_stroke(rect.shrink(2.0), 2.0, Stroke::new(2.0, palette.warning), StrokeKind::Inside);
        }
        if self.focused {
            painter.rect_stroke(rect, 1.0, Stroke::new(2.0, palette.accent), StrokeKind::Inside);
        }
        self.paint_values(ui, rect, palette);
    }

    fn paint_values(&self, ui: &Ui, rect: Rect, palette: &Palette) {
        let text = |y: f32, text: &str, size: f32, color: Color32| {
            // Clear of the box in the left corner and of the bar's room in the right one, where the cell is narrow.
            let is_first = y < LOCK_SIZE + 4.0;
            let [least, most] = [rect.left() + GAIN_PLACES[0], rect.right() - GAIN_PLACES[1]];
            let x = if is_first { rect.center().x.min(most).max(least) } else { rect.center().x };
            let place = pos2(x, rect.top() + y);
            ui.painter().text(place, Align2::CENTER_CENTER, text, FontId::proportional(size), color);
        };
        let Some(shown) = self.shown else { return };
        let (Some(gain), Some(delay)) = (self.gain(), shown.wanted_delay_s(self.pair)) else {
            let nothing = matches!(self.undefined(), Some(Undefined::NumericallyNothing(_)));
            text(0.5 * CELL_HEIGHT, if nothing { "nothing" } else { "no G" }, SMALL_SIZE, palette.dim_text);
            return;
        };
        let strong = if self.fitted { palette.text } else { palette.rejected };
        text(13.0, &format!("{gain:.2}"), 14.5, strong);
        if let Some(half) = self.sureness.half(Scalar::Gain(self.pair)).filter(|_| rect.width() >= LEAST_WITH_BAR) {
            let place = pos2(rect.right() - 3.0, rect.top() + 13.0);
            let words = format!("±{:.0}%", 100.0 * half);
            ui.painter().text(place, Align2::RIGHT_CENTER, words, FontId::proportional(9.0), palette.dim_text);
        }
        let beside = self.other_delay_s().filter(|other| (other - delay).abs() >= APART_S);
        let about = self
            .sureness
            .half(shown.wanted_delay(self.pair))
            .map_or_else(String::new, |half| format!(" ±{:.0}", s_to_ms(half)));
        let beside = beside.map_or(format!("{about} ms"), |other| format!(" ({:.0})", s_to_ms(other)));
        text(28.0, &format!("{:.0}{beside}", s_to_ms(delay)), 10.5, palette.dim_text);
        if let Some(cost) = shown.cost[self.pair] {
            let (before, after) = (cost.uncorrected.total(), cost.corrected.total());
            text(
                40.5,
                &format!("{}→{}", cost_text(before), cost_text(after)),
                10.5,
                change_color(before, after, palette),
            );
        }
    }

    fn menu_ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let mut switch = |ui: &mut Ui, is_on: bool, text: String, edit: fn(Pair, bool) -> Edit| {
            if let Some(is_on) = check_ui(ui, is_on, text, "") {
                commands.push(edit(self.pair, is_on).into());
                ui.close();
            }
        };
        switch(ui, self.constrained, format!("Hold {} exactly", self.name), Edit::Hold);
        switch(ui, self.fitted, format!("Fit {} in the objective", self.name), Edit::Fit);
        entries_ui(ui, [("Hold exactly the on-axis responses", Edit::ConstrainOnAxis.into())], commands);
        let turn = |channel| {
            let is_turned = self.state.study.signs.contains_key(&channel);
            turn_entry(self.state, channel, (!is_turned).then_some(SignRole::Identified))
        };
        entries_ui(ui, Channel::of(self.pair).map(turn), commands);
        if let Some(shown) = self.shown.filter(|_| !self.is_undefined()) {
            let (id, pair) = (shown.condition.id(), self.pair);
            let values = [
                ("G", ExplainTarget::DeltaGain(id, pair)),
                ("D", ExplainTarget::DeltaDelay(id, pair)),
                ("Net gain", ExplainTarget::NetGain(id, pair)),
                ("Net delay", ExplainTarget::NetDelay(id, pair)),
                ("J before", ExplainTarget::CostBefore(id, pair)),
                ("J after", ExplainTarget::CostAfter(id, pair)),
            ];
            question_menu_ui(ui, values.map(|(name, asked)| (name.to_owned(), asked)).into(), commands);
        }
    }

    fn tooltip_ui(&self, ui: &mut Ui) {
        ui.label(RichText::new(&self.name).strong());
        let mut words = vec![if self.constrained { "held exactly" } else { "released" }];
        words.push(if self.fitted { "fitted" } else { "ignored in the objective" });
        if self.on_axis {
            words.push("on-axis");
        }
        ui.label(words.join(" · "));
        let Some(shown) = self.shown else { return };
        for doubt in shown.doubts.iter().filter(|doubt| doubt.channel.is_of(self.pair)) {
            ui.label(doubt.words(self.state.dataset()));
        }
        let (Some(gain), Some(delay)) = (self.gain(), shown.wanted_delay_s(self.pair)) else {
            let why = self.undefined().map(|why| format!("No G, no D and no J: {}", why));
            ui.label(why.unwrap_or_default());
            return;
        };
        ui.label(format!("G = {gain:.4}: the gain that would match the magnitude"));
        ui.label(format!("D = {:.1} ms: the delay that would match the phase (negative: lead)", s_to_ms(delay)));
        let delta = &shown.comparison.delta;
        if let (Some(median_s), Some(band_s)) = (delta.delay_s[self.pair], delta.band_delay_s[self.pair]) {
            let (median_ms, band_ms) = (s_to_ms(median_s), s_to_ms(band_s));
            ui.label(format!("D of eq. (9): {median_ms:.1} ms; of the line through the phase, M15.2: {band_ms:.1} ms"));
        }
        ui.label(format!("net gain k_o k_i = {:.4}", shown.correction.net_gain(self.pair)));
        for (name, scalar) in [
            ("G", Scalar::Gain(self.pair)),
            ("D", shown.wanted_delay(self.pair)),
            ("net gain", Scalar::NetGain(self.pair)),
        ] {
            if let Some((bar, level)) = self.sureness.bar(scalar) {
                ui.label(format!("{name} {}", bar_words(bar, scalar, level)));
            }
        }
        ui.label(format!("net delay τ_o + τ_i = {:.1} ms", s_to_ms(shown.correction.net_delay_s(self.pair))));
        for sentence in &self.toggle_costs {
            ui.label(sentence);
        }
        if let Some(cost) = shown.cost[self.pair] {
            let (before, after) = (cost.uncorrected, cost.corrected);
            ui.label(format!(
                "J_mag {:.1} → {:.1}, J_phase {:.1} → {:.1}",
                before.magnitude, after.magnitude, before.phase, after.phase
            ));
            ui.label(format!("J {:.1} → {:.1}: {}", before.total(), after.total(), verdict(after.total())));
        }
        ui.label("Click: show it · box, double click or space: hold or release it · right-click: more");
    }
}

fn change_color(before: f64, after: f64, palette: &Palette) -> Color32 {
    // A change that rounds away in the digits shown is none.
    if (after - before).abs() < 0.5 {
        palette.dim_text
    } else if after < before {
        palette.good
    } else {
        palette.warning
    }
}

fn verdict(cost: f64) -> &'static str {
    if cost <= INDISTINGUISHABLE {
        "next to indistinguishable (J ≤ 50)"
    } else if cost <= ACCEPTABLE {
        "acceptable (J ≤ 100)"
    } else {
        "above the guide of 100"
    }
}

/// J as a cell has room for it: in thousands from ten thousand on.
fn cost_text(cost: f64) -> String {
    if cost < 9999.5 { format!("{cost:.0}") } else { format!("{:.0}k", 1e-3 * cost) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cost_takes_no_more_than_four_digits() {
        for (cost, text) in [(0.4, "0"), (9999.4, "9999"), (9999.6, "10k"), (66_248.0, "66k")] {
            assert_eq!(cost_text(cost), text);
        }
    }
}
