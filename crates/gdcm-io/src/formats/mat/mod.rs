//! MATLAB files (".mat") of level 4 and of levels 5 to 7, also as written by GNU Octave and SciPy.
//!
//! Source: "MAT-File Format", The MathWorks. Files of version 7.3 are HDF5 files and are read
//! elsewhere; their objects have the layout of `Subsystem`.

mod level4;
mod level5;
mod matrix;
mod subsystem;
mod writer;

use super::variables::{ElementKind, Value, Variable};
use crate::formats::mat::level5::{ByteOrder, Cursor, DataKind, Element, matrix, unpacked};
use crate::formats::mat::matrix::{Arrays, field_names, long_words, places};
use crate::formats::{Contents, Importer};
use crate::reading_budget::{ReadingBudget, VariableFault};

pub(crate) use crate::formats::mat::matrix::rows;
pub(crate) use crate::formats::mat::subsystem::Subsystem;
pub use crate::formats::mat::writer::{write, write_packed};

/// Signature of HDF5 files, at the beginning or after MATLAB's header.
const HDF5_SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";
/// Major version of files of levels 5 to 7.
const LEVEL_5: u8 = 1;
/// Expected format in error messages of [`read`].
const EXPECTED: &str = "a .mat file of MATLAB up to version 7";

/// MATLAB files up to version 7.
pub(crate) const MAT: Importer = Importer {
    name: "a .mat file of MATLAB up to version 7",
    endings: &["mat"],
    recognises: |bytes, ending| {
        ending == "mat" || matches!(level5::version(bytes), Some((_, LEVEL_5)))
    },
    read: |bytes, path, budget| Contents::variables(read(bytes, budget), path),
};

/// Reads the variables of a file, in file order.
///
/// Parts of a variable that cannot be decoded are [`super::variables::Value::Opaque`]; bytes that
/// contradict the format are a fault of the whole file.
pub fn read(bytes: &[u8], budget: &ReadingBudget<'_>) -> Result<Vec<Variable>, VariableFault> {
    if is_hdf5(bytes) {
        return Err(VariableFault::format(
            EXPECTED,
            "an HDF5 file, as MATLAB writes with -v7.3",
        ));
    }
    // The leading text of a level-5 file has no zero in its first four bytes, unlike level 4.
    let text = bytes.get(..4).is_some_and(|start| !start.contains(&0));
    match level5::version(bytes) {
        Some((order, LEVEL_5)) if text || !level4::begins(bytes) => {
            level5::read(bytes, order, budget)
        }
        _ if level4::begins(bytes) => level4::read(bytes, budget),
        Some((_, version)) if text => Err(VariableFault::format(
            EXPECTED,
            format!("a .mat file of the unknown version {version}"),
        )),
        _ => Err(VariableFault::format(EXPECTED, beginning(bytes))),
    }
}

/// Whether this is an HDF5 file, written by MATLAB with `-v7.3`.
pub fn is_hdf5(bytes: &[u8]) -> bool {
    // The signature is at the beginning, or at byte 512, 1024, 2048 and so on ("HDF5 File Format
    // Specification", II.A).
    let doubled = std::iter::successors(Some(512_usize), |at| at.checked_mul(2))
        .take_while(|&at| at < bytes.len());
    let signed = |at: usize| {
        bytes
            .get(at..)
            .is_some_and(|rest| rest.starts_with(&HDF5_SIGNATURE))
    };
    std::iter::once(0).chain(doubled).any(signed)
}

fn beginning(bytes: &[u8]) -> String {
    let start = bytes.get(..bytes.len().min(8)).unwrap_or_default();
    if start.is_empty() {
        return "an empty file".to_owned();
    }
    if start
        .iter()
        .all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace())
    {
        return format!(
            "a text that begins with {:?}",
            String::from_utf8_lossy(start)
        );
    }
    let bytes: Vec<String> = start.iter().map(|byte| format!("{byte:02x}")).collect();
    format!("a file that begins with the bytes {}", bytes.join(" "))
}

