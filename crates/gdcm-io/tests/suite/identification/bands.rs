//! Bands that the records do not excite at one end: the cautions, and the proposed band.

use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_sysid::identification::identify::identify;
use gdcm_sysid::identification::{
    IdentificationCaution, IdentificationError, Options, ResponseEstimate,
};

use super::common::noisy_response;
use super::whole::quick_options;
use crate::synthetic::{Flight, Gusts, stable_aircraft};

#[test]
fn a_band_wider_than_the_sweeps_is_proposed_up_to_their_end() {
    // The sweeps end at 8.06 rad/s, where the window of a point extends 1.6 rad/s to either side.
    let records = Flight::new(
        stable_aircraft(),
        Gusts {
            states: 0.03,
            sensors: 0.05,
        },
    )
    .records(21, 4);
    let wide = Options {
        band: [0.6, 24.0],
        ..quick_options((2, 2))
    };
    let found = identify(&records, &wide, &Sequential, &Unobserved).unwrap();
    let shown = found.cautions.iter().find_map(|caution| match caution {
        IdentificationCaution::BandNotShown {
            band: [0.6, 24.0],
            shown,
        } => Some(*shown),
        _ => None,
    });
    let shown = shown.unwrap_or_else(|| panic!("{:?}", found.cautions));
    assert!(
        shown[0] == 0.6 && (7.0..=10.0).contains(&shown[1]),
        "{shown:?}"
    );
    let again = identify(
        &records,
        &Options {
            band: shown,
            ..wide
        },
        &Sequential,
        &Unobserved,
    )
    .unwrap();
    assert!(
        !again
            .cautions
            .iter()
            .any(|caution| matches!(caution, IdentificationCaution::BandNotShown { .. })),
        "the proposed band is not excited either: {:?}",
        again.cautions
    );
}

/// Returns a measured response whose partial coherence is 0.3, too low to show anything, at the
/// frequencies \[rad/s\] that `is_hidden` selects.
fn with_low_coherence(
    measured: &ResponseEstimate,
    is_hidden: impl Fn(f64) -> bool,
) -> ResponseEstimate {
    let mut measured = measured.clone();
    for point in &mut measured.points {
        if is_hidden(point.omega) {
            point.partial_coherence.fill(0.3);
        }
    }
    measured
}

#[test]
fn a_narrower_band_is_proposed_only_if_a_fifth_of_it_at_an_end_has_low_coherence() {
    let whole = noisy_response();
    let band = [0.5, 6.0];
    assert_eq!(
        whole.shown_band(band),
        None,
        "every input is excited over the whole band"
    );
    // A fifth of the band on the logarithmic axis: a factor of 12^0.2 = 1.64.
    let [low, high] = with_low_coherence(&whole, |omega| omega > 3.0)
        .shown_band(band)
        .unwrap();
    assert!(low == 0.5 && (2.5..=3.0).contains(&high), "{high}");
    let [low, high] = with_low_coherence(&whole, |omega| omega < 1.0)
        .shown_band(band)
        .unwrap();
    assert!((1.0..=1.2).contains(&low) && high == 6.0, "{low}");
    assert_eq!(
        with_low_coherence(&whole, |omega| omega > 4.5).shown_band(band),
        None,
        "less than a fifth of the band is hidden"
    );
    assert_eq!(
        with_low_coherence(&whole, |omega| omega > 1.0 && omega < 3.0).shown_band(band),
        None,
        "the hidden frequencies are not at an end"
    );
    assert_eq!(
        with_low_coherence(&whole, |_| true).shown_band(band),
        None,
        "no band is left to propose"
    );
}

#[test]
fn records_too_short_for_a_band_are_refused_with_the_lower_end_they_suffice_for() {
    // At least 1.5 periods of the lower end are required, and 5 are recommended. 11 s are 1.05
    // periods of 0.6 rad/s, and 1.5 of 0.86 rad/s.
    let short = Flight {
        length_s: 11.0,
        ..Flight::new(stable_aircraft(), Gusts::light())
    };
    let records = short.records(22, 6);
    let in_band = |band| Options {
        band,
        ..quick_options((2, 2))
    };
    let refused = identify(&records, &in_band([0.6, 6.0]), &Sequential, &Unobserved).unwrap_err();
    let IdentificationError::TooShort {
        enough,
        needed_s,
        better_s,
        ..
    } = refused
    else {
        panic!("{refused}")
    };
    let period_s = std::f64::consts::TAU / 0.6;
    let expected = [
        (enough, 1.5 * std::f64::consts::TAU / 11.0),
        (needed_s, 1.5 * period_s),
        (better_s, 5.0 * period_s),
    ];
    for (found, expected) in expected {
        assert!((found - expected).abs() < 1e-9, "{found}, not {expected}");
    }
    let sufficient = in_band([enough * 1.001, 6.0]);
    let found = identify(&records, &sufficient, &Sequential, &Unobserved).unwrap();
    assert!(
        found
            .cautions
            .iter()
            .any(|caution| matches!(caution, IdentificationCaution::Short { .. })),
        "{:?}",
        found.cautions
    );
}
