//! Chips above a plot instead of a legend: a switch for each role present, and the current
//! restrictions of the plot.

use std::collections::BTreeSet;

use egui::{
    Color32, CursorIcon, FontId, Rect, Response, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2,
    vec2,
};

use gdcm_plot::figure::drawing::Dash;

use super::bode_event::BodeEvent;
use super::curve_command::CurveCommand;
use super::curve_style::{CurveStyle, Role};
use super::drawn_curves::BodeCurve;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

const CHIP_HEIGHT: f32 = 22.0;
/// Line height, including the gap below \[pt\].
const LINE_HEIGHT: f32 = 27.0;
/// Gap between two chips \[pt\].
const GAP: f32 = 5.0;
/// Length of a curve sample \[pt\].
const SAMPLE: f32 = 18.0;
/// Length of a curve sample in a shortened chip \[pt\].
const TIGHT_SAMPLE: f32 = 12.0;
const SAMPLE_GAP: f32 = 6.0;
/// Padding at both ends of a chip \[pt\].
const PAD: f32 = 6.0;
/// Maximum length of a model name beside its role \[characters\].
const NAME_LENGTH: usize = 22;
/// Line width of the sample of a band \[pt\].
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
        let mut row = Row {
            area,
            corner: area.min,
            sample: self.sample(),
        };
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
        let height = if is_empty {
            0.0
        } else {
            row.corner.y - area.top() + LINE_HEIGHT
        };
        ChipsResponse { height, event }
    }

    fn role_chip_ui(
        &self,
        ui: &Ui,
        row: &mut Row,
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
    fn bands_chip_ui(&self, ui: &Ui, row: &mut Row, is_shown: bool, palette: &Palette) -> bool {
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

/// Returns the width of a chip without its sample, including the gap to the next chip \[pt\].
fn chip_width(ui: &Ui, text: &str) -> f32 {
    let font = FontId::proportional(SMALL_SIZE);
    let galley = ui
        .painter()
        .layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER);
    galley.size().x + 2.0 * PAD + GAP
}

struct ChipFace<'a> {
    text: &'a str,
    /// Accessible name.
    name: &'a str,
    /// Curve sample, if the chip switches curves.
    sample: Option<Sample>,
    is_lit: bool,
}

/// Curve sample of a chip.
#[derive(Clone, Copy)]
struct Sample {
    style: CurveStyle,
    /// Whether the curves are drawn in the plot.
    is_shown: bool,
}

impl ChipFace<'_> {
    /// Returns whether the curves of the chip are hidden.
    fn is_hidden(&self) -> bool {
        self.sample.is_some_and(|sample| !sample.is_shown)
    }
}

/// Position of the next chip.
struct Row {
    area: Rect,
    corner: egui::Pos2,
    /// Sample length \[pt\].
    sample: f32,
}

impl Row {
    /// Draws a chip: with a curve sample, pale and dashed if the curves are hidden; in the accent
    /// colour if it has no sample.
    fn chip_ui(&mut self, ui: &Ui, face: &ChipFace<'_>, palette: &Palette) -> Response {
        let color = if face.is_hidden() {
            palette.dim_text
        } else {
            palette.text
        };
        let font = FontId::proportional(SMALL_SIZE);
        let galley = ui
            .painter()
            .layout_no_wrap(face.text.to_owned(), font, color);
        let before = match face.sample {
            Some(_) => self.sample + SAMPLE_GAP,
            None => 0.0,
        };
        let place = self.next_place(galley.size().x + before + 2.0 * PAD);
        let id = ui.scope_id().with(("chip", face.name));
        let response = ui.interact(place, id, Sense::click());
        response.widget_info(|| match face.sample {
            Some(sample) => {
                WidgetInfo::selected(egui::Role::CheckBox, true, sample.is_shown, face.name)
            }
            None => WidgetInfo::labeled(egui::Role::Button, true, face.name),
        });
        let is_lit = face.is_lit || response.hovered() || response.has_focus();
        let ground = match face.sample {
            Some(_) => palette.panel,
            None => palette.selected,
        };
        let color = if is_lit { palette.accent } else { palette.line };
        let line = Stroke::new(1.0, color);
        if face.is_hidden() {
            paint_dashed_outline(ui, place, line);
        } else {
            let radius = 0.5 * place.height();
            ui.painter()
                .rect(place, radius, ground, line, StrokeKind::Inside);
        }
        if let Some(sample) = face.sample {
            self.paint_sample(ui, place, sample);
        }
        let at = pos2(
            place.left() + PAD + before,
            place.center().y - 0.5 * galley.size().y,
        );
        ui.painter().galley(at, galley, color);
        response.on_hover_cursor(CursorIcon::PointingHand)
    }

    /// Returns the place of the next chip, on a new line if the current line has no room.
    fn next_place(&mut self, width: f32) -> Rect {
        let size = vec2(width, CHIP_HEIGHT);
        if self.corner.x + size.x > self.area.right() && self.corner.x > self.area.left() {
            self.corner = pos2(self.area.left(), self.corner.y + LINE_HEIGHT);
        }
        let place = Rect::from_min_size(self.corner, size);
        self.corner.x = place.right() + GAP;
        place
    }

    fn paint_sample(&self, ui: &Ui, place: Rect, sample: Sample) {
        let mut style = sample.style;
        if !sample.is_shown {
            style.color = style.color.gamma_multiply(0.5);
        }
        let start = pos2(place.left() + PAD, place.center().y);
        let end = pos2(place.left() + PAD + self.sample, place.center().y);
        let mut shapes = Vec::new();
        style.add_shapes(vec![start, end], &mut shapes);
        ui.painter().extend(shapes);
    }
}

/// Paints the outline of a chip whose curves are hidden.
fn paint_dashed_outline(ui: &Ui, place: Rect, line: Stroke) {
    let path = rounded(place.shrink(0.5), 0.5 * place.height());
    ui.painter()
        .extend(egui::Shape::dashed_line(&path, line, 3.0, 3.0));
}

/// Returns a rectangle with semicircular ends, as a single path.
fn rounded(place: Rect, radius: f32) -> Vec<egui::Pos2> {
    const STEPS: usize = 8;
    let quarter = std::f32::consts::FRAC_PI_2;
    let right = pos2(place.right() - radius, place.center().y);
    let left = pos2(place.left() + radius, place.center().y);
    let mut path = Vec::new();
    for (center, from) in [(right, -quarter), (left, quarter)] {
        for step in 0..=STEPS {
            let angle = from + 2.0 * quarter * step as f32 / STEPS as f32;
            path.push(center + radius * vec2(angle.cos(), angle.sin()));
        }
    }
    path.push(path[0]);
    path
}
