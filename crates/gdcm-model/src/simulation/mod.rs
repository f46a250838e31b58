//! Time responses: flight records, their low-pass filter, and model simulation against them
//! (`validation.rs`).

mod first_order_hold;
mod flight_record;
mod low_pass;
mod output_agreement;
mod validation;
mod validation_settings;
mod window_simulation;

pub use first_order_hold::FirstOrderHold;
pub use flight_record::{FlightRecord, Segment, Signal, centred};
pub use low_pass::LowPass;
pub use output_agreement::ValidationWindow;
pub use validation::{Validation, ValidationError, validate};
pub use validation_settings::ValidationSettings;
