//! Units of background work.

pub mod job;
