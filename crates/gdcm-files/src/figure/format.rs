//! What a figure can be written as.

/// What a figure is written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FigureFormat {
    /// Lines and letters, for documents and for drawing programs.
    Svg,
    /// Dots, 300 to the inch.
    Png,
    /// A page as large as the figure, with its letters.
    Pdf,
    /// The numbers.
    Csv,
}

impl FigureFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Svg, Self::Png, Self::Pdf, Self::Csv];

    /// The end of a file's name.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
            Self::Csv => "csv",
        }
    }

    /// Its name and what it is good for.
    pub fn words(self) -> &'static str {
        match self {
            Self::Svg => "SVG, for documents and drawing programs",
            Self::Png => "PNG, 300 dots to the inch",
            Self::Pdf => "PDF, one page",
            Self::Csv => "CSV, the numbers",
        }
    }
}
