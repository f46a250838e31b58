//! The page `docs/verification.md` as Markdown, from its tables (`rows`) and recorded figures
//! (`figures`).

use std::fmt::Write;

use super::figures::{Coverage, Deviations, FigureFault, Figures};
use super::rows::{COVERAGE, EvidenceRow, SECTIONS, evidence_rows};

/// Codes for the comparisons with certified optima.
const OPTIMA: [&str; 3] = ["certified-gains", "certified-delays", "signed-delays"];

const HEAD: &str = "\
# Verification

Comparisons of the program with independent results, and how well they agree. Sections M1 to M18
are those of [method.md](method.md) and the pages beside it. The tests record the figures:

```sh
docs/make-verification            # runs the tests named below and writes this page
docs/make-verification --check    # runs them and reports figures that have changed
```

Each figure of this page is recorded by the test beside it; none is written by hand. Deviations
are rounded up to one digit, and those below 1e-9 to a power of ten, because rounding differs from
processor to processor.

`gdcm verify` makes the comparisons of the first table on your machine, in seconds, without any
file, and prints for each the equation, the source of the expected value, the worst deviation, and
the tolerance with its reason. It ends with status 0 if all pass and with status 1 otherwise;
`--json` gives the same with stable codes.
";

const PEERS: &str = "
## Independent references

| reference | compared | where |
|---|---|---|
| arithmetic with 50 digits | frequency responses | `tests/data/reference/frequency-response-golden.json` |
| an independent interval branch and bound; SCIP or IPOPT | minima of eq. (7) | `tests/data/reference/gain-instances.json` |
| an interior-point method | minima of eq. (11) | `tests/data/reference/delay-instances.json` |
| NumPy and SciPy, by code that shares nothing with the program | M3 to M18, as the tables above say | `tests/data/reference/`, `tests/data/identification*.json` |
| GNU Octave, Python, a C compiler | exported programs are run and their responses compared | `crates/gdcm-io/src/export/programs/program_tests.rs` |
| GNU Octave, h5py, NumPy, SciPy | files written by them are read | `tests/data/README.md` |
| python-control, SciPy | the same responses, with times | `benches/compare_with_python.sh`, [performance.md](performance.md) |
";

const NOT_VERIFIED: &str = "
## Not verified

- **Against flight.** The example is synthetic. Real flight data are those of two small quadrotors
  ([tutorial-real-aircraft.md](tutorial-real-aircraft.md)); no certified flight-test data of a
  helicopter were available.
- **Against the paper's own figures.** Its models and flight data are not public. The formulas are
  compared with independent code, not with the published numbers.
- **Against other identification programs.** CIFER and MATLAB's System Identification Toolbox were
  not available; identified models are compared with known truths and with independent code.
- **The reference code** and this program were written from the same description. An error in
  the description would be in both.
- **Errors that all identified models share** (airspeed offset, feedback, aliasing) are not part of
  the error bars; the coverage above holds for the generated errors that its rows name.
- **MATLAB** was not available: its files are read from the layouts that GNU Octave, SciPy and h5py
  write, and exported MATLAB programs are run by GNU Octave.
- **Requirements** are evaluated, not certified: levels and tolerances are those that the engineer
  enters.
- **Windows and macOS**: the figures are those of Linux on x86-64. `gdcm verify` repeats the first
  table on any machine.
";

/// Returns the page: comparisons of `gdcm verify`, comparisons that only tests make, certified
/// optima, coverage of intervals, the evidence by section, peers, and what is not verified.
///
/// # Errors
/// [`FigureFault::Missing`] if a row has no figure.
pub fn page_text(figures: &Figures) -> Result<String, FigureFault> {
    let mut text = HEAD.to_owned();
    text.push_str(&comparisons(figures)?);
    text.push_str(&certified_optima(figures)?);
    text.push_str(&interval_coverage(figures)?);
    text.push_str(&evidence_by_section());
    text.push_str(PEERS);
    text.push_str(NOT_VERIFIED);
    Ok(text)
}

/// Tabulates the comparisons that `gdcm verify` makes, then those that only tests make.
fn comparisons(figures: &Figures) -> Result<String, FigureFault> {
    let rows = evidence_rows();
    let mut text = "\n## Comparisons of gdcm verify\n\n".to_owned();
    text.push_str(EVIDENCE_HEAD);
    for row in rows.iter().filter(|row| row.is_verified) {
        text.push_str(&evidence_line(row, deviations(figures, row.code)?));
    }
    text.push_str("\n`gdcm verify` prints their tolerances and the reasons for them.\n");
    text.push_str("\n## Further comparisons\n\n");
    text.push_str(EVIDENCE_HEAD);
    for row in rows.iter().filter(|row| !row.is_verified) {
        text.push_str(&evidence_line(row, deviations(figures, row.code)?));
    }
    Ok(text)
}

