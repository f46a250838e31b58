//! Small multiples: many plots of one size in a row, or in as many rows as show them largest.

use egui::{Rect, ScrollArea, Ui, UiBuilder, Vec2, pos2, vec2};

/// Width over height that suits a small plot.
const ASPECT: f32 = 1.15;
/// How much larger plots must be to be worth a gap in the last row \[pt\].
const PRICE_OF_GAP: f32 = 4.0;

/// How many plots stand beside and under one another, and how large they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tiles {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) size: Vec2,
}

impl Tiles {
    /// The arrangement of `count` plots in `available` that shows them largest, none smaller than `least`.
    ///
    /// Where they do not fit, they stand in one row wider than what is available: it scrolls.
    pub(super) fn arrange(count: usize, available: Vec2, least: Vec2) -> Self {
        let count = count.max(1);
        let candidates = (1..=count).map(|columns| {
            let rows = count.div_ceil(columns);
            Self {
                columns,
                rows,
                size: vec2(available.x / columns as f32, available.y / rows as f32),
            }
        });
        let fitting = candidates.filter(|tiles| tiles.size.x >= least.x && tiles.size.y >= least.y);
        fitting
            .max_by(|a, b| a.usefulness(count).total_cmp(&b.usefulness(count)))
            .unwrap_or(Self {
                columns: count,
                rows: 1,
                size: vec2(
                    least.x.max(available.x / count as f32),
                    available.y.max(least.y),
                ),
            })
    }

    /// Size of the largest plot of good proportions in a tile; full rows look better than a last one with gaps.
    fn usefulness(self, count: usize) -> f32 {
        let gaps = self.columns * self.rows - count;
        (self.size.x / ASPECT).min(self.size.y) - PRICE_OF_GAP * gaps as f32
    }

    /// Size of all tiles together.
    fn all(self) -> Vec2 {
        vec2(
            self.columns as f32 * self.size.x,
            self.rows as f32 * self.size.y,
        )
    }

    /// The place of a tile in an area that begins at `origin`.
    fn rect(self, index: usize, origin: egui::Pos2) -> Rect {
        let column = index % self.columns;
        let row = index / self.columns;
        let offset = vec2(column as f32 * self.size.x, row as f32 * self.size.y);
        Rect::from_min_size(origin + offset, self.size)
    }
}

/// Calls `tile_ui(ui, index, rect)` for each of `count` tiles in `rect`, with scroll bars where they do not fit.
pub(super) fn tiles_ui(
    ui: &mut Ui,
    name: &str,
    rect: Rect,
    count: usize,
    least: Vec2,
    mut tile_ui: impl FnMut(&mut Ui, usize, Rect),
) {
    let mut tiles = Tiles::arrange(count, rect.size(), least);
    let fits = tiles.all().x <= rect.width() + 0.5 && tiles.all().y <= rect.height() + 0.5;
    if !fits {
        // What is wider than the room leaves some of its height to the scroll bar.
        tiles.size.y = (tiles.size.y - ui.spacing().scroll.allocated_width()).max(least.y);
    }
    let size = tiles.all();
    let builder = UiBuilder::new().id_salt(name).max_rect(rect);
    ui.scope_builder(builder, |ui| {
        let mut draw = |ui: &mut Ui| {
            let origin = pos2(ui.max_rect().left(), ui.max_rect().top());
            ui.allocate_rect(Rect::from_min_size(origin, size), egui::Sense::hover());
            (0..count).for_each(|index| tile_ui(ui, index, tiles.rect(index, origin)));
        };
        if fits {
            draw(ui);
        } else {
            ScrollArea::both()
                .id_salt(name)
                .auto_shrink(false)
                .show(ui, draw);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEAST: Vec2 = vec2(150.0, 130.0);

    #[test]
    fn a_flat_area_gets_one_row_and_a_tall_one_several() {
        assert_eq!(Tiles::arrange(5, vec2(900.0, 220.0), LEAST).rows, 1);
        assert_eq!(Tiles::arrange(5, vec2(600.0, 500.0), LEAST).rows, 2);
        assert_eq!(Tiles::arrange(6, vec2(400.0, 900.0), LEAST).columns, 2);
    }

    #[test]
    fn tiles_that_do_not_fit_keep_their_least_size() {
        let tiles = Tiles::arrange(5, vec2(400.0, 150.0), LEAST);
        assert_eq!((tiles.rows, tiles.columns), (1, 5));
        assert_eq!(tiles.size, vec2(150.0, 150.0));
    }

    #[test]
    fn no_tile_lies_on_another() {
        let tiles = Tiles::arrange(7, vec2(800.0, 500.0), LEAST);
        let rects: Vec<Rect> = (0..7)
            .map(|index| tiles.rect(index, pos2(10.0, 20.0)))
            .collect();
        for (k, a) in rects.iter().enumerate() {
            for b in &rects[k + 1..] {
                let common = a.intersect(*b);
                assert!(common.width() < 0.01 || common.height() < 0.01);
            }
        }
    }
}
