//! Chips above a plot instead of a legend: a switch for each role present, and the current
//! restrictions of the plot.

use std::collections::BTreeSet;

use egui::{
    Color32, CursorIcon, FontId, Rect, Response, Sense, Stroke, StrokeKind, Ui, WidgetInfo, pos2,
    vec2,
};

use gdcm_plot::figure::drawing::Dash;

use super::bode::BodeEvent;
use super::curve_command::CurveCommand;
use super::curve_style::{CurveStyle, Role};
use super::drawn_curves::BodeCurve;
use crate::gui::widgets::palette::{Palette, SMALL_SIZE};

/// Height of a chip, and of a line of chips \[pt\].
const HEIGHTS: [f32; 2] = [22.0, 27.0];
/// Gap between two chips \[pt\].
const GAP: f32 = 5.0;
/// Length of a curve's sample in normal and in tight chips \[pt\].
const SAMPLES: [f32; 2] = [18.0, 12.0];
const SAMPLE_GAP: f32 = 6.0;
/// Padding at both ends of a chip \[pt\].
const PAD: f32 = 6.0;
/// Longest name of a single model shown beside its role, in characters.
const NAME_LENGTH: usize = 22;

/// Chip that switches curves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RoleChip {
    pub(super) role: Role,
    pub(super) text: String,
    pub(super) look: CurveStyle,
    /// Whether the curves of the role are drawn.
    pub(super) shown: bool,
    /// Whether the pointer is on a curve of the role, or on its counterpart in another view.
    pub(super) lit: bool,
}

impl RoleChip {
    /// Removes the name of a single model or variant from the chip, and shortens the longest words.
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
    let of_role = |role: Role| {
        let members: Vec<&BodeCurve> = curves
            .iter()
            .filter(|curve| curve.role.shown(curve.rejected) == role)
            .collect();
        let first = members.first()?;
        // A single chip for kept and rejected nominal models: dotted only if none is kept.
        let rejected = members.iter().all(|curve| curve.rejected);
        let look = palette.role_style(first.role, rejected);
        Some(RoleChip {
            role,
            text: text(role, &members),
            look,
            shown: !hidden.is_some_and(|hidden| hidden.contains(&role)),
            lit: members.iter().any(|curve| curve.highlighted),
        })
    };
    Role::ALL.into_iter().filter_map(of_role).collect()
}

fn text(role: Role, members: &[&BodeCurve]) -> String {
    let name = role.name();
    let short = |label: &str| {
        let start: String = label.chars().take(NAME_LENGTH).collect();
        let ellipsis = if start.len() < label.len() { "…" } else { "" };
        format!("{start}{ellipsis}")
    };
    match (role, members) {
        (Role::Representative, [only]) if !only.label.is_empty() => {
            format!("{name} {}", short(&only.label))
        }
        (Role::Variant, [only]) => short(&only.label),
        (Role::Identified, _) => "others".to_owned(),
        _ => name.to_owned(),
    }
}

/// Current restriction of a plot, and the effect of a click on it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Chip {
    /// Text: "Only V+10kt ×".
    pub text: String,
    /// Effect of a click.
    pub hint: String,
}

/// All chips of a plot.
pub(super) struct Chips<'a> {
    /// Distinguishes these chips from those of other plots.
    pub(super) plot: &'a str,
    pub(super) roles: Vec<RoleChip>,
    /// Whether bands are drawn; `None` if there are no bands.
    pub(super) bands: Option<bool>,
    pub(super) states: &'a [Chip],
    /// Whether samples and words are shortened, for lack of room.
    pub(super) is_tight: bool,
}

impl Chips<'_> {
    /// Shortens samples and words.
    pub(super) fn tighten(&mut self) {
        self.is_tight = true;
        self.roles.iter_mut().for_each(RoleChip::shorten);
    }

    /// Returns the total width of the chips side by side \[pt\].
    pub(super) fn width(&self, ui: &Ui) -> f32 {
        let text = |text: &str| {
            let font = FontId::proportional(SMALL_SIZE);
            ui.painter()
                .layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER)
                .size()
                .x
                + 2.0 * PAD
                + GAP
        };
        let bands = self.bands.map(|_| self.bands_text());
        let sample = SAMPLES[usize::from(self.is_tight)];
        let names = self
            .roles
            .iter()
            .map(|chip| chip.text.as_str())
            .chain(bands);
        let roles = names.map(|name| text(name) + sample + SAMPLE_GAP);
        roles
            .chain(self.states.iter().map(|chip| text(&chip.text)))
            .sum::<f32>()
            - GAP
    }

    /// Draws the chips in lines from the upper left corner of `area`; returns their height, and the
    /// clicked chip.
    pub(super) fn ui(&self, ui: &Ui, area: Rect, palette: &Palette) -> (f32, Option<BodeEvent>) {
        let sample = SAMPLES[usize::from(self.is_tight)];
        let mut row = Row {
            area,
            corner: area.min,
            sample,
            event: None,
        };
        for chip in &self.roles {
            let name = format!("Show {}{}", chip.role.name(), self.plot);
            let sample = Some((chip.look, chip.shown));
            let response = row.chip_ui(ui, (&chip.text, &name), (sample, chip.lit), palette);
            let hint = if chip.shown {
                "Click: hide"
            } else {
                "Click: show"
            };
            let hint = format!("{hint} · Alt+click: alone · Shift+click: in front");
            if response.on_hover_text(hint).clicked() {
                let modifiers = ui.input(|input| input.modifiers);
                row.event = Some(BodeEvent::Display(match (modifiers.alt, modifiers.shift) {
                    (true, _) => CurveCommand::ShowRoleAlone(chip.role),
                    (_, true) => CurveCommand::RaiseRole(chip.role),
                    _ => CurveCommand::ToggleRole(chip.role),
                }));
            }
        }
        if let Some(shown) = self.bands {
            let style = CurveStyle {
                color: palette.identified.gamma_multiply(0.45),
                width: 7.0,
                dash: Dash::Solid,
                length: 0.0,
            };
            let name = format!("Show the band of 95 %{}", self.plot);
            let response = row.chip_ui(
                ui,
                (self.bands_text(), &name),
                (Some((style, shown)), false),
                palette,
            );
            if response
                .on_hover_text("How far each identified response may lie from its curve")
                .clicked()
            {
                row.event = Some(BodeEvent::Display(CurveCommand::ShowBands(!shown)));
            }
        }
        for (index, chip) in self.states.iter().enumerate() {
            let name = format!("{}{}", chip.text, self.plot);
            if row
                .chip_ui(ui, (&chip.text, &name), (None, false), palette)
                .on_hover_text(&chip.hint)
                .clicked()
            {
                row.event = Some(BodeEvent::ChipClicked(index));
            }
        }
        let is_empty = self.roles.is_empty() && self.states.is_empty();
        let height = if is_empty {
            0.0
        } else {
            row.corner.y - area.top() + HEIGHTS[1]
        };
        (height, row.event)
    }

    /// Returns the text of the bands' chip.
    fn bands_text(&self) -> &'static str {
        if self.is_tight {
            "95 %"
        } else {
            "band of 95 %"
        }
    }
}

