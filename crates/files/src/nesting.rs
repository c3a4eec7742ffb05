//! How deep arrays and inline tables of a TOML text are nested, found without recursion: its
//! readers recurse, and count what is closed without having been opened against what is open.

use toml_parser::Source;
use toml_parser::lexer::TokenKind;

/// Deepest nesting of arrays and inline tables that is read; ours have three levels at most.
pub const MOST_NESTED: usize = 64;

/// The byte where an array or inline table is opened inside [`MOST_NESTED`] others; `None` if there
/// is none. In a text that is no TOML what is never closed stays open; its other faults are for the
/// parser to name.
#[must_use]
pub fn too_deep(text: &str) -> Option<usize> {
    let mut open: Vec<TokenKind> = Vec::new();
    for token in Source::new(text).lex() {
        let opens = match token.kind() {
            kind @ (TokenKind::LeftCurlyBracket | TokenKind::LeftSquareBracket) => {
                if open.len() == MOST_NESTED {
                    return Some(token.span().start());
                }
                open.push(kind);
                continue;
            }
            TokenKind::RightCurlyBracket => TokenKind::LeftCurlyBracket,
            TokenKind::RightSquareBracket => TokenKind::LeftSquareBracket,
            _ => continue,
        };
        // What closes nothing is passed over, as the parser does.
        open.pop_if(|kind| *kind == opens);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brackets_in_strings_and_comments_and_closed_ones_do_not_count() {
        let text = "a = \"[[[\" # {{{\n[[b]]\nc = [{ d = [1, 2] }, [[3]]]\n".repeat(1000);
        assert_eq!(too_deep(&text), None);
    }

    #[test]
    fn what_nests_is_found_where_it_goes_too_deep() {
        let deep = |levels| format!("a = {}{}", "[".repeat(levels), "]".repeat(levels));
        assert_eq!(too_deep(&deep(MOST_NESTED)), None);
        assert_eq!(too_deep(&deep(MOST_NESTED + 1)), Some(4 + MOST_NESTED));
    }

    /// The parser's own count goes down with each bracket that closes nothing.
    #[test]
    fn brackets_that_close_nothing_hide_none_that_are_open() {
        let text = "a = { b = 3 ]]\n".repeat(2 * MOST_NESTED);
        assert_eq!(too_deep(&text), Some(15 * MOST_NESTED + 4));
        let text = "a = { b = [ } ]\n".repeat(2 * MOST_NESTED);
        assert!(too_deep(&text).is_some());
    }
}
