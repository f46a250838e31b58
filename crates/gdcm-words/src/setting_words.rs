//! Captions, help texts and meanings of choices for every setting, for the window and the command
//! line.

use gdcm_study::decisions::setting::Setting;

/// A setting's texts.
#[derive(Clone, Copy, Debug)]
pub struct SettingWords {
    /// The setting's key in files.
    key: &'static str,
    /// Text in front of the control; empty where there is none.
    pub caption: &'static str,
    /// The control's accessible name.
    pub label: &'static str,
    /// Description in one sentence.
    pub help: &'static str,
    /// Accessible names for a range's lower and upper end; empty for other settings.
    pub ends: [&'static str; 2],
    /// Meaning of each choice, in the setting's order; empty for a setting without choices.
    pub meanings: &'static [&'static str],
}

/// Returns a setting's texts; empty texts if it has none.
pub fn setting_words(setting: &Setting) -> &'static SettingWords {
    let words = SETTING_WORDS.iter().find(|words| words.key == setting.key);
    words.unwrap_or(&NO_WORDS)
}

/// Empty texts, for an unknown setting and for the fields that a setting does not need.
const NO_WORDS: SettingWords = SettingWords {
    key: "",
    caption: "",
    label: "",
    help: "",
    ends: ["", ""],
    meanings: &[],
};