// The object subsystem of a file: bytes that form a small embedded file.
//
// The format is not published by The MathWorks; it is known from the descriptions of the
// MatFileHandler, matio (Python) and MAT.jl projects.

/// Name of the class system.
const SYSTEM: &str = "MCOS";
/// Class of the object that holds all other objects.
const WRAPPER: &str = "FileWrapper__";

/// Reads the objects at byte `at` of the file.
fn objects(
    bytes: &[u8],
    at: Option<usize>,
    order: ByteOrder,
    budget: &ReadingBudget<'_>,
) -> Result<Subsystem, VariableFault> {
    let mut file = Cursor::file(bytes, order);
    let none = || file.damaged("they lie nowhere in it");
    let at = at.filter(|&at| at < bytes.len()).ok_or_else(none)?;
    file.pass(at)?;
    let element = Element::read(&mut file)?;
    if element.kind != DataKind::Packed {
        return within(matrix(element)?, budget);
    }
    let bytes = unpacked(element.data, budget)?;
    let mut inner = Cursor::unpacked(&bytes, order, element.data.offset);
    within(matrix(Element::read(&mut inner)?)?, budget)
}

/// Reads the objects inside an array of bytes.
fn within(array: Cursor<'_>, budget: &ReadingBudget<'_>) -> Result<Subsystem, VariableFault> {
    let mut array = array;
    Header::read(&mut array, budget)?;
    let data = Element::read(&mut array)?.data;
    let order = match data.rest().get(2..4) {
        Some(b"IM") => ByteOrder::Little,
        Some(b"MI") => ByteOrder::Big,
        _ => return Err(data.damaged("their part of the file has no header")),
    };
    let mut small = Cursor::unpacked(data.rest(), order, data.offset);
    small.pass(8)?;
    let mut systems = matrix(Element::read(&mut small)?)?;
    if Header::read(&mut systems, budget)?.class != ArrayClass::Struct {
        return Err(systems.damaged("they do not lie in a record"));
    }
    for name in field_names(&mut systems, budget)? {
        let system = matrix(Element::read(&mut systems)?)?;
        if name == SYSTEM {
            return wrapped(system, budget);
        }
    }
    Err(systems.damaged("there are none of MATLAB's own classes"))
}

/// Reads the objects inside a `FileWrapper__`.
fn wrapped(wrapper: Cursor<'_>, budget: &ReadingBudget<'_>) -> Result<Subsystem, VariableFault> {
    let mut wrapper = wrapper;
    let opaque = Header::read(&mut wrapper, budget)?.class == ArrayClass::Opaque;
    let system = Element::read(&mut wrapper)?.name()?;
    let class = Element::read(&mut wrapper)?.name()?;
    if !opaque || system != SYSTEM || class != WRAPPER {
        return Err(wrapper.damaged("they do not lie in a FileWrapper__"));
    }
    let mut contents = matrix(Element::read(&mut wrapper)?)?;
    let header = Header::read(&mut contents, budget)?;
    if header.class != ArrayClass::Cell {
        return Err(contents.damaged("they do not lie in cells"));
    }
    let trail = FieldPath::start(WRAPPER);
    let arrays = Arrays {
        budget,
        objects: Err("it lies in the objects of the file"),
    };
    let mut cells = Vec::new();
    let mut words = Vec::new();
    for at in 0..header.count {
        let cell = contents;
        let value = arrays.inner(&mut contents, &trail.step(Step::Cell(at))?)?;
        words.extend(exact(cell, &value, budget)?.map(|words| (at, words)));
        budget.take(1, 2 * size_of::<Value>() as u64, "")?;
        cells.push(value);
    }
    Ok(Subsystem::new(cells, budget)?.with_long_words(words))
}

