//! An identified model's uncertainty, and doubts about it (M14.5, M14.10 to M14.18).
//!
//! | subject | files |
//! |---|---|
//! | standard deviations of the responses (M14.5) | [`bands`] |
//! | fit to each record, and to the measured points (M14.17) | [`record_fits`], [`model_doubts`] |
//! | feedback of gusts (M14.14) | [`feedback`] |
//! | records that contradict the others (M14.16) | [`record_contrast`], [`record_fault`] |
//! | all doubts as typed facts | [`cautions`] |

pub mod bands;
pub mod cautions;
pub mod feedback;
pub mod model_doubts;
pub mod record_contrast;
pub mod record_fault;
pub mod record_fits;
