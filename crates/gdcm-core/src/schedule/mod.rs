//! One correction for all airspeeds, what speaks for it, and what it is worth (M11, M12).

mod assessment;
mod form_comparison;
mod regression;
#[expect(clippy::module_inception, reason = "the folder is named for its noun, and so is the file that holds it")]
mod schedule;
mod second_variable;

pub use assessment::*;
pub use form_comparison::*;
pub use regression::*;
pub use schedule::*;
pub use second_variable::*;
