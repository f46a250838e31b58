//! Patterns for common folder, file and variable names, used unless the rules give others.
//!
//! Earlier patterns take precedence. A group `(?<airspeed_kt>...)` sets the field after which it is
//! named ([`NamePattern`]). Most patterns begin with `(?:^|[/_ -])` and end with `(?:[/_ .#-]|$)`:
//! a value is recognised only between the marks that separate the parts of a name.

use std::sync::LazyLock;

use super::name_pattern::NamePattern;

/// Returns the patterns for common names: `c03_045kt_high/roll+5`, `cond 3/V-10kt`,
/// `120kt_low_heavy/flight`.
pub fn standard_patterns() -> &'static [NamePattern] {
    &STANDARD
}

/// Standard patterns, compiled once because every record needs them.
static STANDARD: LazyLock<Vec<NamePattern>> = LazyLock::new(|| {
    let texts = [
        // Condition number: "c03", "cond 3", "fc-12".
        r"(?:^|[/_ #.-])(?:c|cond|condition|fc|case|point)[_ -]?0*(?<condition>\d+)(?:[/_ .#-]|$)".to_owned(),
        // Airspeed: "045kt", "V090kt". After a hyphen it needs three digits: "V-10kt" is an offset.
        r"(?:^|[/_ ])v?0*(?<airspeed_kt>\d+(?:\.\d+)?)[_ ]?(?:kt|kts|ktas|kcas|kias|knots)(?:[/_ .#-]|$)".to_owned(),
        r"-(?<airspeed_kt>\d{3})[_ ]?(?:kt|kts|ktas|kcas|kias|knots)(?:[/_ .#-]|$)".to_owned(),
        // Altitude and mass in numbers: "2000ft", "6600kg".
        r"(?:^|[/_ -])(?<altitude_ft>\d{3,5})[_ ]?ft(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<mass_kg>\d{3,6})[_ ]?kg(?:[/_ .#-]|$)".to_owned(),
        // Weight and altitude in classes: "heavy", "low_gw", "high_alt". Of two bare classes,
        // "low_high", the first is the altitude and the second the weight.
        r"(?:^|[/_ -])(?<weight>light|heavy)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<weight>low|high)[_ ]?(?:w|weight|gw|mass)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude>low|high)[_ ]?(?:alt|altitude)?[/_ -](?<weight>low|high)(?:[/_ .#-]|$)".to_owned(),
        r"(?:^|[/_ -])(?<altitude>low|high)[_ ]?(?:alt|altitude)?(?:[/_ .#-]|$)".to_owned(),
        // Trim offsets: "roll+5", "dV-10", "phi_m5".
        offset_pattern("roll|phi|bank", "roll_deg"),
        offset_pattern("v|speed|airspeed|tas|ias", "airspeed_kt"),
        offset_pattern("roc|climb|rateofclimb|hdot", "rate_of_climb_fpm"),
        offset_pattern("pitch|theta", "pitch_deg"),
        offset_pattern("beta|slip|sideslip", "sideslip_deg"),
        // Moved parameter: "Ixx+5%". In percent only: in other units, a parameter looks like a trim
        // offset.
        r"(?:^|[/_ #,])(?<parameter>[a-z][a-z0-9]*(?:_[a-z0-9]+)*)[_ ]?(?<delta>[+-]\d+(?:\.\d+)?)[_ ]?(?<delta_unit>%|pct|percent)".to_owned(),
        // Role: "nominal", "CT-PBSID 2", "flight_1", "perturbed".
        r"(?:^|[/_ #.-])(?<nominal>nominal|nom|trim|baseline)(?:[/_ .#(-]|$)".to_owned(),
        r"(?:^|[/_ #.-])(?<identified>identified|ident|id|sysid|sid|(?:ct-?)?pbsid|n4sid|cifer|flight|flt|measured|frf)\d*(?:[/_ .#(-]|$)"
            .to_owned(),
        r"(?:^|[/_ #.-])(?<perturbed>perturbed|pert)\d*(?:[/_ .#(-]|$)".to_owned(),
    ];
    // `.ok()`: a test counts the compiled patterns, so that an invalid pattern is not dropped
    // unnoticed.
    texts
        .iter()
        .filter_map(|text| NamePattern::new(text).ok())
        .collect()
});

