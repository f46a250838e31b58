//! What an identification searches, where that is not left to the records: band, orders, past windows, Laguerre poles.

use std::fmt::Display;
use std::sync::Arc;

use egui::{CollapsingHeader, ComboBox, Grid, Id, PopupCloseBehavior, RichText, Role as AccessRole, Ui};

use crate::view::{Command, Palette, entry_ui, named, typed_number};
use gdcm_core::identification::{HIGHEST_ORDER, LONGEST_PAST, SearchSpace};
use gdcm_core::units::number;

use super::{ConditionRecords, Page, RecordsCommand, kept};

const FIELD_WIDTH: f32 = 150.0;
/// Fields that cautions go to.
pub(super) const ORDERS: &str = "orders";
pub(super) const REFERENCES: &str = "references";

/// A field for each, behind a heading; an empty one leaves it to the records. Goes to `field` once that is there.
pub(super) fn advanced_ui(ui: &mut Ui, page: Page<'_>, field: &mut Option<&'static str>, commands: &mut Vec<Command>) {
    let Page { state, records, palette } = page;
    let band = state.study.settings.band;
    let of_study = format!("{} {} (the study's)", number(band.min()), number(band.max()));
    let said = records.band.map_or_else(String::new, |[low, high]| format!("{} {}", number(low), number(high)));
    let search = &records.search;
    let lists: [(&str, String, &str, Sets); 3] = [
        (ORDERS, listed(&search.orders), "by the records: 1 to 24", |search, list| {
            search.orders = whole(list, HIGHEST_ORDER)?;
            Ok(())
        }),
        ("past windows", listed(&search.pasts), "by the records: 8 to 24", |search, list| {
            search.pasts = whole(list, LONGEST_PAST)?;
            Ok(())
        }),
        ("Laguerre poles", listed(&search.poles), "0.375, 0.54, 0.75 of the band's end", |search, list| {
            let wrong = list.iter().find(|pole| **pole <= 0.0);
            search.poles = list.to_vec();
            wrong.map_or(Ok(()), |pole| Err(format!("a pole is positive, found {}", number(*pole))))
        }),
    ];
    let header = CollapsingHeader::new(palette.small("Advanced")).id_salt("advanced identification");
    header.open(field.is_some().then_some(true)).show(ui, |ui| {
        Grid::new("advanced identification").num_columns(2).spacing([6.0, 3.0]).show(ui, |ui| {
            if let Some(text) = field_ui(ui, "band [rad/s]", &said, &of_study, palette) {
                commands.push(match numbers(&text).and_then(|list| band_of(&list)) {
                    Ok(band) => RecordsCommand::SetBand(band).into(),
                    Err(why) => Command::Refuse(why),
                });
            }
            let is_wanted = *field == Some(REFERENCES);
            references_ui(ui, page, is_wanted, commands);
            for (name, said, hint, sets) in lists {
                if let Some(text) = field_ui(ui, name, &said, hint, palette) {
                    let mut wanted = search.clone();
                    commands.push(match numbers(&text).and_then(|list| sets(&mut wanted, &list)) {
                        Ok(()) => RecordsCommand::SetSearch(wanted).into(),
                        Err(why) => Command::Refuse(format!("{name}: {why}")),
                    });
                }
            }
        });
        if let Some(name) = field.take() {
            ui.scroll_to_cursor(None);
            if name != REFERENCES {
                let field = Id::unique(("entry", format!("Identification: {name}"))).with("field");
                ui.memory_mut(|memory| memory.request_focus(field));
            }
        }
    });
}

