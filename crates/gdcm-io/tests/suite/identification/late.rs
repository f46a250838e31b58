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

use crate::made_up::{Flight, Gusts, stable_aircraft};

const BAND: [f64; 2] = [0.6, 6.0];

/// Returns the measured response from four flights after the same `change` in every record.
fn measured(change: impl Fn(&mut FlightRecord)) -> ResponseEstimate {
    let mut records = Flight::of(stable_aircraft(), Gusts::light()).records(31, 4);
    records.iter_mut().for_each(change);
    let prepared = prepare(
        &records,
        &Preparation::new(&["LON", "LAT"], &["P", "Q"]),
        &Sequential,
    )
    .unwrap();
    local_polynomial(
        &spectra(&prepared.segments, 10.4, &Sequential),
        &log_spaced(0.3, 8.0, 40),
        &Sequential,
    )
    .unwrap()
}

/// Delays a channel by three samples of 40 ms.
fn late(mut channel: DVectorViewMut<'_, f64>) {
    let logged = channel.clone_owned();
    (3..logged.len()).for_each(|sample| channel[sample] = logged[sample - 3]);
}

fn found(measured: &ResponseEstimate) -> Option<(ChannelSide, usize, f64)> {
    let late = ChannelTimeSkew::find(measured, BAND, &Dynamics::StateSpace(stable_aircraft()))?;
    Some((late.role, late.index, late.delay_s))
}

#[test]
fn a_channel_that_is_late_in_every_record_is_told_against_the_physics_model() {
    assert_eq!(found(&measured(|_| ())), None, "nothing is late");
    for index in 0..2 {
        let (role, of, delay_s) =
            found(&measured(|record| late(record.outputs.column_mut(index)))).unwrap();
        assert_eq!((role, of), (ChannelSide::Output, index));
        // The bias of the method over its windows, and gusts, amount to a few milliseconds.
        assert!((delay_s - 0.12).abs() < 0.01, "{delay_s}");
        let (role, of, delay_s) =
            found(&measured(|record| late(record.inputs.column_mut(index)))).unwrap();
        assert_eq!((role, of), (ChannelSide::Input, index));
        assert!((delay_s - 0.12).abs() < 0.01, "{delay_s}");
    }
}

#[test]
fn what_all_channels_have_in_common_is_said_of_none() {
    let all = measured(|record| (0..2).for_each(|output| late(record.outputs.column_mut(output))));
    assert_eq!(found(&all), None);
}

#[test]
fn a_physics_model_that_is_wrong_otherwise_is_no_delay() {
    let clean = measured(|_| ());
    let with = |a: DMatrix<f64>, c: DMatrix<f64>| {
        let of = stable_aircraft();
        Dynamics::StateSpace(StateSpace::new(a, of.b().clone(), c, of.d().clone()).unwrap())
    };
    let of = stable_aircraft();
    let mut turned = of.c().clone();
    // An output with the opposite sign.
    turned.row_mut(1).neg_mut();
    assert_eq!(
        ChannelTimeSkew::find(&clean, BAND, &with(of.a().clone(), turned)),
        None
    );
    assert_eq!(
        ChannelTimeSkew::find(&clean, BAND, &with(of.a() * 1.6, of.c().clone())),
        None
    );
}
