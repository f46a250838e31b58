//! A correction as a function file of MATLAB and Octave.

use std::fmt::Write;
use std::path::Path;

use super::curve::{Language, comment, number};
use super::matlab_struct::LONGEST_NAME;
use super::scheduled_correction::{ScheduledChannel, ScheduledCorrection};
use super::{About, Export, ExportFault, Exported, Exporter};

/// The function file, whose name is that of the function.
pub(super) struct MatlabFunction;

impl Exporter for MatlabFunction {
    fn about(&self) -> About {
        About { name: "m", extension: "m", words: "MATLAB function of airspeed", options: &[] }
    }

    fn check_path(&self, path: &Path) -> Result<(), ExportFault> {
        check_function_name(&stem(path))
    }

    fn export<'e>(&self, of: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
        let correction = of.scheduled()?;
        Ok(Exported::bytes(matlab_function(&correction, &stem(of.path))?).with(correction.notes))
    }
}

/// The name of a file without its ending.
fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

const LANGUAGE: Language =
    Language { exp: "exp", min: "min", max: "max", polynomial: "gdcm_polynomial", table: "gdcm_table" };

/// The functions below, whose names the file cannot have.
const HELPERS: [&str; 2] = [LANGUAGE.polynomial, LANGUAGE.table];

/// Linear between the points, the end value outside; `interp1` refuses a table of one point.
const TABLE: &str = "
function y = gdcm_table(points, values, x)
  k = find(points <= x, 1, 'last');
  if isempty(k)
    y = values(1);
  elseif k == numel(points)
    y = values(k);
  else
    y = values(k) + (x - points(k)) / (points(k + 1) - points(k)) * (values(k + 1) - values(k));
  end
end

function y = gdcm_polynomial(coefficients, v)
  y = 0;
  for k = numel(coefficients):-1:1
    y = y * v + coefficients(k);
  end
end
";

/// Writes the file `name.m` with the function `[Mi, Mo, tau_i, tau_o] = name(airspeed_kt)`: diagonal matrices of gains, columns of
/// delays \[s\]; of a correction with leads followed by `lead_i, lead_o`, time constants \[s\] of the filters. MATLAB calls a function by the name of its file.
///
/// # Errors
/// [`ExportFault::FunctionName`] where MATLAB could not.
pub fn matlab_function(correction: &ScheduledCorrection, name: &str) -> Result<String, ExportFault> {
    correction.check()?;
    check_function_name(name)?;
    let second = correction.second.as_ref();
    let argument = correction.second_argument("");
    let leads = if correction.lead.is_some() { ", lead_i, lead_o" } else { "" };
    let mut text = format!("function [Mi, Mo, tau_i, tau_o{leads}] = {name}(airspeed_kt{argument})\n");
    let _ = writeln!(
        text,
        "%{} Gain matrices Mi and Mo, delays tau_i and tau_o [s] at an airspeed [kt].",
        name.to_ascii_uppercase()
    );
    text.push_str(&correction.comment_lines("%"));
    if let Some(lead) = correction.lead {
        let tf = match lead.order {
            1 => "tf([a 1], [b 1])",
            _ => "tf([a^2 sqrt(2)*a 1], [b^2 sqrt(2)*b 1])",
        };
        let _ = writeln!(text, "% Rows of lead_i and lead_o: [a b] in seconds, the filter {tf}.");
    }
    for (side, channels) in [("Input", &correction.inputs), ("Output", &correction.outputs)] {
        for (index, channel) in channels.iter().enumerate() {
            let _ = writeln!(text, "% {side} {}: {}", index + 1, comment(&channel.name));
        }
    }
    let (least, most) = correction.airspeed_range_kt;
    let _ = write!(
        text,
        "  if ~(isscalar(airspeed_kt) && isreal(airspeed_kt)) || isnan(airspeed_kt)\n    \
         error('gdcm:airspeed', 'The airspeed must be one real number.');\n  end\n  \
         a = min(max(double(airspeed_kt), {}), {});\n  v = {};\n",
        number(least),
        number(most),
        correction.scaled_expression(),
    );
    if let Some(second) = second {
        let (least, most) = second.range;
        let _ = write!(
            text,
            "  if ~(isscalar({0}) && isreal({0})) || isnan({0})\n    \
             error('gdcm:second', 'The {1} must be one real number.');\n  end\n  \
             b = min(max(double({0}), {2}), {3});\n  z = {4};\n",
            second.name,
            second.words,
            number(least),
            number(most),
            second.scaled_expression(),
        );
    }
    for (name, channels) in [("i", &correction.inputs), ("o", &correction.outputs)] {
        let count = channels.len();
        let _ = write!(text, "  M{name} = zeros({count}, {count});\n  tau_{name} = zeros({count}, 1);\n");
        for (index, channel) in channels.iter().enumerate() {
            write_channel(&mut text, name, index + 1, channel);
        }
        if let Some(lead) = correction.lead {
            let _ = writeln!(text, "  lead_{name} = repmat({}, {count}, 2);", number(lead.lag_s));
            for (index, zero_s) in channels.iter().enumerate().filter_map(|(at, of)| Some((at, of.zero_s.as_ref()?))) {
                let _ = writeln!(text, "  lead_{name}({}, 1) = {};", index + 1, LANGUAGE.in_brackets(zero_s));
            }
        }
    }
    text.push_str("end\n");
    text.push_str(TABLE);
    Ok(text)
}

