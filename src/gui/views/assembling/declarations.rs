//! Channel signs, units and factors that apply to several files.
//!
//! Declarations for a single model are shown with the model, those for a folder pattern only in the
//! rules file.
//!
//! A *role* is the use of a file's models in their condition: physics or identified.

use std::collections::BTreeMap;

use egui::{Grid, Ui};

use gdcm_model::assembly::declarations::{ChannelDeclarations, Signs};
use gdcm_model::assembly::{FileScope, Rules};

use super::typed_rules::{number_text, typed_factors, typed_signs, typed_units, unit_text};
use crate::gui::commands::command::Command;
use crate::gui::commands::form::FormCommand;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::palette::Palette;
use crate::gui::widgets::text_fields::entry_ui;
use crate::message::Message;

const FIELD_WIDTH: f32 = 160.0;

/// Files for which signs are declared.
#[derive(Clone, Copy)]
enum SignScope {
    AllFiles,
    PhysicsModels,
    IdentifiedModels,
}

impl SignScope {
    const ALL: [Self; 3] = [Self::AllFiles, Self::PhysicsModels, Self::IdentifiedModels];

    fn name(self) -> &'static str {
        match self {
            Self::AllFiles => "Signs in all files",
            Self::PhysicsModels => "Signs of physics models",
            Self::IdentifiedModels => "Signs of identified models",
        }
    }

    /// Returns the role's key in the rules; `None` for all files.
    fn role(self) -> Option<&'static str> {
        match self {
            Self::AllFiles => None,
            Self::PhysicsModels => Some("physics"),
            Self::IdentifiedModels => Some("identified"),
        }
    }

    fn signs(self, rules: &Rules) -> Signs {
        match self.role() {
            None => rules.signs.clone(),
            Some(role) => rules.role_signs.get(role).cloned().unwrap_or_default(),
        }
    }

    fn set(self, rules: &mut Rules, signs: Signs) {
        match self.role() {
            None => rules.signs = signs,
            Some(role) => {
                rules.role_signs.insert(role.to_owned(), signs);
            }
        }
    }
}

/// Shows fields for the signs declared for all files and for each role.
pub(super) fn signs_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let rules = assembly.assembly().rules();
    Grid::new("signs of channels")
        .num_columns(2)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for scope in SignScope::ALL {
                let name = scope.name();
                let value = number_text(&scope.signs(rules));
                if let Some(text) = declaration_ui(ui, name, &value, "NZ -1", palette) {
                    commands.push(match typed_signs(&text) {
                        Ok(signs) => assembly.rules_change(|rules| scope.set(rules, signs)),
                        Err(why) => refusal(name, &why),
                    });
                }
            }
        });
}

/// Shows fields for the units and factors declared for each role; a channel has either a unit or a
/// factor.
pub(super) fn units_and_factors_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    Grid::new("units and factors of channels")
        .num_columns(2)
        .spacing([6.0, 3.0])
        .show(ui, |ui| {
            for (scope, models) in [
                (FileScope::Physics, "physics models"),
                (FileScope::Identified, "identified models"),
            ] {
                let declared = declarations(assembly.assembly().rules(), &scope);
                let name = format!("Units of {models}");
                let value = unit_text(&declared.units);
                if let Some(text) = declaration_ui(ui, &name, &value, "LON in", palette) {
                    commands.push(match typed_units(&text) {
                        Ok(units) => units_change(assembly, &scope, units),
                        Err(why) => refusal(&name, &why),
                    });
                }
                let name = format!("Factors of {models}");
                let value = number_text(&declared.factors);
                if let Some(text) = declaration_ui(ui, &name, &value, "LON 8", palette) {
                    commands.push(match typed_factors(&text) {
                        Ok(factors) => factors_change(assembly, &scope, factors),
                        Err(why) => refusal(&name, &why),
                    });
                }
            }
        });
}

/// Returns the units and factors declared for `scope`.
fn declarations(rules: &Rules, scope: &FileScope) -> ChannelDeclarations {
    let declared = rules
        .declarations
        .iter()
        .find(|declared| declared.scope == *scope);
    match declared {
        Some(declared) => declared.channels.clone(),
        None => ChannelDeclarations::default(),
    }
}

/// Returns the command that replaces the units; a channel with a unit loses its factor.
fn units_change(
    assembly: &AssemblyState,
    scope: &FileScope,
    units: BTreeMap<String, String>,
) -> Command {
    assembly.rules_change(|rules| {
        let declared = rules.declarations_mut(scope.clone());
        declared
            .factors
            .retain(|channel, _| !units.contains_key(channel));
        declared.units = units;
    })
}

/// Returns the command that replaces the factors; a channel with a factor loses its unit.
fn factors_change(
    assembly: &AssemblyState,
    scope: &FileScope,
    factors: BTreeMap<String, f64>,
) -> Command {
    assembly.rules_change(|rules| {
        let declared = rules.declarations_mut(scope.clone());
        declared
            .units
            .retain(|channel, _| !factors.contains_key(channel));
        declared.factors = factors;
    })
}

/// Draws a row with a label and a field; returns a newly typed text.
fn declaration_ui(
    ui: &mut Ui,
    name: &str,
    value: &str,
    hint: &str,
    palette: &Palette,
) -> Option<String> {
    ui.label(palette.small(name.to_lowercase()));
    let text = entry_ui(ui, name, value, hint, FIELD_WIDTH);
    ui.end_row();
    text
}

fn refusal(name: &str, why: &str) -> Command {
    let text = format!("{name}: {why}");
    Command::Form(FormCommand::Refuse(Message::new("wrong-declaration", text)))
}
