//! The last value of a stage, with what it was made from.

use std::convert::Infallible;

/// One value, kept as long as what it depends on stays the same.
#[derive(Clone, Debug)]
pub(super) struct Memo<K, V> {
    kept: Option<(K, V)>,
}

impl<K, V> Default for Memo<K, V> {
    fn default() -> Self {
        Self { kept: None }
    }
}

impl<K: PartialEq, V: Clone> Memo<K, V> {
    /// A value made elsewhere.
    pub(super) fn of(key: K, value: V) -> Self {
        Self { kept: Some((key, value)) }
    }

    /// The value for `key`: the kept one where the key is the same, `make(&key)` otherwise.
    pub(super) fn get(&mut self, key: K, make: impl FnOnce(&K) -> V) -> V {
        let made = self.get_or_fail(key, |key| Ok::<V, Infallible>(make(key)));
        made.unwrap_or_else(|never| match never {})
    }

    /// As [`Memo::get`], for a value that may fail to be made: nothing is kept then. The old value is dropped first, so that
    /// a large one is not in memory twice.
    pub(super) fn get_or_fail<E>(&mut self, key: K, make: impl FnOnce(&K) -> Result<V, E>) -> Result<V, E> {
        if let Some(value) = self.kept(&key) {
            return Ok(value.clone());
        }
        self.kept = None;
        let value = make(&key)?;
        self.kept = Some((key, value.clone()));
        Ok(value)
    }

    /// The value for `key`, if it is kept.
    pub(super) fn kept(&self, key: &K) -> Option<&V> {
        self.kept.as_ref().filter(|(kept, _)| kept == key).map(|(_, value)| value)
    }

    /// Whether the value for `key` is kept.
    pub(super) fn holds(&self, key: &K) -> bool {
        self.kept(key).is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_made_anew_only_when_its_key_changes() {
        let mut memo = Memo::default();
        assert_eq!(memo.get(1, |key| key * 10), 10);
        assert_eq!(memo.get(1, |_| 0), 10, "kept");
        assert_eq!(memo.get(2, |key| key * 10), 20);
    }

    #[test]
    fn a_value_that_could_not_be_made_leaves_nothing() {
        let mut memo = Memo::default();
        assert_eq!(memo.get(1, |key| key * 10), 10);
        assert_eq!(memo.get_or_fail(2, |_| Err("stopped")), Err("stopped"));
        assert!(!memo.holds(&1) && !memo.holds(&2));
    }
}
