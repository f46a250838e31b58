//! Chips above a plot, which serve as its legend: a switch for each role present, and chips that
//! carry out a command.
//!
//! A role ([`Role`]) is the meaning of curves, such as nominal or corrected model. A command chip
//! ends a state of the plot, such as "Only V+10kt ×" while one model is isolated, or concerns the
//! selected models.

use std::collections::BTreeSet;

use egui::{Popup, PopupCloseBehavior, Rect, Role as WidgetRole, Ui};

use gdcm_plot::figure::drawing::Dash;

use super::bode_event::BodeEvent;
use super::chip_row::{ChipFace, ChipRow, GAP, LINE_HEIGHT, SAMPLE_GAP, Sample, chip_width};
use super::curve_command::CurveCommand;
use super::curve_style::{CurveStyle, Role};
use super::drawn_curves::BodeCurve;
use crate::gui::widgets::controls::{hint_above, named_switch};
use crate::gui::widgets::palette::Palette;

/// Curve sample length \[pt\].
const SAMPLE: f32 = 18.0;
/// Curve sample length in a shortened chip \[pt\].
const TIGHT_SAMPLE: f32 = 12.0;
/// Maximum length of a model name beside its role \[characters\].
const NAME_LENGTH: usize = 22;
/// Line width in the sample for an uncertainty band \[pt\].
const BAND_SAMPLE_WIDTH: f32 = 7.0;

/// Chip that shows or hides a role's curves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RoleChip {
    pub(super) role: Role,
    pub(super) text: String,
    pub(super) style: CurveStyle,
    /// Whether the role's curves are drawn.
    pub(super) shown: bool,
    /// Whether one of the role's curves is emphasized: selected, or under the pointer here or in
    /// another view.
    pub(super) lit: bool,
}

impl RoleChip {
    /// Shortens the longest texts, and omits the names of single models and variants.
    fn shorten(&mut self) {
        match self.role {
            Role::Representative => "repr.".clone_into(&mut self.text),
            Role::Variant => self.role.name().clone_into(&mut self.text),
            Role::WithoutLeads => "no leads".clone_into(&mut self.text),
            _ => {}
        }
    }
}

/// Returns a chip for each role among `curves`, drawn or `hidden`, ordered as [`Role::ALL`].
pub(super) fn role_chips(
    curves: &[BodeCurve],
    hidden: Option<&BTreeSet<Role>>,
    palette: &Palette,
) -> Vec<RoleChip> {
    let mut chips = Vec::new();
    for role in Role::ALL {
        let members: Vec<&BodeCurve> = curves
            .iter()
            .filter(|curve| curve.role.shown(curve.rejected) == role)
            .collect();
        let Some(first) = members.first() else {
            continue;
        };
        // Kept and rejected nominal models share a chip: its line is dotted only if all are
        // rejected.
        let rejected = members.iter().all(|curve| curve.rejected);
        chips.push(RoleChip {
            role,
            text: chip_text(role, &members),
            style: palette.role_style(first.role, rejected),
            shown: !hidden.is_some_and(|hidden| hidden.contains(&role)),
            lit: members.iter().any(|curve| curve.highlighted),
        });
    }
    chips
}

/// Returns the role name, followed by a single representative's name, or replaced by a single
/// variant's name or, for identified models, by "others".
fn chip_text(role: Role, members: &[&BodeCurve]) -> String {
    let name = role.name();
    match (role, members) {
        (Role::Representative, [only]) if !only.label.is_empty() => {
            format!("{name} {}", shortened(&only.label))
        }
        (Role::Variant, [only]) => shortened(&only.label),
        (Role::Identified, _) => "others".to_owned(),
        _ => name.to_owned(),
    }
}

fn shortened(label: &str) -> String {
    let mut start: String = label.chars().take(NAME_LENGTH).collect();
    if start.len() < label.len() {
        start.push('…');
    }
    start
}

/// A chip that carries out a command when clicked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CommandChip {
    /// Text, such as "Only V+10kt ×".
    pub text: String,
    /// Tooltip that says what a click does.
    pub hint: String,
}

