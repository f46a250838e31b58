//! The program's window without a display, after its analysis.

use std::time::Duration;

use eframe::App;
use egui::{Context, Ui, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use gdcm::gui::app::GdcmApp;
use gdcm_io::{Opened, embedded_example};

/// Window with the embedded example.
pub struct Window {
    harness: Harness<'static, GdcmApp>,
}

impl Window {
    /// Opens the window and waits until its analysis is complete.
    pub fn settled() -> Self {
        let build = |creation: &mut eframe::CreationContext<'static>| {
            let example = embedded_example().expect("the embedded example is a dataset");
            GdcmApp::new(&creation.egui_ctx, Opened::Dataset(example))
                .expect("a thread can be started")
        };
        let mut harness = Harness::builder()
            .with_size(vec2(1600.0, 900.0))
            .build_eframe(build);
        while harness.state().state().results.toggles.is_none() {
            harness.run_steps(1);
            std::thread::sleep(Duration::from_millis(5));
        }
        harness.run_steps(4);
        Self { harness }
    }

    /// Shows a tab, given its name.
    pub fn show(&mut self, tab: &str) {
        self.harness.ctx.enable_accesskit();
        self.harness.run_steps(2);
        self.harness.get_by_label(tab).click();
        self.harness.run_steps(4);
    }

    /// Returns the numbers of curves and points in the large plot: "25 curves of 500 points".
    pub fn curves_drawn(&self) -> String {
        let drawn = &self.harness.state().state().display.frequency.drawn;
        let points = drawn.first().map_or(0, |curve| curve.omega.len());
        format!("{} curves of {points} points", drawn.len())
    }

    /// Returns the window's context and a function that draws the window.
    pub fn drawn(&mut self) -> (Context, impl FnMut(&mut Ui)) {
        let ctx = self.harness.ctx.clone();
        // As without a screen reader, no accessible names are generated.
        ctx.disable_accesskit();
        let app = self.harness.state_mut();
        let mut frame = eframe::Frame::_new_kittest();
        let draw = move |ui: &mut Ui| {
            app.logic(ui, &mut frame);
            app.ui(ui, &mut frame);
        };
        (ctx, draw)
    }
}
