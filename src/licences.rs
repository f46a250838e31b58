//! Licences of the libraries in this program, collected by `packaging/licences/collect`.

/// List of the libraries, and the texts of their licences.
pub const TEXT: &str = include_str!("../assets/licences.txt");
