//! Assigns a different column to each row at the smallest total cost.
//!
//! ```text
//! min sum_i c_ij(i)    c_ij: cost of column j for row i, j(i): the column of row i
//!
//! 1  row potentials u_i, column potentials v_j, with u_i + v_j <= c_ij, equal where row i has column j
//! 2  for each row i in turn: grow a tree of columns from i by the least reduced cost c_ij - u_i - v_j (Dijkstra),
//!    moving the potentials with it, until a column is free
//! 3  shift the assignments along the path from i to that column
//! ```
//!
//! Kuhn, "The Hungarian method for the assignment problem", Naval Research Logistics Quarterly 2,
//! 1955, with shortest augmenting paths: Jonker & Volgenant, Computing 38, 1987. O(rows^2 columns).

/// Returns the column assigned to each row; needs at least as many columns as rows, and finite
/// costs `cost(row, column)`.
pub(crate) fn cheapest_assignment(
    rows: usize,
    columns: usize,
    cost: impl Fn(usize, usize) -> f64,
) -> Vec<usize> {
    // Step 1: zero at first; `augment` makes the inequality hold for the row that it adds.
    let mut assignment = Assignment {
        row_potentials: vec![0.0; rows],
        column_potentials: vec![0.0; columns],
        row_of: vec![None; columns],
    };
    for row in 0..rows {
        assignment.augment(row, &cost);
    }
    let mut column_of = vec![0; rows];
    for (column, row) in assignment.row_of.into_iter().enumerate() {
        if let Some(row) = row {
            column_of[row] = column;
        }
    }
    column_of
}

/// A partial assignment with minimum cost.
struct Assignment {
    /// `u`, by row.
    row_potentials: Vec<f64>,
    /// `v`, by column.
    column_potentials: Vec<f64>,
    /// Each column's row; `None` for a free column.
    row_of: Vec<Option<usize>>,
}

impl Assignment {
    /// Assigns a column to the row `new`, and reassigns earlier rows where that costs less (steps 2
    /// and 3).
    fn augment(&mut self, new: usize, cost: &impl Fn(usize, usize) -> f64) {
        let columns = self.row_of.len();
        // Least reduced cost from the tree to each column outside it.
        let mut distance = vec![f64::INFINITY; columns];
        // The previous column on the path from the new row; `None` at the row itself.
        let mut before: Vec<Option<usize>> = vec![None; columns];
        let mut in_tree = vec![false; columns];
        // The column that joined the tree last, and its row; at first, the new row itself.
        let mut last = None;
        let mut row = new;
        loop {
            for column in 0..columns {
                if in_tree[column] {
                    continue;
                }
                let reduced =
                    cost(row, column) - self.row_potentials[row] - self.column_potentials[column];
                if reduced < distance[column] {
                    distance[column] = reduced;
                    before[column] = last;
                }
            }
            let open = (0..columns).filter(|&column| !in_tree[column]);
            let Some(next) = open.min_by(|&a, &b| distance[a].total_cmp(&distance[b])) else {
                return;
            };
            // Step 2
            self.shift_potentials(new, &in_tree, &mut distance, next);
            in_tree[next] = true;
            last = Some(next);
            match self.row_of[next] {
                Some(owner) => row = owner,
                None => break,
            }
        }
        // Step 3
        self.shift_assignments(new, &before, last);
    }

    /// Moves the potentials in the tree (the row `new`, the columns in the tree and their rows) so
    /// that the reduced cost to `next` becomes zero.
    fn shift_potentials(
        &mut self,
        new: usize,
        in_tree: &[bool],
        distance: &mut [f64],
        next: usize,
    ) {
        let step = distance[next];
        self.row_potentials[new] += step;
        for (column, owner) in self.row_of.iter().enumerate() {
            match owner {
                Some(owner) if in_tree[column] => {
                    self.row_potentials[*owner] += step;
                    self.column_potentials[column] -= step;
                }
                _ => distance[column] -= step,
            }
        }
    }

    /// Gives each column on the path back from `last` the previous column's row, and the first
    /// column the row `new`.
    fn shift_assignments(&mut self, new: usize, before: &[Option<usize>], last: Option<usize>) {
        let mut at = last;
        while let Some(column) = at {
            at = before[column];
            self.row_of[column] = match at {
                Some(previous) => self.row_of[previous],
                None => Some(new),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Minimum total over all assignments, by exhaustive search.
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
        // Column 0 is the cheapest for both rows, and the only cheap column for row 1.
        let costs = [[1.0, 2.0, 9.0], [1.0, 9.0, 9.0]];
        assert_eq!(
            cheapest_assignment(2, 3, |row, column| costs[row][column]),
            [1, 0]
        );
        assert_eq!(cheapest_assignment(0, 3, |_, _| 0.0), [0; 0]);
    }

    proptest! {
        #[test]
        fn no_assignment_costs_less(entries in prop::collection::vec(0.0_f64..10.0, 25), rows in 1_usize..=5) {
            let costs: Vec<Vec<f64>> = (0..rows).map(|row| entries[5 * row..5 * row + 5].to_vec()).collect();
            let columns = cheapest_assignment(rows, 5, |row, column| costs[row][column]);
            let mut distinct = columns.clone();
            distinct.sort_unstable();
            distinct.dedup();
            prop_assert_eq!(distinct.len(), rows);
            let total: f64 = columns.iter().enumerate().map(|(row, &column)| costs[row][column]).sum();
            // Sums of five terms are rounded in another order.
            prop_assert!((total - tried_out(&costs, 0, &mut Vec::new())).abs() < 1e-13);
        }
    }
}
