//! The squared gain error of a group of entries, as a function of one logarithm.

use super::rounded::Rounded;

/// Value, slope and curvature of a function of one variable at a point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Derivatives {
    pub(crate) value: Rounded,
    pub(crate) slope: Rounded,
    pub(crate) curvature: f64,
}

/// Least and greatest value of a derivative over an interval, rounded outward, with the size of what they are differences of.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Range {
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) size: f64,
}

/// `weight (e^v - centre)^2`: the sum of `w (G - A e^v)^2` over the entries that share the logarithm `v`, less its minimum.
///
/// Concave where `e^v < centre / 2`, convex elsewhere (`(G - K)^2` is convex in the logarithm where `K >= G / 2`).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Exponential {
    weight: f64,
    centre: f64,
    /// Bound on the relative rounding of both.
    rounding: f64,
}

/// One entry `weight (gain - product e^v)^2`, the product known to a relative `error`.
#[derive(Clone, Copy, Debug)]
struct Entry {
    weight: f64,
    gain: f64,
    product: f64,
    error: f64,
}

/// The entries that share a logarithm, gathered before they become one [`Exponential`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Group {
    entries: Vec<Entry>,
}

/// `e^logarithm` with its relative rounding, of a logarithm known to `error`.
pub(crate) fn product(logarithm: f64, error: f64) -> (f64, f64) {
    // The error of the logarithm is the product's own, and the exponential is good to an epsilon.
    (logarithm.exp(), error + f64::EPSILON)
}

/// `weight (gain - product)^2` of an entry that no scale changes.
pub(crate) fn fixed_square(weight: f64, gain: f64, (product, relative): (f64, f64)) -> Rounded {
    let difference = gain - product;
    Rounded::square(weight, difference, relative * product + f64::EPSILON * difference.abs(), 0.0)
}

impl Group {
    /// Adds `weight (gain - e^logarithm e^v)^2`, the logarithm known to `error`.
    pub(crate) fn add(&mut self, weight: f64, gain: f64, logarithm: f64, error: f64) {
        let (product, error) = product(logarithm, error);
        self.entries.push(Entry { weight, gain, product, error });
    }

    /// The function of the group, and the sum where it is least.
    ///
    /// The latter is summed from the residuals, not from `P - Q^2 / R`, which would cancel.
    pub(crate) fn exponential(&self) -> (Exponential, Rounded) {
        let total = |term: fn(&Entry) -> f64| self.entries.iter().map(term).sum::<f64>();
        let weight = total(|entry| entry.weight * entry.product * entry.product);
        if weight <= 0.0 {
            return (Exponential::default(), Rounded::default());
        }
        let centre = total(|entry| entry.weight * entry.gain * entry.product) / weight;
        let mut least = Rounded::default();
        let mut worst = 0.0_f64;
        for entry in &self.entries {
            let met = (entry.product * centre, entry.error + f64::EPSILON);
            least.add(fixed_square(entry.weight, entry.gain, met));
            worst = worst.max(entry.error);
        }
        // A sum of n positive terms is exact to n roundings of half an epsilon; the centre is the quotient of two of them, and
        // holds the product once more than twice.
        let rounding = 3.0 * worst + (self.entries.len() as f64 + 4.0) * f64::EPSILON;
        (Exponential { weight, centre, rounding }, least)
    }
}

impl Exponential {
    /// Whether there is nothing in it.
    pub(crate) fn is_zero(&self) -> bool {
        self.weight == 0.0
    }

    /// Weight of the square.
    pub(crate) fn weight(&self) -> f64 {
        self.weight
    }

    /// `e^v` where the function is least.
    pub(crate) fn centre(&self) -> f64 {
        self.centre
    }

    /// The logarithm below which the function is concave.
    pub(crate) fn inflection(&self) -> f64 {
        (0.5 * self.centre).ln()
    }

    /// Relative rounding of `weight`, `centre` and `z = e^v`: of the first two, of `v` as a difference, of the exponential and of
    /// its reciprocal.
    pub(super) fn relative(&self, v: f64) -> f64 {
        self.rounding + (v.abs() + 4.0) * f64::EPSILON
    }

    /// The function at `v`, given `z = e^v`.
    pub(crate) fn at(&self, v: f64, z: f64) -> Derivatives {
        let away = z - self.centre;
        let relative = self.relative(v);
        let error = relative * (z + self.centre);
        let slope = 2.0 * self.weight * z * away;
        Derivatives {
            value: Rounded::square(self.weight, away, error, relative),
            slope: Rounded { value: slope, error: 2.0 * self.weight * z * error + 2.0 * relative * slope.abs() },
            curvature: 2.0 * self.weight * z * (z + away),
        }
    }

    /// The curvature over `v` in `[low, high]`: a parabola in `e^v`, lowest at `centre / 4`. Only the least is sharp.
    pub(crate) fn curvatures(&self, (low, high): (f64, f64)) -> Range {
        let (least, most) = (low.exp(), high.exp());
        let curvature = |z: f64| 2.0 * self.weight * z * (2.0 * z - self.centre);
        let size = 2.0 * self.weight * most * (2.0 * most + self.centre);
        let margin = 4.0 * self.relative(low.abs().max(high.abs())) * size;
        Range { least: curvature((0.25 * self.centre).clamp(least, most)) - margin, most: size + margin, size }
    }

    /// The slope over `v` in `[low, high]`: a parabola in `e^v`, lowest at `centre / 2`.
    pub(crate) fn slopes(&self, (low, high): (f64, f64)) -> Range {
        let (least, most) = (low.exp(), high.exp());
        let slope = |z: f64| 2.0 * self.weight * z * (z - self.centre);
        let size = 2.0 * self.weight * most * (most + self.centre);
        let margin = 4.0 * self.relative(low.abs().max(high.abs())) * size;
        let (lowest, highest) = (slope((0.5 * self.centre).clamp(least, most)), slope(least).max(slope(most)));
        Range { least: lowest - margin, most: highest + margin, size }
    }
}
