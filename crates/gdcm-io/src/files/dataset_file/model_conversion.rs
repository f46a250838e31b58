//! Converts between models in files and in datasets.
//!
//! A *bundle* holds a condition's physics models, or its identified models. A physics model with
//! moved parameters is no bundle member: in a *run*, a single parameter is moved, in a *rerun*,
//! several together (M18). A *draft* is a model before its checks. Its *bands* are the standard
//! deviations of its response over frequency; *valid bands* are ranges of frequencies.

use nalgebra::DMatrix;

use gdcm_model::dataset::channel::ChannelSide;
use gdcm_model::dataset::dataset_draft::{BandsDraft, ModelDraft, ResponseArray, ResponseDraft};
use gdcm_model::dataset::location::Location;
use gdcm_model::dataset::measured_response::Estimate;
use gdcm_model::dataset::model::{Origin, Provenance};
use gdcm_model::dataset::physics_parameter::{MovedParameters, ParameterChange, ParameterError};
use gdcm_model::dataset::state_space::Timing;
use gdcm_model::dataset::{BundleKind, Model, MovedModel};

use super::json_form::{
    DeviationsText, ModelText, ParameterChangeText, ResponseText, SideText, SourceText,
};
use crate::content_fault::{ContentError, ContentFault};
use crate::json_reading::{Limited, Nested};

