//! Models of all orders by CT-PBSID (M14.3).
//!
//! | stage | files |
//! |---|---|
//! | orders and past windows that the amount of data allows (M14.13) | `search_extent` |
//! | Laguerre projections and their triangular factor | `laguerre`, `triangular_factor` |
//! | states and models | `ct_pbsid` |
//! | modes far above the band | `fast_modes` |
//! | poles over orders | [`stabilisation`] |

pub(crate) mod ct_pbsid;
pub(crate) mod fast_modes;
pub(crate) mod laguerre;
pub(crate) mod search_extent;
pub mod stabilisation;
pub(crate) mod triangular_factor;
