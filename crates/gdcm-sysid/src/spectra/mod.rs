//! From flight records to spectra and the response without a model (M14.1, M14.2).
//!
//! | stage | files |
//! |---|---|
//! | records to segments (M14.1) | [`preparation`], [`preparation_settings`], `clock`, `track`, [`gaps`] |
//! | doubts about channels (M14.18) | `channel_quality`, [`record_cautions`], [`caution_note`] |
//! | low-pass and scales (M14.1) | [`cut_off`], [`scales`] |
//! | spectra (M14.2) | [`spectrum`] |
//! | measured response (M14.2) | [`local_polynomial`], [`response_estimate`], `interpolation` |
//! | response through a reference (M14.15) | `instrument` |

pub mod caution_note;
pub(crate) mod channel_quality;
mod clock;
pub mod cut_off;
pub mod gap_hat;
pub mod gaps;
pub(crate) mod instrument;
pub(crate) mod interpolation;
pub mod local_polynomial;
pub mod preparation;
pub mod preparation_settings;
pub mod record_cautions;
pub mod response_estimate;
pub mod scales;
pub mod spectrum;
mod track;
