//! Identified models from flight records (M14).
mod flight_record;
pub use flight_record::{FlightRecord, Piece};
