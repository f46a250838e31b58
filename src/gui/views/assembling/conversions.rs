//! Conversion factors that do not follow from the units: the engineer declares them in the rules,
//! for a channel and its unit in the files.

use egui::{RichText, Ui};

use gdcm_model::assembly::UnitRule;
use gdcm_model::assembly::problem::ProblemKind;
use gdcm_model::units::number;

use crate::gui::commands::command::Command;
use crate::gui::state::assembling::AssemblyState;
use crate::gui::widgets::number_entry::number_entry_ui;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Unit conversion whose factor does not follow from the units.
#[derive(PartialEq)]
struct Conversion {
    channel: String,
    /// Unit in the files.
    from: String,
    /// Dataset unit; empty for declared conversions.
    to: String,
}

impl Conversion {
    fn is_set_by(&self, rule: &UnitRule) -> bool {
        rule.channel == self.channel && rule.from == self.from
    }
}

/// Shows a field with the factor for each declared conversion, then for each conversion that is
/// still required.
pub(super) fn conversions_ui(
    ui: &mut Ui,
    assembly: &AssemblyState,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let rules = assembly.assembly().rules();
    for conversion in conversions(assembly) {
        let rule = rules.units.iter().find(|rule| conversion.is_set_by(rule));
        let value = match rule {
            Some(rule) => number(rule.factor),
            None => String::new(),
        };
        let Conversion { channel, from, to } = &conversion;
        ui.horizontal(|ui| {
            let label = format!("{channel}: 1 {from} =");
            ui.label(RichText::new(label).size(SMALL_SIZE).color(palette.text));
            let name = format!("Factor of {channel} from {from}");
            if let Some(factor) = number_entry_ui(ui, &name, &value, "factor", 60.0, commands) {
                commands.push(conversion_change(assembly, &conversion, factor));
            }
            ui.label(palette.small(to));
        });
    }
}

fn conversions(assembly: &AssemblyState) -> Vec<Conversion> {
    let mut required = Vec::new();
    for problem in assembly.assembly().problems() {
        if let ProblemKind::Conversion { channel, from, to } = &problem.kind {
            let conversion = Conversion {
                channel: channel.clone(),
                from: from.clone(),
                to: to.clone(),
            };
            if !required.contains(&conversion) {
                required.push(conversion);
            }
        }
    }
    let mut conversions = Vec::new();
    for rule in &assembly.assembly().rules().units {
        conversions.push(Conversion {
            channel: rule.channel.clone(),
            from: rule.from.clone(),
            to: String::new(),
        });
    }
    conversions.extend(required);
    conversions
}

/// Returns the command that sets a conversion's factor, or removes the conversion.
fn conversion_change(
    assembly: &AssemblyState,
    conversion: &Conversion,
    factor: Option<f64>,
) -> Command {
    assembly.rules_change(|rules| {
        rules.units.retain(|rule| !conversion.is_set_by(rule));
        if let Some(factor) = factor {
            rules.units.push(UnitRule {
                channel: conversion.channel.clone(),
                from: conversion.from.clone(),
                factor,
            });
        }
    })
}
