//! How deep the elements of an XML text are nested and how many attributes one has, found without
//! recursion and in time as the text is long: the readers recurse, and compare each attribute of an
//! element with all before it.

use crate::error::ArmErrorKind;

/// Deepest nesting that is read: a URDF needs less than ten.
const MOST_NESTED: usize = 256;
/// Most attributes of an element: the longest call of a macro has some fifty.
const MOST_ATTRIBUTES: usize = 256;

/// The first element that is beyond a bound: the byte where it begins, and which bound. A text that
/// is not well-formed is followed as far as it goes; its faults are for the parser to name.
pub(crate) fn exceeded(text: &str) -> Option<(usize, ArmErrorKind)> {
    beyond(text, MOST_NESTED, MOST_ATTRIBUTES)
}

fn beyond(text: &str, nested: usize, attributes: usize) -> Option<(usize, ArmErrorKind)> {
    let mut depth = 0_usize;
    let mut at = 0;
    while let Some(found) = text[at..].find('<') {
        let start = at + found;
        let rest = &text[start..];
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((_, end)) = skipped.iter().find(|(head, _)| rest.starts_with(head)) {
            at = start + rest.find(end)? + end.len();
        } else if rest.starts_with("<!") {
            // A declaration; the elements in its entities count like others.
            at = start + 2;
        } else if rest.starts_with("</") {
            depth = depth.saturating_sub(1);
            at = start + 2;
        } else {
            let (end, count) = tag(rest)?;
            if !rest[..end].ends_with('/') {
                depth += 1;
            }
            if depth > nested {
                return Some((start, ArmErrorKind::TooDeep { limit: nested }));
            }
            if count > attributes {
                let limit = attributes;
                return Some((start, ArmErrorKind::TooManyAttributes { count, limit }));
            }
            at = start + end;
        }
    }
    None
}

/// Where the tag that `text` starts with is closed, and how many attributes it has; a `>` in an
/// attribute's value closes nothing.
fn tag(text: &str) -> Option<(usize, usize)> {
    let (mut quote, mut count) = (None, 0);
    let end = text.char_indices().skip(1).find_map(|(at, c)| {
        match quote {
            Some(open) if c == open => quote = None,
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == '=' => count += 1,
            None if c == '>' => return Some(at),
            _ => {}
        }
        None
    });
    Some((end?, count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_open_elements_count() {
        let text =
            "<?xml?><!-- <a><a> --><a x='>' y=\"'\"><b/><![CDATA[<c><c>]]><b></b><b><c/></b></a>";
        assert!(beyond(text, 2, 2).is_none());
        let deep = beyond(text, 1, 2).unwrap();
        assert_eq!(Some(deep.0), text.find("<b></b>"));
        assert!(matches!(deep.1, ArmErrorKind::TooDeep { limit: 1 }));
    }

    #[test]
    fn attributes_of_one_element_count_and_signs_in_their_values_do_not() {
        let text = "<a x='1=1' y=\"=\"><b x='' y=''\n z = ''/></a>";
        assert!(beyond(text, 9, 3).is_none());
        let wide = beyond(text, 9, 2).unwrap();
        assert_eq!(Some(wide.0), text.find("<b"));
        let ArmErrorKind::TooManyAttributes { count: 3, limit: 2 } = wide.1 else {
            panic!("{}", wide.1);
        };
    }

    #[test]
    fn broken_texts_end_the_search() {
        for text in ["", "<", "<a", "<!-- <a>", "</a></a><a", "<a b='>"] {
            assert!(beyond(text, 0, 0).is_none(), "{text}");
        }
    }
}
