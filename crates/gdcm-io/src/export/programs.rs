//! The schedule as a function in other programming languages: one template per language, filled
//! with numbers and strings.
//!
//! ```text
//! 1  schedule -> curves over airspeed; a curve that is not finite is a fault  (export)
//! 2  curve -> expression in the language                                      (expression)
//! 3  heading, names and expressions -> template -> text of the file           (file_text)
//!
//! variables in the expressions:
//! a  airspeed [kt], clamped to the range of the schedule, or of the mixing
//! v  a, scaled
//! b  second variable (altitude or mass), clamped to its range
//! z  b, scaled to -1 to 1
//! ```
//!
//! The *mixing* `M~` among the inputs and the *feedback* `K` from outputs to inputs are the
//! couplings (M16).

use std::io;
use std::path::Path;

use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, Value, context};

use gdcm_method::correction::Channel;
use gdcm_method::couplings::CouplingMatrices;
use gdcm_method::schedule::{Airspeeds, Regression};
use gdcm_plot::figure::all_channels;
use gdcm_study::results::export_note::{ExportNote, FileSummary};

use super::exported_schedule::{Curve, ExportedSchedule, LEAD_INTERVALS};
use super::matlab_names::check_function_name;
use super::program_text::{c_text, comment, number, number_list, python_text};
use super::{Export, ExportFormat, Exported, FormatGroup};
use crate::export_fault::ExportFault;
use crate::files::export_contents::ExportContents;

#[cfg(test)]
mod program_tests;

/// A programming language: its file template and the function names in its expressions.
struct Language {
    template: &'static str,
    exp: &'static str,
    min: &'static str,
    max: &'static str,
    /// Name of the function that evaluates a polynomial, given its coefficients and the scaled
    /// airspeed `v`.
    polynomial: &'static str,
    /// Name of the function that interpolates a table, given its airspeeds, its values and the
    /// airspeed `a`.
    table: &'static str,
    /// Whether lists of numbers must be declared as arrays; otherwise they are written in place, in
    /// square brackets.
    declares_arrays: bool,
    /// Writes a string as a literal; for MATLAB, whose template contains no string literals, as a
    /// comment.
    string_literal: fn(&str) -> String,
}

const MATLAB_LANGUAGE: Language = Language {
    template: include_str!("templates/matlab_function.m.jinja"),
    exp: "exp",
    min: "min",
    max: "max",
    polynomial: "gdcm_polynomial",
    table: "gdcm_table",
    declares_arrays: false,
    string_literal: comment,
};
const PYTHON_LANGUAGE: Language = Language {
    template: include_str!("templates/python_module.py.jinja"),
    exp: "math.exp",
    min: "min",
    max: "max",
    polynomial: "_polynomial",
    table: "_table",
    declares_arrays: false,
    string_literal: python_text,
};
const C_LANGUAGE: Language = Language {
    template: include_str!("templates/c_header.h.jinja"),
    exp: "exp",
    min: "fmin",
    max: "fmax",
    polynomial: "GDCM_POLYNOMIAL",
    table: "GDCM_TABLE",
    declares_arrays: true,
    string_literal: c_text,
};

/// Export as a MATLAB function, which is called by the name of its file.
pub(super) const MATLAB: ExportFormat = ExportFormat {
    name: "m",
    extension: "m",
    stem: "correction",
    group: FormatGroup::Function,
    title: "MATLAB function",
    words: "MATLAB function of airspeed",
    options: &[],
    check_path: |path| check_function_name(&stem(path)),
    correction_parts: |analysis, _| ExportContents::of_scheduled(analysis),
    export: |export| MATLAB_LANGUAGE.export(export),
};

pub(super) const PYTHON: ExportFormat = ExportFormat {
    name: "py",
    extension: "py",
    stem: "correction",
    group: FormatGroup::Function,
    title: "Python module",
    words: "Python module, a function of airspeed",
    options: &[],
    check_path: |_| Ok(()),
    correction_parts: |analysis, _| ExportContents::of_scheduled(analysis),
    export: |export| PYTHON_LANGUAGE.export(export),
};

pub(super) const C: ExportFormat = ExportFormat {
    name: "h",
    extension: "h",
    stem: "correction",
    group: FormatGroup::Function,
    title: "C header",
    words: "C header, a function of airspeed",
    options: &[],
    check_path: |_| Ok(()),
    correction_parts: |analysis, _| ExportContents::of_scheduled(analysis),
    export: |export| C_LANGUAGE.export(export),
};

