//! The list of a macro's parameters.

use super::scope::Parameter;

/// `a b:=1 c:=^|${x} *origin`: the parameters of a macro.
pub(super) fn parameters(text: &str) -> Vec<Parameter> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let is_end = |c: char| c.is_whitespace() || c == ':' || c == '=';
        let end = rest.find(is_end).unwrap_or(rest.len()).max(1);
        let (name, after) = (&rest[..end], rest[end..].trim_start());
        let assigned = after.strip_prefix(":=").or_else(|| after.strip_prefix('='));
        let Some(value) = assigned else {
            found.push(Parameter {
                name: name.to_owned(),
                forwards: false,
                default: None,
            });
            rest = rest[end..].trim_start_matches(|c: char| c.is_whitespace() || c == ':');
            continue;
        };
        let value = value.trim_start();
        let (forwards, value) = match value.strip_prefix('^') {
            Some(value) => (true, value.strip_prefix('|').unwrap_or(value)),
            None => (false, value),
        };
        let length = default_length(value);
        found.push(Parameter {
            name: name.to_owned(),
            forwards,
            default: (length > 0).then(|| value[..length].to_owned()),
        });
        rest = value[length..].trim_start();
    }
    found
}

/// Where a default ends: at a space that is neither in an expression nor in quotes.
fn default_length(text: &str) -> usize {
    let mut close = None;
    let mut last = ' ';
    for (at, c) in text.char_indices() {
        match close {
            Some(end) if c == end => close = None,
            Some(_) => {}
            None if c.is_whitespace() => return at,
            None if c == '{' && last == '$' => close = Some('}'),
            None if c == '(' && last == '$' => close = Some(')'),
            None if c == '\'' || c == '"' => close = Some(c),
            None => {}
        }
        last = c;
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_defaults_and_blocks_are_told_apart() {
        let found =
            parameters("a b:=1 c = ^|${x + 1} d:='two words' e:=^ f:=${g}_${h} *origin **rest");
        let shown: Vec<_> = (found.iter())
            .map(|p| (p.name.as_str(), p.forwards, p.default.as_deref()))
            .collect();
        let expected = [
            ("a", false, None),
            ("b", false, Some("1")),
            ("c", true, Some("${x + 1}")),
            ("d", false, Some("'two words'")),
            ("e", true, None),
            ("f", false, Some("${g}_${h}")),
            ("*origin", false, None),
            ("**rest", false, None),
        ];
        assert_eq!(shown, expected);
    }
}
