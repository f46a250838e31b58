//! What a page computes once and keeps until what it depends on changes.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use egui::{Id, Ui};

/// What `compute` gives for `key`, computed when the key of this name changes.
pub(super) fn kept<K, T>(ui: &Ui, name: &str, key: K, compute: impl FnOnce() -> T) -> Arc<T>
where
    K: Hash,
    T: Send + Sync + 'static,
{
    let mut hasher = DefaultHasher::new();
    key.hash(&mut hasher);
    let (place, key) = (Id::unique(("records page", name)), hasher.finish());
    let known = ui.data(|data| data.get_temp::<(u64, Arc<T>)>(place)).filter(|(known, _)| *known == key);
    if let Some((_, value)) = known {
        return value;
    }
    let value = Arc::new(compute());
    ui.data_mut(|data| data.insert_temp(place, (key, Arc::clone(&value))));
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_computed_once_for_a_key() {
        let mut computed = 0;
        egui::__run_test_ui(|ui| {
            computed = 0;
            for (key, expected) in [(1, 10), (1, 10), (2, 20), (1, 10)] {
                let value = kept(ui, "test", key, || {
                    computed += 1;
                    10 * key
                });
                assert_eq!(*value, expected);
            }
        });
        assert_eq!(computed, 3, "once for each change of the key");
    }
}
