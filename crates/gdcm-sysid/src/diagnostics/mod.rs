//! An identified model's uncertainty, and cautions about it (M14.5, M14.10 to M14.18).
//!
//! | subject | files |
//! |---|---|
//! | standard deviations of the responses (M14.5) | [`bands`] |
//! | fit to each record and each output (M14.6) | [`record_fits`] |
//! | distance from the measured points (M14.17) | [`departure`] |
//! | feedback of gusts (M14.14) | [`feedback`], `output_predictor` |
//! | records that contradict the others (M14.16) | [`record_contrast`], `fault_search`, [`record_fault`] |
//! | cautions about the model, from these | [`model_cautions`] |
//! | all cautions as typed facts | [`cautions`] |

pub mod bands;
pub mod cautions;
pub mod departure;
mod fault_search;
pub mod feedback;
pub mod model_cautions;
mod output_predictor;
pub mod record_contrast;
pub mod record_fault;
pub mod record_fits;
