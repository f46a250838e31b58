//! The nodes of the search that are still open.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::differences::DifferenceBounds;

/// A part of the box that is still to be searched.
pub(super) struct Node {
    /// No point of the part is below this.
    pub(super) bound: f64,
    pub(super) region: DifferenceBounds,
    /// Where the search of its underestimator's minimum begins.
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
    /// The least bound is the greatest, so that a heap gives it first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound)
    }
}

/// The open nodes, least bound first, in no more memory than allowed.
pub(super) struct OpenNodes {
    heap: BinaryHeap<Node>,
    most: usize,
    /// Least bound of the nodes for which there was no room.
    refused: f64,
}

impl OpenNodes {
    /// None yet, of so many scales each, in at most so many bytes; one there is always room for.
    pub(super) fn new(scales: usize, bytes: usize) -> Self {
        // What an allocation takes besides its content, twice, and the growth of the heap, which doubles its memory.
        let of_node = DifferenceBounds::bytes(scales) + scales * size_of::<f64>() + 32 + 3 * size_of::<Node>();
        Self { heap: BinaryHeap::new(), most: (bytes / of_node).max(1), refused: f64::INFINITY }
    }

    /// Adds a node, or only its bound where there is no room.
    pub(super) fn push(&mut self, node: Node) {
        if self.heap.len() < self.most {
            self.heap.push(node);
        } else {
            self.refused = self.refused.min(node.bound);
        }
    }

    /// Whether a node found no room.
    pub(super) fn is_full(&self) -> bool {
        self.refused < f64::INFINITY
    }

    /// Takes the node of least bound.
    pub(super) fn pop(&mut self) -> Option<Node> {
        self.heap.pop()
    }

    /// The least bound of all, refused ones too; infinite where there are none.
    pub(super) fn least_bound(&self) -> f64 {
        self.heap.peek().map_or(f64::INFINITY, |node| node.bound).min(self.refused)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_beyond_the_memory_leave_their_bound_only() {
        let node =
            |bound: f64| Node { bound, region: DifferenceBounds::of_box(&[0.0; 20], &[0.0; 20]), start: vec![0.0; 20] };
        let mut open = OpenNodes::new(20, 40_000);
        let kept = (0..100).take_while(|&index| {
            open.push(node(100.0 - f64::from(index)));
            !open.is_full()
        });
        // 400 differences of 8 bytes, and the rest of a node.
        let kept = kept.count();
        assert!((9..=12).contains(&kept), "{kept}");
        assert_eq!(open.least_bound(), 100.0 - kept as f64);
        assert_eq!(open.pop().map(|node| node.bound), Some(101.0 - kept as f64));
    }
}
