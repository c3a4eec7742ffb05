//! The part of YAML in which parameters of robots are published: nested mappings and lists, by
//! indentation or in brackets, with numbers, truth values, texts, and units as tags.

use super::expression;
use super::value::Value;

/// A line without its comment: its number, from 1, its indentation, and what it says.
#[derive(Clone, Copy)]
struct Line<'a> {
    number: usize,
    indent: usize,
    text: &'a str,
}

/// Deepest nesting.
const MOST_NESTED: usize = 32;

/// The value of a whole text.
pub(super) fn parse(text: &str) -> Result<Value, String> {
    let lines = text.lines().enumerate();
    let lines: Vec<Line> = lines
        .filter_map(|(index, line)| {
            let text = without_comment(line).trim_end();
            let own = text.trim_start();
            let says = !own.is_empty() && own != "---" && !own.starts_with('%');
            says.then_some(Line {
                number: index + 1,
                indent: text.len() - own.len(),
                text: own,
            })
        })
        .collect();
    let mut reader = Reader {
        lines,
        at: 0,
        depth: 0,
    };
    if reader.lines.is_empty() {
        return Ok(Value::None);
    }
    let value = reader.block(reader.lines[0].indent)?;
    match reader.lines.get(reader.at) {
        None => Ok(value),
        Some(line) => Err(fault(*line, "is indented like nothing before it")),
    }
}

fn fault(line: Line, what: &str) -> String {
    format!(
        "line {} of the YAML file, `{}`, {what}",
        line.number, line.text
    )
}

/// A `#` after a space, outside quotes, starts a comment.
fn without_comment(line: &str) -> &str {
    let mut quote = None;
    let mut last = ' ';
    for (at, c) in line.char_indices() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if c == '#' && last.is_whitespace() => return &line[..at],
            None if c == '\'' || c == '"' => quote = Some(c),
            None => {}
        }
        last = c;
    }
    line
}

struct Reader<'a> {
    lines: Vec<Line<'a>>,
    at: usize,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn next(&self, indent: usize) -> Option<Line<'a>> {
        let line = self.lines.get(self.at).copied();
        line.filter(|line| line.indent == indent)
    }

    /// The mapping, list or plain value whose lines stand at `indent`.
    fn block(&mut self, indent: usize) -> Result<Value, String> {
        let first = self.lines[self.at];
        self.depth += 1;
        if self.depth > MOST_NESTED {
            return Err(fault(first, "is nested too deep"));
        }
        let value = if is_item(first.text) {
            self.list(indent)?
        } else if key_of(first.text).is_some() {
            self.mapping(indent)?
        } else {
            self.at += 1;
            scalar(first, first.text)?
        };
        self.depth -= 1;
        Ok(value)
    }

    fn list(&mut self, indent: usize) -> Result<Value, String> {
        let mut values = Vec::new();
        while let Some(line) = self.next(indent).filter(|line| is_item(line.text)) {
            let rest = line.text[1..].trim_start();
            if rest.is_empty() {
                self.at += 1;
                values.push(self.below(indent + 1)?);
            } else {
                // What follows the dash is a block of its own, where it stands.
                let inner = indent + line.text.len() - rest.len();
                self.lines[self.at] = Line {
                    indent: inner,
                    text: rest,
                    ..line
                };
                values.push(self.block(inner)?);
            }
        }
        Ok(Value::List(values))
    }

    fn mapping(&mut self, indent: usize) -> Result<Value, String> {
        let mut entries: Vec<(Value, Value)> = Vec::new();
        while let Some(line) = self.next(indent) {
            let Some((key, rest)) = key_of(line.text) else {
                return Err(fault(line, "has no key"));
            };
            self.at += 1;
            let key = scalar(line, key)?;
            let value = if rest.is_empty() {
                let is_list = self.next(indent).is_some_and(|line| is_item(line.text));
                self.below(if is_list { indent } else { indent + 1 })?
            } else {
                scalar(line, rest)?
            };
            entries.push((key, value));
        }
        Ok(Value::Dict(entries))
    }

    /// The block below a key or a dash, at least at `indent`; nothing if there is none.
    fn below(&mut self, indent: usize) -> Result<Value, String> {
        match self.lines.get(self.at) {
            Some(line) if line.indent >= indent => self.block(line.indent),
            _ => Ok(Value::None),
        }
    }
}

fn is_item(text: &str) -> bool {
    text == "-" || text.starts_with("- ")
}

/// The key of a line and what stands after it.
fn key_of(text: &str) -> Option<(&str, &str)> {
    if text.starts_with(['{', '[', '!']) {
        return None;
    }
    let from = match text.chars().next() {
        Some(quote @ ('"' | '\'')) => text[1..].find(quote)? + 2,
        _ => 0,
    };
    let mut colons = text[from..].match_indices(':').map(|(at, _)| from + at);
    let at = colons.find(|at| text[at + 1..].is_empty() || text[at + 1..].starts_with(' '))?;
    Some((text[..at].trim_end(), text[at + 1..].trim_start()))
}