/// Returns the exact integers of a cell that holds 64-bit integers.
fn exact(
    cell: Cursor<'_>,
    value: &Value,
    budget: &ReadingBudget<'_>,
) -> Result<Option<Vec<u64>>, VariableFault> {
    if !matches!(value, Value::Array(array) if !array.is_empty()) {
        return Ok(None);
    }
    let mut cell = cell;
    let mut contents = Element::read(&mut cell)?.data;
    let header = Header::read(&mut contents, budget)?;
    if header.long_words {
        long_words(&Element::read(&mut contents)?, budget)
    } else {
        Ok(None)
    }
}

// Path to a value within a variable.

/// Deepest nesting of values.
const DEEPEST: usize = 64;

/// Path from a variable to a value inside it, one step at a time.
#[derive(Clone, Copy, Debug)]
struct FieldPath<'t> {
    before: Option<&'t FieldPath<'t>>,
    step: Step<'t>,
    depth: usize,
}

/// One step of a path.
#[derive(Clone, Copy, Debug)]
enum Step<'t> {
    /// The variable, or an already traversed path.
    Start(&'t str),
    Field(&'t str),
    /// One of several records, counted from 0.
    Record(usize),
    /// A value in a cell array, counted from 0.
    Cell(usize),
}

impl<'t> FieldPath<'t> {
    /// Starts at a variable.
    fn start(name: &'t str) -> Self {
        Self {
            before: None,
            step: Step::Start(name),
            depth: 0,
        }
    }

    /// Appends a step.
    fn step(&'t self, step: Step<'t>) -> Result<FieldPath<'t>, VariableFault> {
        if self.depth >= DEEPEST {
            return Err(VariableFault::too_deep(&self.words()));
        }
        Ok(FieldPath {
            before: Some(self),
            step,
            depth: self.depth + 1,
        })
    }

    /// Formats the path as in MATLAB: "sys.A", "models{3}.B".
    fn words(&self) -> String {
        let before = self.before.map(FieldPath::words).unwrap_or_default();
        match self.step {
            Step::Start(name) => name.to_owned(),
            Step::Field(name) => format!("{before}.{name}"),
            Step::Record(at) => format!("{before}({})", at + 1),
            Step::Cell(at) => format!("{before}{{{}}}", at + 1),
        }
    }

    /// Adds the path to a fault that names no value yet.
    fn name(&self, fault: VariableFault) -> VariableFault {
        fault.of(|| self.words())
    }
}

// Array header: class, flags, shape and name.
//
// Source: "MAT-File Format", The MathWorks, "miMATRIX Format".

/// Class of an array.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArrayClass {
    Cell,
    Struct,
    Object,
    Char,
    Sparse,
    Float,
    Integer,
    FunctionHandle,
    Opaque,
}

/// Header of an array.
#[derive(Clone, Debug)]
struct Header {
    class: ArrayClass,
    /// Whether the numbers are unsigned 64-bit integers.
    long_words: bool,
    logical: bool,
    complex: bool,
    /// Number of elements along each dimension, at least two dimensions; 1 x 1 for an opaque array.
    shape: Vec<usize>,
    count: usize,
    /// Empty for a value nested in another.
    name: String,
}

impl Header {
    /// Reads the header before the contents.
    fn read(contents: &mut Cursor<'_>, budget: &ReadingBudget<'_>) -> Result<Self, VariableFault> {
        let flags = Element::read(contents)?;
        if flags.kind != DataKind::U32 {
            return Err(flags.data.damaged("an array without flags"));
        }
        let bits = { flags.data }.u32()?;
        let number = bits & 0xff;
        let class = ArrayClass::of(number).ok_or_else(|| {
            flags
                .data
                .damaged(format!("an array of the unknown class {number}"))
        })?;
        let shape = if class == ArrayClass::Opaque {
            vec![1, 1]
        } else {
            shape(contents, budget)?
        };
        // Products of the sides must not overflow, even if another side is zero.
        if super::strides::count(&shape).is_none() {
            budget.take(u64::MAX, 1, "")?;
        }
        Ok(Header {
            class,
            count: count(&shape),
            long_words: number == 15,
            logical: bits & 0x0200 != 0,
            complex: bits & 0x0800 != 0,
            shape,
            name: Element::read(contents)?.name()?,
        })
    }

