//! What every role has at the cursor, and how far that is from the identified model.

use crate::view::plot::LogAxis;
use gdcm_core::response::wrap;
use gdcm_core::units::s_to_ms;

use super::plot::{BodeCurve, BodeQuantity, FrequencyUnit, Pane, Readout, ReadoutRow, Role, decimals};

/// The values of every role at the cursor \[rad/s\], or what changes between two marked frequencies; nothing without either.
pub fn cursor_readout(
    curves: &[BodeCurve],
    quantity: BodeQuantity<'_>,
    unit: FrequencyUnit,
    (cursor, pinned): (Option<f64>, &[f64]),
) -> Option<Readout> {
    let of_each = |row: &dyn Fn(&[&BodeCurve]) -> Vec<String>| -> Vec<ReadoutRow> {
        let members = |role: Role| -> Vec<&BodeCurve> {
            curves.iter().filter(|curve| !curve.hidden && curve.role.shown(curve.rejected) == role).collect()
        };
        let rows = Role::ALL.into_iter().map(|role| (role, members(role)));
        let present = rows.filter(|(_, members)| !members.is_empty());
        present.map(|(role, members)| ReadoutRow { role, cells: row(&members) }).collect()
    };
    if let [from, to] = *pinned {
        let heading = format!("{} → {}", unit.readout(from), unit.readout(to));
        let rows = of_each(&|members| change_cells(members, quantity, (from, to)));
        return Some(Readout { heading, columns: names(quantity, ["Δ", "Δ"]), rows });
    }
    let omega = cursor.or(pinned.first().copied())?;
    let heading = unit.readout(omega);
    let readout = match quantity {
        BodeQuantity::Error { .. } => {
            let rows = of_each(&|members| value_cells(members, quantity, omega).to_vec());
            Readout { heading, columns: names(quantity, ["", ""]), rows }
        }
        BodeQuantity::Response { .. } => {
            let reference = curves.iter().find(|curve| curve.role == Role::IdentifiedRepresentative);
            let rows = of_each(&|members| {
                let differences = difference_cells(members, reference, omega);
                value_cells(members, quantity, omega).into_iter().chain(differences).collect()
            });
            let mut columns = names(quantity, ["", ""]);
            columns.extend(["Δ dB", "Δ deg", "Δ ms"]);
            Readout { heading, columns, rows }
        }
    };
    Some(readout)
}

