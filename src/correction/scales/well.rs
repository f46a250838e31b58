//! The squared gain error of a group of entries, as a function of one logarithm.

use super::sum::Sum;

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

/// One entry `share (gain - product e^v)^2`, with `product` given by its logarithm.
#[derive(Clone, Copy, Debug)]
struct Member {
    share: f64,
    gain: f64,
    product: f64,
    logarithm: f64,
}

/// The entries that share a logarithm, gathered before they become a [`Well`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Gather {
    members: Vec<Member>,
}

/// Roundings of a product that is the exponential of a sum of logarithms: those of the logarithms become the product's.
pub(crate) fn product_roundings(logarithm: f64) -> f64 {
    8.0 + 4.0 * logarithm.abs()
}

impl Gather {
    /// Adds `share (gain - e^logarithm e^v)^2`.
    pub(crate) fn add(&mut self, share: f64, gain: f64, logarithm: f64) {
        self.members.push(Member { share, gain, product: logarithm.exp(), logarithm });
    }

    /// The well, and the sum at the well's bottom.
    ///
    /// The latter is summed from the residuals, not from `P - Q^2 / R`, which would cancel.
    pub(crate) fn well(&self) -> (Well, Sum) {
        let total = |term: fn(&Member) -> f64| self.members.iter().map(term).sum::<f64>();
        let weight = total(|member| member.share * member.product * member.product);
        if weight <= 0.0 {
            return (Well::default(), Sum::default());
        }
        let centre = total(|member| member.share * member.gain * member.product) / weight;
        let mut bottom = Sum::default();
        let mut roundings = 0.0_f64;
        for Member { share, gain, product, logarithm } in &self.members {
            let met = product * centre;
            bottom.add(*share, gain - met, gain + met, product_roundings(*logarithm));
            roundings = roundings.max(product_roundings(*logarithm));
        }
        // A sum of n positive terms is exact to n roundings; 32 more cover the exponential of a difference of scales (up to
        // 180 dB), the differences and the square.
        let rounding = (self.members.len() as f64 + roundings + 32.0) * f64::EPSILON;
        (Well { weight, centre, rounding }, bottom)
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

    /// Least and greatest slope over `e^v` in `[low, high]`: the slope is a parabola in `e^v`, lowest at `centre / 2`.
    pub(crate) fn slopes(&self, low: f64, high: f64) -> (f64, f64) {
        let slope = |z: f64| 2.0 * self.weight * z * (z - self.centre);
        (slope((0.5 * self.centre).clamp(low, high)), slope(low).max(slope(high)))
    }
}
