//! Searches the least number that satisfies a condition, if all larger numbers satisfy it too.

/// Result of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Least {
    Number(usize),
    /// Not even the largest number satisfies the condition.
    NotWithin,
}

/// Searches by bisection between 1 and `most`; `None` if the condition cannot be evaluated.
pub(super) fn least_number(
    most: usize,
    mut is_enough: impl FnMut(usize) -> Option<bool>,
) -> Option<Least> {
    if !is_enough(most)? {
        return Some(Least::NotWithin);
    }
    let mut too_few = 0;
    let mut enough = most;
    while enough - too_few > 1 {
        let middle = too_few + (enough - too_few) / 2;
        if is_enough(middle)? {
            enough = middle;
        } else {
            too_few = middle;
        }
    }
    Some(Least::Number(enough))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_number_is_found_with_few_tests() {
        for wanted in 1..=16 {
            let mut count = 0;
            let least = least_number(16, |number| {
                count += 1;
                Some(number >= wanted)
            });
            assert_eq!(least, Some(Least::Number(wanted)));
            assert!(count <= 5, "{count}");
        }
        assert_eq!(least_number(16, |_| Some(false)), Some(Least::NotWithin));
        assert_eq!(least_number(16, |_| None), None);
    }
}
