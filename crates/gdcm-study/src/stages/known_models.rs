//! Responses of the models in use, computed once per model content and cached: the last response
//! for comparison, and the last for drawing.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

use gdcm_model::dataset::model::ContentHash;
use gdcm_model::dataset::{Band, Model};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse, PreparedModel};

use super::memo::Memo;

/// Band and number of frequencies, on which a response depends besides its model's dynamics.
pub type GridKey = (Band, usize);

/// Use of a response. The last response for each use is cached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Comparing models, in the comparison band.
    Comparison,
    /// Drawing, in a wider band.
    Drawing,
}

/// A model's last responses, and the model prepared for computing them.
#[derive(Debug, Default)]
pub(super) struct ModelResponses {
    prepared: OnceLock<PreparedModel>,
    /// The last response for each [`Purpose`].
    last: [Mutex<Memo<GridKey, Arc<FrequencyResponse>>>; 2],
}

impl ModelResponses {
    /// Locks the cache; a panic under the lock cannot leave it incomplete.
    pub(super) fn last(
        &self,
        purpose: Purpose,
    ) -> MutexGuard<'_, Memo<GridKey, Arc<FrequencyResponse>>> {
        self.last[purpose as usize]
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the model's response on `grid`, which `key` identifies; from the cache if the last
    /// response for this purpose has the same key.
    pub(super) fn response(
        &self,
        model: &Model,
        purpose: Purpose,
        key: GridKey,
        grid: &FrequencyGrid,
    ) -> Arc<FrequencyResponse> {
        let prepared = self
            .prepared
            .get_or_init(|| PreparedModel::new(&model.dynamics));
        self.last(purpose)
            .get(key, |_| Arc::new(prepared.response(grid)))
    }
}

/// Responses of the models in use, keyed by model content: a model keeps its responses when it is
/// renamed or moved to another condition. Engines that share them
/// ([`Engine::sharing`](super::engine::Engine::sharing)) compute and store each response only once.
#[derive(Clone, Debug, Default)]
pub struct KnownModels {
    by_content: Arc<Mutex<HashMap<ContentHash, Weak<ModelResponses>>>>,
}

impl KnownModels {
    fn by_content(&self) -> MutexGuard<'_, HashMap<ContentHash, Weak<ModelResponses>>> {
        self.by_content
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// Removes the models that no condition uses any longer.
    pub(crate) fn forget_unused(&self) {
        self.by_content()
            .retain(|_, responses| responses.strong_count() > 0);
    }

    /// Returns the responses shared by all models with this content: a new, empty cache if no
    /// condition uses such a model.
    pub(super) fn responses_of(&self, content: ContentHash) -> Arc<ModelResponses> {
        let mut by_content = self.by_content();
        let known = by_content.entry(content).or_default();
        known.upgrade().unwrap_or_else(|| {
            let made = Arc::new(ModelResponses::default());
            *known = Arc::downgrade(&made);
            made
        })
    }
}