    /// Returns the element kind of the numbers.
    fn element_kind(&self) -> ElementKind {
        match self.class {
            _ if self.logical => ElementKind::Logical,
            ArrayClass::Integer => ElementKind::Integer,
            _ => ElementKind::Float,
        }
    }
}

impl ArrayClass {
    fn of(number: u32) -> Option<Self> {
        Some(match number {
            1 => ArrayClass::Cell,
            2 => ArrayClass::Struct,
            3 => ArrayClass::Object,
            4 => ArrayClass::Char,
            5 => ArrayClass::Sparse,
            6 | 7 => ArrayClass::Float,
            8..=15 => ArrayClass::Integer,
            16 => ArrayClass::FunctionHandle,
            17 => ArrayClass::Opaque,
            _ => return None,
        })
    }
}

/// Number of elements of an array of this shape, saturating at the largest count.
fn count(shape: &[usize]) -> usize {
    let product = shape
        .iter()
        .fold(1_usize, |product, &length| product.saturating_mul(length));
    if shape.contains(&0) { 0 } else { product }
}

fn shape(
    contents: &mut Cursor<'_>,
    budget: &ReadingBudget<'_>,
) -> Result<Vec<usize>, VariableFault> {
    let mut shape = places(&Element::read(contents)?, budget)?;
    while shape.len() < 2 {
        shape.push(1);
    }
    Ok(shape)
}

// MATLAB command that saves the data of an object as plain arrays.

/// Returns a MATLAB command that writes the contents of `variable`, an object of `class`, to a file
/// as plain arrays.
///
/// Source: the reference pages in the manuals of MATLAB, the Control System Toolbox and the System
/// Identification Toolbox.
pub fn export_line(class: &str, variable: &str) -> String {
    let sys = if variable.is_empty() { "x" } else { variable };
    let (assignment, names) = match class {
        "ss" => (
            format!("[A,B,C,D] = ssdata({sys}); Ts = {sys}.Ts;"),
            "A B C D Ts",
        ),
        "idss" | "idgrey" => (
            format!("[A,B,C,D,K] = idssdata({sys}); Ts = {sys}.Ts;"),
            "A B C D K Ts",
        ),
        "tf" | "idtf" => (format!("[num,den,Ts] = tfdata({sys});"), "num den Ts"),
        "zpk" => (format!("[z,p,k,Ts] = zpkdata({sys});"), "z p k Ts"),
        "frd" | "idfrd" => (
            format!("H = {sys}.ResponseData; w = {sys}.Frequency; unit = {sys}.FrequencyUnit;"),
            "H w unit",
        ),
        "iddata" => (
            format!("u = {sys}.InputData; y = {sys}.OutputData; Ts = {sys}.Ts;"),
            "u y Ts",
        ),
        "timeseries" => (format!("t = {sys}.Time; y = {sys}.Data;"), "t y"),
        "string" | "categorical" => (format!("text = cellstr({sys});"), "text"),
        "datetime" => (format!("t = posixtime({sys});"), "t"),
        "duration" => (format!("t = seconds({sys});"), "t"),
        "table" => (
            format!("data = table2struct({sys}, 'ToScalar', true);"),
            "data",
        ),
        "timetable" => (
            format!("data = table2struct(timetable2table({sys}), 'ToScalar', true);"),
            "data",
        ),
        "containers.Map" => (
            format!("names = keys({sys}); data = values({sys});"),
            "names data",
        ),
        "function_handle" => (format!("text = func2str({sys});"), "text"),
        _ => (format!("data = struct({sys});"), "data"),
    };
    format!("{assignment} save out.mat {names}")
}

#[cfg(test)]
mod sample_tests;