/// Which columns are recorded references: those first whose names say that they may be.
fn references_ui(ui: &mut Ui, page: Page<'_>, is_wanted: bool, commands: &mut Vec<Command>) {
    let Page { records, palette, .. } = page;
    ui.label(palette.small(REFERENCES));
    let said = &records.references;
    let text = if said.is_empty() { "none".to_owned() } else { said.join(", ") };
    let list = ComboBox::from_id_salt(REFERENCES).width(FIELD_WIDTH).selected_text(text).truncate();
    let list = list.close_behavior(PopupCloseBehavior::CloseOnClickOutside).show_ui(ui, |ui| {
        let possible = possible_references(ui, records);
        let unknown = said.iter().filter(|name| possible.iter().all(|(known, _)| known != *name));
        for (name, is_named) in unknown.map(|name| (name, true)).chain(possible.iter().map(|(name, of)| (name, *of))) {
            let mut is_chosen = said.contains(name);
            let text = if is_named { RichText::new(name).strong() } else { RichText::new(name) };
            if ui.checkbox(&mut is_chosen, text).changed() {
                let others = said.iter().filter(|other| *other != name).chain(is_chosen.then_some(name));
                commands.push(RecordsCommand::SetReferences(others.cloned().collect()).into());
            }
        }
    });
    if is_wanted {
        list.response.request_focus();
    }
    let hint = "Columns of recorded signals that drove the loop from outside (M14.15)";
    named(list.response.on_hover_text(hint), AccessRole::ComboBox, "Identification: references");
    ui.end_row();
}

/// The columns of the first record used that may be references, and whether their names say so; those first.
pub(super) fn possible_references(ui: &Ui, records: &ConditionRecords) -> Arc<Vec<(String, bool)>> {
    let Some((_, row)) = records.used_rows().next() else { return Arc::default() };
    let of_row = || row.possible_references().into_iter().map(|(name, is_named)| (name.to_owned(), is_named)).collect();
    kept(ui, "possible references", &[Arc::clone(&row.table) as _], format!("{:?}", row.layout), of_row)
}

/// Takes a list over into what is searched, or says what is wrong with it.
type Sets = fn(&mut SearchSpace, &[f64]) -> Result<(), String>;

fn field_ui(ui: &mut Ui, name: &str, said: &str, hint: &str, palette: &Palette) -> Option<String> {
    ui.label(palette.small(name));
    let text = entry_ui(ui, &format!("Identification: {name}"), said, hint, FIELD_WIDTH);
    ui.end_row();
    text
}

fn listed<T: Display>(list: &[T]) -> String {
    list.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Numbers between blanks.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    text.split_whitespace().filter_map(|part| typed_number(part.trim_end_matches([',', ';'])).transpose()).collect()
}

fn band_of(list: &[f64]) -> Result<Option<[f64; 2]>, String> {
    match *list {
        [] => Ok(None),
        [low, high] if 0.0 < low && low < high => Ok(Some([low, high])),
        _ => Err("the band: expected two frequencies in rad/s, the lower first, as in \"0.5 12\"".to_owned()),
    }
}

fn whole(list: &[f64], most: usize) -> Result<Vec<usize>, String> {
    let wrong = list.iter().find(|value| value.fract() != 0.0 || !(1.0..=most as f64).contains(*value));
    match wrong {
        Some(value) => Err(format!("expected whole numbers from 1 to {most}, found {}", number(*value))),
        None => Ok(list.iter().map(|value| *value as usize).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_typed_between_blanks_and_what_cannot_be_is_refused_in_words() {
        assert_eq!(numbers("2, 4 6.5;").unwrap(), [2.0, 4.0, 6.5]);
        assert!(numbers("2 x").unwrap_err().contains("expected a number"));
        assert_eq!(band_of(&[]), Ok(None));
        assert_eq!(band_of(&[0.5, 12.0]), Ok(Some([0.5, 12.0])));
        assert!(band_of(&[12.0, 0.5]).unwrap_err().contains("the lower first"));
        assert_eq!(whole(&[2.0, 4.0], HIGHEST_ORDER), Ok(vec![2, 4]));
        assert!(whole(&[0.0], HIGHEST_ORDER).is_err() && whole(&[2.5], HIGHEST_ORDER).is_err());
    }
}
