//! The optimiser against independent reference figures, and the properties that any answer must have.

mod costs;
mod explanations;
mod instances;
mod kkt;
mod minima;
mod properties;
mod random;
mod reference_delays;
mod reference_gains;
