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
        "ss" => (
            format!("[A,B,C,D] = ssdata({sys}); Ts = {sys}.Ts;"),
            "A B C D Ts",
        ),
        "idss" | "idgrey" => (
            format!("[A,B,C,D,K] = idssdata({sys}); Ts = {sys}.Ts;"),
            "A B C D K Ts",
        ),
        "tf" | "idtf" => (format!("[num,den,Ts] = tfdata({sys});"), "num den Ts"),
        "zpk" => (format!("[z,p,k,Ts] = zpkdata({sys});"), "z p k Ts"),
        "frd" | "idfrd" => (
            format!("H = {sys}.ResponseData; w = {sys}.Frequency; unit = {sys}.FrequencyUnit;"),
            "H w unit",
        ),
        "iddata" => (
            format!("u = {sys}.InputData; y = {sys}.OutputData; Ts = {sys}.Ts;"),
            "u y Ts",
        ),
        "timeseries" => (format!("t = {sys}.Time; y = {sys}.Data;"), "t y"),
        "string" | "categorical" => (format!("text = cellstr({sys});"), "text"),
        "datetime" => (format!("t = posixtime({sys});"), "t"),
        "duration" => (format!("t = seconds({sys});"), "t"),
        "table" => (
            format!("data = table2struct({sys}, 'ToScalar', true);"),
            "data",
        ),
        "timetable" => (
            format!("data = table2struct(timetable2table({sys}), 'ToScalar', true);"),
            "data",
        ),
        "containers.Map" => (
            format!("names = keys({sys}); data = values({sys});"),
            "names data",
        ),
        "function_handle" => (format!("text = func2str({sys});"), "text"),
        // Any other class: its properties as fields.
        _ => (format!("data = struct({sys});"), "data"),
    };
    format!("{assignment} save out.mat {names}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_space_model_is_saved_as_its_matrices() {
        let command = "[A,B,C,D] = ssdata(sys); Ts = sys.Ts; save out.mat A B C D Ts";
        assert_eq!(export_command("ss", "sys"), command);
    }
}