/// Place of the next chip.
struct Row {
    area: Rect,
    corner: egui::Pos2,
    /// Length of a sample \[pt\].
    sample: f32,
    event: Option<BodeEvent>,
}

impl Row {
    /// Draws a chip with the sample of a curve, pale and dashed if hidden; in the accent colour if
    /// it has no sample.
    fn chip_ui(
        &mut self,
        ui: &Ui,
        (text, name): (&str, &str),
        (sample, is_lit): (Option<(CurveStyle, bool)>, bool),
        palette: &Palette,
    ) -> Response {
        let is_shown = sample.is_none_or(|(_, shown)| shown);
        let color = if is_shown {
            palette.text
        } else {
            palette.dim_text
        };
        let galley =
            ui.painter()
                .layout_no_wrap(text.to_owned(), FontId::proportional(SMALL_SIZE), color);
        let before = if sample.is_some() {
            self.sample + SAMPLE_GAP
        } else {
            0.0
        };
        let size = vec2(galley.size().x + before + 2.0 * PAD, HEIGHTS[0]);
        if self.corner.x + size.x > self.area.right() && self.corner.x > self.area.left() {
            self.corner = pos2(self.area.left(), self.corner.y + HEIGHTS[1]);
        }
        let place = Rect::from_min_size(self.corner, size);
        self.corner.x = place.right() + GAP;
        let response = ui.interact(place, ui.scope_id().with(("chip", name)), Sense::click());
        match sample {
            Some((_, shown)) => {
                response
                    .widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, shown, name));
            }
            None => response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, name)),
        }
        let is_meant = is_lit || response.hovered() || response.has_focus();
        self.paint(ui, place, (sample, is_meant), palette);
        let at = pos2(
            place.left() + PAD + before,
            place.center().y - 0.5 * galley.size().y,
        );
        ui.painter().galley(at, galley, color);
        response.on_hover_cursor(CursorIcon::PointingHand)
    }

    fn paint(
        &self,
        ui: &Ui,
        place: Rect,
        (sample, is_meant): (Option<(CurveStyle, bool)>, bool),
        palette: &Palette,
    ) {
        let radius = 0.5 * place.height();
        let is_hidden = sample.is_some_and(|(_, shown)| !shown);
        let line = Stroke::new(
            1.0,
            if is_meant {
                palette.accent
            } else {
                palette.line
            },
        );
        let fill = match sample {
            _ if is_hidden => Color32::TRANSPARENT,
            Some(_) => palette.panel,
            None => palette.selected,
        };
        if is_hidden {
            let path = rounded(place.shrink(0.5), radius);
            ui.painter()
                .extend(egui::Shape::dashed_line(&path, line, 3.0, 3.0));
        } else {
            ui.painter()
                .rect(place, radius, fill, line, StrokeKind::Inside);
        }
        let Some((look, _)) = sample else { return };
        let look = if is_hidden {
            CurveStyle {
                color: look.color.gamma_multiply(0.5),
                ..look
            }
        } else {
            look
        };
        let left = place.left() + PAD;
        let middle = place.center().y;
        let mut shapes = Vec::new();
        look.add_shapes(
            vec![pos2(left, middle), pos2(left + self.sample, middle)],
            &mut shapes,
        );
        ui.painter().extend(shapes);
    }
}

/// Returns the outline of a rectangle with semicircular ends, as a single path.
fn rounded(place: Rect, radius: f32) -> Vec<egui::Pos2> {
    let centers = [
        pos2(place.right() - radius, place.center().y),
        pos2(place.left() + radius, place.center().y),
    ];
    let quarter = std::f32::consts::FRAC_PI_2;
    let turn = |center: egui::Pos2, from: f32| {
        (0..=8).map(move |step| {
            let angle = from + 2.0 * quarter * step as f32 / 8.0;
            center + radius * vec2(angle.cos(), angle.sin())
        })
    };
    let mut path: Vec<_> = turn(centers[0], -quarter)
        .chain(turn(centers[1], quarter))
        .collect();
    path.push(path[0]);
    path
}
