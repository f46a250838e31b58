//! Values cached between frames.

use std::any::Any;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;

use egui::{Id, Ui};

/// Source data of a cached value, kept alive so that its address cannot be reused.
pub type Source = Arc<dyn Any + Send + Sync>;

/// Value with the sources and the hash of the key for which it was computed.
struct CachedValue<T> {
    sources: Vec<Source>,
    key: u64,
    value: Arc<T>,
}

/// Returns the result of `compute`, cached under `name` for these sources (compared by address) and
/// `key`; recomputes it when either changes. A name holds one value, that of the last sources and
/// key.
pub fn cached<T: Send + Sync + 'static>(
    ui: &Ui,
    name: &str,
    sources: &[Source],
    key: impl Hash,
    compute: impl FnOnce() -> T,
) -> Arc<T> {
    let mut hasher = DefaultHasher::new();
    key.hash(&mut hasher);
    let place = Id::unique(("records page", name));
    let key = hasher.finish();
    let known = ui.data(|data| data.get_temp::<Arc<CachedValue<T>>>(place));
    if let Some(known) = known
        && known.key == key
        && are_same(&known.sources, sources)
    {
        return Arc::clone(&known.value);
    }
    let value = Arc::new(compute());
    let cached = Arc::new(CachedValue {
        sources: sources.to_vec(),
        key,
        value: Arc::clone(&value),
    });
    ui.data_mut(|data| data.insert_temp(place, cached));
    value
}

/// Compares sources by address.
fn are_same(known: &[Source], sources: &[Source]) -> bool {
    known.len() == sources.len()
        && known
            .iter()
            .zip(sources)
            .all(|(known, source)| Arc::ptr_eq(known, source))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_computed_once_for_its_sources_and_key() {
        let mut computed = 0;
        egui::__run_test_ui(|ui| {
            computed = 0;
            let sources: [Source; 2] = [Arc::new(1_i64), Arc::new(1_i64)];
            for (source, key) in [(0, 1), (0, 1), (0, 2), (1, 2), (0, 2)] {
                let value = cached(ui, "test", &[Arc::clone(&sources[source])], key, || {
                    computed += 1;
                    (source, key)
                });
                assert_eq!(*value, (source, key));
            }
        });
        assert_eq!(computed, 4, "once for each change");
    }
}
