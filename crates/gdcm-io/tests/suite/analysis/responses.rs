//! Frequency responses against 50-digit arithmetic.

use gdcm_model::dataset::Band;

use super::*;

/// Frequency responses in 50-digit arithmetic (source: `tests/data/README.md`).
pub const GOLDEN: &str =
    include_str!("../../../../../tests/data/reference/frequency-response-golden.json");

fn matrix(value: &Value) -> DMatrix<f64> {
    let rows: Vec<Vec<f64>> = list(value).iter().map(numbers).collect();
    DMatrix::from_fn(rows.len(), rows[0].len(), |row, column| rows[row][column])
}

/// Returns a model from the literature, or the near-defective one, by file name.
pub fn model_of(file: &str) -> Dynamics {
    let value = json(match file {
        "compleib_HE2_AH64_130kt.json" => {
            include_str!(
                "../../../../../tests/data/reference/published-models/compleib_HE2_AH64_130kt.json"
            )
        }
        "compleib_HE3_Bell205_6out.json" => {
            include_str!(
                "../../../../../tests/data/reference/published-models/compleib_HE3_Bell205_6out.json"
            )
        }
        "westland_lynx_hover_6out.json" => {
            include_str!(
                "../../../../../tests/data/reference/published-models/westland_lynx_hover_6out.json"
            )
        }
        "yamaha_R50_hover_mettler.json" => {
            include_str!(
                "../../../../../tests/data/reference/published-models/yamaha_R50_hover_mettler.json"
            )
        }
        "../near-defective-model.json" => {
            include_str!("../../../../../tests/data/reference/near-defective-model.json")
        }
        _ => panic!("no model {file}"),
    });
    let [a, b, c, d] = ["A", "B", "C", "D"].map(|key| matrix(&value[key]));
    Dynamics::StateSpace(StateSpace::new(a, b, c, d).unwrap())
}

/// Returns a model of the example by condition, bundle and name, or a model from a file.
pub fn dynamics_of(case: &Value) -> Dynamics {
    let name = case["model"].as_str().unwrap();
    let Some(id) = case["condition"].as_i64() else {
        return model_of(name);
    };
    let bundle = match case["kind"].as_str().unwrap() {
        "physics_models" => BundleKind::Physics,
        "identified_models" => BundleKind::Identified,
        kind => panic!("no bundle {kind}"),
    };
    let dataset = crate::REFERENCE_DATASET.dataset.clone();
    let condition = dataset
        .conditions()
        .iter()
        .find(|condition| condition.id() == ConditionId(id))
        .unwrap();
    condition
        .bundle(bundle)
        .iter()
        .find(|model| model.name == name)
        .unwrap()
        .dynamics
        .clone()
}

/// Returns the response at a single frequency: the lower end of a grid of two points, since a grid
/// contains both ends of its band.
fn response_at(dynamics: &Dynamics, omega: f64) -> PairTable<Complex<f64>> {
    let band = Band::new(omega, 2.0 * omega).unwrap();
    let response = FrequencyResponse::from_dynamics(dynamics, &FrequencyGrid::logarithmic(band, 2));
    response.curves().map(|_, values| values[0])
}

#[test]
fn responses_agree_with_50_digit_arithmetic_to_a_billionth_of_the_largest() {
    let golden = json(GOLDEN);
    assert_eq!(list(&golden["cases"]).len(), 8);
    for case in list(&golden["cases"]) {
        let dynamics = dynamics_of(case);
        let mut largest = 0.0_f64;
        let mut error = 0.0_f64;
        for (omega, expected) in numbers(&case["omega_rad_s"])
            .into_iter()
            .zip(list(&case["H_re_im"]))
        {
            let response = response_at(&dynamics, omega);
            assert_eq!(
                (response.outputs(), response.inputs()),
                (list(expected).len(), list(&expected[0]).len())
            );
            for (Pair { output, input }, found) in response.iter() {
                let value = numbers(&expected[output][input]);
                let value = Complex::new(value[0], value[1]);
                largest = largest.max(value.norm());
                error = error.max((found - value).norm());
            }
        }
        assert!(
            largest > 0.0 && error <= 1e-9 * largest,
            "{}: relative error {:.1e}",
            case["model"],
            error / largest
        );
    }
}
