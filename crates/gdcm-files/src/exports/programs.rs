//! The schedule as a function in other programming languages: a template for each, and how it writes numbers and texts.

use std::io;
use std::path::Path;

use gdcm_core::correction::Channel;
use gdcm_core::couplings::CouplingMatrices;
use gdcm_core::schedule::Regression;
use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, Value, context};

use super::matlab_struct::LONGEST_NAME;
use super::scheduled::{Curve, Scheduled, number};
use super::{About, Export, ExportFault, Exported, Exporter};
use crate::figure::all_channels;

/// A file in a programming language.
pub(super) struct Program {
    about: About,
    template: &'static str,
    language: Language,
}

/// How a language writes the value of a curve.
struct Language {
    exp: &'static str,
    min: &'static str,
    max: &'static str,
    /// Of coefficients and the scaled airspeed `v`.
    polynomial: &'static str,
    /// Of airspeeds, values and the airspeed `a`.
    table: &'static str,
    /// Whether a list of numbers is an array that is declared before; otherwise it stands in square brackets.
    declares_arrays: bool,
    /// A text between quotes, where the file holds the names of channels.
    text: fn(&str) -> String,
    /// Whether a function is called by the name of its file.
    is_called_by_its_file: bool,
}

/// The programs, in the order of their list.
pub(super) static PROGRAMS: [Program; 3] = [
    Program {
        about: About { name: "m", extension: "m", words: "MATLAB function of airspeed", options: &[] },
        template: include_str!("templates/matlab_function.m.jinja"),
        language: Language {
            exp: "exp",
            min: "min",
            max: "max",
            polynomial: "gdcm_polynomial",
            table: "gdcm_table",
            declares_arrays: false,
            text: comment,
            is_called_by_its_file: true,
        },
    },
    Program {
        about: About { name: "py", extension: "py", words: "Python module, a function of airspeed", options: &[] },
        template: include_str!("templates/python_module.py.jinja"),
        language: Language {
            exp: "math.exp",
            min: "min",
            max: "max",
            polynomial: "_polynomial",
            table: "_table",
            declares_arrays: false,
            text: python_text,
            is_called_by_its_file: false,
        },
    },
    Program {
        about: About { name: "h", extension: "h", words: "C header, a function of airspeed", options: &[] },
        template: include_str!("templates/c_header.h.jinja"),
        language: Language {
            exp: "exp",
            min: "fmin",
            max: "fmax",
            polynomial: "GDCM_POLYNOMIAL",
            table: "GDCM_TABLE",
            declares_arrays: true,
            text: c_text,
            is_called_by_its_file: false,
        },
    },
];

impl Exporter for Program {
    fn about(&self) -> About {
        self.about
    }

    fn check_path(&self, path: &Path) -> Result<(), ExportFault> {
        if self.language.is_called_by_its_file { check_function_name(&stem(path)) } else { Ok(()) }
    }

    fn export<'e>(&'e self, of: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
        let scheduled = of.scheduled()?;
        scheduled.check()?;
        let name = stem(of.path);
        let write = move |file: &mut dyn io::Write| file.write_all(self.text(&scheduled, &name)?.as_bytes());
        Ok(Exported::new(write).with(scheduled.notes_of_curves()))
    }
}