/// A plot's chips, in a line from the upper left corner.
pub(super) struct Chips<'a> {
    /// Suffix to accessible names that distinguishes these chips from those in other plots.
    pub(super) plot: &'a str,
    pub(super) roles: Vec<RoleChip>,
    /// Whether uncertainty bands are drawn; `None` if there are none.
    pub(super) shows_uncertainty: Option<bool>,
    pub(super) command_chips: &'a [CommandChip],
    /// Whether samples and texts are shortened for lack of room.
    pub(super) is_tight: bool,
}

/// Height and event of the drawn chips.
pub(super) struct ChipsResponse {
    /// Line height, 0 without chips \[pt\].
    pub(super) height: f32,
    /// Event for the clicked chip.
    pub(super) event: Option<BodeEvent>,
}

impl Chips<'_> {
    /// Shortens samples and texts.
    pub(super) fn tighten(&mut self) {
        self.is_tight = true;
        for chip in &mut self.roles {
            chip.shorten();
        }
    }

    /// Returns the chips' total width in a single line \[pt\].
    pub(super) fn width(&self, ui: &Ui) -> f32 {
        let sample = self.sample();
        let uncertainty = self.shows_uncertainty.map(|_| self.uncertainty_text());
        let names = self.roles.iter().map(|chip| chip.text.as_str());
        let switches = names
            .chain(uncertainty)
            .map(|name| chip_width(ui, name) + sample + SAMPLE_GAP);
        let command_chips = self
            .command_chips
            .iter()
            .map(|chip| chip_width(ui, &chip.text));
        switches.chain(command_chips).sum::<f32>() - GAP
    }

    /// Draws the chips in a single line, starting at the upper left corner of `area`:
    ///
    /// 1. the switches that fit, each with a sample of its curves;
    /// 2. for the others a chip that counts them, "+2", with a menu;
    /// 3. the command chips, which are always visible.
    ///
    /// Without roles and command chips nothing is drawn, and the height is 0.
    pub(super) fn ui(&self, ui: &mut Ui, area: Rect, palette: &Palette) -> ChipsResponse {
        if self.roles.is_empty() && self.command_chips.is_empty() {
            return ChipsResponse {
                height: 0.0,
                event: None,
            };
        }
        let mut row = ChipRow::new(area, self.sample());
        let mut event = None;
        // Step 1.
        let switches = self.switches();
        let fitting_count = self.fitting_count(ui, &switches, area.width());
        for switch in &switches[..fitting_count] {
            let face = ChipFace {
                text: switch.text,
                name: &switch.name,
                sample: Some(Sample {
                    style: switch.style(palette),
                    is_shown: switch.is_shown,
                }),
                is_lit: switch.is_lit,
            };
            let response = hint_above(row.chip_ui(ui, &face, palette), &switch.hint());
            if response.clicked() {
                event = Some(switch.event(ui));
            }
        }
        // Step 2.
        let rest = &switches[fitting_count..];
        if !rest.is_empty() {
            event = self.rest_ui(ui, &mut row, rest, palette).or(event);
        }
        // Step 3.
        for (index, chip) in self.command_chips.iter().enumerate() {
            let face = ChipFace {
                text: &chip.text,
                name: &format!("{}{}", chip.text, self.plot),
                sample: None,
                is_lit: false,
            };
            let response = row.chip_ui(ui, &face, palette);
            if hint_above(response, &chip.hint).clicked() {
                event = Some(BodeEvent::CommandChipClicked(index));
            }
        }
        ChipsResponse {
            height: LINE_HEIGHT,
            event,
        }
    }

    /// Returns the switches for all roles, and for the uncertainty bands.
    fn switches(&self) -> Vec<Switch<'_>> {
        let mut switches = Vec::new();
        for chip in &self.roles {
            switches.push(Switch {
                subject: SwitchSubject::Role(chip),
                text: &chip.text,
                name: format!("Show {}{}", chip.role.name(), self.plot),
                is_shown: chip.shown,
                is_lit: chip.lit,
            });
        }
        if let Some(is_shown) = self.shows_uncertainty {
            switches.push(Switch {
                subject: SwitchSubject::Uncertainty,
                text: self.uncertainty_text(),
                name: format!("Show the 95 % band{}", self.plot),
                is_shown,
                is_lit: false,
            });
        }
        switches
    }

    /// Returns how many switches fit beside the command chips; if not all do, also beside the chip
    /// that counts the others.
    fn fitting_count(&self, ui: &Ui, switches: &[Switch<'_>], width: f32) -> usize {
        let command_chips_width: f32 = self
            .command_chips
            .iter()
            .map(|chip| chip_width(ui, &chip.text))
            .sum();
        // Each chip's width includes the gap behind it, which the last chip does not need.
        let room = width - command_chips_width + GAP;
        let sample_width = self.sample() + SAMPLE_GAP;
        let widths: Vec<f32> = switches
            .iter()
            .map(|switch| chip_width(ui, switch.text) + sample_width)
            .collect();
        if widths.iter().sum::<f32>() <= room {
            return switches.len();
        }
        // The count is not known yet: room for two digits.
        let mut used = chip_width(ui, "+10");
        for (count, width) in widths.iter().enumerate() {
            used += width;
            if used > room {
                return count;
            }
        }
        switches.len()
    }

    /// Draws the chip that counts the switches which do not fit, and its menu.
    fn rest_ui(
        &self,
        ui: &mut Ui,
        row: &mut ChipRow,
        rest: &[Switch<'_>],
        palette: &Palette,
    ) -> Option<BodeEvent> {
        let face = ChipFace {
            text: &format!("+{}", rest.len()),
            name: &format!("Further curves{}", self.plot),
            sample: None,
            is_lit: false,
        };
        let response = row.chip_ui(ui, &face, palette);
        let shown = Popup::menu(&response)
            .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
            .show(|ui| {
                let mut event = None;
                for switch in rest {
                    let mut is_on = switch.is_shown;
                    let check = ui.checkbox(&mut is_on, switch.text);
                    let check = named_switch(check, WidgetRole::CheckBox, is_on, &switch.name);
                    if check.clicked() {
                        event = Some(switch.event(ui));
                    }
                }
                event
            });
        shown?.inner
    }

    fn uncertainty_text(&self) -> &'static str {
        if self.is_tight { "95 %" } else { "95 % band" }
    }

    /// Returns the sample length \[pt\].
    fn sample(&self) -> f32 {
        if self.is_tight { TIGHT_SAMPLE } else { SAMPLE }
    }
}

