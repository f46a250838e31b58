//! Which of some things goes with which of others, at the least total cost.
//!
//! ```text
//! 1  potentials u_i of the rows, v_j of the columns, with u_i + v_j <= c_ij, equal where i goes with j
//! 2  for each row i in turn: grow a tree of columns from i by the least reduced cost c_ij - u_i - v_j (Dijkstra) ...
//! 3     ... moving the potentials with it, until a column is free
//! 4     along the path back to i each row takes the column that it was reached by
//! ```
//!
//! Kuhn, "The Hungarian method for the assignment problem", Naval Research Logistics Quarterly 2, 1955, with shortest
//! augmenting paths: Jonker & Volgenant, Computing 38, 1987. O(rows^2 columns).

/// The column of each row, each column taken once at most, with the least total cost; there are at least as many columns as
/// rows, and all costs are finite.
pub(super) fn least_total(rows: usize, columns: usize, cost: impl Fn(usize, usize) -> f64) -> Vec<usize> {
    let mut potentials = (vec![0.0; rows], vec![0.0; columns]);
    let mut row_of: Vec<Option<usize>> = vec![None; columns];
    for row in 0..rows {
        augment(row, &cost, &mut potentials, &mut row_of);
    }
    let mut column_of = vec![0; rows];
    for (column, row) in row_of.into_iter().enumerate() {
        if let Some(row) = row {
            column_of[row] = column;
        }
    }
    column_of
}

/// Gives `new` a column, the rows that have one already others where that costs less.
fn augment(
    new: usize,
    cost: &impl Fn(usize, usize) -> f64,
    (of_row, of_column): &mut (Vec<f64>, Vec<f64>),
    row_of: &mut [Option<usize>],
) {
    let columns = row_of.len();
    let mut distance = vec![f64::INFINITY; columns];
    // The column before on the way from the new row; none where that is the row itself.
    let mut before: Vec<Option<usize>> = vec![None; columns];
    let mut in_tree = vec![false; columns];
    let (mut at, mut row) = (None, new);
    loop {
        for column in (0..columns).filter(|&column| !in_tree[column]) {
            let reduced = cost(row, column) - of_row[row] - of_column[column];
            if reduced < distance[column] {
                (distance[column], before[column]) = (reduced, at);
            }
        }
        let open = (0..columns).filter(|&column| !in_tree[column]);
        let Some(next) = open.min_by(|&a, &b| distance[a].total_cmp(&distance[b])) else { return };
        let step = distance[next];
        of_row[new] += step;
        for (column, owner) in row_of.iter().enumerate() {
            match owner {
                Some(owner) if in_tree[column] => {
                    of_row[*owner] += step;
                    of_column[column] -= step;
                }
                _ => distance[column] -= step,
            }
        }
        in_tree[next] = true;
        at = Some(next);
        match row_of[next] {
            Some(owner) => row = owner,
            None => break,
        }
    }
    while let Some(column) = at {
        at = before[column];
        row_of[column] = at.map_or(Some(new), |previous| row_of[previous]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The least total over every assignment, one after the other.
    fn tried_out(costs: &[Vec<f64>], row: usize, taken: &mut Vec<usize>) -> f64 {
        if row == costs.len() {
            return 0.0;
        }
        let mut least = f64::INFINITY;
        for column in 0..costs[row].len() {
            if !taken.contains(&column) {
                taken.push(column);
                least = least.min(costs[row][column] + tried_out(costs, row + 1, taken));
                taken.pop();
            }
        }
        least
    }

    #[test]
    fn the_nearest_is_not_taken_where_the_total_suffers() {
        // Row 0 is nearest to column 0, and so is row 1, which has nothing else near.
        let costs = [[1.0, 2.0, 9.0], [1.0, 9.0, 9.0]];
        assert_eq!(least_total(2, 3, |row, column| costs[row][column]), [1, 0]);
        assert_eq!(least_total(0, 3, |_, _| 0.0), [0; 0]);
    }

    proptest! {
        #[test]
        fn no_assignment_costs_less(entries in prop::collection::vec(0.0_f64..10.0, 25), rows in 1_usize..=5) {
            let costs: Vec<Vec<f64>> = (0..rows).map(|row| entries[5 * row..5 * row + 5].to_vec()).collect();
            let columns = least_total(rows, 5, |row, column| costs[row][column]);
            let mut distinct = columns.clone();
            distinct.sort_unstable();
            distinct.dedup();
            prop_assert_eq!(distinct.len(), rows);
            let total: f64 = columns.iter().enumerate().map(|(row, &column)| costs[row][column]).sum();
            // Sums of five in another order.
            prop_assert!((total - tried_out(&costs, 0, &mut Vec::new())).abs() < 1e-13);
        }
    }
}
