//! A laid-out figure as SVG, PDF or PNG. The same figure always produces the same bytes.

mod pdf;
mod png;
mod svg;

pub use pdf::pdf;
pub use png::write_png;
pub use svg::{escaped, inline_svg, svg};
