//! The part of an axis in view, and who chose it.

use super::range::Range;

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