#[cfg(test)]
mod mat_tests {
    use proptest::prelude::*;

    use super::*;
    use crate::formats::mat::sample_tests::{chars, doubles, element, file, matrix};
    use crate::formats::variables::{Array, ElementKind, Value};

    const PLAIN: &[u8] = include_bytes!("../../../../../tests/data/mat/scipy-5.mat");
    const PACKED: &[u8] = include_bytes!("../../../../../tests/data/mat/scipy-5-packed.mat");
    const OLD: &[u8] = include_bytes!("../../../../../tests/data/mat/scipy-4.mat");
    /// `ss([1 2; 3 4], [1; 0], [1 0], 0)` of the control package, with tags that count too many
    /// bytes.
    const OCTAVE: &[u8] = include_bytes!("../../../../../tests/data/mat/octave-ss.mat");
    const MOST: u64 = 1 << 20;

    fn read(bytes: &[u8]) -> Result<Vec<Variable>, VariableFault> {
        super::read(bytes, &ReadingBudget::new(MOST))
    }

    fn value(bytes: &[u8], name: &str) -> Value {
        read(bytes)
            .unwrap()
            .into_iter()
            .find(|variable| variable.name == name)
            .unwrap()
            .value
    }

    fn numbers(shape: &[usize], kind: ElementKind, re: &[f64]) -> Value {
        Value::Array(Array {
            shape: shape.to_vec(),
            kind,
            re: re.to_vec(),
            im: None,
        })
    }

    #[test]
    fn a_compressed_file_is_the_same_as_a_plain_one() {
        let plain = read(PLAIN).unwrap();
        assert_eq!(plain.len(), 17);
        assert_eq!(read(PACKED).unwrap(), plain);
    }

    #[test]
    fn numbers_of_scipy_are_read_in_both_levels() {
        let matrix = numbers(
            &[2, 3],
            ElementKind::Float,
            &[1.0, 4.0, 2.0, 5.5, 3.0, -6.0],
        );
        let sparse = numbers(&[3, 2], ElementKind::Float, &[0.0, 3.0, 0.0, 2.0, 0.0, 4.0]);
        for file in [PLAIN, OLD] {
            assert_eq!(value(file, "matrix"), matrix);
            assert_eq!(value(file, "sparse"), sparse);
            assert_eq!(
                value(file, "whole"),
                numbers(&[1, 2], ElementKind::Integer, &[-3.0, 300.0])
            );
            let Value::Array(complex) = value(file, "sparse_complex") else {
                panic!()
            };
            assert_eq!(complex.im, Some(vec![0.0, 0.0, 2.0, 0.0]));
        }
        assert_eq!(
            value(PLAIN, "flags"),
            numbers(&[1, 2], ElementKind::Logical, &[1.0, 0.0])
        );
        assert_eq!(
            value(PLAIN, "long"),
            numbers(&[1, 1], ElementKind::Integer, &[9_007_199_254_740_992.0])
        );
        assert_eq!(
            value(PLAIN, "empty"),
            numbers(&[0, 3], ElementKind::Float, &[])
        );
    }

    #[test]
    fn texts_of_scipy_are_read_in_both_levels() {
        for file in [PLAIN, OLD] {
            let Value::Text(rows) = value(file, "rows") else {
                panic!()
            };
            assert_eq!(
                (rows.shape, rows.texts),
                (vec![2, 1], vec!["ab".to_owned(), "cd".to_owned()])
            );
        }
        let Value::Text(letters) = value(PLAIN, "letters") else {
            panic!()
        };
        assert_eq!(letters.texts, ["\u{e4}\u{3a9}\u{1f681}"]);
    }

