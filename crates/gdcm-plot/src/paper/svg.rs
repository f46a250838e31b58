//! A drawing as SVG 1.1, with lines as paths, text as text, and lengths in points.

use std::fmt::Write;

use gdcm_model::message_text::sanitized;

use crate::figure::Color;
use crate::figure::drawing::{Anchor, Area, Drawing, PT_PER_MM, Shape, Stroke, Text};
use crate::figure::letters::{FONTS, width};

/// Fallback fonts with similar widths, for a viewer without the original fonts.
const OTHER_FONTS: &str = "Helvetica, Arial, sans-serif";

/// Returns the contents of an SVG file.
pub fn svg(drawing: &Drawing) -> String {
    let head = format!(
        "xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" {}",
        size_attributes(drawing)
    );
    element(drawing, &head, "frame")
}

/// Returns the drawing as an element for an HTML page, where the namespace is not needed. `name`
/// prefixes its internal references and must be unique on the page.
pub fn inline_svg(drawing: &Drawing, name: &str) -> String {
    let label = escaped(&sanitized(&drawing.title));
    let head = format!(
        "role=\"img\" aria-label=\"{label}\" {}",
        size_attributes(drawing)
    );
    element(drawing, &head, name)
}

fn size_attributes(drawing: &Drawing) -> String {
    let [width_mm, height_mm] = drawing.size.map(|length| number(length / PT_PER_MM));
    let [width, height] = drawing.size.map(number);
    format!("width=\"{width_mm}mm\" height=\"{height_mm}mm\" viewBox=\"0 0 {width} {height}\"")
}

/// Returns the SVG element; `head` contains its attributes.
fn element(drawing: &Drawing, head: &str, name: &str) -> String {
    let [width, height] = drawing.size;
    let mut svg = Svg {
        text: String::new(),
        name,
        clips: 0,
    };
    svg.line(&format!(
        "<svg {head} font-family=\"{}, {OTHER_FONTS}\" font-weight=\"300\" stroke-linejoin=\"round\">",
        FONTS[0].0,
    ));
    svg.line(&format!(
        "<title>{}</title>",
        escaped(&sanitized(&drawing.title))
    ));
    svg.shape(&Shape::rectangle(
        Area::new(0.0, 0.0, width, height),
        Some(Color::WHITE),
        None,
    ));
    for shape in &drawing.shapes {
        svg.shape(shape);
    }
    svg.line("</svg>");
    svg.text
}

/// An element under construction.
struct Svg<'a> {
    text: String,
    /// Prefix for the names of clip areas.
    name: &'a str,
    /// Number of clip areas so far; a clip area's name ends with its number, counted from 1.
    clips: usize,
}

impl Svg<'_> {
    /// Appends a line to the SVG text.
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn shape(&mut self, shape: &Shape) {
        match shape {
            Shape::Path {
                points,
                closed,
                fill,
                stroke,
            } => {
                let paint = paint(*fill, *stroke);
                self.line(&format!("<path d=\"{}\"{paint}/>", path(points, *closed)));
            }
            Shape::Circle {
                center: [x, y],
                radius,
                fill,
                stroke,
            } => {
                let x = number(*x);
                let y = number(*y);
                let radius = number(*radius);
                self.line(&format!(
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{}/>",
                    paint(*fill, *stroke)
                ));
            }
            Shape::Text(text) => self.text(text),
            Shape::Clipped { area, shapes } => {
                self.clips += 1;
                let Area {
                    left,
                    top,
                    width,
                    height,
                } = *area;
                let [x, y, width, height] = [left, top, width, height].map(number);
                self.line(&format!(
                    "<clipPath id=\"{0}{1}\"><rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/></clipPath>\n\
                     <g clip-path=\"url(#{0}{1})\">",
                    self.name, self.clips
                ));
                for shape in shapes {
                    self.shape(shape);
                }
                self.line("</g>");
            }
        }
    }

    fn text(&mut self, text: &Text) {
        let Text {
            at: [x, y],
            words,
            size_pt,
            anchor,
            upright,
            color,
        } = text;
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let x = number(*x);
        let y = number(*y);
        let size = number(*size_pt);
        let turn = if *upright {
            format!(" transform=\"rotate(-90 {x} {y})\"")
        } else {
            String::new()
        };
        // `textLength` keeps the text as wide as the layout assumed, whatever font the viewer uses.
        let length = number(size_pt * width(words));
        let length = format!(" textLength=\"{length}\" lengthAdjust=\"spacingAndGlyphs\"");
        let color = hex(*color);
        let words = escaped(&sanitized(words));
        self.line(&format!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"{color}\"{anchor}{turn}{length}>{words}</text>"
        ));
    }
}

/// Returns a polyline's path data.
fn path(points: &[[f64; 2]], closed: bool) -> String {
    let mut text = String::new();
    for (index, [x, y]) in points.iter().enumerate() {
        let command = match index {
            0 => "M",
            1 => "L",
            _ => " ",
        };
        // Writing to a string cannot fail.
        let _ = write!(text, "{command}{} {}", number(*x), number(*y));
    }
    if closed {
        text.push('Z');
    }
    text
}

/// Returns the attributes for fill and line.
fn paint(fill: Option<Color>, stroke: Option<Stroke>) -> String {
    let fill = match fill {
        Some(color) => hex(color),
        None => "none".to_owned(),
    };
    let mut text = format!(" fill=\"{fill}\"");
    if let Some(Stroke {
        color,
        width_pt,
        dash,
    }) = stroke
    {
        let _ = write!(
            text,
            " stroke=\"{}\" stroke-width=\"{}\"",
            hex(color),
            number(width_pt)
        );
        if !dash.pattern_pt().is_empty() {
            let lengths: Vec<String> = dash.pattern_pt().iter().copied().map(number).collect();
            let _ = write!(text, " stroke-dasharray=\"{}\"", lengths.join(" "));
        }
    }
    text
}

fn hex(color: Color) -> String {
    let [red, green, blue] = color.rgb();
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Formats a length \[pt\] with at most two decimals, finer than any printer resolves; without
/// trailing zeros, and without a minus sign before zero.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

/// Escapes text for XML. Drops control characters (tabs and line breaks too) and U+FFFE and U+FFFF,
/// which XML 1.0 does not allow.
pub fn escaped(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for character in words.chars() {
        match character {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
            _ if character.is_control() => {}
            _ => text.push(character),
        }
    }
    text
}
