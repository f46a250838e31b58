//! Uncertainty in the results (M13): error bars, differences between conditions, how the scatter
//! splits into sources, bands for a schedule, and the test for a second variable.
//!
//! ```text
//!  1  for each condition c: q_0 <- the analysis with the representatives (a^, b^)
//!  2     s_phys^2 <- mean (q(a, b^) - q_0)^2 over the other accepted physics models a
//!  3     s_own^2  <- mean (q(a^, b) - q_0)^2 over the n other accepted identified models b
//!  4  s_pooled^2 <- sum n s_own^2 / sum n,  over the conditions
//!  5  for each c: s_id^2 <- (n s_own^2 + d_0 s_pooled^2) / (n + d_0),  d_0 = min(4, the others' n);  at least s_coh^2
//!  6     u^2 <- s_phys^2 + s_id^2;  nu <- u^4 / sum s^4/nu;  bar <- q_0 +- t(nu) u
//!  7  differences at equal airspeed: |delta| / sqrt(u_c^2 + u_c'^2), Holm's correction over all
//!  8  split: residual variance S^2 <-> B = sum (1 - h_c)(s_phys^2 + s_id^2) / f;  rest^2 = S^2 - B
//!  9  bands: t(f) S' sqrt(h), t(f) S' sqrt(1 + h),  S'^2 = max(S^2, B)
//! 10  second variable: its coefficient beside the schedule's columns, and leave-one-out errors with and without it
//! ```
//!
//! | step | file |
//! |---|---|
//! | 1 to 3 | `scalar`, `spread` |
//! | 4, 5 | `variance_component`, `coherence_error` |
//! | 6 | `bar`, `condition_bars` (here `s_id` may come from the identified model's own band) |
//! | 7 | `difference` |
//! | 8 | `design`, `variance_decomposition` |
//! | 9 | `schedule_band` |
//! | 10 | `second_variable_effect` |
//!
//! `q` is a condition's scalar result, such as `ln k`; `u` and `nu` are its bar's standard
//! deviation and degrees of freedom; `s_coh` is the measurement error from the coherence; `f` and
//! `h_c` are the degrees of freedom and the hat values in the schedule's fit; `t` is Student's
//! quantile. The other symbols are defined in the files.

pub mod bar;
pub mod coherence_error;
pub mod condition_bars;
mod design;
mod difference;
mod distributions;
pub mod scalar;
mod schedule_band;
pub mod second_variable_effect;
pub mod settings;
pub mod spread;
mod variance_component;
mod variance_decomposition;

pub use bar::{Bar, IdentificationSource};
pub use design::Design;
pub use difference::{Difference, holm};
pub use distributions::student_quantile;
pub use scalar::Scalar;
pub use schedule_band::{BandWidths, ScheduleBand};
pub use second_variable_effect::SecondVariableDesign;
pub use variance_component::VarianceComponent;
pub use variance_decomposition::VarianceDecomposition;