    #[test]
    fn records_and_cells_of_scipy_keep_their_shape() {
        let Value::Struct(records) = value(PLAIN, "records") else {
            panic!()
        };
        assert_eq!(records.shape, [1, 2]);
        assert_eq!(
            records.field("a").unwrap()[1],
            numbers(&[1, 1], ElementKind::Float, &[2.0])
        );
        let Value::Cell(cells) = value(PLAIN, "cells") else {
            panic!()
        };
        assert_eq!((cells.shape, cells.values.len()), (vec![1, 2], 2));
    }

    #[test]
    fn a_model_of_octave_is_an_old_object() {
        let Value::Object(model) = value(OCTAVE, "sys") else {
            panic!()
        };
        assert_eq!(model.class, "ss");
        let a = numbers(&[2, 2], ElementKind::Float, &[1.0, 3.0, 2.0, 4.0]);
        assert_eq!(model.records.field("a").unwrap(), [a]);
        let Value::Object(common) = &model.records.field("lti").unwrap()[0] else {
            panic!()
        };
        assert!(common.class == "lti" && common.records.field("tsam").is_some());
    }

    #[test]
    fn other_files_are_told_apart_by_what_they_begin_with() {
        let hdf5 = [&[b' '; 512][..], &HDF5_SIGNATURE, &[0; 40]].concat();
        assert!(is_hdf5(&hdf5) && is_hdf5(&hdf5[512..]) && !is_hdf5(PLAIN));
        let found = |bytes: &[u8]| match read(bytes) {
            Err(VariableFault::Format { found, .. }) => found,
            other => panic!("{other:?}"),
        };
        assert!(found(&hdf5).contains("HDF5"));
        assert_eq!(found(b""), "an empty file");
        assert!(found(b"t, u, y\n1, 2, 3\n").starts_with("a text that begins with"));
        assert!(found(&[0; 300]).contains("00 00 00"));
    }

    #[test]
    fn two_variables_of_one_name_are_refused() {
        let twice = [doubles("x", &[1, 1], &[1.0]), doubles("x", &[1, 1], &[1.0])].concat();
        assert_eq!(
            read(&file(&twice)),
            Err(VariableFault::Duplicate {
                name: "x".to_owned()
            })
        );
    }

    #[test]
    fn a_fault_names_the_value_and_the_byte() {
        let wrong = matrix(6, &[2, 2], "", &[element(9, &[0; 8])]);
        let names = [
            element(5, &8_i32.to_le_bytes()),
            element(1, b"A\0\0\0\0\0\0\0"),
        ]
        .concat();
        let record = matrix(2, &[1, 1], "", &[names, wrong]);
        let cells = matrix(1, &[1, 2], "models", &[chars("", "a"), record]);
        let Err(VariableFault::Damaged {
            variable, offset, ..
        }) = read(&file(&cells))
        else {
            panic!()
        };
        assert_eq!(variable, "models{2}.A");
        assert!((128..file(&cells).len() as u64).contains(&offset));
    }

    #[test]
    fn cut_off_files_say_so() {
        let Err(fault) = read(&PLAIN[..PLAIN.len() - 9]) else {
            panic!()
        };
        assert!(matches!(fault, VariableFault::CutOff { .. }), "{fault:?}");
        assert!(matches!(
            read(&OLD[..OLD.len() - 9]),
            Err(VariableFault::CutOff { .. })
        ));
    }

    #[test]
    fn values_nested_too_deeply_are_refused() {
        let nested = (0..80).fold(doubles("", &[1, 1], &[1.0]), |inner, _| {
            matrix(1, &[1, 1], "", &[inner])
        });
        let nested = matrix(1, &[1, 1], "deep", &[nested]);
        let Err(VariableFault::TooDeep { variable }) = read(&file(&nested)) else {
            panic!()
        };
        assert!(variable.starts_with("deep{1}{1}"));
    }

