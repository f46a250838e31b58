//! From the arrays of a file to matrices and responses.

use nalgebra::DMatrix;

use crate::dataset::{Dynamics, MeasuredResponse, Pair, PairTable, StateSpace};
use crate::io::content_fault::ContentFault;
use crate::io::flaw::Flaw;
use crate::io::nested::Nested;
use crate::io::place::Place;

use super::schema::ResponseText;

/// The four matrices, as far as a model gives them.
pub(super) struct Matrices {
    pub(super) a: Option<Nested<2>>,
    pub(super) b: Option<Nested<2>>,
    pub(super) c: Option<Nested<2>>,
    pub(super) d: Option<Nested<2>>,
}

impl Matrices {
    fn any(&self) -> bool {
        [&self.a, &self.b, &self.c, &self.d].into_iter().any(Option::is_some)
    }

    /// The model of these matrices, with `p` outputs and `m` inputs.
    pub(super) fn state_space(self, place: &Place, p: usize, m: usize) -> Result<StateSpace, Flaw> {
        let missing = |key: &str| Flaw::new(place.clone(), ContentFault::MissingKey { key: key.to_owned() });
        let a = self.a.ok_or_else(|| missing("A"))?;
        let b = self.b.ok_or_else(|| missing("B"))?;
        let c = self.c.ok_or_else(|| missing("C"))?;
        let d = self.d.ok_or_else(|| missing("D"))?;
        // Checked before the others are checked against it, so that they are not blamed for it.
        if d.shape != [p, m] {
            let expected = format!("{p} x {m} (outputs x inputs)");
            return Err(Flaw::new(place.at("matrix D"), ContentFault::Shape { expected, found: d.shape_words() }));
        }
        let order = a.shape[0];
        // A list without entries does not say how long its lists would be.
        let b = if order == 0 && b.shape[0] == 0 { DMatrix::zeros(0, m) } else { matrix(&b) };
        let c = if order == 0 && c.values.is_empty() { DMatrix::zeros(p, 0) } else { matrix(&c) };
        StateSpace::new(matrix(&a), b, c, matrix(&d)).map_err(|error| Flaw::new(place.clone(), error))
    }
}

fn matrix(array: &Nested<2>) -> DMatrix<f64> {
    DMatrix::from_row_slice(array.shape[0], array.shape[1], &array.values)
}

/// The dynamics of an identified model: matrices or frequency data, not both.
pub(super) fn state_space_or_response(
    matrices: Matrices,
    response: Option<ResponseText>,
    place: &Place,
    p: usize,
    m: usize,
) -> Result<Dynamics, Flaw> {
    match (matrices.any(), response) {
        (true, Some(_)) => Err(Flaw::new(place.clone(), ContentFault::BothDynamics)),
        (false, None) => Err(Flaw::new(place.clone(), ContentFault::NoDynamics)),
        (true, None) => Ok(Dynamics::StateSpace(matrices.state_space(place, p, m)?)),
        (false, Some(text)) => Ok(Dynamics::Measured(measured(text, place, p, m)?)),
    }
}

fn measured(text: ResponseText, place: &Place, p: usize, m: usize) -> Result<MeasuredResponse, Flaw> {
    let count = text.omega_rad_s.len();
    let table = |array: &Nested<3>, key: &str| {
        if array.shape != [p, m, count] {
            let expected = format!("{p} x {m} x {count} (outputs x inputs x frequencies)");
            let fault = ContentFault::Shape { expected, found: array.shape_words() };
            return Err(Flaw::new(place.at(format!("frequency_response, {key}")), fault));
        }
        Ok(PairTable::from_fn(p, m, |Pair { output, input }| {
            let start = (output * m + input) * count;
            array.values[start..start + count].to_vec()
        }))
    };
    let (re, im) = (table(&text.re, "re")?, table(&text.im, "im")?);
    let coherence = text.coherence.as_ref().map(|array| table(array, "coherence")).transpose()?;
    MeasuredResponse::new(text.omega_rad_s, &re, &im, coherence)
        .map_err(|error| Flaw::new(place.at("frequency_response"), error))
}
