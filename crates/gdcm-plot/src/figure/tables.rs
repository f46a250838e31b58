//! Values behind a figure at full precision: a single long table for programs, or a table per panel
//! for readers.
//!
//! The values are those of a panel's marks (`marks.rs`), such as curves, dots and bars. An *area*
//! is an envelope without edges, such as the 95 % band about a curve.

use std::sync::Arc;

use gdcm_model::message_text::sanitized;
use gdcm_model::number_format::full_precision;
use gdcm_words::Table;

use super::axis::Axis;
use super::figure::{Figure, Panel};
use super::marks::{Along, Brackets, Curve, Dots, Mark};

/// Columns in a figure's long table.
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
    /// Returns all values as rows under [`LONG_COLUMNS`], a row for each point: figure title, panel
    /// (plot title, quantity), curve, text beside the point, and both coordinates, each preceded by
    /// its axis label. A labelled horizontal line has no x.
    pub fn long_rows(&self) -> impl Iterator<Item = [String; 8]> + '_ {
        self.panels()
            .flat_map(|(title, panel)| panel.long_rows(&self.title, title))
    }

    /// Returns a table for each panel: a column for each curve if all have the same x and no texts,
    /// otherwise a row for each point. Areas sampled at other x have separate tables at the end.
    /// Tables without rows are omitted.
    pub fn tables(&self) -> Vec<Table> {
        let mut tables = Vec::new();
        let mut tables_of_areas = Vec::new();
        for (title, panel) in self.panels() {
            let numbers = PanelTables::new(panel, title);
            tables.push(numbers.main);
            tables_of_areas.extend(numbers.areas);
        }
        tables.extend(tables_of_areas);
        tables.retain(|table| !table.rows.is_empty());
        tables.into_iter().map(without_control_codes).collect()
    }
}

/// Escapes control characters in a table, which a terminal or a spreadsheet might interpret.
fn without_control_codes(mut table: Table) -> Table {
    let cells = table
        .columns
        .iter_mut()
        .chain(table.rows.iter_mut().flatten());
    for text in cells.chain([&mut table.title]) {
        *text = sanitized(text);
    }
    table
}

/// The points in a mark, with the texts beside them.
struct Series {
    name: String,
    x: Arc<[f64]>,
    y: Arc<[f64]>,
    labels: Option<Vec<String>>,
}

impl Series {
    /// Creates a series from `[x, y]` points without texts.
    fn new(name: impl Into<String>, points: &[[f64; 2]]) -> Self {
        Self {
            name: name.into(),
            x: points.iter().map(|point| point[0]).collect(),
            y: points.iter().map(|point| point[1]).collect(),
            labels: None,
        }
    }

    fn from_curve(curve: &Curve) -> Self {
        Self {
            name: curve.name.clone(),
            x: Arc::clone(&curve.x),
            y: Arc::clone(&curve.y),
            labels: None,
        }
    }

    fn from_dots(group: &Dots) -> Self {
        let points: Vec<[f64; 2]> = group.dots.iter().map(|dot| [dot.x, dot.y]).collect();
        Self {
            labels: Some(group.dots.iter().map(|dot| dot.label.clone()).collect()),
            ..Self::new(&group.name, &points)
        }
    }

    /// Creates a series through both ends of each bracket.
    fn from_brackets(group: &Brackets) -> Self {
        let mut points = Vec::new();
        let mut labels = Vec::new();
        for bracket in &group.brackets {
            for end in bracket.ends {
                points.push([bracket.x, end]);
                labels.push(bracket.label.clone());
            }
        }
        Self {
            labels: Some(labels),
            ..Self::new(&group.name, &points)
        }
    }

    /// Creates two series from vertical ranges: lower ends and upper ends.
    fn from_ends(name: &str, ends: &[[f64; 3]]) -> Vec<Self> {
        let mut lower = Vec::new();
        let mut upper = Vec::new();
        for &[x, low, high] in ends {
            lower.push([x, low]);
            upper.push([x, high]);
        }
        vec![
            Self::new(format!("{name}, lower"), &lower),
            Self::new(format!("{name}, upper"), &upper),
        ]
    }