    #[test]
    fn a_reader_that_shall_stop_stops() {
        assert_eq!(
            super::read(
                PLAIN,
                &ReadingBudget::new(MOST).stopped_by(std::sync::Arc::new(true.into()))
            ),
            Err(VariableFault::Stopped)
        );
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn changed_bytes_never_panic(
            seed in prop::sample::select(vec![PLAIN, PACKED, OLD, OCTAVE]),
            changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        ) {
            let mut bytes = seed.to_vec();
            for (at, byte) in changes {
                let at = at.index(bytes.len());
                bytes[at] ^= byte;
            }
            let _ = read(&bytes);
        }
    }

    #[test]
    fn a_file_cut_off_anywhere_never_panics() {
        for seed in [PLAIN, PACKED, OLD, OCTAVE] {
            for length in 0..seed.len() {
                let _ = read(&seed[..length]);
            }
        }
    }
}

#[cfg(test)]
mod workspace_tests {
    use std::io::Write;

    use super::*;
    use crate::formats::mat::sample_tests::{Directory, doubles, file_with_objects};

    fn file() -> Vec<u8> {
        let directory = Directory {
            version: 2,
            names: &["a"],
            classes: &[[0, 1]],
            made: &[],
            objects: &[[1, 0, 1]],
            plain: &[&[]],
        };
        let empty = doubles("", &[0, 0], &[]);
        file_with_objects(&[], Some(&[directory.cell(), empty.clone(), empty]))
    }

    fn read(bytes: &[u8], at: usize) -> Result<Subsystem, VariableFault> {
        objects(
            bytes,
            Some(at),
            ByteOrder::Little,
            &ReadingBudget::new(1 << 16),
        )
    }

    #[test]
    fn objects_are_read_packed_and_plain() {
        let plain = file();
        assert!(read(&plain, 128).is_ok());
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(&plain[128..]).unwrap();
        let data = encoder.finish().unwrap();
        let tag = [15_u32, data.len() as u32].map(u32::to_le_bytes).concat();
        assert!(read(&[&plain[..128], &tag, &data].concat(), 128).is_ok());
    }

    #[test]
    fn objects_that_lie_elsewhere_are_not_found() {
        let plain = file();
        for at in [0, 8, 136, plain.len(), usize::MAX] {
            assert!(read(&plain, at).is_err(), "{at}");
        }
    }
}

#[cfg(test)]
mod trail_tests {
    use super::*;

    #[test]
    fn the_way_is_written_as_in_matlab() {
        let start = FieldPath::start("models");
        let cell = start.step(Step::Cell(2)).unwrap();
        let record = cell.step(Step::Record(0)).unwrap();
        assert_eq!(
            record.step(Step::Field("B")).unwrap().words(),
            "models{3}(1).B"
        );
    }

    #[test]
    fn the_first_name_stays() {
        let fault = VariableFault::TooDeep {
            variable: String::new(),
        };
        let named = FieldPath::start("a").name(fault);
        assert_eq!(
            FieldPath::start("b").name(named),
            VariableFault::TooDeep {
                variable: "a".to_owned()
            }
        );
    }

    #[test]
    fn the_way_ends() {
        fn deeper(trail: &FieldPath<'_>) -> VariableFault {
            trail
                .step(Step::Cell(0))
                .map_or_else(|fault| fault, |next| deeper(&next))
        }
        assert!(matches!(
            deeper(&FieldPath::start("a")),
            VariableFault::TooDeep { .. }
        ));
    }
}

#[cfg(test)]
mod header_tests {
    use super::*;

    #[test]
    fn an_array_with_a_side_of_none_has_no_elements_however_long_the_others_are() {
        assert_eq!(count(&[usize::MAX, usize::MAX, 0]), 0);
        assert_eq!(count(&[3, 4]), 12);
        assert_eq!(count(&[usize::MAX, 2]), usize::MAX);
    }
}

#[cfg(test)]
mod export_line_tests {
    use super::*;

    #[test]
    fn a_state_space_model_is_saved_as_its_matrices() {
        let line = "[A,B,C,D] = ssdata(sys); Ts = sys.Ts; save out.mat A B C D Ts";
        assert_eq!(export_line("ss", "sys"), line);
    }
}
