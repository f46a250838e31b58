//! Assigns a different column to each row at the smallest total cost.
//!
//! ```text
//! min sum_i c_ij(i)    c_ij: cost of column j for row i, j(i): the column of row i
//!
//! 1  row potentials u_i, column potentials v_j, with u_i + v_j <= c_ij, equal where row i has
//!    column j
//! 2  for each row i in turn: grow a tree of columns from i, each time by the column with the least
//!    reduced cost c_ij - u_i - v_j (Dijkstra), moving the potentials with it, until a column is
//!    free
//! 3  shift the assignments along the path from i to that column
//! ```
//!
//! With such potentials an assignment whose entries all have reduced cost 0 is optimal: any other
//! costs at least the sum of the potentials.
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
        let mut least_reduced = vec![f64::INFINITY; columns];
        // The previous column on the path from the new row; `None` if the row itself comes before.
        let mut previous: Vec<Option<usize>> = vec![None; columns];
        let mut in_tree = vec![false; columns];
        // The column that joined the tree last, and its row; at first, no column and the new row.
        let mut joined = None;
        let mut row = new;
        // Step 2
        loop {
            for column in 0..columns {
                if in_tree[column] {
                    continue;
                }
                let reduced =
                    cost(row, column) - self.row_potentials[row] - self.column_potentials[column];
                if reduced < least_reduced[column] {
                    least_reduced[column] = reduced;
                    previous[column] = joined;
                }
            }
            let outside = (0..columns).filter(|&column| !in_tree[column]);
            let nearest = outside.min_by(|&a, &b| least_reduced[a].total_cmp(&least_reduced[b]));
            let Some(next) = nearest else {
                return;
            };
            self.shift_potentials(new, &in_tree, &mut least_reduced, next);
            in_tree[next] = true;
            joined = Some(next);
            match self.row_of[next] {
                Some(assigned_row) => row = assigned_row,
                None => break,
            }
        }
        // Step 3
        self.shift_assignments(new, &previous, joined);
    }

    /// Moves the potentials in the tree (the row `new`, the columns in the tree and their rows) so
    /// that the reduced cost to `next` becomes zero; the reduced costs to the columns outside the
    /// tree fall by the same step.
    fn shift_potentials(
        &mut self,
        new: usize,
        in_tree: &[bool],
        least_reduced: &mut [f64],
        next: usize,
    ) {
        let step = least_reduced[next];
        self.row_potentials[new] += step;
        for (column, row) in self.row_of.iter().enumerate() {
            match row {
                Some(row) if in_tree[column] => {
                    self.row_potentials[*row] += step;
                    self.column_potentials[column] -= step;
                }
                _ => least_reduced[column] -= step,
            }
        }
    }

    /// Gives each column on the path back from the free column `end` the previous column's row, and
    /// the first column the row `new`.
    fn shift_assignments(&mut self, new: usize, previous: &[Option<usize>], end: Option<usize>) {
        let mut on_path = end;
        while let Some(column) = on_path {
            on_path = previous[column];
            self.row_of[column] = match on_path {
                Some(previous_column) => self.row_of[previous_column],
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
