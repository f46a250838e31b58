//! Connected components in a graph.

/// Finds the connected components in a graph with `count` nodes and the given edges; each lists its
/// nodes in ascending order.
pub(crate) fn connected_pieces(
    count: usize,
    edges: impl Iterator<Item = [usize; 2]>,
) -> Vec<Vec<usize>> {
    // A piece's number is the index of a node in it; at first every node is a piece by itself.
    let mut piece_of: Vec<usize> = (0..count).collect();
    for [a, b] in edges {
        let kept = piece_of[a];
        let merged = piece_of[b];
        for piece in &mut piece_of {
            if *piece == merged {
                *piece = kept;
            }
        }
    }
    let mut pieces = vec![Vec::new(); count];
    for (node, &piece) in piece_of.iter().enumerate() {
        pieces[piece].push(node);
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}
