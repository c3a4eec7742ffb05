//! Words, numbers, texts and marks of robot languages, with their lines.

use std::path::Path;
use std::str::Lines;

use crate::program::number::finite;
use crate::program::{ProgramError, ProgramErrorKind};

/// The smallest piece of the language that means something.
#[derive(Debug, Clone, PartialEq)]
enum Token<'a> {
    /// A name, a keyword or a number: numbers are told apart where one is wanted.
    Word(&'a str),
    Text(&'a str),
    Mark(&'a str),
}

impl Token<'_> {
    fn text(&self) -> String {
        match self {
            Self::Word(text) | Self::Mark(text) => (*text).to_owned(),
            Self::Text(text) => format!("\"{text}\""),
        }
    }
}

/// What tells one language's pieces from another's.
pub(super) struct Syntax {
    /// Begins a comment that ends with its line.
    pub comment: char,
    /// Single characters that mean something by themselves.
    pub marks: &'static str,
    /// Characters of words beside letters, digits and `_.+-`.
    pub in_words: &'static str,
    /// Whether the end of a line ends an instruction: it is the mark [`LINE_END`] then.
    pub lines: bool,
}

/// End of a line that holds something.
pub(super) const LINE_END: &str = "\n";

/// A value as written: a word, a text, or a list of values.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value<'a> {
    Word(&'a str),
    Text,
    List(Vec<Value<'a>>),
}

/// A token with its line.
type Placed<'a> = (Token<'a>, usize);

/// The tokens of a module, taken one after another; no more of them are held than are looked at.
pub(super) struct Source<'a> {
    path: &'a Path,
    syntax: &'a Syntax,
    lines: Lines<'a>,
    /// What is left of the line that was begun, and whether a token came from it.
    rest: &'a str,
    begun: bool,
    line: usize,
    /// The token last taken.
    before: Option<Placed<'a>>,
    /// The two that come next; none once the text ends.
    ahead: [Option<Placed<'a>>; 2],
    /// What cannot be read behind them.
    fault: Option<ProgramErrorKind>,
}

impl<'a> Source<'a> {
    pub fn new(text: &'a str, path: &'a Path, syntax: &'a Syntax) -> Self {
        let mut source = Self {
            path,
            syntax,
            lines: text.lines(),
            rest: "",
            begun: false,
            line: 0,
            before: None,
            ahead: [None, None],
            fault: None,
        };
        source.advance();
        source.advance();
        source.before = None;
        source
    }

    /// Takes the next token.
    fn advance(&mut self) {
        let behind = self.read();
        let [next, after] = &mut self.ahead;
        let taken = std::mem::replace(next, std::mem::replace(after, behind));
        if taken.is_some() {
            self.before = taken;
        }
    }

    /// The token behind those that come next.
    fn read(&mut self) -> Option<Placed<'a>> {
        if self.fault.is_some() {
            return None;
        }
        loop {
            self.rest = self.rest.trim_start();
            if !self.rest.is_empty() && !self.rest.starts_with(self.syntax.comment) {
                return match token(self.rest, self.syntax) {
                    Ok((token, after)) => {
                        (self.rest, self.begun) = (after, true);
                        Some((token, self.line))
                    }
                    Err(kind) => {
                        self.fault = Some(kind);
                        None
                    }
                };
            }
            let ends = std::mem::take(&mut self.begun) && self.syntax.lines;
            self.rest = "";
            if ends {
                return Some((Token::Mark(LINE_END), self.line));
            }
            self.rest = self.lines.next()?;
            self.line += 1;
        }
    }

    /// Line of the token that comes next; the last line if none does.
    pub fn line(&self) -> usize {
        self.ahead[0].as_ref().map_or(self.line.max(1), |t| t.1)
    }

    /// Line of the token last taken.
    pub fn last_line(&self) -> usize {
        let taken = self.before.as_ref().or(self.ahead[0].as_ref());
        taken.map_or(self.line.max(1), |t| t.1)
    }

    /// Whether this mark or word comes next.
    pub fn comes(&self, wanted: &str) -> bool {
        self.ahead[0]
            .as_ref()
            .is_some_and(|(token, _)| match token {
                Token::Word(found) | Token::Mark(found) => found.eq_ignore_ascii_case(wanted),
                Token::Text(_) => false,
            })
    }

    /// Takes this mark or word if it comes next.
    pub fn take(&mut self, wanted: &str) -> bool {
        let comes = self.comes(wanted);
        if comes {
            self.advance();
        }
        comes
    }

    /// Takes what comes next if it is a word.
    pub fn take_word(&mut self) -> Option<&'a str> {
        let Some((Token::Word(word), _)) = &self.ahead[0] else {
            return None;
        };
        let word = *word;
        self.advance();
        Some(word)
    }

    /// Takes a word that this mark follows, and the mark.
    pub fn named(&mut self, mark: &str) -> Option<&'a str> {
        match &self.ahead {
            [Some((Token::Word(name), _)), Some((Token::Mark(found), _))] if *found == mark => {
                let name = *name;
                self.advance();
                self.advance();
                Some(name)
            }
            _ => None,
        }
    }

    /// Leaves out what comes next.
    pub fn skip_one(&mut self, wanted: &str) -> Result<(), ProgramError> {
        self.next(wanted).map(drop)
    }

    /// Leaves out what comes up to this mark, and the mark.
    pub fn skip_past(&mut self, mark: &str) -> Result<(), ProgramError> {
        while !self.take(mark) {
            self.next(mark)?;
        }
        Ok(())
    }

    pub fn number(&mut self, what: &str) -> Result<f64, ProgramError> {
        let word = self.word(what)?;
        finite(word, what).map_err(|kind| self.error(self.last_line(), kind))
    }

    pub fn error(&self, line: usize, kind: ProgramErrorKind) -> ProgramError {
        ProgramError::in_file(self.path, line, kind)
    }

    /// Whether nothing more comes.
    pub fn ended(&self) -> bool {
        self.ahead[0].is_none() && self.fault.is_none()
    }

    fn next(&mut self, wanted: &str) -> Result<Token<'a>, ProgramError> {
        let Some((token, _)) = &self.ahead[0] else {
            let missing = wanted.to_owned();
            let ended = ProgramErrorKind::Truncated { missing };
            let kind = self.fault.take().unwrap_or(ended);
            return Err(self.error(self.line.max(1), kind));
        };
        let token = token.clone();
        self.advance();
        Ok(token)
    }

    /// The fault that the token last taken is not what is wanted.
    pub fn unexpected(&self, wanted: &str) -> ProgramError {
        let taken = self.before.as_ref().or(self.ahead[0].as_ref());
        let (text, line) = taken.map_or((String::new(), 1), |(token, line)| (token.text(), *line));
        self.error(line, ProgramErrorKind::unexpected(&text, wanted))
    }

    pub fn word(&mut self, wanted: &str) -> Result<&'a str, ProgramError> {
        match self.next(wanted)? {
            Token::Word(word) => Ok(word),
            _ => Err(self.unexpected(wanted)),
        }
    }

    /// These words and marks, in this order. Words are the same in capitals and in small letters.
    pub fn expect(&mut self, wanted: &[&str]) -> Result<(), ProgramError> {
        for piece in wanted {
            let fits = match self.next(piece)? {
                Token::Word(found) | Token::Mark(found) => found.eq_ignore_ascii_case(piece),
                Token::Text(_) => false,
            };
            if !fits {
                return Err(self.unexpected(piece));
            }
        }
        Ok(())
    }

    pub fn value(&mut self) -> Result<Value<'a>, ProgramError> {
        self.nested_value(0)
    }

    fn nested_value(&mut self, depth: usize) -> Result<Value<'a>, ProgramError> {
        match self.next("a value")? {
            Token::Word(word) => Ok(Value::Word(word)),
            Token::Text(_) => Ok(Value::Text),
            // No data of the language are nested deeper than four.
            Token::Mark("[") if depth < 8 => {
                let mut list = vec![self.nested_value(depth + 1)?];
                loop {
                    match self.next("`,` or `]`")? {
                        Token::Mark(",") => list.push(self.nested_value(depth + 1)?),
                        Token::Mark("]") => return Ok(Value::List(list)),
                        _ => return Err(self.unexpected("`,` or `]`")),
                    }
                }
            }
            _ => Err(self.unexpected("a value")),
        }
    }
}

