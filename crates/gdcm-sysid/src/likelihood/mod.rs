//! A model's cost, its minimum, and the covariance there (M14.4, M14.5).
//!
//! | stage | files |
//! |---|---|
//! | a model, evaluated by its Schur form | `schur_model`, `frequency_table` |
//! | weighted spectral lines | `spectral_lines`, [`noise_covariance`], `residual_noise` |
//! | cost over the spectral lines | `cost`, `nuisance_columns` |
//! | normal equations in all entries | `normal_equations`, `nuisance_elimination`, `gram_matrix` |
//! | their sums over frequency bins | `frequency_bins`, `binned_products`, `kronecker_sum` |
//! | Levenberg-Marquardt in balanced coordinates | `descent`, `balancing` |
//! | independent parameters at the minimum | `local_parameters`, `local_system` |
//! | covariance, models without a record | `covariance`, `models_without_record` |

pub(crate) mod balancing;
mod binned_products;
pub(crate) mod cost;
pub(crate) mod covariance;
pub(crate) mod descent;
mod frequency_bins;
pub(crate) mod frequency_table;
pub(crate) mod gram_matrix;
mod kronecker_sum;
mod local_parameters;
pub(crate) mod local_system;
pub(crate) mod models_without_record;
pub mod noise_covariance;
pub(crate) mod normal_equations;
mod nuisance_columns;
mod nuisance_elimination;
pub(crate) mod residual_noise;
pub(crate) mod schur_model;
pub(crate) mod spectral_lines;
