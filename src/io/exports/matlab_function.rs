//! A correction as a function file of MATLAB and Octave.

use std::fmt::Write;

use super::curve::Curve;
use super::export_fault::ExportFault;
use super::number::{list, number};
use super::python_module::heading;
use super::quoted::comment;
use super::scheduled_correction::{ScheduledChannel, ScheduledCorrection};

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

/// Writes the file `gdcm_correction.m` with the function `[Mi, Mo, tau_i, tau_o] = gdcm_correction(airspeed_kt)`: diagonal
/// matrices of gains, columns of delays \[s\].
pub fn matlab_function(correction: &ScheduledCorrection) -> Result<String, ExportFault> {
    correction.check()?;
    let mut text = String::from("function [Mi, Mo, tau_i, tau_o] = gdcm_correction(airspeed_kt)\n");
    text.push_str("%GDCM_CORRECTION Gain matrices Mi and Mo, delays tau_i and tau_o [s] at an airspeed [kt].\n");
    for line in heading(correction) {
        let _ = writeln!(text, "% {line}");
    }
    for (side, channels) in [("Input", &correction.inputs), ("Output", &correction.outputs)] {
        for (index, channel) in channels.iter().enumerate() {
            let _ = writeln!(text, "% {side} {}: {}", index + 1, comment(&channel.name));
        }
    }
    let (least, most) = correction.airspeed_range_kt;
    let (mean, half) = (number(correction.airspeed_mean_kt), number(correction.airspeed_half_range_kt));
    let _ = write!(
        text,
        "  if ~(isscalar(airspeed_kt) && isreal(airspeed_kt)) || isnan(airspeed_kt)\n    \
         error('gdcm:airspeed', 'The airspeed must be one real number.');\n  end\n  \
         a = min(max(double(airspeed_kt), {}), {});\n  v = (a - ({mean})) / {half};\n",
        number(least),
        number(most),
    );
    for (name, channels) in [("i", &correction.inputs), ("o", &correction.outputs)] {
        let count = channels.len();
        let _ = write!(text, "  M{name} = zeros({count}, {count});\n  tau_{name} = zeros({count}, 1);\n");
        for (index, channel) in channels.iter().enumerate() {
            write_channel(&mut text, name, index + 1, channel);
        }
    }
    text.push_str("end\n");
    text.push_str(TABLE);
    Ok(text)
}

fn write_channel(text: &mut String, side: &str, place: usize, channel: &ScheduledChannel) {
    let _ = writeln!(text, "  M{side}({place}, {place}) = {};", expression(&channel.gain));
    let _ = writeln!(text, "  tau_{side}({place}) = {};", expression(&channel.delay_s));
}

fn expression(curve: &Curve) -> String {
    match curve {
        Curve::Polynomial { of_logarithm, coefficients, least, most } => {
            let sum = format!("gdcm_polynomial([{}], v)", list(coefficients));
            let value = if *of_logarithm { format!("exp({sum})") } else { sum };
            let value = least.map_or(value.clone(), |least| format!("max({value}, {})", number(least)));
            most.map_or(value.clone(), |most| format!("min({value}, {})", number(most)))
        }
        Curve::Table { airspeed_kt, values } => format!("gdcm_table([{}], [{}], a)", list(airspeed_kt), list(values)),
        Curve::Constant(value) => number(*value),
    }
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
        let folder = std::env::temp_dir().join(format!("gdcm-matlab-function-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("gdcm_correction.m"), matlab_function(&correction).unwrap()).unwrap();
        let speeds: Vec<String> = airspeeds().iter().map(f64::to_string).collect();
        let program = format!(
            "for s = [{}], [Mi, Mo, ti, to] = gdcm_correction(s); \
             printf('%.17g ', [diag(Mi); diag(Mo); ti; to]); end",
            speeds.join(",")
        );
        let output = Command::new("octave-cli").args(["--eval", &program]).current_dir(&folder).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_printed(&correction, &String::from_utf8(output.stdout).unwrap());
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn every_line_that_is_no_code_is_a_comment() {
        let text = matlab_function(&example()).unwrap();
        assert!(text.is_ascii());
        let code = ["function ", "  ", "end", "%"];
        for line in text.lines().filter(|line| !line.is_empty()) {
            assert!(code.iter().any(|start| line.starts_with(start)), "{line}");
            assert!(!matches!(line.trim(), "%{" | "%}"));
        }
        assert_eq!(text.lines().filter(|line| line.starts_with("% Input")).count(), 2);
    }
}
