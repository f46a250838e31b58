//! Repairs a stored zoom factor that would make the window unreadable.

use std::ops::RangeInclusive;
use std::path::Path;

use gdcm_model::message_text::{sanitized, sanitized_path};

/// Usable zoom factors: those that egui lets the user choose with the keyboard.
const ZOOM: RangeInclusive<f64> = 0.2..=5.0;

/// Replaces an unusable zoom factor in eframe's preferences file with 1, and returns a caution;
/// `None` if the stored factor is usable, or if there is none. The file is not parsed: the number
/// follows the first "zoom_factor:".
pub(super) fn repair_zoom(preferences: &Path) -> Option<String> {
    const KEY: &str = "zoom_factor:";
    let text = std::fs::read_to_string(preferences).ok()?;
    let start = text.find(KEY)? + KEY.len();
    let end = start + text[start..].find([',', ')'])?;
    let stored = &text[start..end];
    if let Ok(zoom) = stored.trim().parse::<f64>()
        && ZOOM.contains(&zoom)
    {
        return None;
    }
    let problem = format!(
        "{}: expected a zoom factor from {} to {}, found {}",
        sanitized_path(preferences),
        ZOOM.start(),
        ZOOM.end(),
        sanitized(stored)
    );
    let repaired = format!("{}1.0{}", &text[..start], &text[end..]);
    Some(match std::fs::write(preferences, repaired) {
        Ok(()) => format!("{problem}; it was reset to 1"),
        Err(error) => format!("{problem}; it cannot be repaired: {error}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unusable_zoom_factor_is_replaced_with_a_message_and_other_preferences_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("app.ron");
        let text = |zoom: &str| {
            format!(
                "{{\"egui\": \"(options:(sync:true,zoom_factor:{zoom},reduce_texture_memory:false))\"}}"
            )
        };
        for (stored, kept) in [
            ("0.0", "1.0"),
            ("NaN", "1.0"),
            ("5.5", "1.0"),
            ("0.2", "0.2"),
            ("1.25", "1.25"),
        ] {
            std::fs::write(&path, text(stored)).unwrap();
            let caution = repair_zoom(&path);
            assert_eq!(caution.is_some(), stored != kept, "{stored}: {caution:?}");
            if let Some(caution) = caution {
                assert!(caution.contains(stored), "{caution}");
                assert!(caution.contains("from 0.2 to 5"), "{caution}");
            }
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text(kept));
        }
        assert_eq!(repair_zoom(&folder.path().join("none.ron")), None);
    }
}
