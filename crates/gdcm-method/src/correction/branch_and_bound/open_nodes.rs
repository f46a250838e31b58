//! The search's open nodes, stored in limited memory. A *node* is a part of the box that contains
//! the unknown *scales* ([`super`]); it is *open* until it is closed by its lower bound or
//! branched.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::difference_bounds::DifferenceBounds;

/// A part of the box that remains to be searched.
pub(super) struct Node {
    /// Lower bound on the objective over this part.
    pub(super) bound: f64,
    pub(super) region: DifferenceBounds,
    /// Starting point for minimising the underestimator.
    pub(super) start: Vec<f64>,
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Node {
    /// Compares in reversed order, so that the heap returns the node with the lowest bound first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

/// The open nodes, lowest bound first.
pub(super) struct OpenNodes {
    heap: BinaryHeap<Node>,
    /// Maximum node count in memory.
    most: usize,
    /// Minimum bound over the nodes rejected for lack of memory, so that `least_bound` remains a
    /// lower bound without them.
    refused: f64,
}

impl OpenNodes {
    /// Creates an empty heap for nodes with `scales` scales each, in at most `bytes` bytes; at
    /// least one node is always stored.
    pub(super) fn new(scales: usize, bytes: usize) -> Self {
        // `32`: overhead for two allocations. `3 *`: when the heap grows, the old memory and the
        // new, twice as large, exist together.
        let node_bytes = DifferenceBounds::bytes(scales)
            + scales * size_of::<f64>()
            + 32
            + 3 * size_of::<Node>();
        Self {
            heap: BinaryHeap::new(),
            most: (bytes / node_bytes).max(1),
            refused: f64::INFINITY,
        }
    }

    /// Adds a node, or only its bound if the memory is exhausted.
    pub(super) fn push(&mut self, node: Node) {
        if self.heap.len() < self.most {
            self.heap.push(node);
        } else {
            self.refused = self.refused.min(node.bound);
        }
    }

    /// Returns whether a node was rejected for lack of memory.
    pub(super) fn is_full(&self) -> bool {
        self.refused < f64::INFINITY
    }

    /// Removes and returns the node with the lowest bound.
    pub(super) fn pop(&mut self) -> Option<Node> {
        self.heap.pop()
    }

    /// Returns the minimum bound over all nodes, including rejected nodes; infinite without nodes.
    pub(super) fn least_bound(&self) -> f64 {
        match self.heap.peek() {
            Some(node) => node.bound.min(self.refused),
            None => self.refused,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_beyond_the_memory_leave_their_bound_only() {
        let mut open = OpenNodes::new(20, 40_000);
        let mut kept = 0;
        for index in 0..100 {
            open.push(Node {
                bound: 100.0 - f64::from(index),
                region: DifferenceBounds::from_box(&[0.0; 20], &[0.0; 20]),
                start: vec![0.0; 20],
            });
            if open.is_full() {
                break;
            }
            kept += 1;
        }
        // A node has 400 differences of 8 bytes each, and some overhead.
        assert!((9..=12).contains(&kept), "{kept}");
        assert_eq!(open.least_bound(), 100.0 - f64::from(kept));
        assert_eq!(
            open.pop().map(|node| node.bound),
            Some(101.0 - f64::from(kept))
        );
    }
}
