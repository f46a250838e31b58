//! Form for a dataset to be made from flight records: channels, band, path.

use egui::{Label, ScrollArea, Ui};

use super::form_parts::Form;
use crate::gui::commands::records::RecordsCommand;
use crate::gui::state::records::DatasetForm;
use crate::gui::widgets::text_fields::{is_entered, text_field_ui};

/// Maximum count of listed record columns.
const MOST_COLUMNS: usize = 60;

/// Draws the form, with the columns of the records and the problems found so far.
pub(super) fn record_dataset_ui(form: &mut Form<'_, '_>, wanted: &mut DatasetForm) {
    form.title("Dataset from these records");
    form.explain(
        "For identification without a physics model. Separate channels by commas. If the file \
        gives no unit, or no column has the name of the channel, add them: q [rad/s]=gyro_y, or \
        q [rad/s]=#3 for the third column.",
    );
    form.ui.add_space(4.0);
    let mut entered = false;
    form.line(|form| {
        form.labelled("inputs");
        let hint = "LON, LAT, or M [N m]=moment";
        entered |= form.text_ui("Inputs of the dataset", &mut wanted.inputs, hint);
    });
    form.line(|form| {
        form.labelled("outputs");
        let name = "Outputs of the dataset";
        entered |= wide_field_ui(
            form.ui,
            name,
            &mut wanted.outputs,
            "P, Q, or q [rad/s]=gyro_y",
        );
    });
    form.line(|form| {
        form.labelled("file");
        let name = "Path of the dataset of records";
        entered |= wide_field_ui(form.ui, name, &mut wanted.path, "path of a .json.gz file");
    });
    form.line(|form| {
        form.labelled("band");
        let names = [
            "Lower end of the band to identify",
            "Upper end of the band to identify",
        ];
        for (name, end) in names.iter().zip(&mut wanted.band) {
            text_field_ui(form.ui, name, end, "rad/s", 60.0);
        }
        form.explain("rad/s");
    });
    let columns = column_words(&wanted.columns);
    ScrollArea::vertical()
        .id_salt("columns of the records")
        .max_height(96.0)
        .show(form.ui, |ui| {
            ui.add(Label::new(form.palette.small(columns)).wrap());
        });
    for problem in &wanted.problems {
        form.ui
            .add(Label::new(form.palette.small_warning(&problem.text)).wrap());
    }
    let is_ready = [&wanted.inputs, &wanted.outputs, &wanted.path]
        .iter()
        .all(|text| !text.trim().is_empty());
    form.line(|form| {
        form.submit_ui(
            "Make the dataset",
            is_ready,
            entered,
            Some(RecordsCommand::MakeDataset.into()),
        );
        form.cancel_ui(false);
    });
}

/// Draws a text field that extends to the end of the line; returns whether Enter was pressed in it.
fn wide_field_ui(ui: &mut Ui, name: &str, text: &mut String, hint: &str) -> bool {
    let width = ui.available_width() - 8.0;
    let field = text_field_ui(ui, name, text, hint, width);
    is_entered(ui, &field)
}

/// Lists the record columns, for example "columns: time, gyro_x, gyro_y, and 12 more".
fn column_words(columns: &[String]) -> String {
    let shown = &columns[..columns.len().min(MOST_COLUMNS)];
    let mut words = format!("columns: {}", shown.join(", "));
    let more = columns.len() - shown.len();
    if more > 0 {
        words.push_str(&format!(", and {more} more"));
    }
    words
}
