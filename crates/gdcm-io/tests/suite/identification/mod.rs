//! Identification from flight records: comparison with independent numpy code, general properties,
//! and simulated flights.

mod bands;
mod common;
mod example;
mod late;
mod lines;
mod preparation;
mod record_doubts;
mod real_aircraft;
mod validation;
mod whole;
