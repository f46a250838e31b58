//! Physics parameters set by hand on the command line (M18.5).
//!
//! A physics parameter is a named quantity of the physics model, such as an inertia, for which the
//! dataset has models linearised with it changed. A value is its change from the physics model.

use gdcm_model::message_text::sanitized;
use gdcm_study::decisions::physics_settings::{ParameterDecision, PhysicsCorrection};
use gdcm_study::decisions::setting_table;
use gdcm_study::{Edit, Study};

use super::failure::Failure;

/// Option that sets a parameter.
const OPTION: &str = "--parameter";

/// Change to a parameter: "Ixx=+4%".
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterValue {
    pub name: String,
    pub change: f64,
    /// The unit; empty where it is not given.
    pub unit: String,
}

/// Parses a change: "Ixx=+4%", "wake_curvature=0.2", "swashplate_phase=-1.5 deg".
///
/// # Errors
/// The expected form.
pub fn parameter_value(text: &str) -> Result<ParameterValue, String> {
    let expected = || format!("expected NAME=CHANGE[UNIT], such as Ixx=+4%, found {text}");
    let (name, value) = text.split_once('=').ok_or_else(expected)?;
    let name = name.trim();
    let value = value.trim();
    if name.is_empty() {
        return Err(expected());
    }
    // The longest beginning that is a number; the rest is the unit.
    for end in (1..=value.len()).rev() {
        let Some(number) = value.get(..end) else {
            continue;
        };
        if !number.ends_with(|last: char| last.is_ascii_digit() || last == '.') {
            continue;
        }
        if let Ok(change) = number.parse::<f64>()
            && change.is_finite()
        {
            return Ok(ParameterValue {
                name: name.to_owned(),
                change,
                unit: value[end..].trim().to_owned(),
            });
        }
    }
    Err(expected())
}

/// Applies the given values to the study; if it applies no physics parameters and `--physics` is
/// not given, the values set by hand are applied alone.
pub(super) fn apply_parameters(
    study: &mut Study,
    values: &[ParameterValue],
    is_physics_given: bool,
) -> Result<(), Failure> {
    if values.is_empty() {
        return Ok(());
    }
    let parameters = study.settings.physics_parameters.parameters(&study.dataset);
    for (index, value) in values.iter().enumerate() {
        if values[..index].iter().any(|other| other.name == value.name) {
            return Err(Failure::given_twice(OPTION, &sanitized(&value.name)));
        }
        let known = parameters
            .iter()
            .find(|parameter| parameter.name == value.name);
        if let Some(parameter) = known
            && !value.unit.is_empty()
            && value.unit != parameter.unit
        {
            let reason = sanitized(&format!(
                "{}: expected a change in {}, found {}",
                value.name, parameter.unit, value.unit
            ));
            return Err(Failure::coded_option(OPTION, "parameter-unit", reason));
        }
        if known.is_none() && !parameters.is_empty() {
            let names: Vec<&str> = parameters
                .iter()
                .map(|parameter| parameter.name.as_str())
                .collect();
            let reason = sanitized(&format!(
                "expected one of {}, found {}",
                names.join(", "),
                value.name
            ));
            return Err(Failure::coded_option(OPTION, "unknown-parameter", reason));
        }
        let edit = Edit::DecideParameter {
            name: value.name.clone(),
            decision: ParameterDecision::Value(Some(value.change)),
        };
        decide(study, &edit)?;
    }
    if !is_physics_given && study.settings.physics == PhysicsCorrection::Off {
        decide(study, &setting_table::PHYSICS.to(PhysicsCorrection::ByHand))?;
    }
    Ok(())
}

/// Applies a decision that the option asks for.
fn decide(study: &mut Study, edit: &Edit) -> Result<(), Failure> {
    study
        .apply(edit)
        .map_err(|refusal| Failure::option(OPTION, refusal))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_has_a_name_a_number_and_perhaps_a_unit() {
        let read = |text: &str| parameter_value(text).map(|value| (value.change, value.unit));
        assert_eq!(read("Ixx=+4%"), Ok((4.0, "%".to_owned())));
        assert_eq!(read("a b = -1.5 deg"), Ok((-1.5, "deg".to_owned())));
        assert_eq!(read("k=1e-3"), Ok((1e-3, String::new())));
        assert_eq!(read("k=2.e"), Ok((2.0, "e".to_owned())));
        for text in ["Ixx", "=4", "Ixx=", "Ixx=%", "Ixx=nan", "Ixx=inf"] {
            assert!(read(text).is_err(), "{text}");
        }
    }
}
