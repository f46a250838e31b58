//! For each view with pages, the page in front.

use crate::gui::widgets::choices::PageWords;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PolesPage {
    /// Poles in the s-plane; in a high window, also the modes.
    #[default]
    Plane,
    /// Mode table.
    Modes,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CouplingsPage {
    /// J with and without the couplings, and remarks.
    #[default]
    Benefit,
    /// Mixing and feedback matrices.
    Matrices,
    /// Loop margin and poles.
    Loop,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EvidencePage {
    /// Significant differences, and sources of the scatter.
    #[default]
    Findings,
    /// All differences at equal airspeed.
    Differences,
    /// Second variables and schedule forms.
    Forms,
}

/// Page in the view that compares variants.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ComparePage {
    /// Differences between the decisions.
    #[default]
    Decisions,
    /// Effects of these differences on the results.
    Effects,
}

/// A page of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewPage {
    Overview { has_phases: bool },
    Poles(PolesPage),
    Couplings(CouplingsPage),
    Evidence(EvidencePage),
    Compare(ComparePage),
}

impl ViewPage {
    /// Returns the page's name and purpose.
    pub fn words(self) -> PageWords {
        let [name, purpose] = match self {
            Self::Overview { has_phases: false } => ["Magnitude", "Magnitude of every response"],
            Self::Overview { has_phases: true } => {
                ["Magnitude and phase", "Phase below each magnitude"]
            }
            Self::Poles(PolesPage::Plane) => ["s-plane", "Poles of every model in the s-plane"],
            Self::Poles(PolesPage::Modes) => {
                ["Modes", "Table of the modes, followed from model to model"]
            }
            Self::Couplings(CouplingsPage::Benefit) => {
                ["Benefit", "J with and without the couplings, and cautions"]
            }
            Self::Couplings(CouplingsPage::Matrices) => [
                "Matrices",
                "Mixing and feedback matrices with their error bars",
            ],
            Self::Couplings(CouplingsPage::Loop) => [
                "Loop",
                "Margin of the loop and poles of the physics representative",
            ],
            Self::Evidence(EvidencePage::Findings) => [
                "Findings",
                "Significant differences and sources of the scatter",
            ],
            Self::Evidence(EvidencePage::Differences) => [
                "Differences",
                "Every difference between net gains at equal airspeed",
            ],
            Self::Evidence(EvidencePage::Forms) => [
                "Forms",
                "Tests of a second variable, and the error of each form of the schedule",
            ],
            Self::Compare(ComparePage::Decisions) => [
                "Decisions",
                "Decisions in which the variants differ from the study",
            ],
            Self::Compare(ComparePage::Effects) => [
                "Effects",
                "Effect of each variant on J and on the net gains",
            ],
        };
        let short_name = match self {
            Self::Overview { has_phases: true } => "With phase",
            _ => name,
        };
        PageWords {
            name,
            short_name,
            purpose,
        }
    }
}

/// Page in front for each view whose pages need no other state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ViewPages {
    pub poles: PolesPage,
    pub couplings: CouplingsPage,
    pub evidence: EvidencePage,
    pub compare: ComparePage,
}