fn token<'a>(rest: &'a str, syntax: &Syntax) -> Result<(Token<'a>, &'a str), ProgramErrorKind> {
    if let Some(text) = rest.strip_prefix('"') {
        let end = text
            .find('"')
            .ok_or_else(|| ProgramErrorKind::unexpected(rest, "a text that ends in its line"))?;
        return Ok((Token::Text(&text[..end]), &text[end + 1..]));
    }
    if let Some(after) = rest.strip_prefix(":=") {
        return Ok((Token::Mark(":="), after));
    }
    let in_word = |c: char| {
        c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-') || syntax.in_words.contains(c)
    };
    let end = rest.find(|c| !in_word(c)).unwrap_or(rest.len());
    if end > 0 {
        return Ok((Token::Word(&rest[..end]), &rest[end..]));
    }
    let mark = rest.chars().next().map_or(0, char::len_utf8);
    if syntax.marks.contains(&rest[..mark]) {
        return Ok((Token::Mark(&rest[..mark]), &rest[mark..]));
    }
    Err(ProgramErrorKind::unexpected(
        &rest[..mark],
        &format!("a word, a number or one of {}", syntax.marks),
    ))
}

impl<'a> Value<'a> {
    /// The parts of a list of `wanted` parts.
    pub fn parts(&self, what: &str, wanted: usize) -> Result<&[Value<'a>], ProgramErrorKind> {
        let (found, parts) = match self {
            Self::List(parts) => (parts.len(), parts.as_slice()),
            _ => (1, [].as_slice()),
        };
        if found != wanted || parts.is_empty() {
            return Err(ProgramErrorKind::Fields {
                what: what.to_owned(),
                found,
                wanted: wanted.to_string(),
            });
        }
        Ok(parts)
    }

    pub fn number(&self, what: &str) -> Result<f64, ProgramErrorKind> {
        match self {
            Self::Word(text) => finite(text, what),
            _ => Err(ProgramErrorKind::value(
                what,
                "no number",
                "a finite number",
            )),
        }
    }

    pub fn numbers<const N: usize>(&self, what: &str) -> Result<[f64; N], ProgramErrorKind> {
        let parts = self.parts(what, N)?;
        let mut numbers = [0.0; N];
        for (number, part) in numbers.iter_mut().zip(parts) {
            *number = part.number(what)?;
        }
        Ok(numbers)
    }
}
