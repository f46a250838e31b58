//! Content shown when the program is started without a file.

use serde::{Deserialize, Serialize};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum OpensWith {
    /// The embedded example.
    #[default]
    Example,
    StartPage,
    /// The study or dataset that was open last.
    LastStudy,
}

impl OpensWith {
    /// Every choice, in menu order.
    pub const ALL: [Self; 3] = [Self::Example, Self::StartPage, Self::LastStudy];

    /// Returns the menu text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Example => "Begin with the example",
            Self::StartPage => "Begin with the start page",
            Self::LastStudy => "Begin with the last study",
        }
    }
}
