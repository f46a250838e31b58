//! A correction as a module of Python.

use std::fmt::Write;

use super::curve::{Curve, Language, number, python_text};
use super::scheduled_correction::{ScheduledChannel, ScheduledCorrection};
use super::{About, Export, ExportFault, Exported, Exporter};

/// The module.
pub(super) struct PythonModule;

impl Exporter for PythonModule {
    fn about(&self) -> About {
        About { name: "py", extension: "py", words: "Python module, a function of airspeed", options: &[] }
    }

    fn export<'e>(&self, of: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
        let correction = of.scheduled()?;
        Ok(Exported::bytes(python_module(&correction)?).with(correction.notes))
    }
}

const LANGUAGE: Language =
    Language { exp: "math.exp", min: "min", max: "max", polynomial: "_polynomial", table: "_table" };

/// What the module needs to compute curves.
const CURVES: &str = r#"

def _polynomial(coefficients, v):
    value = 0.0
    for coefficient in reversed(coefficients):
        value = value * v + coefficient
    return value


def _table(points, values, x):
    if x <= points[0]:
        return values[0]
    for k in range(1, len(points)):
        if x < points[k]:
            part = (x - points[k - 1]) / (points[k] - points[k - 1])
            return values[k - 1] + part * (values[k] - values[k - 1])
    return values[-1]


def _diagonal(values):
    return [[value if row == column else 0.0 for column in range(len(values))] for row, value in enumerate(values)]


def gdcm_correction(airspeed_kt@):
    """Gain matrices Mi and Mo (lists of rows), delays tau_i and tau_o in seconds, at an airspeed in knots."""
    if airspeed_kt != airspeed_kt:
        raise ValueError("the airspeed is not a number")
    a = min(max(float(airspeed_kt), AIRSPEED_RANGE_KT[0]), AIRSPEED_RANGE_KT[1])
"#;

/// The time constants of the lead filters.
const LEADS: &str = r#"

def gdcm_leads(airspeed_kt):
    """Time constants a in seconds of the inputs' and of the outputs' lead filters, at an airspeed in knots; b is LEAD_LAG_S."""
    if airspeed_kt != airspeed_kt:
        raise ValueError("the airspeed is not a number")
    a = min(max(float(airspeed_kt), AIRSPEED_RANGE_KT[0]), AIRSPEED_RANGE_KT[1])
"#;

/// A lead filter as states (M15.3).
const LEAD_STATES: &str = r#"

def gdcm_lead_state_space(zero_s):
    """Matrices A, B, C, D (lists of rows) of the lead filter whose numerator has the time constant zero_s."""
    w1, w2 = 1.0 / zero_s, 1.0 / LEAD_LAG_S
    r = (zero_s / LEAD_LAG_S) ** LEAD_ORDER
    if LEAD_ORDER == 1:
        return [[-w2]], [[1.0]], [[r * (w1 - w2)]], [[r]]
    root = math.sqrt(2.0)
    return [[0.0, 1.0], [-w2 * w2, -root * w2]], [[0.0], [1.0]], [[r * (w1 * w1 - w2 * w2), r * root * (w1 - w2)]], [[r]]
"#;

/// Writes a module with the function `gdcm_correction(airspeed_kt)`, which gives `(Mi, Mo, tau_i, tau_o)`; of a correction with leads
/// also `gdcm_leads(airspeed_kt)` and `gdcm_lead_state_space(zero_s)`. It needs nothing but `math`.
pub fn python_module(correction: &ScheduledCorrection) -> Result<String, ExportFault> {
    correction.check()?;
    let mut text = correction.comment_lines("#");
    let names = |channels: &[ScheduledChannel]| -> String {
        channels.iter().map(|channel| format!("    {},\n", python_text(&channel.name))).collect()
    };
    let (least, most) = correction.airspeed_range_kt;
    let _ = write!(text, "\nimport math\n\nINPUTS = [\n{}]\n", names(&correction.inputs));
    let _ = write!(text, "OUTPUTS = [\n{}]\n", names(&correction.outputs));
    let _ = writeln!(text, "AIRSPEED_RANGE_KT = ({}, {})", number(least), number(most));
    if let Some(second) = &correction.second {
        let (least, most) = second.range;
        let _ = writeln!(text, "{}_RANGE = ({}, {})", second.name.to_uppercase(), number(least), number(most));
    }
    text.push_str(&CURVES.replacen('@', &correction.second_argument(""), 1));
    let _ = writeln!(text, "    v = {}", correction.scaled_expression());
    if let Some(second) = &correction.second {
        let (name, range) = (second.name, format!("{}_RANGE", second.name.to_uppercase()));
        let _ = write!(
            text,
            "    if {name} != {name}:\n        raise ValueError(\"the {} is not a number\")\n    \
             b = min(max(float({name}), {range}[0]), {range}[1])\n    z = {}\n",
            second.words,
            second.scaled_expression(),
        );
    }
    let curves = |channels: &[ScheduledChannel], of: fn(&ScheduledChannel) -> &Curve| -> String {
        channels.iter().map(|channel| format!("        {},\n", LANGUAGE.in_brackets(of(channel)))).collect()
    };
    for (name, channels) in [("i", &correction.inputs), ("o", &correction.outputs)] {
        let _ = write!(text, "    gain_{name} = [\n{}    ]\n", curves(channels, |channel| &channel.gain));
        let _ = write!(text, "    tau_{name} = [\n{}    ]\n", curves(channels, |channel| &channel.delay_s));
    }
    text.push_str("    return _diagonal(gain_i), _diagonal(gain_o), tau_i, tau_o\n");
    if let Some(lead) = correction.lead {
        let _ = write!(text, "\n\nLEAD_ORDER = {}\nLEAD_LAG_S = {}\n{LEADS}", lead.order, number(lead.lag_s));
        let _ = writeln!(text, "    v = {}", correction.scaled_expression());
        for (name, channels) in [("i", &correction.inputs), ("o", &correction.outputs)] {
            let zeros = channels.iter().filter_map(|channel| channel.zero_s.as_ref());
            let zeros: String = zeros.map(|zero_s| format!("        {},\n", LANGUAGE.in_brackets(zero_s))).collect();
            let _ = write!(text, "    zero_{name} = [\n{zeros}    ]\n");
        }
        text.push_str("    return zero_i, zero_o\n");
        text.push_str(LEAD_STATES);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::super::scheduled_correction::tests::{NASTY, airspeeds, assert_printed, example};
    use super::*;

    #[test]
    fn the_module_computes_what_the_correction_says() {
        let Ok(found) = Command::new("python3").arg("--version").output() else {
            eprintln!("SKIPPED: python3 is not installed");
            return;
        };
        assert!(found.status.success());
        let correction = example();
        let names: Vec<String> = NASTY.iter().map(|name| format!("{:?}", name.as_bytes())).collect();
        let program = format!(
            "{}\nassert [list(name.encode()) for name in INPUTS + OUTPUTS] == [{}]\n\
             for airspeed in {:?}:\n    mi, mo, ti, to = gdcm_correction(airspeed)\n    \
             assert mi[0][1] == 0.0 and len(mi) == 2 and len(mo) == 1\n    \
             print(*[repr(x) for x in [mi[0][0], mi[1][1], mo[0][0]] + ti + to])\n",
            python_module(&correction).unwrap(),
            names.join(","),
            airspeeds(),
        );
        let output = Command::new("python3").args(["-c", &program]).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert_printed(&correction, &String::from_utf8(output.stdout).unwrap());
    }
}
