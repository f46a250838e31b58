//! Identification from flight records: known answers of independent numpy code, properties, and simulated flights.

mod bands;
mod common;
mod example;
mod late;
mod lines;
mod preparation;
mod validation;
mod whole;
