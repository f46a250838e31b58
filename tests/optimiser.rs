//! The optimiser against independent reference figures, and the properties that any answer must have.

#[path = "optimiser/costs.rs"]
mod costs;
#[path = "optimiser/explanations.rs"]
mod explanations;
#[path = "optimiser/instances.rs"]
mod instances;
#[path = "optimiser/kkt.rs"]
mod kkt;
#[path = "optimiser/minima.rs"]
mod minima;
#[path = "optimiser/properties.rs"]
mod properties;
#[path = "optimiser/random.rs"]
mod random;
#[path = "optimiser/reference_delays.rs"]
mod reference_delays;
#[path = "optimiser/reference_gains.rs"]
mod reference_gains;
