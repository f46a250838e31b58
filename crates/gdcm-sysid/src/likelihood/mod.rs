//! The cost of a model, its minimum, and the covariance there (M14.4, M14.5).
//!
//! | stage | files |
//! |---|---|
//! | models in blocks of one or two states | `blocks`, `mode_removal` |
//! | cost over the spectral lines | `cost`, [`noise_covariance`] |
//! | normal equations | `normal_system`, `gram_matrix` |
//! | Levenberg-Marquardt | `refinement`, `models_without_record` |
//! | covariance of parameters and poles | `covariance` |

pub(crate) mod balancing;
pub(crate) mod blocks;
pub(crate) mod cost;
pub(crate) mod covariance;
pub(crate) mod dense_model;
pub(crate) mod dense_system;
pub(crate) mod descent;
pub(crate) mod gram_matrix;
pub(crate) mod linear_model;
mod mode_removal;
pub(crate) mod models_without_record;
pub mod noise_covariance;
pub(crate) mod normal_system;
mod nuisance_elimination;
pub(crate) mod refinement;
pub(crate) mod residual_noise;
