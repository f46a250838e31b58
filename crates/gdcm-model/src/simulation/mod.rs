//! Time responses: flight records, their low-pass filter, and simulation of a model against them.

mod first_order_hold;
mod flight_record;
mod low_pass;
mod validation;

pub use first_order_hold::FirstOrderHold;
pub use flight_record::{FlightRecord, Segment, Signal, centred};
pub use low_pass::LowPass;
pub use validation::{Validation, ValidationError, ValidationSettings, ValidationWindow, validate};
