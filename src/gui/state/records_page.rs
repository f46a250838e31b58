//! Pages in the Records view.
//!
//! The recommended model of an identification is the refined one, "CT-PBSID, refined" (M14:
//! docs/identification.md).

use crate::gui::widgets::choices::PageWords;

/// A page in the Records view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RecordsPage {
    /// The displayed record over time, and the response in focus with its models.
    #[default]
    Fit,
    /// Excitation of the inputs, and the highest frequency that it reaches.
    Inputs,
    /// Models at all orders: fit, stabilisation diagram and poles; what further sweeps would bring.
    Order,
    /// Columns assigned to channels.
    Columns,
}

impl RecordsPage {
    /// All pages, in display order.
    pub const ALL: [Self; 4] = [Self::Fit, Self::Inputs, Self::Order, Self::Columns];

    /// Returns the texts on the page's tab.
    pub fn words(self) -> PageWords {
        match self {
            Self::Fit => PageWords {
                name: "Fit",
                short_name: "Fit",
                purpose: "The selected record over time with the models' responses; the measured \
                frequency response, and the identified model with its confidence band",
            },
            Self::Inputs => PageWords {
                name: "Inputs",
                short_name: "Inputs",
                purpose: "Spectrum of each input in each record: which inputs are excited, and \
                up to which frequency",
            },
            Self::Order => PageWords {
                name: "Order",
                short_name: "Order",
                purpose: "Fit and poles over the model order, poles of the recommended model, \
                and the confidence intervals to expect from further sweeps",
            },
            Self::Columns => PageWords {
                name: "Columns",
                short_name: "Columns",
                purpose: "Assignment of the record's columns to time and channels",
            },
        }
    }
}
