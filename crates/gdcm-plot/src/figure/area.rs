//! Rectangles on paper and on the screen; y runs downwards.

/// An axis-aligned rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Area {
    /// Creates a rectangle from its upper left corner, width and height.
    pub fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self {
            left,
            top,
            width,
            height,
        }
    }

    /// Returns the right edge's coordinate, `left + width`.
    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    /// Returns the lower edge's coordinate, `top + height`.
    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Returns the point at `x` widths from the left edge and `y` heights from the lower edge.
    pub fn at(&self, x: f64, y: f64) -> [f64; 2] {
        [self.left + x * self.width, self.bottom() - y * self.height]
    }

    /// Returns the four corners, clockwise from the upper left corner.
    pub fn corners(&self) -> [[f64; 2]; 4] {
        [
            [self.left, self.top],
            [self.right(), self.top],
            [self.right(), self.bottom()],
            [self.left, self.bottom()],
        ]
    }

    /// Returns whether a point lies in the rectangle, edges included.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right()).contains(&x) && (self.top..=self.bottom()).contains(&y)
    }

    /// Returns the area, width times height.
    pub fn size(&self) -> f64 {
        self.width * self.height
    }

    /// Returns the rectangle enlarged by `by` on every side.
    pub fn expanded(&self, by: f64) -> Self {
        Self::new(
            self.left - by,
            self.top - by,
            self.width + 2.0 * by,
            self.height + 2.0 * by,
        )
    }

    /// Returns the distance from a point to the rectangle; 0 inside.
    pub fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        let dx = outside_distance(x, self.left, self.right());
        let dy = outside_distance(y, self.top, self.bottom());
        dx.hypot(dy)
    }

    /// Returns the area common to both rectangles; 0 if they do not overlap.
    pub fn overlap(&self, other: &Self) -> f64 {
        let width = self.right().min(other.right()) - self.left.max(other.left);
        let height = self.bottom().min(other.bottom()) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }
}

/// Returns the distance from a value to the interval between `low` and `high`; 0 inside.
fn outside_distance(value: f64, low: f64, high: f64) -> f64 {
    (low - value).max(value - high).max(0.0)
}
