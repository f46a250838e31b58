//! Text for the models from which G is computed.

use gdcm_method::correction::delta::GainSource;
use gdcm_study::decisions::settings::Settings;

/// Describes the models from which G is computed: "the representatives". With leads, the mean over
/// all pairs has no effect; the text then adds the reason.
pub fn gain_source_text(settings: &Settings) -> String {
    let source = match settings.gain_source {
        GainSource::Representatives => "the representatives",
        GainSource::MeanOfPairs => "the mean of ln G over all pairs of kept models",
    };
    if settings.is_gain_source_idle() {
        return format!(
            "{source}, without effect: with leads, G is computed from the difference between \
            the representatives that remains after the leads"
        );
    }
    source.to_owned()
}

#[cfg(test)]
mod tests {
    use gdcm_study::PhaseCorrection;

    use super::*;
    use crate::example_tests::EXAMPLE;

    #[test]
    fn a_source_without_effect_is_described_as_such() {
        let mut settings = EXAMPLE.study.settings.clone();
        settings.phase = PhaseCorrection::Lead;
        assert_eq!(gain_source_text(&settings), "the representatives");
        settings.gain_source = GainSource::MeanOfPairs;
        assert!(
            gain_source_text(&settings)
                .starts_with("the mean of ln G over all pairs of kept models, without effect"),
            "{}",
            gain_source_text(&settings)
        );
        settings.phase = PhaseCorrection::Delay;
        assert_eq!(
            gain_source_text(&settings),
            "the mean of ln G over all pairs of kept models"
        );
    }
}
