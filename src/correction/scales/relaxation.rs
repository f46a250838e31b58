//! A convex function below the objective, over one region.

use super::envelope::{Line, envelope, well_jet};
use super::landscape::{Bend, Landscape, Slope, Slopes};
use super::link::{Link, Shape};
use super::region::Region;
use super::well::Jet;

/// What stands for a link over the region: the link itself where it is convex, else the convex envelopes of its wells.
#[derive(Clone, Copy, Debug)]
enum Under {
    Itself,
    Envelopes { forward: Option<Line>, backward: Option<Line> },
}

/// A link's stand-in with the range of its difference. The descent keeps to the box of the region only, so beyond the range
/// the stand-in goes on along its tangent and bends up: anything convex is right there, and this keeps the minimum near.
#[derive(Clone, Copy, Debug)]
struct Stand {
    under: Under,
    low: f64,
    high: f64,
}

impl Stand {
    /// The link's difference at `scales`, kept inside the range.
    fn difference(&self, link: &Link, scales: &[f64]) -> f64 {
        (scales[link.to] - scales[link.from]).clamp(self.low, self.high)
    }
}

/// Convex function of the scales that is nowhere in the region above the landscape.
pub(crate) struct Relaxation<'a> {
    landscape: &'a Landscape,
    stands: Vec<Stand>,
    fence: f64,
}

impl<'a> Relaxation<'a> {
    /// The relaxation of `landscape` over `region`, with curvature `fence` beyond the ranges of the differences.
    pub(crate) fn new(landscape: &'a Landscape, region: &Region, fence: f64) -> Self {
        let stand = |link: &Link| {
            let (low, high) = region.range(link.from, link.to);
            Stand { under: under(link, (low, high)), low, high: high.max(low) }
        };
        Self { landscape, stands: landscape.links.iter().map(stand).collect(), fence }
    }

    /// Whether it is the landscape itself: the region is a convex piece, link by link.
    pub(crate) fn is_exact(&self) -> bool {
        self.stands.iter().all(|stand| matches!(stand.under, Under::Itself))
    }

    /// The links that are not convex over the region.
    fn bent(&self) -> impl Iterator<Item = (&'a Link, &Stand)> {
        let links = self.landscape.links.iter().zip(&self.stands);
        links.filter(|(_, stand)| !matches!(stand.under, Under::Itself))
    }

    /// The link that lies furthest above its envelope at `scales` (kept inside the region's ranges), with that distance less the
    /// rounding of it.
    pub(crate) fn widest_gap(&self, scales: &[f64]) -> Option<(&'a Link, f64)> {
        let gap = |(link, stand): (&'a Link, &Stand)| {
            let u = stand.difference(link, scales);
            let (above, below) = (link.shape.at(u), inside(&link.shape, &stand.under, u));
            (link, above.value - below.value - above.value_error - below.value_error)
        };
        self.bent().map(gap).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Each link (from, to) that is bent but not where it is at `scales`, with the edge of the interval where it is concave:
    /// what lies beyond the edges is easily bounded, and what is left is convex in these links. The furthest edge comes first.
    pub(crate) fn edges(&self, scales: &[f64]) -> Vec<(usize, usize, f64)> {
        let edge = |(link, stand): (&'a Link, &Stand)| {
            let u = stand.difference(link, scales);
            let edge = link.shape.concave_edge(u, stand.low, stand.high)?;
            Some((link, edge, (edge - u).abs()))
        };
        let mut edges: Vec<(&Link, f64, f64)> = self.bent().filter_map(edge).collect();
        edges.sort_by(|a, b| b.2.total_cmp(&a.2));
        edges.into_iter().map(|(link, edge, _)| (link.from, link.to, edge)).collect()
    }

    /// The link whose slope varies most over the region, weighed with its range: what hides the sign of a scale's slope, or that
    /// there is but one minimum.
    pub(crate) fn widest_slope(&self) -> Option<&'a Link> {
        let variation = |(link, stand): (&'a Link, &Stand)| {
            let (least, most) = link.shape.slopes(stand.low, stand.high);
            (link, (most - least) * (stand.high - stand.low))
        };
        let links = self.landscape.links.iter().zip(&self.stands).map(variation);
        links.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(link, _)| link)
    }

    fn jet(&self, link: &Link, stand: &Stand, scales: &[f64]) -> Jet {
        let u = scales[link.to] - scales[link.from];
        let end = u.clamp(stand.low, stand.high);
        let mut jet = inside(&link.shape, &stand.under, end);
        let beyond = u - end;
        if beyond != 0.0 {
            let bend = self.fence * beyond;
            jet.value_error += jet.slope_error * beyond.abs() + 8.0 * f64::EPSILON * (jet.slope * beyond).abs();
            jet.slope_error += 8.0 * f64::EPSILON * bend.abs();
            jet.value += (jet.slope + 0.5 * bend) * beyond;
            jet.slope += bend;
            jet.curvature = self.fence;
        }
        jet
    }
}

