//! Caches that keep one value, valid while its key stays the same.

use std::convert::Infallible;

/// A cached value, valid while its key stays the same.
#[derive(Clone, Debug)]
pub(crate) struct Memo<K, V> {
    kept: Option<(K, V)>,
}

impl<K, V> Default for Memo<K, V> {
    fn default() -> Self {
        Self { kept: None }
    }
}

impl<K: PartialEq, V: Clone> Memo<K, V> {
    /// Creates a cache with a value computed elsewhere.
    pub(crate) fn with(key: K, value: V) -> Self {
        Self {
            kept: Some((key, value)),
        }
    }

    /// Returns the value for `key`: the cached value where the key is the same, `make(&key)`
    /// otherwise.
    pub(crate) fn get(&mut self, key: K, make: impl FnOnce(&K) -> V) -> V {
        let made = self.get_or_fail(key, |key| Ok::<V, Infallible>(make(key)));
        made.unwrap_or_else(|never| match never {})
    }

    /// Works as [`Memo::get`] for a fallible computation: an error leaves the cache empty. The old
    /// value is dropped first, so that a large value is not in memory twice.
    pub(crate) fn get_or_fail<E>(
        &mut self,
        key: K,
        make: impl FnOnce(&K) -> Result<V, E>,
    ) -> Result<V, E> {
        if let Some(value) = self.kept(&key) {
            return Ok(value.clone());
        }
        self.kept = None;
        let value = make(&key)?;
        self.kept = Some((key, value.clone()));
        Ok(value)
    }

    /// Returns the value for `key`, if cached.
    pub(crate) fn kept(&self, key: &K) -> Option<&V> {
        match &self.kept {
            Some((kept, value)) if kept == key => Some(value),
            _ => None,
        }
    }

    /// Returns whether the value for `key` is cached.
    pub(crate) fn holds(&self, key: &K) -> bool {
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