    /// Returns a mark's series; empty for a mark without values.
    fn from_mark(mark: &Mark) -> Vec<Self> {
        match mark {
            Mark::Curve(curve) => vec![Self::from_curve(curve)],
            Mark::Dots(group) => vec![Self::from_dots(group)],
            Mark::Bars(bars) => vec![Self::new(&bars.name, &bars.bars)],
            Mark::Spans(spans) => Self::from_ends(&spans.name, &spans.spans),
            Mark::Envelope(envelope) if envelope.edge.is_some() => {
                envelope.edges().iter().map(Self::from_curve).collect()
            }
            Mark::Envelope(envelope) => Self::from_ends(&envelope.name, &envelope.points),
            Mark::Intervals(intervals) => Self::from_ends(&intervals.name, &intervals.ends),
            Mark::Brackets(group) => vec![Self::from_brackets(group)],
            Mark::Rule(_) | Mark::Strip(_) | Mark::Guide(_) | Mark::Note(_) => Vec::new(),
        }
    }

    /// Returns the text beside a point; empty if there is none.
    fn label(&self, point: usize) -> &str {
        let label = self.labels.as_ref().and_then(|labels| labels.get(point));
        label.map(String::as_str).unwrap_or_default()
    }

    fn count(&self) -> usize {
        self.x.len().min(self.y.len())
    }
}

/// A value independent of x: a labelled horizontal line.
struct Constant<'m> {
    name: &'m str,
    value: f64,
}

impl<'m> Constant<'m> {
    fn from_mark(mark: &'m Mark) -> Option<Self> {
        match mark {
            Mark::Rule(rule) if rule.along == Along::Y && !rule.label.is_empty() => Some(Self {
                name: &rule.label,
                value: rule.at,
            }),
            _ => None,
        }
    }
}

impl Panel {
    /// Returns the panel's name in the tables: plot title, if any, and quantity.
    fn name(&self, plot_title: &str) -> String {
        if plot_title.is_empty() {
            self.y.label.clone()
        } else {
            format!("{plot_title}, {}", self.y.label)
        }
    }

    /// Returns the panel's rows in the long table.
    fn long_rows(&self, figure_title: &str, plot_title: &str) -> Vec<[String; 8]> {
        let name = self.name(plot_title);
        let mut rows = Vec::new();
        for [curve, label, x, y] in self.point_rows() {
            rows.push([
                figure_title.to_owned(),
                name.clone(),
                curve,
                label,
                self.x.label.clone(),
                x,
                self.y.label.clone(),
                y,
            ]);
        }
        rows
    }

    /// Returns curve, label, x and y at each point, followed by the constants.
    fn point_rows(&self) -> Vec<[String; 4]> {
        let series: Vec<Series> = self.marks.iter().flat_map(Series::from_mark).collect();
        rows_of_points(&self.x, &series, &self.constants())
    }

    fn constants(&self) -> Vec<Constant<'_>> {
        self.marks.iter().filter_map(Constant::from_mark).collect()
    }
}