/// Returns the pattern for a trim offset: one of `words`, a sign and a number.
fn offset_pattern(words: &str, coordinate: &str) -> String {
    const SIGNED: &str = r"(?:[+-]|p|m|plus|minus)[_ ]?\d+(?:\.\d+)?";
    format!(r"(?:^|[/_#, -])(?:d|delta_?)?(?:{words})[_ ]?(?<by_{coordinate}>{SIGNED})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::names::name_pattern::{PatternError, read_name, unread_offsets};
    use crate::names::{NameFacts, RowRole};

    fn read(name: &str) -> NameFacts {
        read_name(name, standard_patterns())
    }

    #[test]
    fn names_give_condition_airspeed_altitude_and_perturbation() {
        assert_eq!(standard_patterns().len(), 18);
        let facts = read("c03_045kt_high/roll+5");
        assert_eq!(
            (
                facts.condition,
                facts.airspeed_kt,
                facts.altitude.as_deref()
            ),
            (Some(3), Some(45.0), Some("high"))
        );
        assert_eq!(
            facts.perturbation.into_iter().collect::<Vec<_>>(),
            [("roll_deg".to_owned(), 5.0)]
        );
        let offsets: Vec<f64> = read("dV+5_dROC+150_dPHI-5")
            .perturbation
            .into_values()
            .collect();
        assert_eq!(
            offsets,
            [5.0, 150.0, -5.0],
            "airspeed_kt, rate_of_climb_fpm, roll_deg"
        );
        let facts = read("fc-12/120kt_low_heavy/V-10kt roc+150fpm");
        assert_eq!(
            (facts.condition, facts.airspeed_kt, facts.weight.as_deref()),
            (Some(12), Some(120.0), Some("heavy"))
        );
        let offsets: Vec<f64> = facts.perturbation.values().copied().collect();
        assert_eq!(offsets, [-10.0, 150.0], "airspeed_kt, rate_of_climb_fpm");
    }

    #[test]
    fn unread_trim_offsets_are_reported() {
        let unread = |name: &str| unread_offsets(name, standard_patterns());
        let facts = read("c3/dV+5_dROC+150_dPHI+5");
        assert_eq!(
            facts.perturbation.into_values().collect::<Vec<_>>(),
            [5.0, 150.0, 5.0]
        );
        assert!(
            unread("dV+5_dROC+150_dPHI+5").is_empty() && unread("V-10kt roc+150fpm").is_empty()
        );
        assert_eq!(unread("dV+5_flap-10"), ["flap-10"]);
    }

    #[test]
    fn the_first_low_or_high_is_the_altitude_and_the_second_the_weight() {
        let facts = read("60kt_low_high/nominal");
        assert_eq!(
            (
                facts.altitude.as_deref(),
                facts.weight.as_deref(),
                facts.role
            ),
            (Some("low"), Some("high"), Some(RowRole::Nominal))
        );
        let facts = read("V090kt_2000ft_6600kg/CT-PBSID 2");
        assert_eq!(
            (facts.airspeed_kt, facts.altitude_ft, facts.mass_kg),
            (Some(90.0), Some(2000.0), Some(6600.0))
        );
        assert_eq!(read("x/flight_1").role, Some(RowRole::Identified));
        let facts = read("study#study.c3.identified(2)");
        assert_eq!(
            (facts.condition, facts.role),
            (Some(3), Some(RowRole::Identified)),
            "fields of a struct"
        );
    }

    #[test]
    fn names_give_the_parameter_moved_in_a_run() {
        for (name, parameter, delta) in [
            ("c03/Ixx+5%", "Ixx", 5.0),
            ("c03_045kt/inflow_tau-10%", "inflow_tau", -10.0),
            ("c03/tail lift +2.5 %", "lift", 2.5),
            ("c03/V-5kt_Ixx_-5pct", "Ixx", -5.0),
        ] {
            let facts = read(name);
            let change = facts.parameter.unwrap();
            assert_eq!(
                (change.name.as_str(), change.delta, change.unit.as_str()),
                (parameter, delta, "%"),
                "{name}"
            );
            assert_eq!(facts.condition, Some(3), "{name}");
        }
        assert_eq!(read("c3/V-5kt_Ixx+5%").perturbation["airspeed_kt"], -5.0);
        for name in ["c3/roll+5", "c3/V-5kt", "c3/rev-3", "c3/Ixx+0%"] {
            assert_eq!(read(name).parameter, None, "{name}");
        }
    }

    #[test]
    fn a_pattern_can_read_a_parameter_in_another_unit() {
        let pattern = r"(?<parameter>phase)(?<delta>[+-]\d+)(?<delta_unit>deg)";
        let facts = read_name("c3/phase+2deg", &[NamePattern::new(pattern).unwrap()]);
        let change = facts.parameter.unwrap();
        assert_eq!((change.delta, change.unit.as_str()), (2.0, "deg"));
        let pattern = NamePattern::new(r"(?<parameter>wake)(?<delta>m\d+)").unwrap();
        let change = read_name("wakem3", &[pattern]).parameter.unwrap();
        assert_eq!((change.delta, change.unit.as_str()), (-3.0, "1"));
    }

    #[test]
    fn an_airspeed_offset_is_not_an_airspeed() {
        for name in ["V+10kt", "a/V-10kt", "c1/v_m10kt"] {
            let facts = read(name);
            assert_eq!(facts.airspeed_kt, None, "{name}");
            assert_eq!(
                facts.perturbation.get("airspeed_kt").map(|by| by.abs()),
                Some(10.0),
                "{name}"
            );
        }
    }

    #[test]
    fn earlier_patterns_take_precedence() {
        let mut patterns = vec![NamePattern::new("case(?<condition>\\d)").unwrap()];
        patterns.extend_from_slice(standard_patterns());
        assert_eq!(read_name("case7/c03", &patterns).condition, Some(7));
        let unknown = NamePattern::new("(?<speed>\\d+)").unwrap_err();
        let group = "speed".to_owned();
        let pattern = "(?<speed>\\d+)".to_owned();
        assert_eq!(unknown, PatternError::Group { pattern, group });
        // The message must be a single line, whatever the text contains.
        for wrong in [
            "(".to_owned(),
            "(?<cond\u{7f}ition>a)".to_owned(),
            "(th".repeat(40_000),
            format!("(?<{}>a)", "g".repeat(900)),
        ] {
            let message = NamePattern::new(&wrong).unwrap_err().to_string();
            assert!(
                message.len() < 500 && !message.contains(char::is_control),
                "{message:?}"
            );
        }
    }
}