impl Language {
    /// Exports the schedule as a file in this language.
    ///
    /// # Errors
    /// There is no schedule, requested couplings or physics parameters are unavailable, or a curve
    /// is not finite.
    fn export<'e>(self, export: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
        let scheduled = export.scheduled()?;
        // Step 1.
        scheduled.check()?;
        let name = stem(export.path);
        let remarks = scheduled.curve_remarks();
        let summary = FileSummary::Function {
            channels: all_channels(scheduled.dataset).len(),
            has_delays: scheduled.schedule.has_delays(),
            has_leads: scheduled.schedule.leads.is_some(),
        };
        let mut notes = export.schedule_notes();
        if scheduled.has_lead_table() {
            notes.push(ExportNote::LeadsTabulated {
                points: LEAD_INTERVALS + 1,
            });
        }
        // Steps 2 and 3.
        let write = move |file: &mut dyn io::Write| {
            file.write_all(self.file_text(&scheduled, &name)?.as_bytes())
        };
        Ok(Exported::new(summary, write)
            .with_remarks(remarks)
            .with_notes(notes))
    }

    /// Returns the text of the file; `name` is the file name without its extension.
    fn file_text(&self, scheduled: &ExportedSchedule<'_>, name: &str) -> io::Result<String> {
        let airspeeds = &scheduled.schedule.airspeeds;
        let inputs: Vec<Channel> = (0..scheduled.dataset.inputs().len())
            .map(Channel::Input)
            .collect();
        let outputs: Vec<Channel> = (0..scheduled.dataset.outputs().len())
            .map(Channel::Output)
            .collect();
        let couplings = scheduled
            .couplings
            .map(|couplings| self.coupling_values(couplings));
        // Step 2: `side_values` and `coupling_values` write the expressions.
        let values = context! {
            name,
            capitals => name.to_ascii_uppercase(),
            heading => scheduled.heading(&scheduled.curve_remarks()),
            least => number(airspeeds.min_kt),
            most => number(airspeeds.max_kt),
            scaled => scaled_airspeed(airspeeds),
            second => second_variable_values(scheduled),
            lead => lead_values(scheduled),
            couplings,
            contains => self.contained_parts(scheduled),
            sides => vec![
                self.side_values(scheduled, "Input", &inputs),
                self.side_values(scheduled, "Output", &outputs),
            ],
        };
        // Step 3.
        let whole_lines = SyntaxConfig::builder()
            .trim_blocks(true)
            .lstrip_blocks(true)
            .keep_trailing_newline(true)
            .build();
        let mut environment = Environment::new();
        environment.set_syntax(whole_lines.map_err(io::Error::other)?);
        environment
            .render_str(self.template, values)
            .map_err(io::Error::other)
    }

    /// Returns the template values for the correction's parts: name and source of each part, the
    /// changes of the physics parameters, and the omitted parts; all but the names are string
    /// literals.
    fn contained_parts(&self, scheduled: &ExportedSchedule<'_>) -> Value {
        let mut parts = Vec::new();
        for (name, source) in scheduled.contents.parts() {
            let text = (self.string_literal)(source.word());
            parts.push(context! { name, capitals => name.to_uppercase(), text });
        }
        let mut left_out = Vec::new();
        for words in scheduled.contents.left_out_words(scheduled.dataset) {
            left_out.push((self.string_literal)(&words));
        }
        let mut physics = Vec::new();
        for words in &scheduled.contents.physics {
            physics.push((self.string_literal)(words));
        }
        let moved = (self.string_literal)(&scheduled.contents.physics.join(", "));
        context! { parts, physics, moved, left_out }
    }

    /// Returns the template values of the couplings: the mixing `M~(V)` and the feedback `K`, both
    /// row by row, with the clamping and scaling of the airspeed on which `M~` depends. An entry of
    /// `M~`, from the input `from` to the input `to`, is their mixing curve (`numerator`) divided
    /// by the curve from `from` to itself (`denominator`), so that the diagonal is 1 (`is_unit`).
    fn coupling_values(&self, couplings: &CouplingMatrices) -> Value {
        let airspeeds = couplings.airspeeds();
        let (inputs, outputs) = couplings.feedback().shape();
        let mut mixing = Vec::with_capacity(inputs);
        let mut feedback = Vec::with_capacity(inputs);
        for to in 0..inputs {
            let mut row = Vec::with_capacity(inputs);
            for from in 0..inputs {
                row.push(context! {
                    column => from,
                    numerator => self.mixing_expression(couplings, to, from),
                    denominator => self.mixing_expression(couplings, from, from),
                    is_unit => to == from,
                });
            }
            mixing.push(row);
            let gains: Vec<f64> = couplings.feedback().row(to).iter().copied().collect();
            feedback.push(number_list(&gains));
        }
        context! {
            least => number(airspeeds.min_kt),
            most => number(airspeeds.max_kt),
            scaled => scaled_airspeed(airspeeds),
            mixing,
            feedback,
            inputs,
            outputs,
        }
    }

    fn mixing_expression(&self, couplings: &CouplingMatrices, to: usize, from: usize) -> Value {
        self.expression(&Curve::plain(couplings.mixing_curve(to, from).clone()))
    }

    /// Returns the template values of the inputs or the outputs; `side` is "Input" or "Output".
    fn side_values(
        &self,
        scheduled: &ExportedSchedule<'_>,
        side: &str,
        channels: &[Channel],
    ) -> Value {
        let (inputs, outputs) = scheduled.dataset.input_and_output_names();
        let mut entries = Vec::with_capacity(channels.len());
        for (index, &channel) in channels.iter().enumerate() {
            let name = channel.name(&inputs, &outputs);
            let zero = scheduled
                .zero_s(channel)
                .map(|zero_s| self.expression(&zero_s));
            entries.push(context! {
                index,
                number => index + 1,
                text => (self.string_literal)(&name),
                comment => comment(&name),
                gain => self.expression(&scheduled.gain(channel)),
                delay => self.expression(&scheduled.delay_s(channel)),
                zero,
            });
        }
        let lower = side.to_lowercase();
        context! {
            capital => side,
            capitals => side.to_uppercase(),
            // "in" or "out".
            short => lower.trim_end_matches("put"),
            letter => &lower[..1],
            count => channels.len(),
            channels => entries,
        }
    }

    /// Returns the expression of a curve (see [`Curve`]) in terms of the airspeed `a`, the scaled
    /// airspeed `v` and the scaled second variable `z`, together with the arrays `c0`, `c1`, … that
    /// it uses.
    fn expression(&self, curve: &Curve) -> Value {
        let mut arrays = Vec::new();
        let mut value = self.regression_expression(&curve.regression, &mut arrays);
        if let Some(slope) = curve.slope {
            value = format!("{value} + ({}) * z", number(slope));
        }
        if curve.is_logarithm {
            value = format!("{}({value})", self.exp);
        }
        if let Some(upper) = &curve.upper {
            let upper = self.regression_expression(upper, &mut arrays);
            value = format!(
                "{}({}({value}, {upper}), {})",
                self.max,
                self.min,
                number(0.0)
            );
        }
        context! { arrays, value }
    }

    fn regression_expression(&self, regression: &Regression, arrays: &mut Vec<String>) -> String {
        match regression {
            Regression::Polynomial { coefficients } if coefficients.len() == 1 => {
                number(coefficients[0])
            }
            Regression::Polynomial { coefficients } => {
                let coefficients = self.array_expression(coefficients, arrays);
                format!("{}({coefficients}, v)", self.polynomial)
            }
            Regression::Table {
                airspeeds_kt,
                values,
            } => {
                let airspeeds = self.array_expression(airspeeds_kt, arrays);
                let values = self.array_expression(values, arrays);
                format!("{}({airspeeds}, {values}, a)", self.table)
            }
        }
    }

    /// Returns the expression of a list of numbers. For a language that declares arrays, this is
    /// the name of an array, which is added to `arrays`.
    fn array_expression(&self, values: &[f64], arrays: &mut Vec<String>) -> String {
        let numbers = number_list(values);
        if !self.declares_arrays {
            return format!("[{numbers}]");
        }
        arrays.push(numbers);
        format!("c{}", arrays.len() - 1)
    }
}