/// Tabulates the deviations from certified optima.
fn certified_optima(figures: &Figures) -> Result<String, FigureFault> {
    let mut text = "\n## Certified optima\n\n".to_owned();
    text.push_str(
        "| code | instances | worst relative deviation of the objective |\n|---|---|---|\n",
    );
    for code in OPTIMA {
        let found = deviations(figures, code)?;
        let _ = writeln!(
            text,
            "| `{code}` | {} | {} |",
            found.instances,
            bound_text(found.worst)
        );
    }
    text.push_str(
        "\nEvery minimum of eq. (7) in these instances is also proven by the program itself, to a \
         relative\ngap of 1e-9.\n",
    );
    Ok(text)
}

/// Tabulates the coverages, and lists the populations in which they were measured.
fn interval_coverage(figures: &Figures) -> Result<String, FigureFault> {
    let mut text = "\n## Coverage of intervals\n\n".to_owned();
    text.push_str(
        "| code | section | intervals | nominal | covered | seeds | test |\n|---|---|---|---|---|---|---|\n",
    );
    for row in COVERAGE {
        let Some(found) = figures.coverage.get(row.code) else {
            return Err(FigureFault::Missing {
                code: row.code.to_owned(),
            });
        };
        text.push_str(&coverage_line(row.code, row.sections, found));
    }
    text.push('\n');
    for row in COVERAGE {
        let _ = writeln!(text, "- `{}`: {}.", row.code, row.what);
    }
    text.push_str(
        "\nMore populations: [uncertainty.md](uncertainty.md#measured-coverage), \
         [physics.md](physics.md#m187-limits).\n",
    );
    Ok(text)
}

/// Tabulates, for each method section, the codes of the figures that test it, and other tests.
fn evidence_by_section() -> String {
    let mut text = "\n## By section\n\n| section | evidence |\n|---|---|\n".to_owned();
    for section in SECTIONS {
        let mut parts: Vec<String> = Vec::new();
        for code in section.codes {
            parts.push(format!("`{code}`"));
        }
        if !section.note.is_empty() {
            parts.push(section.note.to_owned());
        }
        let _ = writeln!(
            text,
            "| [{} {}]({}) | {} |",
            section.number,
            section.title,
            section.page,
            parts.join(", ")
        );
    }
    text
}

const EVIDENCE_HEAD: &str = "\
| code | section | compared | expected by | instances | values | worst deviation | test |
|---|---|---|---|---|---|---|---|
";

fn deviations<'f>(figures: &'f Figures, code: &str) -> Result<&'f Deviations, FigureFault> {
    match figures.deviations.get(code) {
        Some(found) => Ok(found),
        None => Err(FigureFault::Missing {
            code: code.to_owned(),
        }),
    }
}

fn evidence_line(row: &EvidenceRow, found: &Deviations) -> String {
    format!(
        "| `{}` | {} | {} | {} | {} | {} | {}, {} | `{}` {} |\n",
        row.code,
        row.sections,
        row.what,
        row.source,
        found.instances,
        found.values,
        bound_text(found.worst),
        row.measure,
        found.package,
        test_name(&found.test)
    )
}

fn coverage_line(code: &str, sections: &str, found: &Coverage) -> String {
    format!(
        "| `{code}` | {sections} | {} | {:.0} % | {:.1} % | {} | `{}` {} |\n",
        found.intervals,
        100.0 * found.nominal,
        100.0 * found.share(),
        found.seeds,
        found.package,
        test_name(&found.test)
    )
}

/// Formats a test name, which a renderer may break between its modules.
fn test_name(test: &str) -> String {
    let parts: Vec<String> = test.split("::").map(|part| format!("`{part}`")).collect();
    parts.join(" :: ")
}

/// Rounds a deviation up to one digit; below 1e-9, up to a power of ten.
fn bound_text(worst: f64) -> String {
    if worst == 0.0 {
        return "0".to_owned();
    }
    let exponent = worst.log10().floor();
    let power = 10_f64.powf(exponent);
    let digit = (worst / power).ceil();
    if exponent < -9.0 || digit >= 10.0 {
        return format!("1e{}", exponent + 1.0);
    }
    format!("{digit}e{exponent}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_rounded_up() {
        assert_eq!(bound_text(0.0), "0");
        assert_eq!(bound_text(3.2e-13), "1e-12");
        assert_eq!(bound_text(8.31e-4), "9e-4");
        assert_eq!(bound_text(2.01e-9), "3e-9");
        assert_eq!(bound_text(9.7e-5), "1e-4");
    }

    /// The page in `docs` is the one that the recorded figures give.
    #[test]
    fn the_page_is_made_of_the_recorded_figures() {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
        let figures = std::fs::read_to_string(format!("{root}/tests/data/verification.json"))
            .expect("the figures are there");
        let figures: Figures = serde_json::from_str(&figures).expect("they are figures");
        let page = std::fs::read_to_string(format!("{root}/docs/verification.md"))
            .expect("the page is there");
        assert_eq!(page_text(&figures).expect("every row has its figure"), page);
    }
}
