//! The last value of a stage, with what it was made from.

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
    /// The value for `key`: the kept one where the key is the same, `make(&key)` otherwise.
    pub(super) fn get(&mut self, key: K, make: impl FnOnce(&K) -> V) -> V {
        match &self.kept {
            Some((kept, value)) if *kept == key => value.clone(),
            _ => {
                let value = make(&key);
                self.kept = Some((key, value.clone()));
                value
            }
        }
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
}
