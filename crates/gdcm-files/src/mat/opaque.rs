//! Arrays whose contents lie elsewhere in the file: objects of classes, and what cannot be read.
//!
//! The format is not published by The MathWorks; it is known from the descriptions of the MatFileHandler, matio (Python) and
//! MAT.jl projects.

use super::cursor::Cursor;
use super::element::Element;
use super::export_line::export_line;
use super::matrix::Arrays;
use super::subsystem::Reference;
use super::trail::FieldPath;
use crate::variables::{Value, VariableFault};

/// The value of an opaque array behind its name.
pub(super) fn value(
    arrays: &Arrays<'_>,
    contents: &mut Cursor<'_>,
    trail: &FieldPath<'_>,
) -> Result<Value, VariableFault> {
    let system = Element::read(contents)?.name()?;
    let class = Element::read(contents)?.name()?;
    if system != "MCOS" {
        Element::pass_all(contents)?;
        let why = "only objects of MATLAB's own classes are read; in MATLAB, save what it holds as numbers or text"
            .to_owned();
        return Ok(Value::Opaque { class: format!("{class} ({system})"), why });
    }
    let contents = arrays.inner(contents, trail)?;
    let variable = trail.words();
    let objects = match arrays.objects {
        Ok(objects) => objects,
        Err(why) => return Ok(unread_because(&class, why, &variable)),
    };
    match (&contents, Reference::of(&contents)) {
        (_, Some(reference)) => objects.referred(&reference, trail, arrays.meter),
        (Value::Struct(records), None) => objects.enumeration(records, &class, trail, arrays.meter),
        _ => Ok(unread_because(&class, "it refers to no object", &variable)),
    }
}

/// A value of a class that this program does not read.
pub(super) fn unread(class: &str, trail: &FieldPath<'_>) -> Value {
    unread_because(class, "values of this class are not read", &trail.words())
}

/// A value that cannot be read, and how to come by its data all the same.
pub(super) fn unread_because(class: &str, why: &str, variable: &str) -> Value {
    let line = export_line(class, variable);
    Value::Opaque { class: class.to_owned(), why: format!("{why}; in MATLAB, save its data: {line}") }
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::super::sample::{element, file, opaque, reference};
    use crate::variables::{MemoryBudget, Value};

    fn first(bytes: &[u8]) -> (String, String) {
        match read(bytes, &MemoryBudget::new(1 << 16, &|_| false)).unwrap().remove(0).value {
            Value::Opaque { class, why } => (class, why),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn an_object_without_the_part_that_holds_it_says_how_to_save_it() {
        let (class, why) = first(&file(&opaque("sys", "tf", reference(&[1], 1))));
        assert_eq!(class, "tf");
        assert!(
            why.contains("nowhere") && why.ends_with("[num,den,Ts] = tfdata(sys); save out.mat num den Ts"),
            "{why}"
        );
    }

    #[test]
    fn objects_of_other_systems_are_named_and_not_read() {
        let flags = element(6, &[17, 0, 0, 0, 0, 0, 0, 0]);
        let names = ["x", "java", "java.util.Date"].map(|name| element(1, name.as_bytes())).concat();
        let (class, _) = first(&file(&element(14, &[flags, names].concat())));
        assert_eq!(class, "java.util.Date (java)");
    }
}
