//! Detection of a channel that is logged late in all records, by comparison with a physics model.

use nalgebra::{DMatrix, DVectorViewMut};

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::{Dynamics, StateSpace};
use gdcm_model::executor::Sequential;
use gdcm_model::response::frequency_grid::log_spaced;
use gdcm_model::simulation::FlightRecord;
use gdcm_study::results::channel_time_skew::ChannelTimeSkew;
use gdcm_sysid::identification::{Preparation, ResponseEstimate};
use gdcm_sysid::spectra::local_polynomial::local_polynomial;
use gdcm_sysid::spectra::preparation::prepare;
use gdcm_sysid::spectra::spectrum::spectra;

use super::common::HIGHEST_LINE;
use crate::synthetic::{Flight, Gusts, stable_aircraft};

const BAND: [f64; 2] = [0.6, 6.0];

/// Returns the measured response from four flights after the same `change` in every record.
fn measured(change: impl Fn(&mut FlightRecord)) -> ResponseEstimate {
    let mut records = Flight::new(stable_aircraft(), Gusts::light()).records(31, 4);
    records.iter_mut().for_each(change);
    let prepared = prepare(
        &records,
        &Preparation::new(&["LON", "LAT"], &["P", "Q"]),
        &Sequential,
    )
    .unwrap();
    local_polynomial(
        &spectra(&prepared.segments, HIGHEST_LINE, &Sequential),
        &log_spaced(0.3, 8.0, 40),
        &Sequential,
    )
    .unwrap()
}

/// Delays a channel by three samples of 40 ms, 0.12 s.
fn delay(mut channel: DVectorViewMut<'_, f64>) {
    let on_time = channel.clone_owned();
    for sample in 3..on_time.len() {
        channel[sample] = on_time[sample - 3];
    }
}

/// Compares a measured response with the true physics model.
fn find_late_channel(measured: &ResponseEstimate) -> Option<ChannelTimeSkew> {
    ChannelTimeSkew::find(measured, BAND, &Dynamics::StateSpace(stable_aircraft()))
}

#[test]
fn a_channel_late_in_every_record_is_found_by_comparison_with_the_physics_model() {
    assert_eq!(
        find_late_channel(&measured(|_| ())),
        None,
        "no channel is late"
    );
    for index in 0..2 {
        let late_output = measured(|record| delay(record.outputs.column_mut(index)));
        let found = find_late_channel(&late_output).unwrap();
        assert_eq!((found.role, found.index), (ChannelSide::Output, index));
        // The bias of the method over its windows, and gusts, amount to a few milliseconds.
        assert!((found.delay_s - 0.12).abs() < 0.01, "{}", found.delay_s);
        let late_input = measured(|record| delay(record.inputs.column_mut(index)));
        let found = find_late_channel(&late_input).unwrap();
        assert_eq!((found.role, found.index), (ChannelSide::Input, index));
        assert!((found.delay_s - 0.12).abs() < 0.01, "{}", found.delay_s);
    }
}

#[test]
fn a_delay_common_to_all_outputs_is_not_reported() {
    let all_late = measured(|record| {
        for output in 0..2 {
            delay(record.outputs.column_mut(output));
        }
    });
    assert_eq!(find_late_channel(&all_late), None);
}

#[test]
fn other_errors_of_the_physics_model_are_not_taken_for_a_delay() {
    let clean = measured(|_| ());
    let aircraft = stable_aircraft();
    let mut c = aircraft.c().clone();
    c.row_mut(1).neg_mut();
    let opposite_sign = wrong_model(aircraft.a().clone(), c);
    assert_eq!(ChannelTimeSkew::find(&clean, BAND, &opposite_sign), None);
    let too_fast = wrong_model(aircraft.a() * 1.6, aircraft.c().clone());
    assert_eq!(ChannelTimeSkew::find(&clean, BAND, &too_fast), None);
}

/// Returns the aircraft with other matrices A and C.
fn wrong_model(a: DMatrix<f64>, c: DMatrix<f64>) -> Dynamics {
    let aircraft = stable_aircraft();
    let b = aircraft.b().clone();
    let d = aircraft.d().clone();
    Dynamics::StateSpace(StateSpace::new(a, b, c, d).unwrap())
}