static SETTING_WORDS: [SettingWords; 30] = [
    SettingWords {
        key: "alpha_gain",
        caption: "α gains",
        label: "α gains",
        help: "Weight that keeps the output gains, eq. (7), near 1; 0 is the limit α → 0",
        ..NO_WORDS
    },
    SettingWords {
        key: "alpha_delay",
        caption: "α delays",
        label: "α delays",
        help: "Weight that keeps the output delays, eq. (11), or all signed delays (M15) near 0; 0 is the limit α → 0",
        ..NO_WORDS
    },
    SettingWords {
        key: "phase",
        caption: "Phase",
        label: "Phase correction",
        help: "How the phase is corrected: not at all, by delays, or by a delay or lead filter for each \
    channel",
        meanings: &[
            "Gains only",
            "Each channel gets a delay, eq. (11) (the paper)",
            "Each channel gets one signed delay; a negative delay becomes a lead filter, \
                which acts like a faster servo (M15)",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "delay_from",
        caption: "Delay estimate",
        label: "Delay estimate",
        help: "Definition of the delta delay D to which delays are fitted: median of phase divided by frequency, or \
    straight line over the band",
        meanings: &[
            "Median of Δφ/ω over the band, eq. (9) (the paper)",
            "Least-squares line through Δφ over the band (M15.2)",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "lead.order",
        caption: "Lead: order",
        label: "Order of the lead filters",
        help: "Order of every lead filter (M15.3)",
        meanings: &[
            "Second order, Butterworth damping: leaves the gain within the band nearly unchanged",
            "First order, (1 + a s)/(1 + b s): the gain rises within the band",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "lead.n",
        caption: "n",
        label: "n of the lead filters",
        help: "Parameter of the lag of every lead filter, 1/(n ω_B), where ω_B is the top of the band; a \
    smaller n gives less noise and permits more lead",
        ..NO_WORDS
    },
    SettingWords {
        key: "lead.r_max",
        caption: "R_max",
        label: "R_max of the lead filters",
        help: "Maximum gain of a channel's lead filter far above the band (10 is 20 dB); it limits the lead \
    of the channel",
        ..NO_WORDS
    },
    SettingWords {
        key: "couplings",
        caption: "Couplings",
        label: "Couplings",
        help: "Correction of couplings and modes, common to all conditions and applied before the channel \
    correction: none, a mixing of the inputs, or a mixing and a feedback of outputs to inputs \
    (M16)",
        meanings: &[
            "Only gains, delays and leads of the channels (the paper)",
            "Each input receives constant shares of the other inputs (M16)",
            "Each input receives constant shares of the other inputs and of the outputs, \
                which also moves the modes (M16)",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "physics",
        caption: "Physics",
        label: "Physics parameters",
        help: "Parameters of the physics model that are changed before every other correction: none, those \
    that the diagnosis names, all, or values set by hand (M18)",
        meanings: &[
            "The physics models are those of the file",
            "The parameters that the diagnosis names, refitted with the others switched off (M18)",
            "All parameters that are switched on, at the fitted values (M18)",
            "The values set by hand; nothing is fitted (M18)",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "band_rad_s",
        caption: "Band",
        label: "Band",
        help: "Comparison band; in the window, its limits can also be dragged in the plot",
        ends: ["Band from", "Band to"],
        ..NO_WORDS
    },
    SettingWords {
        key: "points",
        caption: "Points",
        label: "Frequencies in the band",
        help: "Number of logarithmically spaced frequencies in the band",
        ..NO_WORDS
    },
    SettingWords {
        key: "quantile",
        caption: "bound quantile",
        label: "Bound quantile",
        help: "Quantile q; the bounds are the quantiles q and 1 − q of |H_ref|/|H_sim| and of Δφ/ω over \
            the band (H_ref: identified response, H_sim: physics response)",
        ..NO_WORDS
    },
    SettingWords {
        key: "gain_bounds",
        caption: "Gain bounds",
        label: "Gain bounds",
        help: "Minimum and maximum gain of every channel, common to all conditions; auto: from the \
    quantiles of each condition",
        ends: ["Lower gain bound", "Upper gain bound"],
        ..NO_WORDS
    },
    SettingWords {
        key: "delay_upper_s",
        caption: "Delay bound",
        label: "Upper delay bound",
        help: "Maximum delay of every channel, common to all conditions; auto: from the quantiles of each \
    condition",
        ..NO_WORDS
    },
    SettingWords {
        key: "agreement_db",
        caption: "Loop tolerance",
        label: "Loop tolerance",
        help: "Largest mismatch at which held gains that form a loop of responses still count as \
    consistent",
        ..NO_WORDS
    },
    SettingWords {
        key: "cost_average",
        caption: "Method",
        label: "Average in J",
        help: "How squared errors are averaged over frequency in J",
        meanings: &[
            "J uses the median over frequency (the paper)",
            "J uses the mean over frequency (Tischler)",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "gain_objective",
        caption: "",
        label: "Objective of the gains",
        help: "Errors between net gain and delta gain G that are minimised: differences of the gains, or in dB",
        meanings: &[
            "Minimises squared differences of the gains, eq. (7)",
            "Minimises squared errors in dB: a factor and its inverse count alike",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "gain_from",
        caption: "G from",
        label: "Source of G",
        help: "Source of the delta gain G: the two representatives, or the mean over all pairs of kept models",
        meanings: &[
            "G of the two representatives (the paper)",
            "G is the geometric mean over all pairs of kept models",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "error_bars.level",
        caption: "Confidence level",
        label: "Confidence level",
        help: "Level of error bars, intervals and tests, except the 95 % bands of identified models",
        ..NO_WORDS
    },
    SettingWords {
        key: "error_bars.prior_degrees",
        caption: "pooling",
        label: "Pooling (degrees of freedom borrowed)",
        help: "Maximum degrees of freedom that the identification part of a condition's error bar borrows \
    from the other conditions; 0 uses the condition's own data only",
        ..NO_WORDS
    },
    SettingWords {
        key: "coherence_threshold",
        caption: "Coherence",
        label: "Minimum coherence",
        help: "Frequencies of a measured response whose coherence γ² is lower are left out: off, on (0.6), \
    or a value; off: all frequencies count equally",
        ..NO_WORDS
    },
    SettingWords {
        key: "error_bars.averages",
        caption: "",
        label: "averages of measured responses",
        help: "Number of independent averages of measured responses whose files do not state it",
        ..NO_WORDS
    },
    SettingWords {
        key: "error_bars.window_s",
        caption: "",
        label: "windows of measured responses",
        help: "Length of the windows of measured responses whose files do not state it",
        ..NO_WORDS
    },
    SettingWords {
        key: "error_bars.half_overlap",
        caption: "",
        label: "windows overlap",
        help: "Assumes that the windows of all measured responses overlap by half",
        ..NO_WORDS
    },
    SettingWords {
        key: "schedule.kind",
        caption: "Schedule",
        label: "Schedule",
        help: "Degree of the schedule's polynomial in airspeed, 0 to 3, or a lookup table",
        meanings: &[
            "Polynomial of degree 0 in airspeed",
            "Polynomial of degree 1 in airspeed",
            "Polynomial of degree 2 in airspeed",
            "Polynomial of degree 3 in airspeed",
            "Mean of each cluster of airspeeds, with linear interpolation between them",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "schedule.of",
        caption: "",
        label: "Scheduled quantity",
        help: "Quantity regressed on airspeed: ln k, or the gain k itself",
        meanings: &[
            "Regresses ln k: the product of two scheduled gains is the schedule of their \
                product",
            "Regresses the gain k itself",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "schedule_delays",
        caption: "Over airspeed",
        label: "Schedule of delays",
        help: "Schedule the delays of the channels too, clamped to their bounds (M11); without a value: always",
        meanings: &[
            "Delays are scheduled with the gains if a held response has a net delay above 0.5 \
                ms in a scheduled condition",
            "Delays are scheduled with the gains",
            "Gains only (the paper)",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "schedule.tau_degree",
        caption: "Over airspeed",
        label: "Schedule of the signed delays",
        help: "Degree of the polynomial of signed delays in airspeed; 0 assumes that lags of servos and \
    sensors do not depend on airspeed (M15.5)",
        meanings: &[
            "One signed delay for all airspeeds: lags of servos and sensors do not depend on \
                airspeed (M15.5)",
            "Polynomial of degree 1 in airspeed",
            "Polynomial of degree 2 in airspeed",
            "Polynomial of degree 3 in airspeed",
        ],
        ..NO_WORDS
    },
    SettingWords {
        key: "schedule.airspeed_tolerance_kt",
        caption: "Airspeed tolerance",
        label: "Airspeed tolerance",
        help: "Maximum difference between consecutive airspeeds that count as one, for the lookup \
    table and for the permitted degree",
        ..NO_WORDS
    },
    SettingWords {
        key: "schedule.second_variable",
        caption: "Scheduled over",
        label: "Second variable of the schedule",
        help: "Schedule gains with a second variable in addition to airspeed",
        meanings: &[
            "Airspeed only, as in the paper",
            "Airspeed and altitude; recommended only if the Evidence view shows that altitude is \
             needed",
            "Airspeed and mass; recommended only if the Evidence view shows that mass is needed",
        ],
        ..NO_WORDS
    },
];

#[cfg(test)]
mod tests {
    use gdcm_study::decisions::setting::Kind;
    use gdcm_study::decisions::setting_table::SETTINGS;

    use super::*;

    #[test]
    fn every_setting_has_words_and_every_choice_a_meaning() {
        for setting in SETTINGS {
            let words = setting_words(setting);
            assert_eq!(words.key, setting.key);
            assert!(!words.label.is_empty() && !words.help.is_empty());
            let choices = match setting.kind {
                Kind::Choice { words, .. } => words.len(),
                _ => 0,
            };
            assert_eq!(words.meanings.len(), choices, "{}", setting.key);
            let is_range = matches!(setting.kind, Kind::Range { .. } | Kind::Band { .. });
            assert_eq!(words.ends.iter().all(|end| !end.is_empty()), is_range);
        }
    }
}