/// Returns name, label, x and y at each point, followed by the constants.
fn rows_of_points(
    x_axis: &Axis,
    series: &[Series],
    constants: &[Constant<'_>],
) -> Vec<[String; 4]> {
    let mut rows = Vec::new();
    for series in series {
        for point in 0..series.count() {
            rows.push([
                series.name.clone(),
                series.label(point).to_owned(),
                x_cell(x_axis, series.x[point]),
                number_cell(series.y[point]),
            ]);
        }
    }
    for constant in constants {
        rows.push([
            constant.name.to_owned(),
            String::new(),
            String::new(),
            number_cell(constant.value),
        ]);
    }
    rows
}

/// The tables for one panel.
struct PanelTables {
    main: Table,
    /// All areas without lines, if any of them is sampled at other x than the first series;
    /// otherwise `None`, and the areas are in `main`.
    areas: Option<Table>,
}

impl PanelTables {
    /// Builds the main table from all marks; areas without lines have a table of their own if any
    /// of them is sampled at other x than the first series.
    fn new(panel: &Panel, plot_title: &str) -> Self {
        let mut main = Vec::new();
        let mut areas = Vec::new();
        for mark in &panel.marks {
            let is_area = matches!(mark, Mark::Envelope(envelope) if envelope.edge.is_none());
            if is_area {
                areas.extend(Series::from_mark(mark));
            } else {
                main.extend(Series::from_mark(mark));
            }
        }
        let title = panel.name(plot_title);
        let mut table_of_areas = None;
        if let Some(first) = main.first()
            && areas.iter().any(|area| area.x != first.x)
        {
            table_of_areas = Some(table(panel, format!("{title}, bands"), &areas, &[]));
        } else {
            main.extend(areas);
        }
        Self {
            main: table(panel, title, &main, &panel.constants()),
            areas: table_of_areas,
        }
    }
}

/// Builds a wide table if all series have the same x and no texts, otherwise a long table.
fn table(panel: &Panel, title: String, series: &[Series], constants: &[Constant<'_>]) -> Table {
    match series.first() {
        Some(first)
            if series
                .iter()
                .all(|next| next.labels.is_none() && next.x == first.x) =>
        {
            wide_table(panel, title, series, constants)
        }
        _ => long_table(panel, title, series, constants),
    }
}

/// Builds `x | first curve [unit] | second curve [unit] | …` from series with the same x.
fn wide_table(
    panel: &Panel,
    title: String,
    series: &[Series],
    constants: &[Constant<'_>],
) -> Table {
    let unit = unit_of(&panel.y.label);
    let mut columns = vec![panel.x.label.clone()];
    columns.extend(series.iter().map(|series| format!("{}{unit}", series.name)));
    for constant in constants {
        columns.push(format!("{}{unit}", constant.name));
    }
    let mut table = Table::new(title, columns);
    let x: &[f64] = match series.first() {
        Some(first) => &first.x,
        None => &[],
    };
    for (point, &x) in x.iter().enumerate() {
        let mut cells = vec![x_cell(&panel.x, x)];
        for series in series {
            let value = series.y.get(point).copied().unwrap_or(f64::NAN);
            cells.push(number_cell(value));
        }
        for constant in constants {
            cells.push(number_cell(constant.value));
        }
        table.row(cells);
    }
    table
}

/// Builds `series | label | x | y`.
fn long_table(
    panel: &Panel,
    title: String,
    series: &[Series],
    constants: &[Constant<'_>],
) -> Table {
    let columns = ["series", "label", &panel.x.label, &panel.y.label];
    let mut table = Table::new(title, columns);
    for row in rows_of_points(&panel.x, series, constants) {
        table.row(row);
    }
    table
}

/// Returns ` [dB]` for `Magnitude [dB]`; empty for a label without a unit.
fn unit_of(label: &str) -> &str {
    label.rfind(" [").map(|at| &label[at..]).unwrap_or_default()
}

/// Formats an x value: on an axis with names the nearest name, otherwise the value.
fn x_cell(axis: &Axis, value: f64) -> String {
    /// Maximum distance between a value and its name; names are 1 apart.
    const NEAREST: f64 = 0.5;
    let mut names = axis.names.iter().flatten();
    match names.find(|(at, _)| (at - value).abs() < NEAREST) {
        Some((_, name)) => name.clone(),
        None => number_cell(value),
    }
}

/// Formats a number at full precision; empty if it is not finite.
fn number_cell(value: f64) -> String {
    full_precision(Some(value))
}

#[cfg(test)]
mod tests {
    use super::super::drawing::{Color, Stroke};
    use super::super::figure::Plot;
    use super::super::marks::{Bars, DotShape, Dots, Rule};
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
