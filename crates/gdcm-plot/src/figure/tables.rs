//! The numbers of a figure at full precision: as one long table for programs, or as a table for
//! each panel for people.

use std::sync::Arc;

use gdcm_model::message_text::sanitized;
use gdcm_model::number_format::full_precision;
use gdcm_words::Table;

use super::axis::Axis;
use super::figure::{Along, Bracket, Curve, Envelope, Figure, Intervals, Mark, Panel, Spans};

/// The columns of a figure's long table.
pub const LONG_COLUMNS: [&str; 8] = [
    "figure",
    "panel",
    "curve",
    "label",
    "x_quantity",
    "x",
    "y_quantity",
    "y",
];

impl Figure {
    /// Returns all numbers as the rows of one table under [`LONG_COLUMNS`], one for each point: the
    /// figure's title, the panel (title of the plot, quantity), the curve, the text beside the
    /// point, and both coordinates, each after the label of its axis. A labelled horizontal line
    /// has no x.
    pub fn long_rows(&self) -> impl Iterator<Item = [String; 8]> + '_ {
        self.panels()
            .flat_map(|(title, panel)| panel.long_rows(&self.title, panel.name(title)))
    }

    /// Returns the numbers of each panel: one column for each curve if all share their x, otherwise
    /// one row for each point. Band limits at frequencies of their own follow in separate tables.
    pub fn tables(&self) -> Vec<Table> {
        let (tables, of_bands): (Vec<Table>, Vec<Option<Table>>) = self
            .panels()
            .map(|(title, panel)| panel.tables(title))
            .unzip();
        let tables = tables
            .into_iter()
            .chain(of_bands.into_iter().flatten())
            .filter(|table| !table.rows.is_empty());
        tables.map(without_control_codes).collect()
    }
}

/// Removes control characters from a table, so that a terminal or a spreadsheet shows its names
/// unchanged.
fn without_control_codes(mut table: Table) -> Table {
    let cells = table
        .columns
        .iter_mut()
        .chain(table.rows.iter_mut().flatten());
    cells
        .chain([&mut table.title])
        .for_each(|text| *text = sanitized(text));
    table
}

/// Listed numbers of a mark: its name, and its points with the texts beside them.
struct Series {
    name: String,
    x: Arc<[f64]>,
    y: Arc<[f64]>,
    labels: Option<Vec<String>>,
}

/// Name and value of a constant over all x.
type Constant<'m> = (&'m str, f64);

impl Panel {
    /// Returns its name among the numbers, in a plot of this title.
    fn name(&self, title: &str) -> String {
        if title.is_empty() {
            self.y.label.clone()
        } else {
            format!("{title}, {}", self.y.label)
        }
    }