/// Refuses a name that no function of a file can have.
fn check_function_name(name: &str) -> Result<(), ExportFault> {
    let is_name = name.starts_with(|first: char| first.is_ascii_alphabetic())
        && name.len() <= LONGEST_NAME
        && name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    if !is_name || HELPERS.contains(&name) {
        return Err(ExportFault::FunctionName { found: name.to_owned() });
    }
    Ok(())
}

fn write_channel(text: &mut String, side: &str, place: usize, channel: &ScheduledChannel) {
    let _ = writeln!(text, "  M{side}({place}, {place}) = {};", LANGUAGE.in_brackets(&channel.gain));
    let _ = writeln!(text, "  tau_{side}({place}) = {};", LANGUAGE.in_brackets(&channel.delay_s));
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::super::scheduled_correction::tests::{airspeeds, assert_printed, example};
    use super::*;

    #[test]
    fn the_function_computes_what_the_correction_says() {
        if Command::new("octave-cli").arg("--version").output().is_err() {
            eprintln!("SKIPPED: octave-cli is not installed, the function for MATLAB is not run");
            return;
        }
        let correction = example();
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(
            folder.path().join("gdcm_correction.m"),
            matlab_function(&correction, "gdcm_correction").unwrap(),
        )
        .unwrap();
        let speeds: Vec<String> = airspeeds().iter().map(f64::to_string).collect();
        let program = format!(
            "for s = [{}], [Mi, Mo, ti, to] = gdcm_correction(s); \
             printf('%.17g ', [diag(Mi); diag(Mo); ti; to]); end",
            speeds.join(",")
        );
        let output = Command::new("octave-cli").args(["--eval", &program]).current_dir(&folder).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_printed(&correction, &String::from_utf8(output.stdout).unwrap());
    }

    #[test]
    fn every_line_that_is_no_code_is_a_comment() {
        let text = matlab_function(&example(), "gdcm_correction").unwrap();
        assert!(text.is_ascii());
        let code = ["function ", "  ", "end", "%"];
        for line in text.lines().filter(|line| !line.is_empty()) {
            assert!(code.iter().any(|start| line.starts_with(start)), "{line}");
            assert!(!matches!(line.trim(), "%{" | "%}"));
        }
        assert_eq!(text.lines().filter(|line| line.starts_with("% Input")).count(), 2);
    }

    #[test]
    fn a_name_that_matlab_cannot_call_is_refused() {
        for name in ["", "2nd", "my-study", "gdcm_table", "\u{e9}t\u{e9}", &"x".repeat(64)] {
            let refused = matlab_function(&example(), name);
            assert_eq!(refused, Err(ExportFault::FunctionName { found: name.to_owned() }));
        }
        assert!(matlab_function(&example(), "k2_v").unwrap().starts_with("function [Mi, Mo, tau_i, tau_o] = k2_v("));
    }
}