impl Program {
    /// The text of the file; `name` is that of the file without its ending.
    pub(super) fn text(&self, of: &Scheduled<'_>, name: &str) -> io::Result<String> {
        let airspeeds = &of.schedule.airspeeds;
        let second = of.schedule.second.as_ref().map(|term| {
            let name = format!("{}_{}", term.variable.name(), term.variable.unit());
            context! {
                capitals => name.to_uppercase(),
                name,
                words => format!("{} [{}]", term.variable.name(), term.variable.unit()),
                least => number(term.range[0]),
                most => number(term.range[1]),
                scaled => format!("(b - ({})) / {}", number(term.middle()), number(term.half_range())),
            }
        });
        let lead = of.schedule.leads.as_ref().map(|leads| {
            context! {
                order => leads.design.settings().order.number(),
                lag_s => number(leads.design.lag_s()),
                limit_rad_s => number(leads.design.band_top_rad_s()),
            }
        });
        let is_input = |channel: &Channel| matches!(channel, Channel::Input(_));
        let (inputs, outputs) = all_channels(of.dataset).into_iter().partition::<Vec<_>, _>(is_input);
        let values = context! {
            name,
            capitals => name.to_ascii_uppercase(),
            heading => of.heading(&of.notes_of_curves()),
            least => number(airspeeds.min_kt),
            most => number(airspeeds.max_kt),
            scaled => match airspeeds.half_range_kt {
                0.0 => number(0.0),
                half_range_kt => format!("(a - ({})) / {}", number(airspeeds.mean_kt), number(half_range_kt)),
            },
            second,
            lead,
            couplings => of.couplings.map(|couplings| self.couplings(couplings)),
            sides => vec![self.side(of, "Input", &inputs), self.side(of, "Output", &outputs)],
        };
        let mut environment = Environment::new();
        let whole_lines =
            SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true).build();
        environment.set_syntax(whole_lines.map_err(io::Error::other)?);
        environment.render_str(self.template, values).map_err(io::Error::other)
    }

    /// `M~(V)` of the airspeed `V` clamped and scaled as the couplings take it, and `K`, row by row.
    fn couplings(&self, of: &CouplingMatrices) -> Value {
        let airspeeds = of.airspeeds();
        let (inputs, outputs) = of.feedback().shape();
        let curve = |to, from| self.language.expression(&Curve::plain(of.mixing_curve(to, from).clone()));
        let mixing = |to: usize| {
            let entry = |from: usize| {
                context! { column => from, own => curve(to, from), of => curve(from, from), is_unit => to == from }
            };
            (0..inputs).map(entry).collect::<Vec<_>>()
        };
        let feedback =
            |to: usize| (0..outputs).map(|from| number(of.feedback()[(to, from)])).collect::<Vec<_>>().join(", ");
        context! {
            least => number(airspeeds.min_kt),
            most => number(airspeeds.max_kt),
            scaled => match airspeeds.half_range_kt {
                0.0 => number(0.0),
                half_range_kt => format!("(a - ({})) / {}", number(airspeeds.mean_kt), number(half_range_kt)),
            },
            mixing => (0..inputs).map(mixing).collect::<Vec<_>>(),
            feedback => (0..inputs).map(feedback).collect::<Vec<_>>(),
            inputs,
            outputs,
        }
    }

    fn side(&self, of: &Scheduled<'_>, capital: &str, channels: &[Channel]) -> Value {
        let (inputs, outputs) = of.dataset.names_of_channels();
        let entry = |(index, &channel): (usize, &Channel)| {
            let name = channel.name(&inputs, &outputs);
            context! {
                index,
                number => index + 1,
                text => (self.language.text)(&name),
                comment => comment(&name),
                gain => self.language.expression(&of.gain(channel)),
                delay => self.language.expression(&of.delay_s(channel)),
                zero => of.zero_s(channel).map(|zero_s| self.language.expression(&zero_s)),
            }
        };
        let lower = capital.to_lowercase();
        context! {
            capital,
            capitals => capital.to_uppercase(),
            short => lower.trim_end_matches("put"),
            letter => &lower[..1],
            count => channels.len(),
            channels => channels.iter().enumerate().map(entry).collect::<Vec<_>>(),
        }
    }
}

