//! The objective after the constraints are eliminated, as a function of the scales.

use super::link::Link;
use super::sum::Sum;

/// Value, gradient and curvature (row-major Hessian) of a function of the scales, with bounds on the rounding errors.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slopes {
    pub(crate) value: f64,
    pub(crate) value_error: f64,
    pub(crate) gradient: Vec<f64>,
    pub(crate) gradient_error: Vec<f64>,
    pub(crate) curvature: Vec<f64>,
}

impl Slopes {
    /// Zero, for `nodes` scales.
    pub(crate) fn zero(nodes: usize) -> Self {
        Self {
            value: 0.0,
            value_error: 0.0,
            gradient: vec![0.0; nodes],
            gradient_error: vec![0.0; nodes],
            curvature: vec![0.0; nodes * nodes],
        }
    }

    /// Forgets everything, keeping the memory.
    pub(crate) fn clear(&mut self) {
        self.value = 0.0;
        self.value_error = 0.0;
        self.gradient.fill(0.0);
        self.gradient_error.fill(0.0);
        self.curvature.fill(0.0);
    }

    /// Adds a function of `s_to - s_from` with this slope and curvature.
    pub(crate) fn add(&mut self, link: &Link, slope: f64, slope_error: f64, curvature: f64) {
        let (nodes, from, to) = (self.gradient.len(), link.from, link.to);
        self.gradient[to] += slope;
        self.gradient[from] -= slope;
        self.gradient_error[to] += slope_error;
        self.gradient_error[from] += slope_error;
        self.curvature[to * nodes + to] += curvature;
        self.curvature[from * nodes + from] += curvature;
        self.curvature[to * nodes + from] -= curvature;
        self.curvature[from * nodes + to] -= curvature;
    }
}

/// How the curvature of a link that bends down is entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bend {
    /// As it is.
    True,
    /// As its magnitude, which keeps the Hessian positive semidefinite far from a minimum.
    Upward,
}

/// A function of the scales that a descent can follow.
pub(crate) trait Slope {
    /// Value, gradient and curvature at `scales`.
    fn slopes(&self, scales: &[f64], bend: Bend, into: &mut Slopes);
}

/// `constant + sum of links`, over the box of the scales.
///
/// Node `n - 1` is the ground: its scale is 0, so a link to it is a function of one scale.
#[derive(Clone, Debug)]
pub(crate) struct Landscape {
    /// Least scale of each node, the ground last.
    pub(crate) lower: Vec<f64>,
    /// Greatest scale of each node, the ground last.
    pub(crate) upper: Vec<f64>,
    /// Every link, at most one for each two nodes.
    pub(crate) links: Vec<Link>,
    /// What no scale changes.
    pub(crate) constant: Sum,
}

impl Landscape {
    /// Number of nodes, with the ground.
    pub(crate) fn nodes(&self) -> usize {
        self.lower.len()
    }

    /// The node whose scale is always 0.
    pub(crate) fn ground(&self) -> usize {
        self.lower.len() - 1
    }

    /// Value at `scales`.
    pub(crate) fn value(&self, scales: &[f64]) -> f64 {
        let links: f64 = self.links.iter().map(|link| link.shape.at(scales[link.to] - scales[link.from]).value).sum();
        self.constant.value + links
    }

    /// The pieces that links tie together, each with its nodes; `true` where the piece holds the ground.
    pub(crate) fn pieces(&self) -> Vec<(Vec<usize>, bool)> {
        let mut piece_of: Vec<usize> = (0..self.nodes()).collect();
        for link in &self.links {
            let (kept, merged) = (piece_of[link.from], piece_of[link.to]);
            for piece in &mut piece_of {
                if *piece == merged {
                    *piece = kept;
                }
            }
        }
        (0..self.nodes())
            .map(|piece| (0..self.nodes()).filter(|&node| piece_of[node] == piece).collect::<Vec<_>>())
            .filter(|nodes| !nodes.is_empty())
            .map(|nodes| (nodes.contains(&self.ground()), nodes))
            .map(|(grounded, nodes)| (nodes, grounded))
            .collect()
    }
}

impl Slope for Landscape {
    fn slopes(&self, scales: &[f64], bend: Bend, into: &mut Slopes) {
        into.clear();
        into.value = self.constant.value;
        into.value_error = self.constant.error;
        for link in &self.links {
            let jet = link.shape.at(scales[link.to] - scales[link.from]);
            let curvature = if bend == Bend::Upward { jet.curvature.abs() } else { jet.curvature };
            into.value += jet.value;
            into.value_error += jet.value_error;
            into.add(link, jet.slope, jet.slope_error, curvature);
        }
    }
}
