//! Bode layout: places for the panes, and for the texts and strips around them.
//!
//! A pane is the magnitude or the phase plot. The read-out lists the values at the cursor; the
//! coherence strip shows the coherence of measured responses.

use egui::{Rect, pos2, vec2};

use super::bode_scene::BodeScene;
use super::panel_axis::TICKS_HEIGHT;
use super::readout_strip::STRIP_HEIGHT;

/// Vertical axis width \[pt\], equal in both panes so that the frequencies align.
pub(super) const VALUE_AXIS_WIDTH: f32 = 40.0;
/// Magnitude pane's share of the panes' total height.
const MAGNITUDE_PART: f32 = 0.52;
/// Height of the heading above a pane \[pt\].
const HEADING: f32 = 20.0;
/// Space above and below the read-out (without it, between the panes), and above the coherence
/// strip \[pt\].
const GAP: f32 = 6.0;
/// Margin at the right for the frequency unit \[pt\].
const UNIT_MARGIN: f32 = 36.0;
/// Margin at the right for the names of roles \[pt\].
const ROLE_NAME_MARGIN: f32 = 78.0;
/// Margin at the right for names of groups of curves \[pt\].
const GROUP_NAME_MARGIN: f32 = 76.0;
/// Margin at the right for names on reference lines \[pt\].
const LINE_NAME_MARGIN: f32 = 118.0;
/// Minimum plot height with room for the values between the panes \[pt\].
const LEAST_WITH_STRIP: f32 = 300.0;
const COHERENCE_HEIGHT: f32 = 52.0;
/// Minimum plot height with room for the coherence strip \[pt\].
const LEAST_WITH_COHERENCE: f32 = 380.0;

/// Places for headings, panes and strips.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BodeLayout {
    /// Lines above the panes.
    pub(super) headings: [Rect; 2],
    /// Magnitude and phase, with their axes.
    pub(super) panes: [Rect; 2],
    /// Values between the panes, if there is room.
    pub(super) readout: Option<Rect>,
    /// Strip below the panes, if there is coherence and room.
    pub(super) coherence: Option<Rect>,
}

impl BodeLayout {
    /// Divides `area` into headings, panes and strips:
    ///
    /// 1. at the right, the margin for names or the unit;
    /// 2. at the bottom, the coherence strip, if there is coherence and the height suffices;
    /// 3. in the middle of the rest, the read-out strip, if the scene has or reserves it and the
    ///    height suffices;
    /// 4. the remaining height: a heading above each pane, the frequency axis below the phase, and
    ///    the panes in a fixed proportion.
    pub(super) fn new(area: Rect, scene: &BodeScene<'_>) -> Self {
        // Step 1.
        let mut inner = area.with_max_x(area.right() - right_margin(scene));
        // Step 2.
        let mut coherence = None;
        if !scene.coherence.is_empty() && inner.height() >= LEAST_WITH_COHERENCE {
            let strip = inner
                .with_min_y(inner.bottom() - COHERENCE_HEIGHT)
                .with_min_x(inner.left() + VALUE_AXIS_WIDTH);
            inner = inner.with_max_y(strip.top() - GAP);
            coherence = Some(strip);
        }
        // Step 3.
        // A reserved read-out has its room even without values, so that nothing moves when the
        // pointer arrives.
        let has_readout = (scene.readout.is_some() || scene.reserves_readout)
            && inner.height() >= LEAST_WITH_STRIP;
        let between = if has_readout {
            STRIP_HEIGHT + 2.0 * GAP
        } else {
            GAP
        };
        // Step 4.
        let panes_height = inner.height() - 2.0 * HEADING - between - TICKS_HEIGHT;
        let magnitude = Rect::from_min_size(
            pos2(inner.left(), inner.top() + HEADING),
            vec2(inner.width(), MAGNITUDE_PART * panes_height),
        );
        let phase = inner.with_min_y(magnitude.bottom() + between + HEADING);
        let mut readout = None;
        if has_readout {
            readout = Some(Rect::from_min_max(
                pos2(inner.left() + VALUE_AXIS_WIDTH, magnitude.bottom() + GAP),
                pos2(inner.right(), magnitude.bottom() + GAP + STRIP_HEIGHT),
            ));
        }
        Self {
            headings: [line_above(magnitude), line_above(phase)],
            panes: [magnitude, phase],
            readout,
            coherence,
        }
    }
}

fn line_above(pane: Rect) -> Rect {
    Rect::from_min_max(pos2(pane.left(), pane.top() - HEADING), pane.right_top())
}

/// Returns the right margin \[pt\]: for names on reference lines; else for names of groups of
/// curves; else for names of roles; else only for the frequency unit.
fn right_margin(scene: &BodeScene<'_>) -> f32 {
    if !scene.reference_lines.is_empty() {
        LINE_NAME_MARGIN
    } else if !scene.group_names.is_empty() {
        GROUP_NAME_MARGIN
    } else if scene.names_roles {
        ROLE_NAME_MARGIN
    } else {
        UNIT_MARGIN
    }
}
