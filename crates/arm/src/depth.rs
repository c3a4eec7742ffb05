//! How deep the elements of an XML text are nested, found without recursion: the readers recurse.

/// The byte where an element is opened inside `limit` others; `None` if there is none. A text that
/// is not well-formed is followed as far as it goes; its faults are for the parser to name.
pub(crate) fn exceeded(text: &str, limit: usize) -> Option<usize> {
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
            let end = tag_end(rest)?;
            if !rest[..end].ends_with('/') {
                depth += 1;
            }
            if depth > limit {
                return Some(start);
            }
            at = start + end;
        }
    }
    None
}

/// Where the tag that `text` starts with is closed; a `>` in an attribute's value closes nothing.
fn tag_end(text: &str) -> Option<usize> {
    let mut quote = None;
    text.char_indices().skip(1).find_map(|(at, c)| {
        match quote {
            Some(open) if c == open => quote = None,
            None if c == '"' || c == '\'' => quote = Some(c),
            None if c == '>' => return Some(at),
            _ => {}
        }
        None
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_open_elements_count() {
        let text =
            "<?xml?><!-- <a><a> --><a x='>' y=\"'\"><b/><![CDATA[<c><c>]]><b></b><b><c/></b></a>";
        assert_eq!(exceeded(text, 2), None);
        assert_eq!(exceeded(text, 1), text.find("<b></b>"));
    }

    #[test]
    fn broken_texts_end_the_search() {
        for text in ["", "<", "<a", "<!-- <a>", "</a></a><a", "<a b='>"] {
            assert_eq!(exceeded(text, 0), None, "{text}");
        }
    }
}
