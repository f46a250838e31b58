//! Content of the window when the program is started without a file.

use serde::{Deserialize, Serialize};

/// Content of the window when the program is started without a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum OpensWith {
    /// The embedded example.
    #[default]
    Example,
    /// The start page.
    StartPage,
    /// The study or dataset that was open last.
    LastStudy,
}

impl OpensWith {
    /// Every choice, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Example, Self::StartPage, Self::LastStudy];

    /// Returns the text of the menu entry.
    pub fn name(self) -> &'static str {
        match self {
            Self::Example => "Begin with the example",
            Self::StartPage => "Begin with the start page",
            Self::LastStudy => "Begin with the last study",
        }
    }
}
