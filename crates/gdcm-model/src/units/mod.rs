//! Physical units, and conversions between internal and display units.
//!
//! Units spelt in files, and the factors between them, are in `physical_unit.rs`. The re-exported
//! number formats ([`crate::number_format`]) accompany a unit in most texts.

pub mod display_units;
pub mod physical_unit;

pub use crate::number_format::{
    number, signed, six_digits, telling, told_apart, without_sign_of_zero,
};
pub use display_units::{
    db_to_ratio, hz_to_rad_s, ms_to_s, neper_to_db, rad_s_to_hz, ratio_to_db, s_to_ms,
};
