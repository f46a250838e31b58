//! Licences under which the program uses its libraries, collected by `packaging/licences/collect`.

/// Lists the libraries, with their licences' texts.
pub const TEXT: &str = include_str!("../assets/licences.txt");