/// A value that stands in one line.
fn scalar(line: Line, text: &str) -> Result<Value, String> {
    if let Some(tagged) = text.strip_prefix('!') {
        let (tag, number) = tagged.split_once(' ').unwrap_or((tagged, ""));
        let factor = match tag {
            "radians" | "meters" => 1.0,
            "degrees" => std::f64::consts::PI / 180.0,
            "millimeters" => 1e-3,
            "foot" => 0.3048,
            "inches" => 0.0254,
            _ => return Err(fault(line, "has a tag that is not known")),
        };
        let value = expression::constant(number.trim());
        let value = value.map_err(|_| fault(line, "is not a number"))?;
        return Ok(Value::Float(value * factor));
    }
    if text.starts_with(['&', '*', '|', '>']) {
        return Err(fault(line, "uses a part of YAML that is not read"));
    }
    if text.starts_with(['[', '{']) {
        return in_brackets(line, text);
    }
    Ok(plain(text))
}

fn plain(text: &str) -> Value {
    for quote in ['"', '\''] {
        let inner = text.strip_prefix(quote).and_then(|t| t.strip_suffix(quote));
        if let Some(inner) = inner {
            return Value::Text(inner.to_owned());
        }
    }
    match text {
        "true" | "True" | "TRUE" | "yes" | "Yes" | "on" | "On" => return Value::Bool(true),
        "false" | "False" | "FALSE" | "no" | "No" | "off" | "Off" => return Value::Bool(false),
        "~" | "null" | "Null" | "" => return Value::None,
        ".inf" => return Value::Float(f64::INFINITY),
        "-.inf" => return Value::Float(f64::NEG_INFINITY),
        _ => {}
    }
    let is_number = text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    match (text.parse::<i64>(), text.parse::<f64>()) {
        (Ok(value), _) => Value::Int(value),
        (_, Ok(value)) if is_number => Value::Float(value),
        _ => Value::Text(text.to_owned()),
    }
}

/// `[a, b]` or `{a: 1, b: [2, 3]}` in one line.
fn in_brackets(line: Line, text: &str) -> Result<Value, String> {
    let is_list = text.starts_with('[');
    let close = if is_list { ']' } else { '}' };
    let inner = text[1..].strip_suffix(close);
    let inner = inner.ok_or_else(|| fault(line, "is not closed in its line"))?;
    let mut values = Vec::new();
    let mut entries = Vec::new();
    for part in parts(inner) {
        if is_list {
            values.push(scalar(line, part)?);
        } else {
            let (key, value) = key_of(part).ok_or_else(|| fault(line, "has no key"))?;
            entries.push((scalar(line, key)?, scalar(line, value)?));
        }
    }
    Ok(if is_list {
        Value::List(values)
    } else {
        Value::Dict(entries)
    })
}

/// What commas part that stand neither in brackets nor in quotes.
fn parts(text: &str) -> Vec<&str> {
    let (mut depth, mut quote, mut from) = (0_usize, None, 0);
    let mut found = Vec::new();
    for (at, c) in text.char_indices() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => {}
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == '[' || c == '{' => depth += 1,
            None if c == ']' || c == '}' => depth = depth.saturating_sub(1),
            None if c == ',' && depth == 0 => {
                found.push(text[from..at].trim());
                from = at + 1;
            }
            None => {}
        }
    }
    found.push(text[from..].trim());
    found.retain(|part| !part.is_empty());
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Value {
        Value::Text(text.to_owned())
    }

    #[test]
    fn mappings_lists_and_units_are_read() {
        let value = parse(concat!(
            "# limits\n---\nlimits:\n  pan:   # the first\n    max: !degrees 180.0\n    used: true\n",
            "  'a: b': \"x # y\"\nlist:\n- 1\n- [2.5, {k: z}]\n-\n  n: 3\nnone:\n- m: 1\n  o: 2\n",
        ));
        let value = value.expect("it is read");
        let get = |path: &[&str]| {
            let step = |value: Value, key: &&str| value.item(&text(key)).expect(key);
            path.iter().fold(value.clone(), step)
        };
        assert_eq!(
            get(&["limits", "pan", "max"]),
            Value::Float(std::f64::consts::PI)
        );
        assert_eq!(get(&["limits", "pan", "used"]), Value::Bool(true));
        assert_eq!(get(&["limits", "a: b"]), text("x # y"));
        assert_eq!(
            get(&["list"]).to_string(),
            "[1, [2.5, {'k': 'z'}], {'n': 3}]"
        );
        assert_eq!(get(&["none"]).to_string(), "[{'m': 1, 'o': 2}]");
    }

    #[test]
    fn what_is_not_read_is_told_with_its_line() {
        for (yaml, line) in [("a: 1\nb: &x 2", 2), ("a: [1, 2", 1), ("a: 1\n   b: 2", 2)] {
            let told = parse(yaml).expect_err(yaml);
            assert!(told.contains(&format!("line {line} ")), "{told}");
        }
    }
}
