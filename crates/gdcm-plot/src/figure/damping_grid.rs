//! Grid in the s-plane: rays at constant damping ratio and arcs at constant frequency.

use std::f64::consts::PI;

use super::axis::Range;
use super::marks::Guide;
use super::ticks::step_above;

/// Damping ratios of the rays.
const DAMPING_RATIOS: [f64; 6] = [0.1, 0.2, 0.4, 0.6, 0.8, 0.95];
/// Ray length \[rad/s\]; beyond every displayed pole.
const FAR: f64 = 1e3;
/// Maximum number of arcs.
const ARCS: u32 = 8;
/// Number of intervals between the points of an arc.
const ARC_POINTS: usize = 60;
/// Distances, as fractions of plot width and height, below which two labels overlap.
const BESIDE: [f64; 2] = [0.11, 0.07];

/// Returns unlabelled rays at constant damping ratio, `Re λ = -ζ |λ|`, above and below the real
/// axis.
pub(super) fn rays() -> Vec<Guide> {
    let mut rays = Vec::new();
    for ratio in DAMPING_RATIOS {
        for sign in [1.0, -1.0] {
            let far = [-FAR * ratio, sign * FAR * (1.0 - ratio * ratio).sqrt()];
            rays.push(Guide {
                points: vec![[0.0, 0.0], far],
                label: String::new(),
            });
        }
    }
    rays
}

/// Returns the grid lines in the displayed part of the s-plane: rays at constant damping ratio and
/// arcs at constant frequency. The upper rays are labelled where they leave the displayed ranges.
pub fn damping_grid([real, imaginary]: [Range; 2]) -> impl Iterator<Item = Guide> {
    let mut reach = 0.0f64;
    for end in [real.min, real.max, imaginary.min, imaginary.max] {
        reach = reach.max(end.abs());
    }
    let mut guides = labelled_rays(real, imaginary, reach);
    // At most four arcs up to the farthest end; the plot's corners may lie farther out.
    let step = step_above(reach / 4.0);
    for k in 1..=ARCS {
        let radius = step * f64::from(k);
        if radius >= 2.0 * reach {
            break;
        }
        guides.push(arc(radius));
    }
    guides.into_iter()
}

/// Returns rays that extend `2 reach` \[rad/s\] to the left, labelled where they leave the displayed
/// ranges; a label too close to the previous label is omitted.
fn labelled_rays(real: Range, imaginary: Range, reach: f64) -> Vec<Guide> {
    let mut last_label: Option<[f64; 2]> = None;
    let mut rays = Vec::new();
    for ratio in DAMPING_RATIOS {
        let slope = (1.0 - ratio * ratio).sqrt() / ratio;
        // Distance from the imaginary axis at which the ray leaves the displayed ranges.
        let edge = (-real.min).min(imaginary.max / slope).max(0.0);
        let place = [edge / real.width(), edge * slope / imaginary.width()];
        let is_labelled = edge > 0.0 && !last_label.is_some_and(|last| is_beside(place, last));
        if is_labelled {
            last_label = Some(place);
        }
        for side in [1.0, -1.0] {
            let label = if side > 0.0 && is_labelled {
                format!("ζ {ratio}")
            } else {
                String::new()
            };
            let points = vec![
                [0.0, 0.0],
                [-edge, side * edge * slope],
                [-2.0 * reach, side * 2.0 * reach * slope],
            ];
            rays.push(Guide { points, label });
        }
    }
    rays
}

/// Returns whether labels at these two places would overlap.
fn is_beside(place: [f64; 2], other: [f64; 2]) -> bool {
    (0..2).all(|axis| (place[axis] - other[axis]).abs() < BESIDE[axis])
}

/// Returns the left half of a circle about the origin, starting at its top.
fn arc(radius: f64) -> Guide {
    let mut points = Vec::new();
    for k in 0..=ARC_POINTS {
        let angle = PI * (0.5 + k as f64 / ARC_POINTS as f64);
        points.push([radius * angle.cos(), radius * angle.sin()]);
    }
    Guide {
        points,
        label: String::new(),
    }
}
