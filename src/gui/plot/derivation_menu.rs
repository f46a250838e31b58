//! Menu that lists the values under the pointer whose derivations can be displayed.

use egui::{Id, Response};

use gdcm_words::derivation::ExplainTarget;

/// Heading above the menus that open derivations, and above the sheet that shows one.
pub const QUESTION: &str = "How was this computed?";

/// Value whose derivation can be displayed.
#[derive(Clone, Debug)]
pub struct Question {
    /// Name of the value in the menu.
    pub name: String,
    pub target: ExplainTarget,
}

impl Question {
    pub fn new(name: impl Into<String>, target: ExplainTarget) -> Self {
        Self {
            name: name.into(),
            target,
        }
    }
}

/// Plot and listed values for the open menu, if any.
#[derive(Clone, Debug, Default)]
pub(super) struct QuestionMenu {
    open: Option<OpenMenu>,
}

#[derive(Clone, Debug)]
struct OpenMenu {
    plot: Id,
    questions: Vec<Question>,
}

impl QuestionMenu {
    /// Opens a plot's menu on a secondary click, with the questions about the mark under the
    /// pointer; returns the target chosen in the menu.
    pub(super) fn ui(
        &mut self,
        response: &Response,
        pointed: &[Question],
    ) -> Option<ExplainTarget> {
        if response.secondary_clicked() {
            self.open = None;
            if !pointed.is_empty() {
                self.open = Some(OpenMenu {
                    plot: response.id,
                    questions: pointed.to_vec(),
                });
            }
        }
        let menu = self.open.as_ref()?;
        if menu.plot != response.id {
            return None;
        }
        let mut chosen = None;
        response.context_menu(|ui| {
            ui.label(QUESTION);
            for question in &menu.questions {
                if ui.button(&question.name).clicked() {
                    chosen = Some(question.target.clone());
                    ui.close();
                }
            }
        });
        chosen
    }
}