    /// Returns its rows of the long table, in a figure of this title and under this name.
    fn long_rows<'p>(
        &'p self,
        figure_title: &'p str,
        name: String,
    ) -> impl Iterator<Item = [String; 8]> + 'p {
        let mut rows = Vec::new();
        for series in self.marks.iter().flat_map(series) {
            for at in 0..series.x.len().min(series.y.len()) {
                let label = series
                    .labels
                    .as_ref()
                    .and_then(|labels| labels.get(at))
                    .map_or("", String::as_str);
                rows.push([
                    series.name.clone(),
                    label.to_owned(),
                    place(&self.x, series.x[at]),
                    figure(series.y[at]),
                ]);
            }
        }
        for (line, value) in self.marks.iter().filter_map(constant) {
            rows.push([line.to_owned(), String::new(), String::new(), figure(value)]);
        }
        rows.into_iter().map(move |[curve, label, x, y]| {
            let x_quantity = self.x.label.clone();
            let y_quantity = self.y.label.clone();
            [
                figure_title.to_owned(),
                name.clone(),
                curve,
                label,
                x_quantity,
                x,
                y_quantity,
                y,
            ]
        })
    }

    fn tables(&self, title: &str) -> (Table, Option<Table>) {
        let (bands, others): (Vec<&Mark>, Vec<&Mark>) = self
            .marks
            .iter()
            .partition(|mark| matches!(mark, Mark::Envelope(of) if of.edge.is_none()));
        let mut main: Vec<Series> = others.into_iter().flat_map(series).collect();
        let bands: Vec<Series> = bands.into_iter().flat_map(series).collect();
        let title = self.name(title);
        let apart = main
            .first()
            .is_some_and(|first| bands.iter().any(|band| band.x != first.x));
        let of_bands = apart.then(|| self.table(format!("{title}, bands"), &bands, &[]));
        if !apart {
            main.extend(bands);
        }
        let constants: Vec<Constant<'_>> = self.marks.iter().filter_map(constant).collect();
        (self.table(title, &main, &constants), of_bands)
    }

    fn table(&self, title: String, series: &[Series], constants: &[Constant<'_>]) -> Table {
        let same_x = |first: &Series| {
            series
                .iter()
                .all(|next| next.labels.is_none() && next.x == first.x)
        };
        if series.first().is_some_and(same_x) {
            self.wide(title, series, constants)
        } else {
            self.long(title, series, constants)
        }
    }

    /// Builds `x | first curve [unit] | second curve [unit] | …`; the series have the same x.
    fn wide(&self, title: String, series: &[Series], constants: &[Constant<'_>]) -> Table {
        let unit = unit_of(&self.y.label);
        let names = series
            .iter()
            .map(|series| series.name.as_str())
            .chain(constants.iter().map(|(name, _)| *name));
        let headings = names.map(|name| format!("{name}{unit}"));
        let mut table = Table::new(title, std::iter::once(self.x.label.clone()).chain(headings));
        let x = series
            .first()
            .map(|series| &series.x[..])
            .unwrap_or_default();
        for (at, &x) in x.iter().enumerate() {
            let values = series
                .iter()
                .map(|series| series.y.get(at).copied().unwrap_or(f64::NAN));
            let values = values
                .chain(constants.iter().map(|(_, value)| *value))
                .map(figure);
            table.row(std::iter::once(place(&self.x, x)).chain(values));
        }
        table
    }

    /// Builds `series | label | x | y`.
    fn long(&self, title: String, series: &[Series], constants: &[Constant<'_>]) -> Table {
        let mut table = Table::new(title, ["series", "label", &self.x.label, &self.y.label]);
        for series in series {
            for (at, (&x, &y)) in series.x.iter().zip(series.y.iter()).enumerate() {
                let label = series
                    .labels
                    .as_ref()
                    .and_then(|labels| labels.get(at))
                    .cloned()
                    .unwrap_or_default();
                table.row([series.name.clone(), label, place(&self.x, x), figure(y)]);
            }
        }
        for (name, value) in constants {
            table.row([
                (*name).to_owned(),
                String::new(),
                String::new(),
                figure(*value),
            ]);
        }
        table
    }
}

fn series(mark: &Mark) -> Vec<Series> {
    let of = |name: &str, points: Vec<[f64; 2]>, labels| Series {
        name: name.to_owned(),
        x: points.iter().map(|point| point[0]).collect(),
        y: points.iter().map(|point| point[1]).collect(),
        labels,
    };
    let of_curve = |curve: &Curve| Series {
        name: curve.name.clone(),
        x: Arc::clone(&curve.x),
        y: Arc::clone(&curve.y),
        labels: None,
    };
    match mark {
        Mark::Curve(curve) => vec![of_curve(curve)],
        Mark::Envelope(of) if of.edge.is_some() => {
            of.edges().map(|curve| of_curve(&curve)).collect()
        }
        Mark::Dots(dots) => {
            let labels = dots.dots.iter().map(|dot| dot.label.clone()).collect();
            vec![of(
                &dots.name,
                dots.dots.iter().map(|dot| [dot.x, dot.y]).collect(),
                Some(labels),
            )]
        }
        Mark::Bars(bars) => vec![of(&bars.name, bars.bars.clone(), None)],
        Mark::Spans(Spans {
            name, spans: ends, ..
        })
        | Mark::Envelope(Envelope {
            name, points: ends, ..
        })
        | Mark::Intervals(Intervals { name, ends, .. }) => {
            let end = |(end, at): (&str, usize)| {
                of(
                    &format!("{name}, {end}"),
                    ends.iter().map(|ends| [ends[0], ends[at]]).collect(),
                    None,
                )
            };
            [("lower", 1), ("upper", 2)].map(end).into()
        }
        Mark::Brackets(brackets) => {
            let both = |of: &Bracket| of.ends.map(|end| ([of.x, end], of.label.clone()));
            let (points, labels) = brackets.brackets.iter().flat_map(both).unzip();
            vec![of(&brackets.name, points, Some(labels))]
        }
        Mark::Rule(_) | Mark::Band(_) | Mark::Guide(_) | Mark::Note(_) => Vec::new(),
    }
}

/// Returns the label and value of a labelled horizontal line.
fn constant(mark: &Mark) -> Option<Constant<'_>> {
    match mark {
        Mark::Rule(rule) if rule.along == Along::Y && !rule.label.is_empty() => {
            Some((&rule.label, rule.at))
        }
        _ => None,
    }
}

/// Returns ` [dB]` for `Magnitude [dB]`; empty for a label without a unit.
fn unit_of(label: &str) -> &str {
    label.rfind(" [").map(|at| &label[at..]).unwrap_or_default()
}

/// Returns the name of a place on an axis of names, including places beside it; otherwise the
/// number.
fn place(axis: &Axis, value: f64) -> String {
    let name = axis
        .names
        .iter()
        .flatten()
        .find(|(at, _)| (at - value).abs() < 0.5)
        .map(|(_, name)| name.clone());
    name.unwrap_or_else(|| figure(value))
}

/// Formats a number at full precision; empty if it is not finite.
fn figure(value: f64) -> String {
    full_precision(Some(value))
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Color, Stroke};
    use super::super::figure::{Bars, Curve, DotShape, Dots, Plot, Rule};
    use super::*;

    const LINE: Stroke = Stroke::solid(Color::INK, 1.0);

    fn table_of(panel: Panel) -> Table {
        Figure::new("")
            .plot(Plot::new("LON → Q").panel(panel))
            .tables()
            .remove(0)
    }

    #[test]
    fn curves_on_the_same_frequencies_stand_beside_one_another_to_the_last_digit() {
        let omega: Arc<[f64]> = vec![0.1 + 0.2, 1e-300].into();
        let panel = Panel::new(
            Axis::logarithmic("Frequency [rad/s]"),
            Axis::linear("Magnitude [dB]"),
        )
        .with(Curve::new(
            "nominal",
            LINE,
            Arc::clone(&omega),
            [1.0, f64::NAN],
        ))
        .with(Curve::new("V+5kt", LINE, omega, [-2.5, 3.0]));
        let table = table_of(panel);
        assert_eq!(table.title, "LON → Q, Magnitude [dB]");
        assert_eq!(
            table.columns,
            ["Frequency [rad/s]", "nominal [dB]", "V+5kt [dB]"]
        );
        assert_eq!(
            table.rows,
            [
                ["0.30000000000000004", "1.0", "-2.5"],
                ["1e-300", "", "3.0"]
            ]
        );
    }

    #[test]
    fn dots_and_a_curve_stand_below_one_another_with_their_labels() {
        let panel = Panel::new(Axis::linear("Airspeed [kt]"), Axis::linear("Net gain [-]"))
            .with(Dots::new("optimum", DotShape::Circle, Color::INK).dot(60.0, 1.1, "10"))
            .with(Curve::new("schedule", LINE, [45.0], [1.0]));
        let table = table_of(panel);
        assert_eq!(
            table.columns,
            ["series", "label", "Airspeed [kt]", "Net gain [-]"]
        );
        assert_eq!(
            table.rows,
            [
                ["optimum", "10", "60.0", "1.1"],
                ["schedule", "", "45.0", "1.0"]
            ]
        );
    }

    #[test]
    fn the_long_table_has_a_row_for_each_point_of_each_curve_of_each_panel() {
        let omega: Arc<[f64]> = vec![0.5, 12.0].into();
        let magnitude = Panel::new(
            Axis::logarithmic("Frequency [rad/s]"),
            Axis::linear("Magnitude [dB]"),
        )
        .with(Curve::new("nominal", LINE, Arc::clone(&omega), [1.0, -0.0]))
        .with(Rule::horizontal(3.0, LINE).label("limit"));
        let errors = Panel::new(Axis::named("Condition", ["3"]), Axis::linear("ΔJ [-]"))
            .with(Dots::new("optimum", DotShape::Circle, Color::INK).dot(0.0, f64::NAN, "10"));
        let plots = [
            Plot::new("LON → Q").panel(magnitude),
            Plot::new("").panel(errors),
        ];
        let rows: Vec<[String; 8]> = Figure::new("Both").plots(plots).long_rows().collect();
        let magnitude = "LON → Q, Magnitude [dB]";
        assert_eq!(
            rows,
            [
                [
                    "Both",
                    magnitude,
                    "nominal",
                    "",
                    "Frequency [rad/s]",
                    "0.5",
                    "Magnitude [dB]",
                    "1.0"
                ],
                [
                    "Both",
                    magnitude,
                    "nominal",
                    "",
                    "Frequency [rad/s]",
                    "12.0",
                    "Magnitude [dB]",
                    "-0.0"
                ],
                [
                    "Both",
                    magnitude,
                    "limit",
                    "",
                    "Frequency [rad/s]",
                    "",
                    "Magnitude [dB]",
                    "3.0"
                ],
                [
                    "Both",
                    "ΔJ [-]",
                    "optimum",
                    "10",
                    "Condition",
                    "3",
                    "ΔJ [-]",
                    ""
                ],
            ]
        );
    }

    #[test]
    fn bars_stand_beside_their_names() {
        let bars = Bars {
            name: "ΔJ".to_owned(),
            color: Color::INK,
            width: 0.2,
            bars: vec![[0.0, -4.0], [1.0, 2.0]],
            feet: Vec::new(),
            beside: 0.0,
        };
        let table = table_of(
            Panel::new(Axis::named("Condition", ["3", "7"]), Axis::linear("ΔJ [-]")).with(bars),
        );
        assert_eq!(table.columns, ["Condition", "ΔJ [-]"]);
        assert_eq!(table.rows, [["3", "-4.0"], ["7", "2.0"]]);
    }
}
