//! Models of all orders by CT-PBSID (M14.3).
//!
//! | stage | files |
//! |---|---|
//! | orders and past windows that the amount of data allows (M14.13) | `tried_orders` |
//! | Laguerre projections and their triangular factor | `laguerre`, `data_matrix`, `triangular_factor` |
//! | states and models | `ct_pbsid`, `continuous_model` |
//! | modes far above the band | `fast_modes` |
//! | poles over orders | [`stabilisation`] |

mod continuous_model;
pub(crate) mod ct_pbsid;
pub(crate) mod data_matrix;
pub(crate) mod fast_modes;
mod laguerre;
pub mod stabilisation;
pub(crate) mod triangular_factor;
pub(crate) mod tried_orders;
