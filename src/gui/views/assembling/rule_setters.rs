//! Setters for a model's rule: each parses a typed text, or returns the reason for refusing it. An
//! empty text removes the setting, except the offsets from trim, which then become an empty list.

use gdcm_model::assembly::RowRule;

use super::typed_rules::{typed_factors, typed_signs, typed_trim, typed_units};

pub(super) fn set_condition(rule: &mut RowRule, text: &str) -> Result<(), String> {
    let text = text.trim();
    rule.condition = if text.is_empty() {
        None
    } else {
        let wrong = |_| format!("expected a whole number, found \"{text}\"");
        Some(text.parse().map_err(wrong)?)
    };
    Ok(())
}

pub(super) fn set_trim(rule: &mut RowRule, text: &str) -> Result<(), String> {
    rule.perturbation = Some(typed_trim(text)?);
    Ok(())
}

pub(super) fn set_signs(rule: &mut RowRule, text: &str) -> Result<(), String> {
    let signs = typed_signs(text)?;
    rule.signs = if signs.is_empty() { None } else { Some(signs) };
    Ok(())
}

/// Sets units and removes factors for the same channels: a channel has either a unit or a factor.
pub(super) fn set_units(rule: &mut RowRule, text: &str) -> Result<(), String> {
    let units = typed_units(text)?;
    if let Some(factors) = &mut rule.factors {
        factors.retain(|channel, _| !units.contains_key(channel));
    }
    rule.units = if units.is_empty() { None } else { Some(units) };
    Ok(())
}

/// Sets factors and removes units for the same channels: a channel has either a unit or a factor.
pub(super) fn set_factors(rule: &mut RowRule, text: &str) -> Result<(), String> {
    let factors = typed_factors(text)?;
    if let Some(units) = &mut rule.units {
        units.retain(|channel, _| !factors.contains_key(channel));
    }
    rule.factors = if factors.is_empty() {
        None
    } else {
        Some(factors)
    };
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::typed_rules::{number_text, unit_text};
    use super::*;

    #[test]
    fn a_trim_is_parsed_and_written_in_the_same_form() {
        let mut rule = RowRule::default();
        set_trim(&mut rule, "roll_deg 5, airspeed_kt -10").unwrap();
        assert_eq!(
            number_text(&rule.perturbation.clone().unwrap()),
            "airspeed_kt -10, roll_deg 5"
        );
        let error = set_trim(&mut rule, "roll").unwrap_err();
        assert!(error.contains("roll_deg 5"), "{error}");
    }

    #[test]
    fn a_sign_is_1_or_minus_1() {
        let mut rule = RowRule::default();
        set_signs(&mut rule, "NZ -1").unwrap();
        assert_eq!(rule.signs.as_ref().unwrap()["NZ"], -1.0);
        let error = set_signs(&mut rule, "NZ -2").unwrap_err();
        assert!(error.contains("1 or -1"), "{error}");
    }

    #[test]
    fn a_channel_has_a_unit_or_a_factor() {
        let mut rule = RowRule::default();
        set_units(&mut rule, "LON in, roll rate rad/s").unwrap();
        assert_eq!(
            rule.units.as_ref().map(unit_text).as_deref(),
            Some("LON in, roll rate rad/s")
        );
        set_factors(&mut rule, "LON 8").unwrap();
        assert_eq!(
            rule.units.as_ref().map(unit_text).as_deref(),
            Some("roll rate rad/s")
        );
        assert_eq!(
            rule.factors.as_ref().map(number_text).as_deref(),
            Some("LON 8")
        );
        assert!(set_units(&mut rule, "in").is_err());
        assert!(set_factors(&mut rule, "LON 0").is_err());
    }

    #[test]
    fn a_condition_is_a_whole_number() {
        let mut rule = RowRule::default();
        set_condition(&mut rule, "3").unwrap();
        assert_eq!(rule.condition, Some(3));
        assert!(set_condition(&mut rule, "three").is_err());
    }
}