/// Switch for a role's curves, or for the uncertainty bands.
struct Switch<'a> {
    subject: SwitchSubject<'a>,
    text: &'a str,
    /// Accessible name.
    name: String,
    is_shown: bool,
    is_lit: bool,
}

enum SwitchSubject<'a> {
    Role(&'a RoleChip),
    Uncertainty,
}

impl Switch<'_> {
    fn style(&self, palette: &Palette) -> CurveStyle {
        match self.subject {
            SwitchSubject::Role(chip) => chip.style,
            SwitchSubject::Uncertainty => CurveStyle {
                color: palette.identified.gamma_multiply(0.45),
                width: BAND_SAMPLE_WIDTH,
                dash: Dash::Solid,
                length: 0.0,
            },
        }
    }

    fn hint(&self) -> String {
        match self.subject {
            SwitchSubject::Role(_) => {
                let effect = if self.is_shown { "hide" } else { "show" };
                format!("Click: {effect} · Alt+click: alone · Shift+click: in front")
            }
            SwitchSubject::Uncertainty => {
                "Confidence interval for each identified response".to_owned()
            }
        }
    }

    /// Returns the event for a click; for a role it depends on the pressed modifier keys.
    fn event(&self, ui: &Ui) -> BodeEvent {
        let modifiers = ui.input(|input| input.modifiers);
        BodeEvent::Display(match self.subject {
            SwitchSubject::Role(chip) if modifiers.alt => CurveCommand::ShowRoleAlone(chip.role),
            SwitchSubject::Role(chip) if modifiers.shift => CurveCommand::RaiseRole(chip.role),
            SwitchSubject::Role(chip) => CurveCommand::ToggleRole(chip.role),
            SwitchSubject::Uncertainty => CurveCommand::ShowBands(!self.is_shown),
        })
    }
}