impl ModelText {
    /// Returns the keys that are present but have no meaning for models in this kind of bundle. The
    /// keys from `condition` on describe models outside a dataset, which have the same form.
    pub(super) fn misplaced_keys(&self, kind: BundleKind) -> Vec<&'static str> {
        let is_physics = kind == BundleKind::Physics;
        let mut misplaced = Vec::new();
        for (key, is_misplaced) in [
            ("role", !is_physics && self.role.is_some()),
            ("perturbation", !is_physics && self.perturbation.is_some()),
            ("parameter", !is_physics && self.parameter.is_some()),
            ("parameters", !is_physics && self.parameters.is_some()),
            ("method", is_physics && self.method.is_some()),
            ("order", is_physics && self.order.is_some()),
            ("bands", is_physics && self.bands.is_some()),
            ("condition", self.condition.is_some()),
            ("airspeed_kt", self.airspeed_kt.is_some()),
            ("altitude_ft", self.altitude_ft.is_some()),
            ("mass_kg", self.mass_kg.is_some()),
            ("inputs", self.inputs.is_some()),
            ("outputs", self.outputs.is_some()),
            ("input_units", self.input_units.is_some()),
            ("output_units", self.output_units.is_some()),
            ("notes", self.notes.is_some()),
            ("recommended", self.recommended.is_some()),
        ] {
            if is_misplaced {
                misplaced.push(key);
            }
        }
        misplaced
    }

    /// Returns the parameters moved in a physics model; `None` for a bundle member.
    ///
    /// # Errors
    /// Fails if the model is both a run and a rerun.
    pub(crate) fn moved_parameters(&self) -> Result<Option<MovedParameters>, ParameterError> {
        match (&self.parameter, &self.parameters) {
            (None, None) => Ok(None),
            (Some(run), None) => Ok(Some(MovedParameters::Run(run.change()))),
            (None, Some(Limited(changes))) => Ok(Some(MovedParameters::Rerun(
                changes.iter().map(ParameterChangeText::change).collect(),
            ))),
            (Some(_), Some(_)) => Err(ParameterError::RunAndRerun),
        }
    }

    /// Returns a physics model's origin, given by its role. A model with moved parameters may omit
    /// the role or call itself nominal; it is perturbed all the same, because it is no bundle
    /// member.
    ///
    /// # Errors
    /// Fails if a bundle member lacks a role, or if a role is neither nominal nor perturbed.
    pub(super) fn physics_origin(&self, place: &Location) -> Result<Origin, ContentError> {
        let is_moved = self.parameter.is_some() || self.parameters.is_some();
        if is_moved && matches!(self.role.as_deref(), None | Some("nominal")) {
            return Ok(Origin::Perturbed {
                perturbation: self.perturbation.clone(),
            });
        }
        let Some(role) = &self.role else {
            let fault = ContentFault::MissingKey { key: "role".into() };
            return Err(ContentError::new(place.clone(), fault));
        };
        match self.origin() {
            Some(origin @ (Origin::Nominal { .. } | Origin::Perturbed { .. })) => Ok(origin),
            Some(Origin::Identified { .. }) | None => {
                let fault = ContentFault::Word {
                    expected: "\"nominal\" or \"perturbed\"".to_owned(),
                    found: role.clone(),
                };
                Err(ContentError::new(place.at("role"), fault))
            }
        }
    }

    pub(crate) fn identified_origin(&self) -> Origin {
        Origin::Identified {
            method: self.method.clone(),
            order: self.order,
        }
    }

    /// Returns the origin given by the role; `None` for a missing or unknown role.
    pub(crate) fn origin(&self) -> Option<Origin> {
        let perturbation = self.perturbation.clone();
        match self.role.as_deref() {
            Some("nominal") => Some(Origin::Nominal { perturbation }),
            Some("perturbed") => Some(Origin::Perturbed { perturbation }),
            Some("identified") => Some(self.identified_origin()),
            _ => None,
        }
    }

    /// Converts the file's entry to an identified model draft for a dataset or a study.
    pub(crate) fn into_identified(self) -> ModelDraft {
        let origin = self.identified_origin();
        self.into_draft(origin)
    }

    /// Converts the file's entry to a draft with this origin, without moved parameters, which the
    /// reader of datasets adds.
    pub(crate) fn into_draft(self, origin: Origin) -> ModelDraft {
        let bands = match origin {
            Origin::Identified { .. } => self.bands.map(DeviationsText::into_draft),
            Origin::Nominal { .. } | Origin::Perturbed { .. } => None,
        };
        ModelDraft {
            name: self.name,
            origin,
            timing: Timing {
                sample_time_s: self.sample_time_s,
                input_delays_s: self.input_delays_s.map(|list| list.0),
                output_delays_s: self.output_delays_s.map(|list| list.0),
            },
            matrices: [self.a, self.b, self.c, self.d].map(|array| array.map(dense_matrix)),
            response: self.frequency_response.map(ResponseText::into_draft),
            states: Limited::entries(self.states),
            source: self.source.map(SourceText::into_provenance),
            bands,
            moved: None,
        }
    }

    pub(crate) fn of_model(model: &Model) -> Self {
        Self::from_draft(ModelDraft::from_model(model))
    }

    pub(super) fn of_moved(moved: &MovedModel) -> Self {
        Self::from_draft(ModelDraft::from_moved(moved))
    }

    pub(crate) fn from_draft(draft: ModelDraft) -> Self {
        let [a, b, c, d] = draft
            .matrices
            .map(|matrix| matrix.as_ref().map(Nested::of_matrix));
        let Timing {
            sample_time_s,
            input_delays_s,
            output_delays_s,
        } = draft.timing;
        let origin = match draft.origin {
            Origin::Nominal { perturbation } => Self {
                role: Some("nominal".to_owned()),
                perturbation,
                ..Self::default()
            },
            Origin::Perturbed { perturbation } => Self {
                role: Some("perturbed".to_owned()),
                perturbation,
                ..Self::default()
            },
            // In a dataset the bundle implies the role; outside, `model_text` adds it.
            Origin::Identified { method, order } => Self {
                method,
                order,
                ..Self::default()
            },
        };
        let mut parameter = None;
        let mut parameters = None;
        match draft.moved {
            Some(MovedParameters::Run(change)) => {
                parameter = Some(ParameterChangeText::from_change(change));
            }
            Some(MovedParameters::Rerun(changes)) => {
                let texts = changes.into_iter().map(ParameterChangeText::from_change);
                parameters = Some(Limited(texts.collect()));
            }
            None => {}
        }
        Self {
            name: draft.name,
            parameter,
            parameters,
            states: Limited::some(draft.states),
            a,
            b,
            c,
            d,
            sample_time_s,
            input_delays_s: input_delays_s.map(Limited),
            output_delays_s: output_delays_s.map(Limited),
            frequency_response: draft.response.map(ResponseText::from_draft),
            bands: draft.bands.map(DeviationsText::from_draft),
            source: draft.source.map(SourceText::from_provenance),
            ..origin
        }
    }
}

