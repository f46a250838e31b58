//! The engineer's data: channels, models, flight conditions; checked once at construction (M1).

pub mod channel;
pub mod condition;
#[expect(
    clippy::module_inception,
    reason = "the file holds the type after which the folder is named"
)]
pub mod dataset;
mod draft_checks;
pub mod location;
pub mod measured_response;
pub mod model;
pub mod state_space;
pub mod unchecked_dataset;

pub use channel::{BundleKind, Channel, ConditionId, ModelId, Pair, PairTable};
pub use condition::Condition;
pub use dataset::{Band, Dataset};
pub use model::{Dynamics, Model};
pub use state_space::StateSpace;

/// Upper limits on all inputs: they bound the memory and time that a faulty or hostile file can
/// take.
pub mod limits {
    /// Bytes of text in a file, before or after decompression: 128 MiB, some 500 conditions of the
    /// example's size.
    pub const LARGEST_TEXT: u64 = 128 << 20;
    /// Inputs, and outputs: the largest count with which gains and delays are tested. Tables of
    /// pairs grow with the product, the search for the best gains grows faster.
    pub const MOST_CHANNELS: usize = 32;
    /// On-axis, constrained or ignored responses.
    pub const MOST_PAIRS: usize = MOST_CHANNELS * MOST_CHANNELS;
    /// Conditions: the comparison of ids takes quadratic time.
    pub const MOST_CONDITIONS: usize = 5000;
    /// Models in a bundle: the comparison of names takes quadratic time.
    pub const MOST_MODELS: usize = 5000;
    /// Records in a condition: the comparison of names takes quadratic time.
    pub const MOST_RECORDS: usize = 1000;
    /// Pieces in a record, and source records listed by a model.
    pub const MOST_PIECES: usize = 1000;
    /// Models in all conditions together.
    pub const MOST_MODELS_IN_ALL: usize = 50_000;
    /// States in a model: the cost of a response is cubic in their count.
    pub const MOST_STATES: usize = 1000;
    /// Frequencies in a measured response.
    pub const MOST_FREQUENCIES: usize = 100_000;
    /// Coordinates in a perturbation.
    pub const MOST_COORDINATES: usize = 50;
    /// Smallest and largest count of independent averages in a measured response.
    pub const AVERAGES: [f64; 2] = [1e-6, 1e6];
    /// Shortest and longest window in a measured response \[s\].
    pub const WINDOW_S: [f64; 2] = [1e-6, 1e6];
}
