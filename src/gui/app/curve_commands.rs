//! Commands that change how curves over frequency are shown.

use super::GdcmApp;
use crate::gui::plot::Pane;
use crate::gui::plot::curve_command::CurveCommand;

impl GdcmApp {
    /// Applies a command about curves. If the command changes the form of phases or phase errors,
    /// their axis is fitted again.
    pub(super) fn carry_out_curve(&mut self, command: CurveCommand) {
        let display = &mut self.state.display;
        match command {
            CurveCommand::DrawPhaseErrors(_) => display.frequency.error.release_values(Pane::Phase),
            CurveCommand::DrawPhases(_) => display.frequency.bode.release_values(Pane::Phase),
            _ => {}
        }
        display.curves.carry_out(command);
    }
}
