//! Chips above a plot instead of a legend: a switch for each role present, and the current
//! restrictions of the plot.

use std::collections::BTreeSet;

use egui::{Rect, Ui};

use gdcm_plot::figure::drawing::Dash;

use super::bode_event::BodeEvent;
use super::chip_row::{ChipFace, ChipRow, GAP, SAMPLE_GAP, Sample, chip_width};
use super::curve_command::CurveCommand;
use super::curve_style::{CurveStyle, Role};
use super::drawn_curves::BodeCurve;
use crate::gui::widgets::palette::Palette;

/// Length of a curve sample \[pt\].
const SAMPLE: f32 = 18.0;
/// Length of a curve sample in a shortened chip \[pt\].
const TIGHT_SAMPLE: f32 = 12.0;
/// Maximum length of a model name beside its role \[characters\].
const NAME_LENGTH: usize = 22;
/// Line width of the sample of an uncertainty band \[pt\].
const BAND_SAMPLE_WIDTH: f32 = 7.0;

/// Chip that shows or hides the curves of a role.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RoleChip {
    pub(super) role: Role,
    pub(super) text: String,
    pub(super) look: CurveStyle,
    /// Whether the role's curves are drawn.
    pub(super) shown: bool,
    /// Whether a curve of the role is emphasized, here or in another view.
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

/// Returns a chip for each role among `curves`, drawn or `hidden`, in the order of [`Role::ALL`].
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
            look: palette.role_style(first.role, rejected),
            shown: !hidden.is_some_and(|hidden| hidden.contains(&role)),
            lit: members.iter().any(|curve| curve.highlighted),
        });
    }
    chips
}

/// Returns the role name, followed by the name of a single representative, or replaced by the name
/// of a single variant or by "others" for identified models.
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

/// Current restriction of a plot, and the effect of a click on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chip {
    /// Text: "Only V+10kt ×".
    pub text: String,
    /// Tooltip: the effect of a click.
    pub hint: String,
}

/// Chips of a plot, in lines from the upper left corner.
pub(super) struct Chips<'a> {
    /// Suffix that distinguishes these chips from the chips of other plots.
    pub(super) plot: &'a str,
    pub(super) roles: Vec<RoleChip>,
    /// Whether uncertainty bands are drawn; `None` if there are none.
    pub(super) bands: Option<bool>,
    pub(super) states: &'a [Chip],
    /// Whether samples and texts are shortened for lack of room.
    pub(super) is_tight: bool,
}

/// Height and event of the drawn chips.
pub(super) struct ChipsResponse {
    /// Height of all lines \[pt\].
    pub(super) height: f32,
    /// Event of the clicked chip.
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

    /// Returns the total width of the chips in a single line \[pt\].
    pub(super) fn width(&self, ui: &Ui) -> f32 {
        let sample = self.sample();
        let bands = self.bands.map(|_| self.bands_text());
        let names = self.roles.iter().map(|chip| chip.text.as_str());
        let switches = names
            .chain(bands)
            .map(|name| chip_width(ui, name) + sample + SAMPLE_GAP);
        let states = self.states.iter().map(|chip| chip_width(ui, &chip.text));
        switches.chain(states).sum::<f32>() - GAP
    }

    /// Draws the chips in lines, starting at the upper left corner.
    pub(super) fn ui(&self, ui: &Ui, area: Rect, palette: &Palette) -> ChipsResponse {
        let mut row = ChipRow::new(area, self.sample());
        let mut event = None;
        for chip in &self.roles {
            if let Some(request) = self.role_chip_ui(ui, &mut row, chip, palette) {
                event = Some(BodeEvent::Display(request));
            }
        }
        if let Some(shown) = self.bands
            && self.bands_chip_ui(ui, &mut row, shown, palette)
        {
            event = Some(BodeEvent::Display(CurveCommand::ShowBands(!shown)));
        }
        for (index, chip) in self.states.iter().enumerate() {
            let face = ChipFace {
                text: &chip.text,
                name: &format!("{}{}", chip.text, self.plot),
                sample: None,
                is_lit: false,
            };
            let response = row.chip_ui(ui, &face, palette);
            if response.on_hover_text(&chip.hint).clicked() {
                event = Some(BodeEvent::ChipClicked(index));
            }
        }
        let is_empty = self.roles.is_empty() && self.states.is_empty();
        let height = if is_empty { 0.0 } else { row.height() };
        ChipsResponse { height, event }
    }

    fn role_chip_ui(
        &self,
        ui: &Ui,
        row: &mut ChipRow,
        chip: &RoleChip,
        palette: &Palette,
    ) -> Option<CurveCommand> {
        let face = ChipFace {
            text: &chip.text,
            name: &format!("Show {}{}", chip.role.name(), self.plot),
            sample: Some(Sample {
                style: chip.look,
                is_shown: chip.shown,
            }),
            is_lit: chip.lit,
        };
        let response = row.chip_ui(ui, &face, palette);
        let effect = if chip.shown { "hide" } else { "show" };
        let hint = format!("Click: {effect} · Alt+click: alone · Shift+click: in front");
        if !response.on_hover_text(hint).clicked() {
            return None;
        }
        let modifiers = ui.input(|input| input.modifiers);
        Some(if modifiers.alt {
            CurveCommand::ShowRoleAlone(chip.role)
        } else if modifiers.shift {
            CurveCommand::RaiseRole(chip.role)
        } else {
            CurveCommand::ToggleRole(chip.role)
        })
    }

    /// Draws the chip of the uncertainty bands; returns whether it was clicked.
    fn bands_chip_ui(&self, ui: &Ui, row: &mut ChipRow, is_shown: bool, palette: &Palette) -> bool {
        let style = CurveStyle {
            color: palette.identified.gamma_multiply(0.45),
            width: BAND_SAMPLE_WIDTH,
            dash: Dash::Solid,
            length: 0.0,
        };
        let face = ChipFace {
            text: self.bands_text(),
            name: &format!("Show the band of 95 %{}", self.plot),
            sample: Some(Sample { style, is_shown }),
            is_lit: false,
        };
        let response = row.chip_ui(ui, &face, palette);
        response
            .on_hover_text("Confidence interval for each identified response")
            .clicked()
    }

    fn bands_text(&self) -> &'static str {
        if self.is_tight {
            "95 %"
        } else {
            "band of 95 %"
        }
    }

    /// Returns the sample length \[pt\].
    fn sample(&self) -> f32 {
        if self.is_tight { TIGHT_SAMPLE } else { SAMPLE }
    }
}
