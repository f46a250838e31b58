//! The home directory in a path as it is typed.

use std::path::{Path, PathBuf};

/// `~` and `~/x` with the home directory in the place of `~`, as a shell reads them; any other path, and each of them where there is
/// no home directory, as it is.
pub fn at_home(path: &Path, home: Option<&Path>) -> PathBuf {
    match (path.strip_prefix("~"), home) {
        (Ok(rest), Some(home)) if rest.as_os_str().is_empty() => home.to_owned(),
        (Ok(rest), Some(home)) => home.join(rest),
        _ => path.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tilde_means_home_where_a_shell_says_so() {
        let home = Path::new("/home/ada");
        for (typed, meant) in [
            ("~", "/home/ada"),
            ("~/", "/home/ada"),
            ("~/x/data.json", "/home/ada/x/data.json"),
            ("~bob/x", "~bob/x"),
            ("x/~/y", "x/~/y"),
            ("/data/x", "/data/x"),
        ] {
            assert_eq!(at_home(Path::new(typed), Some(home)), Path::new(meant), "{typed}");
            assert_eq!(at_home(Path::new(typed), None), Path::new(typed));
        }
    }
}