impl ParameterChangeText {
    fn change(&self) -> ParameterChange {
        ParameterChange {
            name: self.name.clone(),
            delta: self.delta,
            unit: self.unit.clone(),
        }
    }

    fn from_change(change: ParameterChange) -> Self {
        Self {
            name: change.name,
            delta: change.delta,
            unit: change.unit,
        }
    }
}

fn dense_matrix(array: Nested<2>) -> DMatrix<f64> {
    DMatrix::from_row_slice(array.shape[0], array.shape[1], &array.values)
}

fn response_array(Nested { shape, values }: Nested<3>) -> ResponseArray {
    ResponseArray { shape, values }
}

fn nested_lists(ResponseArray { shape, values }: ResponseArray) -> Nested<3> {
    Nested { shape, values }
}

impl DeviationsText {
    fn into_draft(self) -> BandsDraft {
        BandsDraft {
            omega: self.omega_rad_s,
            sd_db: response_array(self.sd_db),
            sd_deg: response_array(self.sd_deg),
        }
    }

    fn from_draft(bands: BandsDraft) -> Self {
        Self {
            omega_rad_s: bands.omega,
            sd_db: nested_lists(bands.sd_db),
            sd_deg: nested_lists(bands.sd_deg),
        }
    }
}

impl ResponseText {
    fn into_draft(self) -> ResponseDraft {
        ResponseDraft {
            omega: self.omega_rad_s,
            re: response_array(self.re),
            im: response_array(self.im),
            coherence: self.coherence.map(response_array),
            valid_bands: self.valid_band_rad_s.map(response_array),
            estimate: Estimate {
                averages: self.averages,
                window_s: self.window_s,
            },
        }
    }

    fn from_draft(response: ResponseDraft) -> Self {
        let Estimate { averages, window_s } = response.estimate;
        Self {
            omega_rad_s: response.omega,
            re: nested_lists(response.re),
            im: nested_lists(response.im),
            coherence: response.coherence.map(nested_lists),
            valid_band_rad_s: response.valid_bands.map(nested_lists),
            averages,
            window_s,
        }
    }
}

impl SourceText {
    fn into_provenance(self) -> Provenance {
        let Self {
            file,
            sha256,
            variable,
            made,
            note,
            records,
            unused,
            by_position,
        } = self;
        Provenance {
            file,
            sha256,
            variable,
            made,
            note,
            records: Limited::entries(records),
            unused: Limited::entries(unused),
            by_position: Limited::entries(by_position)
                .into_iter()
                .map(SideText::side)
                .collect(),
        }
    }

    fn from_provenance(source: Provenance) -> Self {
        let Provenance {
            file,
            sha256,
            variable,
            made,
            note,
            records,
            unused,
            by_position,
        } = source;
        Self {
            file,
            sha256,
            variable,
            made,
            note,
            records: Limited::some(records),
            unused: Limited::some(unused),
            by_position: Limited::some(by_position.into_iter().map(SideText::from_side).collect()),
        }
    }
}

impl SideText {
    fn side(self) -> ChannelSide {
        match self {
            Self::Inputs => ChannelSide::Input,
            Self::Outputs => ChannelSide::Output,
        }
    }

    fn from_side(side: ChannelSide) -> Self {
        side.pick(Self::Inputs, Self::Outputs)
    }
}
