//! Printed widths and file formats.

/// Figure width in print.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ColumnWidth {
    /// A single column in a two-column journal, 84 mm.
    Single,
    /// Both columns, 174 mm.
    #[default]
    Double,
}

impl ColumnWidth {
    pub const BOTH: [Self; 2] = [Self::Single, Self::Double];

    /// Returns the width \[mm\].
    pub fn mm(self) -> f64 {
        match self {
            Self::Single => 84.0,
            Self::Double => 174.0,
        }
    }

    /// Returns the name used in commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Double => "double",
        }
    }

    /// Returns the name with the width, for display in a list.
    pub fn words(self) -> &'static str {
        match self {
            Self::Single => "single column (84 mm)",
            Self::Double => "double column (174 mm)",
        }
    }
}

/// File format in which a figure is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FigureFormat {
    /// Vector graphics, for documents and drawing programs.
    Svg,
    /// Pixels, 300 dpi.
    Png,
    /// A page as large as the figure, with embedded fonts.
    Pdf,
    /// The values behind the marks, a row for each point.
    Csv,
}

impl FigureFormat {
    pub const ALL: [Self; 4] = [Self::Svg, Self::Png, Self::Pdf, Self::Csv];

    /// Returns the file extension, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
            Self::Csv => "csv",
        }
    }

    /// Returns the format's name with its purpose or contents, for a tooltip.
    pub fn words(self) -> &'static str {
        match self {
            Self::Svg => "SVG, for documents and drawing programs",
            Self::Png => "PNG, 300 dots per inch",
            Self::Pdf => "PDF, a single page",
            Self::Csv => "CSV, the values of all curves",
        }
    }
}
