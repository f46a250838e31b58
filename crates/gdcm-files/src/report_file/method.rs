//! The method's equations, in plain words and in mathematics.

use super::page::Page;

/// Adds the section.
pub(super) fn add(page: &mut Page) {
    page.section("The method");
    page.fixed(include_str!("method.html"));
}
