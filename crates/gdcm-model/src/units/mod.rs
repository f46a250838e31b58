//! Physical units, and conversions between internal and display units.

pub mod conversion;
pub mod physical_unit;

pub use crate::number_format::{
    number, signed, six_digits, telling, told_apart, without_sign_of_zero,
};
pub use conversion::{db_to_ratio, ms_to_s, neper_to_db, rad_s_to_hz, ratio_to_db, s_to_ms};
