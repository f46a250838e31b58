//! Licences under which the program uses its libraries, collected by `packaging/licences/collect`.

/// List of the libraries, with their licences' texts.
pub const TEXT: &str = include_str!("../assets/licences.txt");
