//! Entry in the command table: name, keys, place in a menu.

use egui::{Key, KeyboardShortcut, Modifiers};

use super::command::Command;

/// Menu in the top bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Opening, saving, exporting.
    File,
    Edit,
    /// Fitting the plots, frequency unit, next or previous condition and response, views, pages,
    /// panels, window regions and theme.
    View,
    /// Units other than the frequency's, styles and visibility of curves: a submenu in `View`.
    Curves,
    Help,
}

/// Contexts in which a shortcut works.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Everywhere, also while text is being typed.
    Everywhere,
    /// Only without a focused control and without an open form: lists, fields and texts use these
    /// keys too.
    WithoutFocus,
}

/// Ctrl, or Command on macOS.
pub(super) const CTRL: Modifiers = Modifiers::COMMAND;
pub(super) const CTRL_SHIFT: Modifiers = Modifiers {
    shift: true,
    ..Modifiers::COMMAND
};

/// Entry in a menu or in the palette.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Name in menus and in the palette.
    pub name: String,
    /// Explanation, shown as a tooltip.
    pub meaning: &'static str,
    /// Shortcuts; the first is displayed.
    pub shortcuts: Vec<KeyboardShortcut>,
    pub reach: Reach,
    /// Menu and group within it; groups are separated by lines. `None` for entries in the palette
    /// alone.
    pub menu: Option<(Menu, u8)>,
    pub enabled: bool,
    pub command: Command,
}

impl Entry {
    /// Creates an entry for the palette alone, without shortcut.
    pub fn new(
        name: impl Into<String>,
        meaning: &'static str,
        command: impl Into<Command>,
    ) -> Self {
        Self {
            name: name.into(),
            meaning,
            shortcuts: Vec::new(),
            reach: Reach::Everywhere,
            menu: None,
            enabled: true,
            command: command.into(),
        }
    }

    /// Adds a shortcut; the first one is displayed.
    pub fn keys(mut self, modifiers: Modifiers, key: Key) -> Self {
        self.shortcuts.push(KeyboardShortcut::new(modifiers, key));
        self
    }

    /// Adds a key without modifiers; all keys of the entry then work only while nothing has the
    /// focus and no form is open.
    pub fn free_key(mut self, key: Key) -> Self {
        self.reach = Reach::WithoutFocus;
        self.keys(Modifiers::NONE, key)
    }

    /// Puts the entry into a menu group.
    pub fn within(mut self, menu: Menu, group: u8) -> Self {
        self.menu = Some((menu, group));
        self
    }

    pub fn enabled(mut self, enabled: bool) -> Self {
        self.enabled = enabled;
        self
    }
}

/// Puts entries into a menu group.
pub(super) fn group<const N: usize>(
    menu: Menu,
    group: u8,
    entries: [Entry; N],
) -> impl Iterator<Item = Entry> {
    entries
        .into_iter()
        .map(move |entry| entry.within(menu, group))
}