/// Returns the template values of the second variable; `None` if the schedule has none.
fn second_variable_values(scheduled: &ExportedSchedule<'_>) -> Option<Value> {
    let term = scheduled.schedule.second.as_ref()?;
    let name = format!("{}_{}", term.variable.name(), term.variable.unit());
    Some(context! {
        capitals => name.to_uppercase(),
        name,
        words => format!("{} [{}]", term.variable.name(), term.variable.unit()),
        least => number(term.range[0]),
        most => number(term.range[1]),
        scaled => format!("(b - ({})) / {}", number(term.middle()), number(term.half_range())),
    })
}

/// Returns the template values of the lead filters; `None` if the schedule has none.
fn lead_values(scheduled: &ExportedSchedule<'_>) -> Option<Value> {
    let leads = scheduled.schedule.leads.as_ref()?;
    Some(context! {
        order => leads.design.settings().order.number(),
        lag_s => number(leads.design.lag_s()),
        limit_rad_s => number(leads.design.band_top_rad_s()),
    })
}

/// Returns the expression of the scaled airspeed, which is valid in every language.
fn scaled_airspeed(airspeeds: &Airspeeds) -> String {
    if airspeeds.half_range_kt == 0.0 {
        return number(0.0);
    }
    format!(
        "(a - ({})) / {}",
        number(airspeeds.mean_kt),
        number(airspeeds.half_range_kt)
    )
}

/// Returns a file name without its extension.
fn stem(path: &Path) -> String {
    match path.file_stem() {
        Some(stem) => stem.to_string_lossy().into_owned(),
        None => String::new(),
    }
}
