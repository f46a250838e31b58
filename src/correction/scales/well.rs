//! The squared gain error of a group of entries, as a function of one logarithm.

/// Value, slope and curvature of a function of one variable at a point, with a bound on the rounding error of each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Jet {
    pub(crate) value: f64,
    pub(crate) slope: f64,
    pub(crate) curvature: f64,
    /// Bound on the rounding error of `value`.
    pub(crate) value_error: f64,
    /// Bound on the rounding error of `slope`.
    pub(crate) slope_error: f64,
}

/// `weight (e^v - centre)^2`: the sum of `w (G - A e^v)^2` over the entries that share the logarithm `v`, less its minimum.
///
/// Concave where `e^v < centre / 2`, convex elsewhere (`(G - K)^2` is convex in the logarithm where `K >= G / 2`).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Well {
    weight: f64,
    centre: f64,
    rounding: f64,
}

/// Entries `(gain, product)` of `sum (gain - product e^v)^2`, gathered before they become a [`Well`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Gather {
    entries: Vec<(f64, f64, f64)>,
}

impl Gather {
    /// Adds `share (gain - product e^v)^2`.
    pub(crate) fn add(&mut self, share: f64, gain: f64, product: f64) {
        self.entries.push((share, gain, product));
    }

    /// The well, and the constant that is the sum at the well's bottom.
    ///
    /// The constant is summed from the residuals, not from `P - Q^2 / R`, which would cancel.
    pub(crate) fn well(&self) -> (Well, f64) {
        let weight: f64 = self
            .entries
            .iter()
            .map(|(share, _, product)| share * product * product)
            .sum();
        if weight <= 0.0 {
            return (Well::default(), 0.0);
        }
        let moment: f64 = self
            .entries
            .iter()
            .map(|(share, gain, product)| share * gain * product)
            .sum();
        let centre = moment / weight;
        let bottom = self
            .entries
            .iter()
            .map(|(share, gain, product)| share * (gain - product * centre).powi(2))
            .sum();
        // A sum of n positive terms is exact to n roundings; 8 more cover the exponential, the differences and the square.
        let rounding = (self.entries.len() as f64 + 8.0) * f64::EPSILON;
        (
            Well {
                weight,
                centre,
                rounding,
            },
            bottom,
        )
    }
}

impl Well {
    /// Whether the well is there at all.
    pub(crate) fn is_flat(&self) -> bool {
        self.weight == 0.0
    }

    /// Weight of the well.
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// Value of `e^v` at the bottom.
    pub(crate) fn centre(&self) -> f64 {
        self.centre
    }

    /// The logarithm below which the well is concave.
    pub(crate) fn inflection(&self) -> f64 {
        (0.5 * self.centre).ln()
    }

    /// The well at `v`, given `z = e^v`.
    pub(crate) fn at(&self, z: f64) -> Jet {
        let depth = z - self.centre;
        let value = self.weight * depth * depth;
        let slope = 2.0 * self.weight * z * depth;
        let reach = self.weight * (z + self.centre);
        Jet {
            value,
            slope,
            curvature: 2.0 * self.weight * z * (z + depth),
            value_error: self.rounding * (2.0 * depth.abs() * reach + value),
            slope_error: self.rounding * 2.0 * z * (reach + self.weight * depth.abs()),
        }
    }

    /// Least curvature over `e^v` in `[low, high]`: the curvature is a parabola in `e^v`, lowest at `centre / 4`.
    pub(crate) fn least_curvature(&self, low: f64, high: f64) -> f64 {
        let z = (0.25 * self.centre).clamp(low, high);
        2.0 * self.weight * z * (2.0 * z - self.centre)
    }
}
