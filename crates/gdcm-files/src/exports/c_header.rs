//! A correction as a header of C.

use std::fmt::Write;

use super::curve::{Curve, Language, c_text, comment, list, number};
use super::scheduled_correction::{ScheduledChannel, ScheduledCorrection};
use super::{About, Export, ExportFault, Exported, Exporter};

/// The header.
pub(super) struct CHeader;

impl Exporter for CHeader {
    fn about(&self) -> About {
        About { name: "h", extension: "h", words: "C header, a function of airspeed", options: &[] }
    }

    fn export<'e>(&self, of: &Export<'e>) -> Result<Exported<'e>, ExportFault> {
        let correction = of.scheduled()?;
        Ok(Exported::bytes(c_header(&correction)?).with(correction.notes))
    }
}

const LANGUAGE: Language =
    Language { exp: "exp", min: "fmin", max: "fmax", polynomial: "GDCM_POLYNOMIAL", table: "GDCM_TABLE" };

/// What the function needs to interpolate.
const TABLE: &str = "
static inline double gdcm_table(int count, const double points[], const double values[], double x)
{
    int k;
    if (x <= points[0]) {
        return values[0];
    }
    for (k = 1; k < count; k++) {
        if (x < points[k]) {
            double part = (x - points[k - 1]) / (points[k] - points[k - 1]);
            return values[k - 1] + part * (values[k] - values[k - 1]);
        }
    }
    return values[count - 1];
}

static inline double gdcm_polynomial(int count, const double coefficients[], double v)
{
    double value = 0.0;
    int k;
    for (k = count - 1; k >= 0; k--) {
        value = value * v + coefficients[k];
    }
    return value;
}

#define GDCM_TABLE(p, y, x) gdcm_table((int)(sizeof(p) / sizeof(*(p))), (p), (y), (x))
#define GDCM_POLYNOMIAL(c, v) gdcm_polynomial((int)(sizeof(c) / sizeof(*(c))), (c), (v))

/* Gains and delays [s] at an airspeed [kt]@words. Gives 0, or 1 where an argument was clamped to its range, or -1 and no values
 * where one is not a number. */
