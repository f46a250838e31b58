//! gdcm

pub mod correction;
pub mod dataset;
pub mod fidelity;
pub mod response;
pub mod schedule;
pub mod study;
pub mod units;
