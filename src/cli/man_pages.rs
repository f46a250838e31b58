//! Manual pages for packages, from the same table as the help.

use std::path::Path;

use clap::CommandFactory;
use clap_mangen::Man;

use gdcm_io::Existing;
use gdcm_io::output_set::{OutputSet, make_directory};

use super::arguments::Arguments;
use super::failure::Failure;

/// Writes a page about the program and one for each command that the help lists.
pub(super) fn write_man_pages(directory: &Path, existing: Existing) -> Result<(), Failure> {
    make_directory(directory)?;
    let mut outputs = OutputSet::new(existing, Vec::new());
    for page in man_pages() {
        let path = directory.join(page.get_filename());
        outputs.add(&path, |file| page.render(file))?;
    }
    outputs.persist()?;
    Ok(())
}

fn man_pages() -> Vec<Man> {
    let mut program = Arguments::command().disable_help_subcommand(true);
    // Gives the commands their full names, `gdcm-analyze`, and the global options.
    program.build();
    let mut pages = Vec::new();
    for command in program.get_subcommands() {
        if !command.is_hide_set() {
            pages.push(Man::new(command.clone()));
        }
    }
    pages.insert(0, Man::new(program));
    pages
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_command_has_a_page_and_the_hidden_one_has_none() {
        let mut names = Vec::new();
        for page in man_pages() {
            let mut text = Vec::new();
            page.render(&mut text).unwrap();
            assert!(text.len() > 500, "{}", page.get_filename());
            names.push(page.get_filename());
        }
        assert_eq!(names[0], "gdcm.1");
        assert!(names.contains(&"gdcm-analyze.1".to_owned()), "{names:?}");
        assert!(!names.contains(&"gdcm-man-pages.1".to_owned()), "{names:?}");
        let commands = Arguments::command();
        assert_eq!(names.len(), commands.get_subcommands().count());
    }
}
