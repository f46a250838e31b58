//! Identification from flight records (M14): comparison with independent numpy code, general
//! properties, and simulated flights.

mod bands;
mod common;
mod example;
mod late;
mod lines;
mod preparation;
mod real_aircraft;
mod record_doubts;
mod validation;
mod whole;