impl Slope for Relaxation<'_> {
    fn slopes(&self, scales: &[f64], _bend: Bend, into: &mut Slopes) {
        into.clear();
        into.value = self.landscape.constant.value;
        into.value_error = self.landscape.constant.error;
        for (link, stand) in self.landscape.links.iter().zip(&self.stands) {
            let jet = self.jet(link, stand, scales);
            into.value += jet.value;
            into.value_error += jet.value_error;
            // Convex up to the rounding of the interval's ends.
            into.add(link, jet.slope, jet.slope_error, jet.curvature.max(0.0));
        }
    }
}

fn under(link: &Link, (low, high): (f64, f64)) -> Under {
    match &link.shape {
        shape if shape.is_convex_over(low, high) => Under::Itself,
        Shape::Wells { forward, backward, .. } => {
            Under::Envelopes { forward: envelope(forward, low, high), backward: envelope(backward, -high, -low) }
        }
        Shape::Parabola { .. } => Under::Itself,
    }
}

/// The stand-in within the range of its difference.
fn inside(shape: &Shape, under: &Under, u: f64) -> Jet {
    match (shape, under) {
        (Shape::Wells { forward, backward, .. }, Under::Envelopes { forward: ahead, backward: behind }) => {
            let ahead = well_jet(forward, ahead.as_ref(), u);
            let behind = well_jet(backward, behind.as_ref(), -u);
            Jet {
                value: ahead.value + behind.value,
                slope: ahead.slope - behind.slope,
                curvature: ahead.curvature + behind.curvature,
                value_error: ahead.value_error + behind.value_error,
                slope_error: ahead.slope_error + behind.slope_error,
            }
        }
        _ => shape.at(u),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::sum::Sum;
    use super::super::well::{Gather, Well};
    use super::*;

    fn well(share: f64, centre: f64) -> Well {
        let mut gather = Gather::default();
        gather.add(share, centre, 0.0);
        gather.well().0
    }

    fn landscape(forward: (f64, f64), backward: (f64, f64), range: (f64, f64)) -> Landscape {
        let shape = Shape::wells(well(forward.0, forward.1), well(backward.0, backward.1));
        let links = vec![Link { from: 0, to: 1, shape }];
        Landscape { lower: vec![range.0, 0.0], upper: vec![range.1, 0.0], links, constant: Sum::default() }
    }

    proptest! {
        #[test]
        fn the_relaxation_is_convex_and_nowhere_above_the_landscape(
            forward in (0.01..10.0_f64, 0.05..20.0_f64),
            backward in (prop_oneof![Just(0.0), 0.01..10.0_f64], 0.05..20.0_f64),
            low in -3.0..1.0_f64,
            width in 0.01..4.0_f64,
        ) {
            let landscape = landscape(forward, backward, (low, low + width));
            let region = Region::of_box(&landscape.lower, &landscape.upper);
            let relaxation = Relaxation::new(&landscape, &region, 1.0);
            let mut slopes = Slopes::zero(2);
            let mut steepness = f64::INFINITY;
            for step in 0..=200 {
                let scales = [low + width * f64::from(step) / 200.0, 0.0];
                relaxation.slopes(&scales, Bend::True, &mut slopes);
                let value = landscape.value(&scales);
                prop_assert!(slopes.value - slopes.value_error <= value, "{} is above {}", slopes.value, value);
                // The difference is measured from node 0 to node 1: the slope of node 1 falls as the scale of node 0 rises.
                let rounding = 1e-9 * (1.0 + steepness.abs().min(1e9));
                prop_assert!(slopes.gradient[1] <= steepness + rounding, "{} after {}", slopes.gradient[1], steepness);
                steepness = slopes.gradient[1];
            }
        }

        #[test]
        fn two_wells_are_convex_wherever_they_say_so(
            forward in (0.01..10.0_f64, 0.05..20.0_f64),
            backward in (0.01..10.0_f64, 0.05..20.0_f64),
            at in -3.0..3.0_f64,
        ) {
            let shape = Shape::wells(well(forward.0, forward.1), well(backward.0, backward.1));
            let convex = shape.is_convex_over(at, at);
            let curvature = shape.at(at).curvature;
            // The interval is widened by 1e-11; the curvature there is as small as that times its own slope.
            prop_assert!(convex == (curvature > 0.0) || curvature.abs() <= 1e-6, "{} {}", convex, curvature);
        }

        #[test]
        fn bounds_on_slope_and_curvature_hold_over_the_range(
            forward in (0.01..10.0_f64, 0.05..20.0_f64),
            backward in (0.01..10.0_f64, 0.05..20.0_f64),
            low in -3.0..1.0_f64,
            width in 0.01..4.0_f64,
            share in 0.0..1.0_f64,
        ) {
            let shape = Shape::wells(well(forward.0, forward.1), well(backward.0, backward.1));
            let jet = shape.at(low + share * width);
            let (least, most) = shape.slopes(low, low + width);
            // The rounding of figures of up to 1e4.
            prop_assert!(least - 1e-9 <= jet.slope && jet.slope <= most + 1e-9);
            prop_assert!(shape.least_curvature(low, low + width) <= jet.curvature + 1e-9);
        }
    }
}