impl Language {
    /// The value of a curve at the airspeed `a`, the scaled airspeed `v` and the scaled second variable `z`, with the arrays `c0`, `c1`
    /// and so on that it takes.
    fn expression(&self, curve: &Curve) -> Value {
        let mut arrays = Vec::new();
        let mut array = |numbers: &[f64]| {
            let numbers = numbers.iter().map(|&value| number(value)).collect::<Vec<_>>().join(", ");
            if !self.declares_arrays {
                return format!("[{numbers}]");
            }
            arrays.push(numbers);
            format!("c{}", arrays.len() - 1)
        };
        let mut figures = |of: &Regression| match of {
            Regression::Polynomial { coefficients } if coefficients.len() == 1 => number(coefficients[0]),
            Regression::Polynomial { coefficients } => format!("{}({}, v)", self.polynomial, array(coefficients)),
            Regression::Table { airspeeds_kt, values } => {
                format!("{}({}, {}, a)", self.table, array(airspeeds_kt), array(values))
            }
        };
        let mut value = figures(&curve.figures);
        if let Some(slope) = curve.slope {
            value = format!("{value} + ({}) * z", number(slope));
        }
        if curve.of_logarithm {
            value = format!("{}({value})", self.exp);
        }
        if let Some(upper) = &curve.upper {
            value = format!("{}({}({value}, {}), {})", self.max, self.min, figures(upper), number(0.0));
        }
        context! { arrays, value }
    }
}

/// The name of a file without its ending.
fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// What MATLAB (`iskeyword`) and GNU Octave keep for themselves, and the functions in the file.
const KEYWORDS: [&str; 34] = [
    "break",
    "case",
    "catch",
    "classdef",
    "continue",
    "do",
    "else",
    "elseif",
    "end",
    "end_try_catch",
    "end_unwind_protect",
    "endfor",
    "endfunction",
    "endif",
    "endparfor",
    "endswitch",
    "endwhile",
    "for",
    "function",
    "global",
    "if",
    "otherwise",
    "parfor",
    "persistent",
    "return",
    "spmd",
    "switch",
    "try",
    "until",
    "unwind_protect",
    "unwind_protect_cleanup",
    "while",
    "gdcm_polynomial",
    "gdcm_table",
];

/// Refuses a name that no function of a file of MATLAB can have.
fn check_function_name(name: &str) -> Result<(), ExportFault> {
    let is_name = name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.len() <= LONGEST_NAME
        && name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if is_name && !KEYWORDS.contains(&name) {
        return Ok(());
    }
    Err(ExportFault::FunctionName { found: name.to_owned() })
}

/// A text for a comment of any language: visible characters of ASCII, the signs of the program's own words by what stands for them
/// there, all others by their numbers in Unicode, and nothing that ends or begins a comment.
pub(super) fn comment(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            // Two characters that begin or end comments, continue lines or are written otherwise never stand together.
            '*' | '/' | '\\' | '?' | '%' | '{' | '}' | '"' | '\''
                if plain.ends_with(['*', '/', '?', '%', '"', '\'']) =>
            {
                plain.push(' ');
                plain.push(character);
            }
            ' '..='~' => plain.push(character),
            '\u{2212}' | '\u{2013}' => plain.push('-'),
            '±' => plain.push_str("+-"),
            '≈' => plain.push('~'),
            '²' => plain.push_str("^2"),
            '°' => plain.push_str("deg"),
            'α' => plain.push_str("alpha"),
            'τ' => plain.push_str("tau"),
            _ => plain.push_str(&format!("<U+{:04X}>", u32::from(character))),
        }
    }
    // A line of a comment that ends in a backslash goes on in the next.
    if plain.ends_with('\\') {
        plain.push('.');
    }
    plain
}

/// A text between double quotes for C: bytes that are no plain characters as three octal digits.
fn c_text(text: &str) -> String {
    let escaped = |byte: u8| match byte {
        // A question mark could begin a trigraph.
        b'"' | b'\\' | b'?' | 0..0x20 | 0x7f.. => format!("\\{byte:03o}"),
        _ => char::from(byte).to_string(),
    };
    format!("\"{}\"", text.bytes().map(escaped).collect::<String>())
}

/// A text between double quotes for Python.
fn python_text(text: &str) -> String {
    let escaped = |character: char| match character {
        '"' | '\\' => format!("\\{character}"),
        ' '..='~' => character.to_string(),
        _ => format!("\\U{:08x}", u32::from(character)),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}
