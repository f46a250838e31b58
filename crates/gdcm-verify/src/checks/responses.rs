//! Frequency responses (M2).

use nalgebra::{Complex, DMatrix, dmatrix};

use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{Band, BundleKind, ConditionId, Dynamics, Pair, StateSpace};
use gdcm_model::response::{FrequencyGrid, FrequencyResponse};

use crate::check::{CheckFault, Found};
use crate::reference::{RESPONSES, Reference, model_file};
use crate::reference_study::ReferenceStudy;

/// Compares responses with 50-digit arithmetic.
pub(super) fn golden_responses(study: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for case in RESPONSES.read()?.list("cases")? {
        let dynamics = dynamics_of(&case, study)?;
        let mut largest = 0.0_f64;
        let mut errors = Vec::new();
        let omegas = case.numbers("omega_rad_s")?;
        for (omega, expected) in omegas.into_iter().zip(case.list("H_re_im")?) {
            let response = response_at(&dynamics, omega)?;
            for (output, row) in expected.elements()?.iter().enumerate() {
                for (input, value) in row.elements()?.iter().enumerate() {
                    let value = value.as_complex()?;
                    largest = largest.max(value.norm());
                    let own = response.curve(Pair::new(output, input))[0];
                    errors.push((own - value).norm());
                }
            }
        }
        found.instance();
        for error in errors {
            found.deviation(error / largest);
        }
    }
    Ok(found)
}

/// Returns the model that a case names: from the reference dataset or from the literature.
fn dynamics_of(case: &Reference, study: &mut ReferenceStudy) -> Result<Dynamics, CheckFault> {
    let name = case.text("model")?;
    if !case.has("condition") {
        let file = model_file(&name)?.read()?;
        let space = StateSpace::new(
            file.matrix("A")?,
            file.matrix("B")?,
            file.matrix("C")?,
            file.matrix("D")?,
        );
        return space
            .map(Dynamics::StateSpace)
            .map_err(CheckFault::no_result);
    }
    let id = ConditionId(case.integer("condition")?);
    let kind = match case.text("kind")?.as_str() {
        "physics_models" => BundleKind::Physics,
        _ => BundleKind::Identified,
    };
    let analysis = study.analysis()?;
    let Some(condition) = analysis.study.dataset.condition(id) else {
        return Err(CheckFault::no_result(format!("no condition {id}")));
    };
    for model in condition.bundle(kind) {
        if model.name == name {
            return Ok(model.dynamics.clone());
        }
    }
    Err(CheckFault::no_result(format!("no model {name}")))
}

/// Evaluates a model at one frequency, the lower end of a two-point grid, since a grid contains
/// both ends of its band.
fn response_at(dynamics: &Dynamics, omega: f64) -> Result<FrequencyResponse, CheckFault> {
    let band = Band::new(omega, 2.0 * omega).map_err(CheckFault::no_result)?;
    let grid = FrequencyGrid::logarithmic(band, 2);
    Ok(FrequencyResponse::from_dynamics(dynamics, &grid))
}

/// A first-order model with a sample time and channel delays.
struct TimedLag {
    sample_time_s: Option<f64>,
    input_delay_s: f64,
    output_delay_s: f64,
}

/// Poles: continuous-time lag \[rad/s\], discrete-time lag \[-\].
const POLES: [f64; 2] = [-1.7, 0.9];
/// Gain from input to state, `b` in the closed form.
const GAIN: f64 = 0.8;
/// Feed-through, `d` in the closed form.
const FEED_THROUGH: f64 = 0.3;

impl TimedLag {
    fn pole(&self) -> f64 {
        match self.sample_time_s {
            None => POLES[0],
            Some(_) => POLES[1],
        }
    }

    fn model(&self) -> Result<Dynamics, CheckFault> {
        let timing = Timing {
            sample_time_s: self.sample_time_s,
            input_delays_s: Some(vec![self.input_delay_s]),
            output_delays_s: Some(vec![self.output_delay_s]),
        };
        let one: DMatrix<f64> = dmatrix![1.0];
        StateSpace::new(
            dmatrix![self.pole()],
            dmatrix![GAIN],
            one,
            dmatrix![FEED_THROUGH],
        )
        .and_then(|space| space.timed(timing))
        .map(Dynamics::StateSpace)
        .map_err(CheckFault::no_result)
    }

    /// `(b / (z - a) + d) exp(-j omega (tau_o + tau_i))`, with the pole `a`, the delays `tau_o` and
    /// `tau_i`, and `z = exp(j omega T)` for the sample time `T`, or `j omega` in continuous time.
    fn closed_form(&self, omega: f64) -> Complex<f64> {
        let z = match self.sample_time_s {
            None => Complex::new(0.0, omega),
            Some(sample_time_s) => Complex::from_polar(1.0, omega * sample_time_s),
        };
        let delay_s = self.input_delay_s + self.output_delay_s;
        (GAIN / (z - self.pole()) + FEED_THROUGH) * Complex::from_polar(1.0, -omega * delay_s)
    }
}

/// Compares responses in discrete time and with delays with their closed form.
pub(super) fn timed_responses(_: &mut ReferenceStudy) -> Result<Found, CheckFault> {
    let mut found = Found::default();
    for sample_time_s in [None, Some(0.01), Some(0.05)] {
        for [input_delay_s, output_delay_s] in [[0.0, 0.0], [0.03, 0.0], [0.02, 0.15]] {
            let lag = TimedLag {
                sample_time_s,
                input_delay_s,
                output_delay_s,
            };
            let model = lag.model()?;
            found.instance();
            for omega in [0.5, 2.0, 5.0, 12.0] {
                let own = response_at(&model, omega)?.curve(Pair::new(0, 0))[0];
                let expected = lag.closed_form(omega);
                found.deviation((own - expected).norm() / expected.norm());
            }
        }
    }
    Ok(found)
}
