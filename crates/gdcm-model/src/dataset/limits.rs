//! Limits on file contents: they bound the memory and time that a faulty or hostile file can take.

/// Maximum text length in a file \[bytes\], before or after decompression: 128 MiB, enough for
/// about 500 conditions of the example's size.
pub const LARGEST_TEXT: u64 = 128 << 20;
/// Maximum number of inputs, and of outputs: the largest number tested with gains and delays.
/// Response tables grow with the product of both, and the time to search for the best gains grows
/// faster.
pub const MOST_CHANNELS: usize = 32;
/// Maximum number of on-axis, constrained or ignored responses.
pub const MOST_PAIRS: usize = MOST_CHANNELS * MOST_CHANNELS;
/// Maximum number of conditions: comparing identifiers takes quadratic time.
pub const MOST_CONDITIONS: usize = 5000;
/// Maximum number of models in a bundle: comparing names takes quadratic time.
pub const MOST_MODELS: usize = 5000;
/// Maximum number of records in a condition: comparing names takes quadratic time.
pub const MOST_RECORDS: usize = 1000;
/// Maximum number of used intervals in a record, and of notes, source records and unused variables
/// listed by a model.
pub const MOST_PIECES: usize = 1000;
/// Maximum number of models in all conditions together.
pub const MOST_MODELS_IN_ALL: usize = 50_000;
/// Maximum number of states in a model: the cost of a response is cubic in it.
pub const MOST_STATES: usize = 1000;
/// Maximum number of frequencies in a measured response.
pub const MOST_FREQUENCIES: usize = 100_000;
/// Maximum number of coordinates in a perturbation.
pub const MOST_COORDINATES: usize = 50;
/// Maximum number of named physics model parameters, and of those moved in one model.
pub const MOST_PARAMETERS: usize = 200;
/// Minimum and maximum number of independent averages in a measured response.
pub const AVERAGES: [f64; 2] = [1e-6, 1e6];
/// Minimum and maximum window length in a measured response \[s\].
pub const WINDOW_S: [f64; 2] = [1e-6, 1e6];
