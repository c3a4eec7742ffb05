//! Texts of users as errors show them.

use std::ops::Range;

/// Longest line that is shown as it is, and how much of a longer one, bytes.
const LONGEST: usize = 300;
/// How much of a long line stands before what is pointed at, bytes.
const BEFORE: usize = 60;

/// A text for the excerpt of an error, whose `spans` are moved along: characters that would act on
/// a terminal become question marks, of lines that nobody could read only the part about their
/// first span is left. Lines keep their numbers.
#[must_use]
pub fn excerpt(text: &str, spans: &mut [Range<usize>]) -> String {
    let mut shown = String::with_capacity(text.len());
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let end = start + line.len();
        let here = |span: &&mut Range<usize>| (start..end).contains(&span.start);
        let at = spans.iter_mut().find(here).map(|span| span.start - start);
        let body = line.trim_end_matches('\n');
        let part = part(body, at.unwrap_or(0));
        let (first, last) = (start + part.start, start + part.end);
        let offset = shown.len();
        for span in spans
            .iter_mut()
            .filter(|span| (start..end).contains(&span.start))
        {
            // What reaches into lines below is pointed at where it begins.
            let from = span.start.clamp(first, last);
            let to = if body.len() > LONGEST {
                span.end.clamp(from, last)
            } else {
                span.end
            };
            *span = offset + from - first..offset + to - first;
        }
        shown.extend(body[part].chars().flat_map(harmless));
        shown.push_str(&line[body.len()..]);
        start = end;
    }
    shown
}

/// A message with values from a file, for a terminal; of words that nobody could read only the
/// beginning is left.
#[must_use]
pub fn harmless_text(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for word in text.split_inclusive(char::is_whitespace) {
        let end = word.trim_end_matches(char::is_whitespace).len();
        if end <= LONGEST {
            shown.extend(word.chars().flat_map(harmless));
        } else {
            shown.extend(word[part(&word[..end], 0)].chars().flat_map(harmless));
            shown.push('…');
            shown.extend(word[end..].chars().flat_map(harmless));
        }
    }
    shown
}

/// A character, or as many question marks as it has bytes.
fn harmless(character: char) -> impl Iterator<Item = char> {
    let acts = character.is_control() && !matches!(character, '\n' | '\t');
    let (shown, count) = match acts {
        true => ('?', character.len_utf8()),
        false => (character, 1),
    };
    std::iter::repeat_n(shown, count)
}

/// The part of a line to show, at borders of characters.
fn part(line: &str, at: usize) -> Range<usize> {
    if line.len() <= LONGEST {
        return 0..line.len();
    }
    let border = |index: usize| {
        (0..=index.min(line.len()))
            .rev()
            .find(|i| line.is_char_boundary(*i))
    };
    let first = border(at.saturating_sub(BEFORE)).unwrap_or(0);
    first..border(first + LONGEST).unwrap_or(line.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Vertical tabs and form feeds part words, and act on a terminal.
    #[test]
    fn what_parts_long_words_is_shown_as_a_question_mark() {
        let word = "x".repeat(LONGEST + 1);
        for space in ['\u{b}', '\u{c}', '\u{85}'] {
            let shown = harmless_text(&format!("{word}{space}y{space}z\n"));
            let harmless = |c: char| !c.is_control() || c == '\n';
            assert!(shown.chars().all(harmless), "{shown:?}");
        }
    }

    #[test]
    fn what_acts_on_a_terminal_is_shown_as_question_marks() {
        let span = 11..14;
        let mut spans = [span];
        let shown = excerpt("a\x1b[31m\u{9b}b\n\tkey\r", &mut spans);
        assert_eq!(shown, "a?[31m??b\n\tkey?");
        assert_eq!(&shown[spans[0].clone()], "key");
        assert_eq!(harmless_text("\x07x"), "?x");
        let long = format!("key {} is unknown", "x".repeat(4000));
        let cut = format!("key {}… is unknown", "x".repeat(LONGEST));
        assert_eq!(harmless_text(&long), cut);
    }

    proptest! {
        /// Lines keep their number and what is pointed at its text, or its beginning.
        #[test]
        fn spans_point_at_the_same_text(
            lines in prop::collection::vec("[aé]{0,900}", 1..6),
            line in 0_usize..6,
            from in 0.0..1.0_f64,
            length in 1_usize..200,
        ) {
            let text = lines.join("\n");
            let line = line % lines.len();
            let before: usize = lines[..line].iter().map(|l| l.len() + 1).sum();
            let count = lines[line].chars().count();
            prop_assume!(count > 0);
            let first = ((from * count as f64) as usize).min(count - 1);
            let pointed: String = lines[line].chars().skip(first).take(length).collect();
            let start = before + lines[line].chars().take(first).map(char::len_utf8).sum::<usize>();
            let span = start..start + pointed.len();
            let mut spans = [span];
            let shown = excerpt(&text, &mut spans);
            prop_assert_eq!(shown.lines().count(), text.lines().count());
            prop_assert!(shown.lines().all(|line| line.len() <= LONGEST));
            let now = &shown[spans[0].clone()];
            prop_assert!(!now.is_empty() && pointed.starts_with(now));
            prop_assert!(now == pointed || lines[line].len() > LONGEST);
            prop_assert_eq!(shown[..spans[0].start].matches('\n').count(), line);
        }
    }
}
