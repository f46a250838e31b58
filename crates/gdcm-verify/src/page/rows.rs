//! Tables behind `docs/verification.md`: for each recorded figure its subject and method section,
//! and for each section the figures that test it.

use crate::checks::CHECKS;

/// A method section, with the page in `docs` that describes it.
pub struct Section {
    pub number: &'static str,
    pub title: &'static str,
    pub page: &'static str,
    /// Codes of the comparisons and coverages that test this section.
    pub codes: &'static [&'static str],
    /// Other tests, or the reason why there is no independent figure.
    pub note: &'static str,
}

/// All method sections, in order.
pub const SECTIONS: &[Section] = &[
    Section {
        number: "M1",
        title: "data",
        page: "method.md",
        codes: &[],
        note: "definitions; the readers of files have tests of their own ([testing.md](testing.md))",
    },
    Section {
        number: "M2",
        title: "frequency response",
        page: "method.md",
        codes: &["frequency-responses", "discrete-and-delayed-responses"],
        note: "",
    },
    Section {
        number: "M3",
        title: "phase difference",
        page: "method.md",
        codes: &["delta-gains-and-delays"],
        note: "within D",
    },
    Section {
        number: "M4",
        title: "cost J",
        page: "method.md",
        codes: &[
            "cost-of-gain-and-delay",
            "coherence-weights",
            "costs-of-corrections",
        ],
        note: "",
    },
    Section {
        number: "M5",
        title: "representatives and outliers",
        page: "method.md",
        codes: &["representatives"],
        note: "",
    },
    Section {
        number: "M6",
        title: "delta gain and delta delay",
        page: "method.md",
        codes: &["delta-gains-and-delays", "recovered-gains-and-delays"],
        note: "",
    },
    Section {
        number: "M7",
        title: "bounds",
        page: "method.md",
        codes: &["delta-gains-and-delays"],
        note: "",
    },
    Section {
        number: "M8",
        title: "gains",
        page: "method.md",
        codes: &[
            "certified-gains",
            "held-products",
            "channel-gains-and-delays",
            "recovered-gains-and-delays",
        ],
        note: "",
    },
    Section {
        number: "M9",
        title: "delays",
        page: "method.md",
        codes: &["certified-delays", "channel-gains-and-delays"],
        note: "",
    },
    Section {
        number: "M10",
        title: "corrected model",
        page: "method.md",
        codes: &["costs-of-corrections", "recovered-gains-and-delays"],
        note: "",
    },
    Section {
        number: "M11",
        title: "schedule",
        page: "method.md",
        codes: &["schedule-and-assessment"],
        note: "",
    },
    Section {
        number: "M12",
        title: "assessment",
        page: "method.md",
        codes: &["schedule-and-assessment"],
        note: "",
    },
    Section {
        number: "MUAD",
        title: "unnoticeable added dynamics",
        page: "method.md",
        codes: &["muad-envelopes"],
        note: "",
    },
    Section {
        number: "M13",
        title: "error bars",
        page: "error-bars.md",
        codes: &[
            "error-bars",
            "student-quantiles",
            "bars-of-independent-models",
            "bars-of-shared-errors",
            "bars-of-trim",
        ],
        note: "",
    },
    Section {
        number: "M14",
        title: "identification from flight records",
        page: "identification.md",
        codes: &[
            "identification-of-known-model",
            "identification-of-exact-records",
            "intervals-of-two-by-two-responses",
            "intervals-of-six-by-four-responses",
        ],
        note: "known answers of each step in `gdcm-sysid` (modules `known_answers`)",
    },
    Section {
        number: "M15",
        title: "leads",
        page: "lead.md",
        codes: &["lead-filters", "signed-delays"],
        note: "",
    },
    Section {
        number: "M16",
        title: "couplings",
        page: "couplings.md",
        codes: &["coupled-state-space", "coupling-fit"],
        note: "",
    },
    Section {
        number: "M17",
        title: "requirements",
        page: "requirements.md",
        codes: &["bandwidth-and-phase-delay"],
        note: "",
    },
    Section {
        number: "M18",
        title: "physics parameters",
        page: "physics.md",
        codes: &["physics-parameters"],
        note: "",
    },
];

