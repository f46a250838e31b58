//! Figures for print: the content of the exported files, read back.

use std::sync::{Arc, LazyLock};

use gdcm_io::export::figure_file::write_as;
use gdcm_method::correction::Channel;
use gdcm_model::dataset::{ConditionId, Pair};
use gdcm_model::progress::Unobserved;
use gdcm_plot::figure::axis::Axis;
use gdcm_plot::figure::drawing::{Dash, Hue, Stroke};
use gdcm_plot::figure::figure::{Bars, Curve, Plot};
use gdcm_plot::figure::{
    Color, ColumnWidth, ConditionSource, Figure, FigureFormat, FigureKind, FigureRequest, Panel,
    Range, all_channels,
};
use gdcm_study::results::couplings_assessment::CouplingsAssessment;
use gdcm_study::results::physics_assessment::PhysicsAssessment;
use gdcm_study::results::required_modes::IdentifiedPoles;
use gdcm_study::results::requirements::Requirements;
use gdcm_study::stages::condition_curves::{CURVE_POINTS, ConditionCurves, curves_band};
use gdcm_study::{Analysis, CouplingCorrection, Edit, Engine, PhysicsCorrection, Study};

mod leads;
mod numbers;
mod pages;
mod views;

/// Data for figures of condition 10 of the example, with its suggested outliers rejected and with
/// error bars.
struct Example {
    analysis: Analysis,
    curves: Arc<ConditionCurves>,
    requirements: Arc<Requirements>,
    couplings: Arc<CouplingsAssessment>,
    physics: Arc<PhysicsAssessment>,
}

static EXAMPLE: LazyLock<Example> = LazyLock::new(|| {
    let mut study = Study::new(crate::EXAMPLE.dataset.clone());
    let mut engine = Engine::default();
    let first = engine.analyze(&study, &Unobserved).unwrap();
    let models = first.condition(CONDITION).unwrap().suggested();
    study
        .apply(&Edit::reject_physics(CONDITION, &models))
        .unwrap();
    let mut analysis = engine.analyze(&study, &Unobserved).unwrap();
    analysis.uncertainty = Some(Arc::new(
        engine.uncertainty(&analysis, &Unobserved).unwrap(),
    ));
    let grid = (curves_band(&study.settings), CURVE_POINTS);
    let curves = engine
        .curves(&study.dataset, CONDITION, grid, &Unobserved)
        .unwrap()
        .unwrap();
    let requirements = Arc::new(
        engine
            .requirements(&analysis, &IdentifiedPoles::default(), &Unobserved)
            .unwrap(),
    );
    let couplings = engine
        .assess_couplings(&study, CouplingCorrection::MixingAndFeedback, &Unobserved)
        .unwrap()
        .unwrap()
        .unwrap();
    let physics = engine
        .assess_physics(&study, PhysicsCorrection::Named, &Unobserved)
        .unwrap()
        .unwrap()
        .unwrap();
    Example {
        analysis,
        curves,
        requirements,
        couplings,
        physics,
    }
});

const CONDITION: ConditionId = ConditionId(10);

impl Example {
    fn source(&self) -> ConditionSource<'_> {
        ConditionSource {
            study: &self.analysis.study,
            analysis: self.analysis.condition(CONDITION),
            schedule: self.analysis.schedule.as_ref().ok(),
            curves: &self.curves,
            variant: None,
        }
    }

    fn pair(&self, output: &str, input: &str) -> Pair {
        self.analysis
            .study
            .dataset
            .find_pair(output, input)
            .unwrap()
    }

    fn on_axis(&self) -> Vec<Pair> {
        self.analysis
            .study
            .dataset
            .measuring_pairs()
            .marked()
            .collect()
    }

    fn channels(&self) -> Vec<Channel> {
        all_channels(&self.analysis.study.dataset)
    }

    fn figure(&self, kind: FigureKind, pairs: Vec<Pair>) -> Figure {
        let requirements = Some(Arc::clone(&self.requirements));
        let couplings = Some(Arc::clone(&self.couplings));
        let physics = Some(Arc::clone(&self.physics));
        self.request(&FigureRequest {
            requirements,
            couplings,
            physics,
            ..FigureRequest::new(kind, pairs, self.channels())
        })
    }

    fn request(&self, request: &FigureRequest) -> Figure {
        request
            .figure(Some(&self.analysis), Some(&self.source()))
            .unwrap()
    }
}

/// Returns a figure with one curve of two points, from corner to corner of a frame with known axis
/// ranges.
fn diagonal() -> Figure {
    let curve = Curve::new(
        "rising",
        Stroke {
            color: RED,
            width_pt: 3.0,
            dash: Dash::Solid,
        },
        [1.0, 100.0],
        [-5.0, 5.0],
    );
    let x = Axis::logarithmic("Frequency [rad/s]").showing(Some(Range::new(1.0, 100.0)));
    let y = Axis::linear("Magnitude [dB]").showing(Some(Range::new(-5.0, 5.0)));
    Figure::new("A line & <its> frame → Δφ")
        .plot(Plot::new("LON → Q").panel(Panel::new(x, y).with(curve.key("rising"))))
}

const RED: Color = Color::new(Hue::Nominal);

fn bytes(figure: &Figure, width: ColumnWidth, format: FigureFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    write_as(figure, width, format, &mut bytes).unwrap();
    bytes
}

fn svg(figure: &Figure) -> String {
    String::from_utf8(bytes(figure, ColumnWidth::Double, FigureFormat::Svg)).unwrap()
}
