//! Frequency bands that the records do not excite: the messages, and the proposed band.

use gdcm_model::executor::Sequential;
use gdcm_model::progress::Unobserved;
use gdcm_sysid::identification::identify::identify;
use gdcm_sysid::identification::{IdentificationCaution, IdentificationError, Options};

use super::common::noisy_measured;
use super::whole::quick;
use crate::made_up::{Flight, Gusts, stable_aircraft};

#[test]
fn a_band_beyond_the_sweeps_is_offered_up_to_their_end() {
    // The sweeps end at 8.06 rad/s, where the window of a point extends 1.6 rad/s to either side.
    let records = Flight::of(
        stable_aircraft(),
        Gusts {
            states: 0.03,
            sensors: 0.05,
        },
    )
    .records(21, 4);
    let wide = Options {
        band: [0.6, 24.0],
        ..quick((2, 2))
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
    let is_of_band = |caution: &IdentificationCaution| {
        matches!(caution, IdentificationCaution::BandNotShown { .. })
    };
    assert!(
        !again.cautions.iter().any(is_of_band),
        "{:?}",
        again.cautions
    );
}

#[test]
fn the_ends_of_a_band_count_only_where_a_fifth_of_it_shows_nothing() {
    let whole = noisy_measured();
    let band = [0.5, 6.0];
    assert_eq!(
        whole.shown_band(band),
        None,
        "every input was moved over all of it"
    );
    let without = |hidden: &dyn Fn(f64) -> bool| {
        let mut measured = whole.clone();
        let hidden_points = measured
            .points
            .iter_mut()
            .filter(|point| hidden(point.omega));
        hidden_points.for_each(|point| point.partial_coherence.fill(0.3));
        measured
    };
    // A fifth of the band on the logarithmic axis: a factor of 12^0.2 = 1.64.
    let [low, high] = without(&|omega| omega > 3.0).shown_band(band).unwrap();
    assert!(low == 0.5 && (2.5..=3.0).contains(&high), "{high}");
    let [low, high] = without(&|omega| omega < 1.0).shown_band(band).unwrap();
    assert!((1.0..=1.2).contains(&low) && high == 6.0, "{low}");
    assert_eq!(
        without(&|omega| omega > 4.5).shown_band(band),
        None,
        "less than a fifth"
    );
    assert_eq!(
        without(&|omega| omega > 1.0 && omega < 3.0).shown_band(band),
        None,
        "the ends are shown"
    );
    assert_eq!(
        without(&|_| true).shown_band(band),
        None,
        "there is no other band to offer"
    );
}

#[test]
fn records_too_short_for_the_lower_end_of_the_band_say_which_end_they_would_do_for() {
    // 11 s are 1.05 periods of 0.6 rad/s, and 1.5 of 0.86 rad/s.
    let short = Flight {
        length_s: 11.0,
        ..Flight::of(stable_aircraft(), Gusts::light())
    };
    let records = short.records(22, 6);
    let of_band = |band| {
        identify(
            &records,
            &Options {
                band,
                ..quick((2, 2))
            },
            &Sequential,
            &Unobserved,
        )
    };
    let refused = of_band([0.6, 6.0]).unwrap_err();
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
    let offered = of_band([enough * 1.001, 6.0]).unwrap();
    let is_short =
        |caution: &IdentificationCaution| matches!(caution, IdentificationCaution::Short { .. });
    assert!(
        offered.cautions.iter().any(is_short),
        "{:?}",
        offered.cautions
    );
}