/// A comparison that a test records.
pub struct EvidenceRow {
    pub code: &'static str,
    pub sections: &'static str,
    pub what: &'static str,
    pub source: &'static str,
    pub measure: &'static str,
    /// Whether `gdcm verify` makes the comparison too.
    pub is_verified: bool,
}

/// Comparisons that only tests make, not `gdcm verify`.
const OTHERS: &[EvidenceRow] = &[
    EvidenceRow {
        code: "recovered-gains-and-delays",
        sections: "M6, M8, M10",
        what: "channel gains and a delay applied to two published helicopter models (AH-64, 2 × 2; \
               Yamaha R-50, 13 × 4), recovered by the whole method from measured responses",
        source: "the applied gains and delay",
        measure: "relative gain, s",
        is_verified: false,
    },
    EvidenceRow {
        code: "identification-of-exact-records",
        sections: "M14",
        what: "identification from three records of an aircraft in closed loop, without noise",
        source: "the simulated aircraft, integrated in steps of a tenth of the sample time",
        measure: "relative to the largest magnitude at each frequency",
        is_verified: false,
    },
];

/// Returns all comparisons: those that `gdcm verify` makes, then the others.
pub fn evidence_rows() -> Vec<EvidenceRow> {
    let mut rows = Vec::with_capacity(CHECKS.len() + OTHERS.len());
    for check in CHECKS {
        rows.push(EvidenceRow {
            code: check.code,
            sections: check.sections,
            what: check.what,
            source: check.source,
            measure: check.measure,
            is_verified: true,
        });
    }
    for row in OTHERS {
        rows.push(EvidenceRow { ..*row });
    }
    rows
}

/// A measured coverage: how many intervals contain the true value.
pub struct CoverageRow {
    pub code: &'static str,
    pub sections: &'static str,
    pub what: &'static str,
}

/// Measured coverages, in page order.
pub const COVERAGE: &[CoverageRow] = &[
    CoverageRow {
        code: "bars-of-independent-models",
        sections: "M13",
        what: "error bars of net gains: three identified models with independent errors",
    },
    CoverageRow {
        code: "bars-of-shared-errors",
        sections: "M13",
        what: "error bars of net gains: three identified models that share half of their error \
               variance",
    },
    CoverageRow {
        code: "bars-of-trim",
        sections: "M13",
        what: "error bars of net gains: the scatter of trims is four times the error of a model",
    },
    CoverageRow {
        code: "intervals-of-two-by-two-responses",
        sections: "M14",
        what: "magnitudes and phases of identified responses at twelve frequencies: two inputs, two \
               outputs, generated flights through gusts in open loop",
    },
    CoverageRow {
        code: "intervals-of-six-by-four-responses",
        sections: "M14",
        what: "magnitudes and phases of identified responses at twelve frequencies: four inputs, six \
            outputs, generated flights through gusts in open loop",
    },
];

/// Returns the measured coverages, in page order.
pub fn coverage_rows() -> &'static [CoverageRow] {
    COVERAGE
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_section_of_the_method_is_listed_and_every_code_is_known() {
        let numbers: Vec<&str> = SECTIONS.iter().map(|section| section.number).collect();
        for number in 1..=18 {
            assert!(
                numbers.contains(&format!("M{number}").as_str()),
                "M{number}"
            );
        }
        let mut known: BTreeSet<&str> = evidence_rows().iter().map(|row| row.code).collect();
        known.extend(COVERAGE.iter().map(|row| row.code));
        let mut used = BTreeSet::new();
        for section in SECTIONS {
            used.extend(section.codes.iter().copied());
        }
        assert_eq!(used, known);
    }
}
