//! What the keyboard asks of the plot that has the focus.

use egui::{Context, EventFilter, Key, Modifiers, Pos2, Response, Ui, Vec2, vec2};
use gdcm_files::figure::Range;

use super::bode_view::BodeView;
use super::curve::Pane;

/// Part of what is in view that an arrow moves it by.
const STEP: f32 = 0.1;
/// How much closer + looks.
const CLOSER: f64 = 1.25;

/// Arrows pan a pane that has the focus, + and − zoom it (with Shift only its frequencies), Home fits the plot. Escape leaves it.
pub(super) fn plot_keys(ui: &Ui, pane: Pane, response: &Response, view: &mut BodeView) {
    if !response.has_focus() {
        return;
    }
    let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    let Some(frame) = view.transform(pane).map(|transform| *transform.frame()) else { return };
    let shift = ui.input(|input| input.modifiers.shift);
    let pressed = |key| ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as f32;
    // The view moves where the arrow points: what is drawn moves the other way.
    let along = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
    let up = pressed(Key::ArrowUp) - pressed(Key::ArrowDown);
    let closer = pressed(Key::Plus) + pressed(Key::Equals) - pressed(Key::Minus);
    let is_fitted = pressed(Key::Home) > 0.0;
    if along != 0.0 || up != 0.0 {
        view.pan(pane, STEP * vec2(-along * frame.width(), up * frame.height()));
    }
    if closer != 0.0 {
        let factor = CLOSER.powf(f64::from(closer));
        view.zoom(pane, frame.center(), factor, if shift { 1.0 } else { factor });
    }
    if is_fitted {
        view.request_fit();
    }
    if along != 0.0 || up != 0.0 || closer != 0.0 || is_fitted {
        ui.ctx().request_repaint();
    }
}

/// The digit from 1 to 9 that is pressed, taken from the keys.
pub(super) fn pressed_digit(ui: &Ui) -> Option<usize> {
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];
    let pressed = |key: &Key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, *key));
    digits.iter().position(pressed).map(|place| place + 1)
}

/// How much closer one notch of a wheel looks.
const NOTCH: f32 = 1.1;
/// Points that a notch scrolls by.
const NOTCH_PT: f32 = 40.0;
/// How far beyond what is computed the wheel looks, in decades of frequency.
const BEYOND: f64 = 1.0;

/// How much closer to look, in x and y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Turn {
    /// By the wheel, or by two fingers.
    pub(super) both: Vec2,
    /// By the sideways wheel, which Shift makes of any: only x means it.
    pub(super) sideways: f32,
}

impl Turn {
    /// The same where there is one axis only: whichever way the wheel turns.
    pub(super) fn along_one_axis(self) -> f32 {
        let pinched = (self.both.x * self.both.y).sqrt();
        pinched * self.sideways
    }
}

/// What the wheel and two fingers ask of the widget under the pointer, and where; nothing where they rest.
pub(super) fn turned(ctx: &Context, response: &Response) -> Option<(Turn, Pos2)> {
    let pointer = response.hover_pos()?;
    let (scrolled, pinched) = ctx.input(|input| (input.smooth_scroll_delta(), input.zoom_delta_2d()));
    if scrolled == Vec2::ZERO && pinched == Vec2::splat(1.0) {
        return None;
    }
    // Two fingers scroll by parts of a notch.
    let closer = |points: f32| NOTCH.powf(points / NOTCH_PT);
    Some((Turn { both: closer(scrolled.y) * pinched, sideways: closer(scrolled.x) }, pointer))
}

/// The part of an axis in view. What the engineer chose stays until a fit of everything is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ViewedRange {
    range: Range,
    is_chosen: bool,
    /// Widths that can be in view.
    widths: Range,
    /// Values that can be in view.
    ends: Range,
}

impl ViewedRange {
    /// Shows `range` until something is fitted, later always a part of `ends` with a width in `widths`.
    pub(super) fn new(range: Range, widths: Range, ends: Range) -> Self {
        Self { range, is_chosen: false, widths, ends }
    }

    /// From now on no farther than a decade beyond what is computed, which is `computed` in decades.
    pub(super) fn reach(&mut self, computed: Range) {
        self.ends = Range::new(computed.min - BEYOND, computed.max + BEYOND);
    }

    /// Looks `factor` times closer, with `fixed` staying where it is, no farther than allowed.
    pub(super) fn zoom(&mut self, factor: f64, fixed: f64) {
        let Range { min, max } = self.range.zoomed(factor, fixed);
        if min < self.ends.max && max > self.ends.min {
            self.choose(Range::new(min.max(self.ends.min), max.min(self.ends.max)));
        }
    }

    /// What is in view.
    pub(super) fn range(&self) -> Range {
        self.range
    }

    /// Whether the engineer chose what is in view.
    pub(super) fn is_chosen(&self) -> bool {
        self.is_chosen
    }

    /// Shows what the engineer wants to see, where the numbers allow it.
    pub(super) fn choose(&mut self, range: Range) {
        if let Some(range) = self.allowed(range).filter(|range| *range != self.range) {
            self.range = range;
            self.is_chosen = true;
        }
    }

    /// Shows what fits the data, unless the engineer chose something else.
    pub(super) fn fit(&mut self, range: Range) {
        if let Some(range) = self.allowed(range).filter(|_| !self.is_chosen) {
            self.range = range;
        }
    }

    /// Forgets the engineer's choice: the next fit counts.
    pub(super) fn release(&mut self) {
        self.is_chosen = false;
    }

    fn allowed(&self, range: Range) -> Option<Range> {
        let range = range.limited(self.widths)?;
        (self.ends.contains(range.min) && self.ends.contains(range.max)).then_some(range)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viewed() -> ViewedRange {
        ViewedRange::new(Range::new(0.0, 1.0), Range::new(0.1, 50.0), Range::new(-100.0, 100.0))
    }

    #[test]
    fn what_was_chosen_stays_until_it_is_released() {
        let mut viewed = viewed();
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!((viewed.range(), viewed.is_chosen()), (Range::new(2.0, 3.0), false));
        viewed.choose(Range::new(4.0, 5.0));
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!((viewed.range(), viewed.is_chosen()), (Range::new(4.0, 5.0), true));
        viewed.release();
        viewed.fit(Range::new(2.0, 3.0));
        assert_eq!(viewed.range(), Range::new(2.0, 3.0));
    }

    #[test]
    fn zooming_out_ends_a_decade_beyond_what_is_computed() {
        let mut viewed = viewed();
        viewed.reach(Range::new(-0.5, 1.25));
        (0..100).for_each(|_| viewed.zoom(1.0 / 1.1, 0.3));
        assert_eq!(viewed.range(), Range::new(-1.5, 2.25));
        viewed.zoom(1.1, 0.3);
        assert!(viewed.range().width() < 3.75, "and back");
    }

    #[test]
    fn choosing_what_is_in_view_already_is_no_choice() {
        let mut viewed = viewed();
        viewed.choose(Range::new(0.0, 1.0));
        assert!(!viewed.is_chosen());
    }

    #[test]
    fn a_range_beyond_the_ends_is_not_shown() {
        let mut viewed = viewed();
        viewed.choose(Range::new(99.0, 101.0));
        viewed.choose(Range { min: f64::NAN, max: 1.0 });
        assert_eq!(viewed, self::viewed());
    }
}