static inline int gdcm_correction(double airspeed_kt@argument, double gain_in[], double gain_out[], double delay_in[],
                                  double delay_out[])
{
";

/// The time constants of the lead filters.
const LEADS: &str = "
/* Time constants a [s] of the lead filters at an airspeed [kt]; b is GDCM_LEAD_LAG_S. Gives what gdcm_correction gives. */
static inline int gdcm_leads(double airspeed_kt, double zero_in[], double zero_out[])
{
";

/// One step of a lead filter by Tustin's rule, in the transposed direct form II.
const LEAD_STEP: &str = "
/* What a lead filter remembers; all zero at rest. */
struct gdcm_lead {
    double s1;
    double s2;
};

/* One step of step_s seconds (at most half of GDCM_LEAD_LAG_S) of the lead filter whose time constant is a = zero_s. */
static inline double gdcm_lead_step(struct gdcm_lead *lead, double zero_s, double step_s, double u)
{
    const double root = GDCM_LEAD_ORDER == 1 ? 1.0 : 1.4142135623730951;
    const double square = GDCM_LEAD_ORDER == 1 ? 0.0 : 1.0;
    double p = 2.0 * zero_s / step_s, q = 2.0 * GDCM_LEAD_LAG_S / step_s;
    double n0 = 1.0 + root * p + square * p * p, n1 = 2.0 - 2.0 * square * p * p, n2 = 1.0 - root * p + square * p * p;
    double d0 = 1.0 + root * q + square * q * q, d1 = 2.0 - 2.0 * square * q * q, d2 = 1.0 - root * q + square * q * q;
    double y;
    if (GDCM_LEAD_ORDER == 1) {
        n1 = n2;
        d1 = d2;
        n2 = 0.0;
        d2 = 0.0;
    }
    y = (n0 * u + lead->s1) / d0;
    lead->s1 = n1 * u - d1 * y + lead->s2;
    lead->s2 = n2 * u - d2 * y;
    return y;
}
";

/// Writes a header with the function `gdcm_correction`, which fills arrays of gains and delays \[s\] (C99, `-lm`); of a correction with
/// leads also `gdcm_leads` and `gdcm_lead_step`.
pub fn c_header(correction: &ScheduledCorrection) -> Result<String, ExportFault> {
    correction.check()?;
    let mut text = format!("/*\n{}", correction.comment_lines(" *"));
    text.push_str(" */\n#ifndef GDCM_CORRECTION_H\n#define GDCM_CORRECTION_H\n\n#include <math.h>\n\n");
    for (side, channels) in [("INPUT", &correction.inputs), ("OUTPUT", &correction.outputs)] {
        let _ = writeln!(text, "#define GDCM_{side}_COUNT {}", channels.len());
        for (index, channel) in channels.iter().enumerate() {
            let _ = writeln!(text, "#define GDCM_{side}_NAME_{index} {}", c_text(&channel.name));
        }
    }
    let second = correction.second.as_ref();
    let argument = correction.second_argument("double ");
    let words = second.map_or_else(String::new, |second| format!(" and a second variable, {}", second.words));
    text.push_str(&TABLE.replacen("@words", &words, 1).replacen("@argument", &argument, 1));
    let (least, most) = correction.airspeed_range_kt;
    let (least, most) = (number(least), number(most));
    let scaled = correction.scaled_expression();
    let _ = write!(
        text,
        "    double a = airspeed_kt < {least} ? {least} : (airspeed_kt > {most} ? {most} : airspeed_kt);\n    \
         double v = {scaled};\n    \
         if (airspeed_kt != airspeed_kt) {{\n        return -1;\n    }}\n    \
         (void)v;\n    (void)gain_in;\n    (void)gain_out;\n    (void)delay_in;\n    (void)delay_out;\n"
    );
    let mut clamped = "a != airspeed_kt".to_owned();
    if let Some(second) = second {
        let ((least, most), name) = (second.range, second.name);
        let (least, most) = (number(least), number(most));
        let _ = write!(
            text,
            "    const double b = {name} < {least} ? {least} : ({name} > {most} ? {most} : {name});\n    \
             const double z = {};\n    if ({name} != {name}) {{\n        return -1;\n    }}\n    (void)z;\n",
            second.scaled_expression(),
        );
        clamped.push_str(&format!(" || b != {name}"));
    }
    for (side, channels) in [("in", &correction.inputs), ("out", &correction.outputs)] {
        for (index, channel) in channels.iter().enumerate() {
            write_channel(&mut text, side, index, channel);
        }
    }
    let _ = write!(text, "    return {clamped};\n}}\n");
    if let Some(lead) = correction.lead {
        let _ = write!(
            text,
            "\n#define GDCM_LEAD_ORDER {}\n#define GDCM_LEAD_LAG_S {}\n{LEADS}    \
             double a = airspeed_kt < {least} ? {least} : (airspeed_kt > {most} ? {most} : airspeed_kt);\n    \
             double v = {scaled};\n    if (airspeed_kt != airspeed_kt) {{\n        return -1;\n    }}\n    \
             (void)v;\n    (void)zero_in;\n    (void)zero_out;\n",
            lead.order,
            number(lead.lag_s)
        );
        for (side, channels) in [("in", &correction.inputs), ("out", &correction.outputs)] {
            for (index, zero_s) in channels.iter().enumerate().filter_map(|(at, of)| Some((at, of.zero_s.as_ref()?))) {
                write_curve(&mut text, &format!("zero_{side}[{index}]"), zero_s);
            }
        }
        text.push_str("    return a != airspeed_kt;\n}\n");
        text.push_str(LEAD_STEP);
    }
    text.push_str("\n#endif\n");
    Ok(text)
}

fn write_channel(text: &mut String, side: &str, index: usize, channel: &ScheduledChannel) {
    let _ = writeln!(text, "    /* {side}put {}: {} . */", index + 1, comment(&channel.name));
    for (target, curve) in [("gain", &channel.gain), ("delay", &channel.delay_s)] {
        write_curve(text, &format!("{target}_{side}[{index}]"), curve);
    }
}

/// A block that gives `target` the value of a curve, its numbers in arrays of their own.
fn write_curve(text: &mut String, target: &str, curve: &Curve) {
    let mut arrays = Vec::new();
    let expression = LANGUAGE.expression(curve, &mut |numbers| {
        let name = format!("c{}", arrays.len());
        arrays.push(format!("        static const double {name}[] = {{{}}};\n", list(numbers)));
        name
    });
    let _ = write!(text, "    {{\n{}        {target} = {expression};\n    }}\n", arrays.concat());
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    use super::super::scheduled_correction::tests::{NASTY, airspeeds, assert_printed, example};
    use super::*;

    /// Compiles the header with a program around it and gives what that prints.
    fn run(header: &str, body: &str) -> Option<String> {
        if Command::new("cc").arg("--version").output().is_err() {
            eprintln!("SKIPPED: cc is not installed");
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let [source, program] = ["main.c", "main"].map(|name| folder.path().join(name));
        std::fs::write(folder.path().join("gdcm.h"), header).unwrap();
        let main = format!("#include \"gdcm.h\"\n#include <stdio.h>\nint main(void)\n{{\n{body}\nreturn 0;\n}}\n");
        std::fs::write(&source, main).unwrap();
        let flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-o"];
        let built = Command::new("cc").args(flags).args([&program, &source]).arg("-lm").output().unwrap();
        assert!(built.status.success(), "{}\n{header}", String::from_utf8_lossy(&built.stderr));
        let output = Command::new(&program).output().unwrap();
        assert!(output.status.success());
        Some(String::from_utf8(output.stdout).unwrap())
    }

    #[test]
    fn the_header_computes_what_the_correction_says() {
        let correction = example();
        let speeds: Vec<String> = airspeeds().iter().map(|speed| format!("{speed:.1}")).collect();
        let body = format!(
            "double s[] = {{{}}}; double gi[2], go[1], di[2], no[1]; int k;\n\
             for (k = 0; k < 50; k++) {{ int cut = gdcm_correction(s[k], gi, go, di, no);\n\
             if (cut != (s[k] < 0.0 || s[k] > 80.0)) return 1;\n\
             printf(\"%.17g %.17g %.17g %.17g %.17g %.17g\\n\", gi[0], gi[1], go[0], di[0], di[1], no[0]); }}\n\
             if (gdcm_correction(NAN, gi, go, di, no) != -1) return 1;",
            speeds.join(",")
        );
        if let Some(printed) = run(&c_header(&correction).unwrap(), &body) {
            assert_printed(&correction, &printed);
        }
    }

    #[test]
    fn names_come_back_byte_by_byte() {
        let body = "const char *n[] = {GDCM_INPUT_NAME_0, GDCM_INPUT_NAME_1}; int k; const char *c;\n\
                    for (k = 0; k < GDCM_INPUT_COUNT; k++) { for (c = n[k]; *c; c++) printf(\"%d \", (unsigned char)*c); }";
        if let Some(printed) = run(&c_header(&example()).unwrap(), body) {
            let bytes: Vec<u8> = printed.split_whitespace().map(|word| word.parse().unwrap()).collect();
            assert_eq!(bytes, [NASTY[0], NASTY[1]].concat().as_bytes());
        }
    }

    #[test]
    fn a_correction_without_channels_compiles() {
        let mut correction = example();
        correction.inputs.clear();
        correction.outputs.clear();
        run(&c_header(&correction).unwrap(), "return gdcm_correction(1.0, 0, 0, 0, 0);");
    }
}
