//! Variables written as MATLAB or Octave statements: `A = [1 2; 3 4e-3]; % comment`.
//!
//! Constants are computed; nothing is run. What is not understood is named, and never guessed.

mod ahead;
mod arithmetic;
mod block;
mod brackets;
mod expression;
mod functions;
mod lexer;
mod scope;
mod statement;
mod token;
mod trouble;

pub use statement::read_literals;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::statement::Literals;
    use super::*;
    use crate::variables::{Array, CellArray, MemoryBudget, StructArray, TextArray, Value, VariableFault};

    fn read(text: &str) -> Result<Literals, VariableFault> {
        read_literals(text, &MemoryBudget::new(1 << 22, &|_| false))
    }

    fn value(text: &str) -> Value {
        let literals = read(text).unwrap();
        literals.variables.into_iter().next_back().unwrap().value
    }

    fn matrix(rows: usize, columns: usize, values: &[f64]) -> Value {
        Value::Array(Array::matrix(rows, columns, values.to_vec()))
    }

    fn why(text: &str) -> String {
        match value(text) {
            Value::Opaque { why, .. } => why,
            other => panic!("{}", other.words()),
        }
    }

    #[test]
    fn matrices_are_rows_of_numbers() {
        assert_eq!(value("A = [1 2; 3, 4e-3]; % comment"), matrix(2, 2, &[1.0, 3.0, 2.0, 0.004]));
        assert_eq!(value("A = [1 2 ...\n 3\n 4,5,6 # six\n];"), matrix(2, 3, &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0]));
        assert_eq!(value("A = []"), matrix(0, 0, &[]));
        assert_eq!(value("A = [[1;2] [3;4]; 5 6]'"), matrix(2, 3, &[1.0, 3.0, 2.0, 4.0, 5.0, 6.0]));
    }

    #[test]
    fn blanks_decide_between_sign_and_operator() {
        assert_eq!(value("A = [1 -2]"), matrix(1, 2, &[1.0, -2.0]));
        assert_eq!(value("A = [1 - 2]"), matrix(1, 1, &[-1.0]));
        assert_eq!(value("A = [1 -2 + 3]"), matrix(1, 2, &[1.0, 1.0]));
        assert_eq!(value("A = [1, -2 -3]"), matrix(1, 3, &[1.0, -2.0, -3.0]));
        let open = read("x = 2; A = [x' x ']").unwrap_err().to_string();
        assert_eq!(open, "variable A: line 1: column 18: a text begins here and has no end; write ' behind it");
    }

    #[test]
    fn constants_are_computed() {
        assert_eq!(value("x = -2^2 + 2*3/4"), matrix(1, 1, &[-2.5]));
        assert_eq!(value("x = 2^-1"), matrix(1, 1, &[0.5]));
        assert_eq!(value("k = pi/180;"), matrix(1, 1, &[std::f64::consts::PI / 180.0]));
        assert_eq!(value("k = [1/57.3, -inf]"), matrix(1, 2, &[1.0 / 57.3, f64::NEG_INFINITY]));
        assert_eq!(value("w = 1:3"), matrix(1, 3, &[1.0, 2.0, 3.0]));
        assert_eq!(value("w = [4:-2:0]'"), matrix(3, 1, &[4.0, 2.0, 0.0]));
        assert_eq!(value("a = 2, b = [a, a*a; zeros(1,2)]"), matrix(2, 2, &[2.0, 0.0, 4.0, 0.0]));
        assert_eq!(value("D = diag([1 2])"), matrix(2, 2, &[1.0, 0.0, 0.0, 2.0]));
        assert_eq!(value("E = eye(2)*3"), matrix(2, 2, &[3.0, 0.0, 0.0, 3.0]));
        assert_eq!(value("Z = zeros(size([1 2 3]))"), matrix(1, 3, &[0.0, 0.0, 0.0]));
    }

    #[test]
    fn complex_numbers_are_written_with_i_or_j() {
        let Value::Array(array) = value("p = [1+2i, 3 - 1j; 0 1i]'") else { panic!() };
        assert_eq!(array.shape, [2, 2]);
        assert_eq!((array.re, array.im.unwrap()), (vec![1.0, 3.0, 0.0, 0.0], vec![-2.0, 1.0, 0.0, -1.0]));
    }

    #[test]
    fn texts_and_cells_of_texts_are_read() {
        let text = |text: &str| Value::Text(TextArray { shape: vec![1, 1], texts: vec![text.to_owned()] });
        assert_eq!(value("s = 'it''s'"), text("it's"));
        let cell = CellArray { shape: vec![1, 2], values: vec![text("LAT"), text("PED")] };
        assert_eq!(value("u = {'LAT','PED'};"), Value::Cell(cell.clone()));
        assert_eq!(value("u = {'LAT' 'PED'};"), Value::Cell(cell));
        let strings = TextArray { shape: vec![2, 1], texts: vec!["a".to_owned(), "bc".to_owned()] };
        assert_eq!(value("u = [\"a\"; \"bc\"]"), Value::Text(strings));
    }

    #[test]
    fn models_are_records_of_their_matrices() {
        let text = "A=1; B=2; C=3; D=0;\nsys = ss(A,B,C,D);\nsys.InputName = {'LAT'};\nsys.Ts = 0.1;";
        let Value::Struct(StructArray { fields, .. }) = value(text) else { panic!() };
        let names: Vec<_> = fields.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["A", "B", "C", "D", "Ts", "InputName"]);
        assert_eq!(fields[4].1, [matrix(1, 1, &[0.1])]);
        assert_eq!(value("s.a = 1; s.b.c = 2; t = s.b.c + s.a"), matrix(1, 1, &[3.0]));
    }

    #[test]
    fn what_is_not_run_is_noted() {
        let text = "function out = f(x)\nclear all; clc\nclose all\nA = 1;\nplot(A)\nhold on\nend\n%{\nB = 2\n%}\n";
        let literals = read(text).unwrap();
        assert_eq!(literals.variables.len(), 1);
        assert_eq!(literals.notes[0], "line 1 (\"function out = f(x)\") is not run");
        assert_eq!(literals.notes.len(), 6);
    }

    #[test]
    fn what_is_not_understood_is_opaque_and_the_rest_usable() {
        let text = "A = inv([1 2\n3 4]);\nB = A*2\nif x > 1, C = 1; end\nD = 5;\nE(2,1) = 3;\n[F, G] = size(A);\nD(1) = 2\nH = 7";
        let literals = read(text).unwrap();
        let reasons: Vec<_> = literals
            .variables
            .iter()
            .map(|variable| match &variable.value {
                Value::Opaque { why, .. } => format!("{} {why}", variable.name),
                _ => variable.name.clone(),
            })
            .collect();
        assert_eq!(
            reasons,
            [
                "A line 1, column 5: inv(…) is not computed here; write its numbers, or save the variables as a .mat file",
                "B line 3, column 5: A could not be read itself",
                "C line 4, column 11: it is set within a condition or a loop, which is not run; write its value outside",
                "D line 8, column 1: only a part of it is set here; write the whole of it in one statement",
                "E line 6, column 1: only a part of it is set here; write the whole of it in one statement",
                "F line 7, column 2: it is the result of a function, which is not run; write its value",
                "G line 7, column 5: it is the result of a function, which is not run; write its value",
                "H",
            ]
        );
    }

    #[test]
    fn troubles_say_where_and_what_to_write() {
        assert_eq!(why("A = [1 2; 3];"), "line 1, column 5: row 2 has 1 columns, the first 2; complete the shorter");
        assert_eq!(
            why("\nA = 1 +\n"),
            "line 2, column 8: the end of the line is not understood here; write the value itself"
        );
        assert_eq!(why("A = @(x) x"), "line 1, column 5: functions are not read; write the numbers");
        assert_eq!(why("A = 'open"), "line 1, column 5: a text begins here and has no end; write ' behind it");
        assert_eq!(
            why("A = 1; A += 2"),
            "line 1, column 8: only a part of it is set here; write the whole of it in one statement"
        );
        assert_eq!(why("A = 1; A++"), why("A = 1; A += 2"));
        assert_eq!(
            why("A = x(1)"),
            "line 1, column 5: x(…) is not computed here; write its numbers, or save the variables as a .mat file"
        );
    }

    #[test]
    fn what_never_ends_is_one_clear_fault() {
        let message = |text: &str| read(text).unwrap_err().to_string();
        assert_eq!(
            message("x = 1\nA = [1 2\n3 4\n"),
            "variable A: line 2: the bracket [ in column 5 is never closed; close it"
        );
        assert!(message("%{\nA = 1").starts_with("line 1: the comment opened here is never closed"));
        assert!(matches!(read(&format!("A = {}", "[".repeat(100_000))), Err(VariableFault::TooDeep { .. })));
        assert!(matches!(read("A = zeros(1e5)"), Err(VariableFault::TooLarge { .. })));
        assert!(matches!(read("A = 1:1e12"), Err(VariableFault::TooLarge { .. })));
        assert!(matches!(read("A = 1\0"), Err(VariableFault::Format { .. })));
        let doubled = format!("A = [1 2];\n{}", "A = [A A];\n".repeat(60));
        assert!(matches!(read(&doubled), Err(VariableFault::TooLarge { .. })));
        let nested = format!("a = {{1}};\n{}", "a = {a};\n".repeat(100));
        assert!(matches!(read(&nested), Err(VariableFault::TooDeep { .. })));
        let path = format!("a{} = 1", ".b".repeat(100));
        assert!(matches!(read(&path), Err(VariableFault::TooDeep { .. })));
    }

    #[test]
    fn long_lines_and_continuations_are_read() {
        let row = format!("A = [{}];", "1 ".repeat(20_000));
        assert!(matches!(value(&row), Value::Array(array) if array.len() == 20_000));
        assert_eq!(value(&format!("A = {}1", "- ".repeat(50_000))), matrix(1, 1, &[1.0]));
        assert_eq!(value(&format!("A = 1 + {}2", "...\n".repeat(50_000))), matrix(1, 1, &[3.0]));
        assert_eq!(read(&"...\n".repeat(50_000)).unwrap().variables, []);
    }

    proptest! {
        #[test]
        fn matrices_written_come_back(values in prop::collection::vec(-1e300..1e300, 6)) {
            let row = |row: usize| format!("{:e} {:e}, {}", values[row], values[2 + row], values[4 + row]);
            let text = format!("M = [{};\n{}];", row(0), row(1));
            prop_assert_eq!(value(&text), matrix(2, 3, &values));
        }

        #[test]
        fn any_text_is_read_or_refused(text in "[A-Cijx0-9=:;,.'\"{}()\\[\\] \\n\\-+*/^%#e@]{0,120}") {
            let _ = read(&text);
        }

        #[test]
        fn any_characters_are_read_or_refused(text in ".{0,80}") {
            let _ = read(&text);
        }
    }
}
