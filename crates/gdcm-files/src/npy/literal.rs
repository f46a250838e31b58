//! The Python literals in which a header is written.

/// Deeper than any header that `NumPy` writes for values this program reads.
const DEEPEST: usize = 16;

/// A value of a header: the part of Python's literals that `numpy.lib.format` writes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Literal {
    Text(String),
    Whole(u64),
    Truth(bool),
    /// A tuple or a list.
    Sequence(Vec<Literal>),
    /// A dictionary whose keys are texts.
    Dictionary(Vec<(String, Literal)>),
}

impl Literal {
    /// Reads one literal, with blanks around it and nothing else; errors say in words what is wrong.
    pub(super) fn parse(text: &str) -> Result<Self, &'static str> {
        let mut scanner = Scanner { rest: text };
        let literal = scanner.value(DEEPEST)?;
        scanner.skip_blanks();
        if scanner.rest.is_empty() { Ok(literal) } else { Err("something follows the header's dictionary") }
    }
}

struct Scanner<'t> {
    rest: &'t str,
}

impl Scanner<'_> {
    fn skip_blanks(&mut self) {
        self.rest = self.rest.trim_start_matches([' ', '\t', '\r', '\n']);
    }

    fn take(&mut self, sign: char) -> bool {
        self.skip_blanks();
        let rest = self.rest.strip_prefix(sign);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn value(&mut self, depth: usize) -> Result<Literal, &'static str> {
        let deeper = depth.checked_sub(1).ok_or("the header is nested too deeply")?;
        self.skip_blanks();
        match self.rest.chars().next() {
            Some('\'' | '"') => Ok(Literal::Text(self.text()?)),
            Some('0'..='9') => self.whole(),
            Some('(') => self.sequence('(', ')', deeper),
            Some('[') => self.sequence('[', ']', deeper),
            Some('{') => self.dictionary(deeper),
            Some('T' | 'F') => self.truth(),
            Some(_) => Err("the header holds something that is no value"),
            None => Err("the header ends too early"),
        }
    }

    fn text(&mut self) -> Result<String, &'static str> {
        let quote = if self.rest.starts_with('"') { '"' } else { '\'' };
        let body = &self.rest[1..];
        let end = body.find(quote).ok_or("a text of the header does not end")?;
        let text = &body[..end];
        // Escapes would stand only in names of fields that hold quotes, backslashes or control characters.
        if text.contains('\\') {
            return Err("the header holds an escape");
        }
        self.rest = &body[end + 1..];
        Ok(text.to_owned())
    }

    fn whole(&mut self) -> Result<Literal, &'static str> {
        let end = self.rest.find(|sign: char| !sign.is_ascii_digit()).unwrap_or(self.rest.len());
        let (digits, rest) = self.rest.split_at(end);
        // Python 2 wrote an L behind long numbers.
        self.rest = rest.strip_prefix('L').unwrap_or(rest);
        digits.parse().map(Literal::Whole).map_err(|_| "a number of the header is too large")
    }

    fn truth(&mut self) -> Result<Literal, &'static str> {
        for (word, truth) in [("True", true), ("False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Ok(Literal::Truth(truth));
            }
        }
        Err("the header holds something that is no value")
    }

    fn sequence(&mut self, open: char, close: char, depth: usize) -> Result<Literal, &'static str> {
        let mut values = Vec::new();
        self.take(open);
        while !self.take(close) {
            values.push(self.value(depth)?);
            if !self.take(',') && !self.rest.starts_with(close) {
                return Err("the header lacks a comma");
            }
        }
        Ok(Literal::Sequence(values))
    }

    fn dictionary(&mut self, depth: usize) -> Result<Literal, &'static str> {
        let mut entries = Vec::new();
        self.take('{');
        while !self.take('}') {
            let Literal::Text(key) = self.value(depth)? else { return Err("a key of the header is no text") };
            if !self.take(':') {
                return Err("the header lacks a colon");
            }
            entries.push((key, self.value(depth)?));
            if !self.take(',') && !self.rest.starts_with('}') {
                return Err("the header lacks a comma");
            }
        }
        Ok(Literal::Dictionary(entries))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_header_of_numpy_is_read() {
        let read =
            Literal::parse("{'descr': [('a', '<f8', (2,))], 'fortran_order': False, 'shape': (3, 4L), }   \n").unwrap();
        let text = |text: &str| Literal::Text(text.to_owned());
        let field = Literal::Sequence(vec![text("a"), text("<f8"), Literal::Sequence(vec![Literal::Whole(2)])]);
        let expected = Literal::Dictionary(vec![
            ("descr".to_owned(), Literal::Sequence(vec![field])),
            ("fortran_order".to_owned(), Literal::Truth(false)),
            ("shape".to_owned(), Literal::Sequence(vec![Literal::Whole(3), Literal::Whole(4)])),
        ]);
        assert_eq!(read, expected);
    }

    #[test]
    fn whatever_else_python_knows_is_refused() {
        for text in
            ["", "{", "{'a' 1}", "(1 2)", "-1", "1e3", "{1: 2}", "'a", "__import__('os')", "True1", "() ()", "'\\x00'"]
        {
            assert!(Literal::parse(text).is_err(), "{text}");
        }
        assert!(Literal::parse(&"(".repeat(100_000)).is_err());
        assert!(Literal::parse("99999999999999999999999").is_err());
    }
}
