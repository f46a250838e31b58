//! A convex function below the objective, over one region.

use super::landscape::{Bend, Landscape, Slope, Slopes};
use super::link::{Link, Shape};
use super::region::Region;
use super::well::{Jet, Well};

/// A straight line that replaces a well left of `until`.
#[derive(Clone, Copy, Debug)]
struct Line {
    until: f64,
    at: f64,
    value: f64,
    slope: f64,
    error: f64,
}

/// What stands for a link over the region: the link itself where it is convex, else the convex envelopes of its wells.
#[derive(Clone, Copy, Debug)]
enum Under {
    Itself,
    Envelopes {
        forward: Option<Line>,
        backward: Option<Line>,
    },
}

/// A link's stand-in with the range of its difference. The descent keeps to the box of the region only, so beyond the range
/// the stand-in goes on along its tangent and bends up: anything convex is right there, and this keeps the minimum near.
#[derive(Clone, Copy, Debug)]
struct Stand {
    under: Under,
    low: f64,
    high: f64,
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
            Stand {
                under: under(link, (low, high)),
                low,
                high: high.max(low),
            }
        };
        Self {
            landscape,
            stands: landscape.links.iter().map(stand).collect(),
            fence,
        }
    }

    /// Whether it is the landscape itself: the region is a convex piece, link by link.
    pub(crate) fn is_exact(&self) -> bool {
        self.stands.iter().all(|stand| matches!(stand.under, Under::Itself))
    }

    /// The link that lies furthest above its envelope at `scales` (kept inside the region's ranges), with that distance.
    pub(crate) fn widest_gap(&self, scales: &[f64]) -> Option<(usize, f64)> {
        let links = self.landscape.links.iter().zip(&self.stands).enumerate();
        let open = links.filter(|(_, (_, stand))| !matches!(stand.under, Under::Itself));
        let gap = |(index, (link, stand)): (usize, (&Link, &Stand))| {
            let u = (scales[link.to] - scales[link.from]).clamp(stand.low, stand.high);
            (
                index,
                link.shape.at(u).value - inside(&link.shape, &stand.under, u).value,
            )
        };
        open.map(gap).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Least curvature of the link from `node` to the ground over the region, at least 0.
    pub(crate) fn ground_curvature(&self, into: &mut [f64]) {
        let ground = self.landscape.ground();
        into.fill(0.0);
        for (link, stand) in self.landscape.links.iter().zip(&self.stands) {
            if link.to == ground && matches!(stand.under, Under::Itself) {
                into[link.from] += link.shape.least_curvature(stand.low, stand.high).max(0.0);
            }
        }
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
    fn value(&self, scales: &[f64]) -> f64 {
        let links = self.landscape.links.iter().zip(&self.stands);
        let sum: f64 = links.map(|(link, stand)| self.jet(link, stand, scales).value).sum();
        self.landscape.constant + sum
    }

    fn slopes(&self, scales: &[f64], _bend: Bend, into: &mut Slopes) {
        into.clear();
        into.value = self.landscape.constant;
        into.value_error = self.landscape.constant * 128.0 * f64::EPSILON;
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
        Shape::Wells { forward, backward, .. } => Under::Envelopes {
            forward: envelope(forward, low, high),
            backward: envelope(backward, -high, -low),
        },
        Shape::Parabola { .. } => Under::Itself,
    }
}

/// The stand-in within the range of its difference.
fn inside(shape: &Shape, under: &Under, u: f64) -> Jet {
    match (shape, under) {
        (
            Shape::Wells { forward, backward, .. },
            Under::Envelopes {
                forward: ahead,
                backward: behind,
            },
        ) => {
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

fn well_jet(well: &Well, line: Option<&Line>, v: f64) -> Jet {
    match line {
        Some(line) if v < line.until => {
            let rise = line.slope * (v - line.at);
            Jet {
                value: line.value + rise,
                slope: line.slope,
                curvature: 0.0,
                value_error: line.error + 8.0 * f64::EPSILON * (line.value.abs() + rise.abs()),
                slope_error: 8.0 * f64::EPSILON * line.slope.abs(),
            }
        }
        _ if well.is_flat() => Jet::default(),
        _ => well.at(v.exp()),
    }
}

/// The line of the convex envelope of a well over `[low, high]`: none where it is convex there, the chord where the line from
/// the left end is nowhere tangent, else the tangent, with the well itself to the right of it.
fn envelope(well: &Well, low: f64, high: f64) -> Option<Line> {
    if well.is_flat() || low >= well.inflection() {
        return None;
    }
    let start = well.at(low.exp());
    let end = well.at(high.exp());
    // Height over the well's left end of the tangent at b: falls as b moves right of the inflection.
    let overshoot = |b: f64, jet: &Jet| jet.value + jet.slope * (low - b) - start.value;
    if high <= well.inflection() || overshoot(high, &end) >= 0.0 {
        let slope = if high > low {
            (end.value - start.value) / (high - low)
        } else {
            0.0
        };
        let error = start.value_error + end.value_error;
        return Some(Line {
            until: f64::INFINITY,
            at: low,
            value: start.value.min(end.value - slope * (high - low)),
            slope,
            error,
        });
    }
    let (mut over, mut under) = (well.inflection().max(low), high);
    let mut tangent = end;
    // Any point of the bracket's right side is valid; twelve halvings cost the bound less than a millionth.
    for round in 0..12 {
        let middle = if round == 0 {
            well.centre().ln().min(0.5 * (over + under)).max(over)
        } else {
            0.5 * (over + under)
        };
        let jet = well.at(middle.exp());
        if overshoot(middle, &jet) > 0.0 {
            over = middle;
        } else {
            under = middle;
            tangent = jet;
        }
    }
    let error = start.value_error + tangent.value_error + tangent.slope_error * (under - low);
    Some(Line {
        until: under,
        at: under,
        value: tangent.value,
        slope: tangent.slope,
        error,
    })
}
