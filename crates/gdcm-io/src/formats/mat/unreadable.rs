//! Values that this program does not read, each with the reason and a MATLAB command that exports
//! its data.

use crate::formats::mat::value_path::ValuePath;
use crate::formats::variables::Value;
use crate::variable_fault::unread::ObjectFault;
use crate::variable_fault::unread::Unread;

/// Returns the opaque value for an object of an unsupported class.
pub(super) fn unread_class(class: &str, path: &ValuePath<'_>) -> Value {
    unreadable(class, ObjectFault::Class, &path.text())
}

/// Returns an opaque value with the reason and a command that exports its data.
pub(super) fn unreadable(class: &str, fault: ObjectFault, variable: &str) -> Value {
    let command = export_command(class, variable);
    Value::opaque(class, Unread::Object { fault, command })
}

/// Returns a MATLAB command that writes `variable`, an object of `class`, to a file as plain
/// arrays.
///
/// Source: the reference manuals of MATLAB, the Control System Toolbox and the System
/// Identification Toolbox.
fn export_command(class: &str, variable: &str) -> String {
    // Empty if the file gives the value no name.
    let sys = if variable.is_empty() { "x" } else { variable };
    let (assignment, names) = match class {
        "ss" => with_properties(
            &format!("[A,B,C,D] = ssdata({sys});"),
            "A B C D",
            sys,
            &["Ts", "InputDelay", "OutputDelay", "TimeUnit"],
        ),
        "idss" | "idgrey" => with_properties(
            &format!("[A,B,C,D,K] = idssdata({sys});"),
            "A B C D K",
            sys,
            &["Ts", "InputDelay", "OutputDelay", "TimeUnit"],
        ),
        "tf" | "idtf" => with_properties(
            &format!("[num,den] = tfdata({sys});"),
            "num den",
            sys,
            &["Ts", "InputDelay", "OutputDelay", "IODelay", "TimeUnit"],
        ),
        "zpk" => with_properties(
            &format!("[z,p,k] = zpkdata({sys});"),
            "z p k",
            sys,
            &["Ts", "InputDelay", "OutputDelay", "IODelay", "TimeUnit"],
        ),
        "frd" => with_properties(
            &frequency_data(sys),
            "H w unit",
            sys,
            &["InputDelay", "OutputDelay", "IODelay", "TimeUnit"],
        ),
        "idfrd" => with_properties(
            &frequency_data(sys),
            "H w unit",
            sys,
            &["InputDelay", "OutputDelay", "TimeUnit"],
        ),
        "iddata" => (
            format!("u = {sys}.InputData; y = {sys}.OutputData; Ts = {sys}.Ts;"),
            "u y Ts".to_owned(),
        ),
        "timeseries" => (format!("t = {sys}.Time; y = {sys}.Data;"), "t y".to_owned()),
        "string" | "categorical" => (format!("text = cellstr({sys});"), "text".to_owned()),
        "datetime" => (format!("t = posixtime({sys});"), "t".to_owned()),
        "duration" => (format!("t = seconds({sys});"), "t".to_owned()),
        "table" => (
            format!("data = table2struct({sys}, 'ToScalar', true);"),
            "data".to_owned(),
        ),
        "timetable" => (
            format!("data = table2struct(timetable2table({sys}), 'ToScalar', true);"),
            "data".to_owned(),
        ),
        "containers.Map" => (
            format!("names = keys({sys}); data = values({sys});"),
            "names data".to_owned(),
        ),
        "function_handle" => (format!("text = func2str({sys});"), "text".to_owned()),
        // Any other class: its properties as fields.
        _ => (format!("data = struct({sys});"), "data".to_owned()),
    };
    format!("{assignment} save out.mat {names}")
}

fn frequency_data(sys: &str) -> String {
    format!("H = {sys}.ResponseData; w = {sys}.Frequency; unit = {sys}.FrequencyUnit;")
}

/// Extends an assignment, and the names that it defines, by properties of a system, which its
/// matrices do not contain.
fn with_properties(
    assignment: &str,
    names: &str,
    sys: &str,
    properties: &[&str],
) -> (String, String) {
    let mut statements = assignment.to_owned();
    for property in properties {
        statements.push_str(&format!(" {property} = {sys}.{property};"));
    }
    (statements, format!("{names} {}", properties.join(" ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_space_model_is_saved_with_its_delays() {
        let command = "[A,B,C,D] = ssdata(sys); Ts = sys.Ts; InputDelay = sys.InputDelay; \
            OutputDelay = sys.OutputDelay; TimeUnit = sys.TimeUnit; \
            save out.mat A B C D Ts InputDelay OutputDelay TimeUnit";
        assert_eq!(export_command("ss", "sys"), command);
    }
}
