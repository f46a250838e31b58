//! Identification from flight records: known answers of independent numpy code, properties, and simulated flights.

mod common;
mod example;
mod flight;
mod lines;
mod preparation;
mod validation;
mod whole;
