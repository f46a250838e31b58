//! Options for `gdcm assemble` that declare a sign, unit or factor for a channel in some files.

use gdcm_model::assembly::FileScope;

use super::channel_values::{factor, sign_factor, text_value};

/// Value that an option declares for a channel in some assembled files.
#[derive(Clone, Debug, PartialEq)]
pub struct FileValue<T> {
    pub channel: String,
    pub value: T,
    /// Files to which the value applies; by default those with identified models.
    pub scope: FileScope,
}

impl<T> FileValue<T> {
    /// Parses `CHANNEL=VALUE` or `CHANNEL=VALUE:SCOPE`; `None` if a part is empty or `parse`
    /// rejects the value.
    fn parse(text: &str, parse: impl FnOnce(&str) -> Option<T>) -> Option<Self> {
        let (channel, rest) = text.split_once('=')?;
        let (value, scope) = rest.split_once(':').unwrap_or((rest, "identified"));
        let [channel, value, scope] = [channel, value, scope].map(str::trim);
        if channel.is_empty() || value.is_empty() || scope.is_empty() {
            return None;
        }
        Some(Self {
            channel: channel.to_owned(),
            value: parse(value)?,
            scope: FileScope::from(scope.to_owned()),
        })
    }
}

/// Explains the scope syntax; appended to error messages.
const SCOPE_HINT: &str = "optionally followed by :identified, :physics, :all or :FILE (a model's file or folder pattern)";

pub(super) fn file_sign(text: &str) -> Result<FileValue<f64>, String> {
    FileValue::parse(text, sign_factor).ok_or_else(|| {
        format!("expected CHANNEL=1 or CHANNEL=-1, such as NZ=-1, {SCOPE_HINT}; found \"{text}\"")
    })
}

pub(super) fn file_unit(text: &str) -> Result<FileValue<String>, String> {
    FileValue::parse(text, text_value).ok_or_else(|| {
        format!("expected CHANNEL=UNIT, such as LON=in, {SCOPE_HINT}; found \"{text}\"")
    })
}

pub(super) fn file_factor(text: &str) -> Result<FileValue<f64>, String> {
    FileValue::parse(text, factor).ok_or_else(|| {
        format!(
            "expected CHANNEL=X with a number X other than 0, such as LON=8 or NZ=-1, \
            {SCOPE_HINT}; found \"{text}\""
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_or_a_factor_of_files_names_its_channel_and_scope() {
        let unit = |scope: FileScope| {
            Ok(FileValue {
                channel: "P".to_owned(),
                value: "rad/s".to_owned(),
                scope,
            })
        };
        assert_eq!(file_unit("P=rad/s"), unit(FileScope::Identified));
        assert_eq!(file_unit("P=rad/s:physics"), unit(FileScope::Physics));
        assert_eq!(
            file_unit("P = rad/s : c1/x=2.mat"),
            unit(FileScope::Files("c1/x=2.mat".into()))
        );
        let scaled = file_factor("NZ=-9.81:all").unwrap();
        assert_eq!((scaled.value, scaled.scope), (-9.81, FileScope::All));
        assert_eq!(
            file_sign("NZ=-1:flight_*").unwrap().scope,
            FileScope::Files("flight_*".into())
        );
        for wrong in ["P", "P=", "=in", "P=in:"] {
            assert!(file_unit(wrong).is_err(), "{wrong}");
        }
        for wrong in ["P=0", "P=x", "P=inf"] {
            assert!(file_factor(wrong).is_err(), "{wrong}");
        }
        assert!(file_sign("P=2").is_err());
    }
}
