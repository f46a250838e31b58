//! Small multiples: the plots of a figure as equally large tiles, in the number of rows and columns
//! with which they are largest.

use egui::{Rect, ScrollArea, Ui, UiBuilder, Vec2, vec2};

/// Preferred ratio of plot width to height.
const ASPECT: f32 = 1.15;
/// Minimum increase in plot size that justifies an empty tile in the last row \[pt\].
const PRICE_OF_GAP: f32 = 4.0;

/// Number of rows and columns, and plot size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tiles {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) size: Vec2,
}

impl Tiles {
    /// Arranges `count` plots in `available` so that they are largest, none smaller than `least`:
    ///
    /// 1. every number of columns from 1 to `count`, with the rows that it needs, is a candidate if
    ///    no tile is smaller than `least`;
    /// 2. the candidate with the highest [`Self::usefulness`] is chosen, among equals the one
    ///    with the most columns;
    /// 3. without a candidate, the plots form a single row of at least the minimum size, which is
    ///    larger than `available` and scrolls.
    pub(super) fn arrange(count: usize, available: Vec2, least: Vec2) -> Self {
        let count = count.max(1);
        let mut best: Option<Self> = None;
        // Step 1.
        for columns in 1..=count {
            let rows = count.div_ceil(columns);
            let size = vec2(available.x / columns as f32, available.y / rows as f32);
            let tiles = Self {
                columns,
                rows,
                size,
            };
            let fits = size.x >= least.x && size.y >= least.y;
            // Step 2.
            if fits && best.is_none_or(|best| tiles.usefulness(count) >= best.usefulness(count)) {
                best = Some(tiles);
            }
        }
        // Step 3.
        best.unwrap_or(Self {
            columns: count,
            rows: 1,
            size: vec2(
                least.x.max(available.x / count as f32),
                available.y.max(least.y),
            ),
        })
    }

    /// Rates an arrangement by the height of the largest plot with preferred proportions in a tile,
    /// less a penalty for empty tiles \[pt\].
    fn usefulness(self, count: usize) -> f32 {
        let empty_tiles = self.columns * self.rows - count;
        (self.size.x / ASPECT).min(self.size.y) - PRICE_OF_GAP * empty_tiles as f32
    }

    fn total_size(self) -> Vec2 {
        vec2(
            self.columns as f32 * self.size.x,
            self.rows as f32 * self.size.y,
        )
    }

    /// Allocates and draws all tiles.
    fn ui(self, ui: &mut Ui, count: usize, tile_ui: &mut impl FnMut(&mut Ui, usize, Rect)) {
        let origin = ui.max_rect().left_top();
        let area = Rect::from_min_size(origin, self.total_size());
        ui.allocate_rect(area, egui::Sense::hover());
        for index in 0..count {
            tile_ui(ui, index, self.rect(index, origin));
        }
    }

    /// Returns a tile's area, with the first tile at `origin`.
    fn rect(self, index: usize, origin: egui::Pos2) -> Rect {
        let column = index % self.columns;
        let row = index / self.columns;
        let offset = vec2(column as f32 * self.size.x, row as f32 * self.size.y);
        Rect::from_min_size(origin + offset, self.size)
    }
}

/// Area into which tiles are drawn.
pub(super) struct TiledArea {
    /// Distinguishes the scroll bars from those in other areas.
    pub(super) name: &'static str,
    pub(super) rect: Rect,
    pub(super) count: usize,
    /// Minimum tile size \[pt\].
    pub(super) least: Vec2,
}

/// Calls `tile_ui(ui, index, rect)` for each tile, with scroll bars if they do not fit.
pub(super) fn tiles_ui(
    ui: &mut Ui,
    area: &TiledArea,
    mut tile_ui: impl FnMut(&mut Ui, usize, Rect),
) {
    let TiledArea {
        name,
        rect,
        count,
        least,
    } = *area;
    let mut tiles = Tiles::arrange(count, rect.size(), least);
    let total = tiles.total_size();
    // Half a point of tolerance for rounding errors.
    let fits = total.x <= rect.width() + 0.5 && total.y <= rect.height() + 0.5;
    if !fits {
        // The tiles are then a single row (see `arrange`), whose scroll bar takes some height.
        tiles.size.y = (tiles.size.y - ui.spacing().scroll.allocated_width()).max(least.y);
    }
    ui.scope_builder(UiBuilder::new().id_salt(name).max_rect(rect), |ui| {
        if fits {
            tiles.ui(ui, count, &mut tile_ui);
        } else {
            ScrollArea::both()
                .id_salt(name)
                .auto_shrink(false)
                .show(ui, |ui| tiles.ui(ui, count, &mut tile_ui));
        }
    });
}

#[cfg(test)]
mod tests {
    use egui::pos2;

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