/// The columns of magnitude and phase.
fn names(quantity: BodeQuantity<'_>, marks: [&str; 2]) -> Vec<&'static str> {
    let is_change = !marks[0].is_empty();
    [Pane::Magnitude, Pane::Phase].map(|pane| quantity.column(pane, is_change)).to_vec()
}

/// One number of several curves: itself, or from where to where it goes.
fn cell(values: impl Iterator<Item = f64>, count: usize) -> String {
    let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in values.filter(|value| value.is_finite()) {
        (least, greatest) = (least.min(value), greatest.max(value));
    }
    match (least <= greatest, decimals(least, count), decimals(greatest, count)) {
        (false, ..) => "–".to_owned(),
        (true, least, greatest) if least == greatest => least,
        (true, least, greatest) => format!("{least}…{greatest}"),
    }
}

fn value_cells(members: &[&BodeCurve], quantity: BodeQuantity<'_>, omega: f64) -> [String; 2] {
    [Pane::Magnitude, Pane::Phase].map(|pane| {
        let values = members.iter().filter_map(|curve| curve.value_at(pane, omega));
        cell(values.map(|value| quantity.shown_value(pane, value)), quantity.decimals(pane))
    })
}

fn change_cells(members: &[&BodeCurve], quantity: BodeQuantity<'_>, (from, to): (f64, f64)) -> Vec<String> {
    let change = |pane| {
        let of = move |curve: &&BodeCurve| Some(curve.value_at(pane, to)? - curve.value_at(pane, from)?);
        cell(members.iter().filter_map(of), quantity.decimals(pane))
    };
    [Pane::Magnitude, Pane::Phase].map(change).to_vec()
}

/// Magnitude \[dB\] and phase \[deg\] less those of the reference, and the delay \[ms\] that the difference of phases means: its
/// principal value, for a single frequency knows no turns (M4).
fn difference_cells(members: &[&BodeCurve], reference: Option<&BodeCurve>, omega: f64) -> [String; 3] {
    let difference = |pane| {
        let of_reference = reference.and_then(|reference| reference.value_at(pane, omega));
        members.iter().filter_map(move |curve| Some(curve.value_at(pane, omega)? - of_reference?))
    };
    let phases: Vec<f64> = difference(Pane::Phase).map(|degrees| wrap(degrees.to_radians())).collect();
    [
        cell(difference(Pane::Magnitude), 2),
        cell(phases.iter().map(|phase| phase.to_degrees()), 1),
        cell(phases.iter().map(|phase| s_to_ms(phase / omega)), 1),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::plot::CurveId;
    use gdcm_core::dataset::{BundleKind, ConditionId, ModelId};

    fn flat(name: &str, role: Role, magnitude_db: f64, phase_deg: f64) -> BodeCurve {
        BodeCurve {
            id: CurveId::Model(ModelId::new(ConditionId(1), BundleKind::Physics, name)),
            label: name.to_owned(),
            detail: String::new(),
            role,
            rejected: false,
            highlighted: false,
            hidden: false,
            omega: vec![1.0, 4.0].into(),
            magnitude_db: vec![magnitude_db; 2].into(),
            phase_deg: vec![phase_deg, phase_deg - 90.0].into(),
        }
    }

    fn curves() -> Vec<BodeCurve> {
        vec![
            flat("a", Role::Perturbed, -3.0, 0.0),
            flat("b", Role::Perturbed, -1.0, 0.0),
            flat("n", Role::Nominal, 2.0, 400.0),
            flat("i", Role::IdentifiedRepresentative, 1.0, 10.0),
        ]
    }

    fn readout(pinned: &[f64]) -> Readout {
        let cursor = pinned.is_empty().then_some(1.0);
        let unit = FrequencyUnit::RadPerSecond;
        cursor_readout(&curves(), BodeQuantity::RESPONSE, unit, (cursor, pinned)).unwrap()
    }

    fn cells(readout: &Readout, role: Role) -> Vec<&str> {
        let row = readout.rows.iter().find(|row| row.role == role).unwrap();
        row.cells.iter().map(String::as_str).collect()
    }

    #[test]
    fn every_role_is_listed_with_its_difference_from_the_identified_model() {
        let readout = readout(&[]);
        assert_eq!(readout.columns, ["dB", "deg", "Δ dB", "Δ deg", "Δ ms"]);
        // 400° is a turn and 30° ahead of 10°: 30° at 1 rad/s are 523.6 ms.
        assert_eq!(cells(&readout, Role::Nominal), ["2.0", "400", "1.00", "30.0", "523.6"]);
        assert_eq!(cells(&readout, Role::IdentifiedRepresentative), ["1.0", "10", "0.00", "0.0", "0.0"]);
        assert_eq!(cells(&readout, Role::Perturbed)[0], "\u{2212}3.0…\u{2212}1.0", "of several models, the range");
    }

    #[test]
    fn between_two_marks_the_changes_are_listed() {
        let readout = readout(&[1.0, 4.0]);
        assert_eq!(readout.columns, ["Δ dB", "Δ deg"]);
        assert_eq!(cells(&readout, Role::Nominal), ["0.0", "\u{2212}90"]);
        assert_eq!(readout.heading, "ω 1.00 rad/s → ω 4.00 rad/s");
    }

    #[test]
    fn without_a_cursor_there_is_nothing_to_list() {
        let unit = FrequencyUnit::RadPerSecond;
        assert_eq!(cursor_readout(&curves(), BodeQuantity::RESPONSE, unit, (None, &[])), None);
    }
}
