//! Text of files and names of files, as they stand in messages.

/// Most characters of a path, and of a whole line.
pub(super) const LONG: usize = 4096;

/// `text` in one line of at most `most` characters: control characters become `?`, and what is cut off is marked by
/// `...`.
pub(super) fn one_line(text: &str, most: usize) -> String {
    let is_cut = text.chars().nth(most).is_some();
    let kept = if is_cut { most.saturating_sub(3) } else { most };
    let line = text.chars().take(kept).map(|c| if c.is_control() || is_separator(c) { '?' } else { c });
    line.chain("...".chars().filter(|_| is_cut)).collect()
}

/// What ends a line or a paragraph without being a control character.
fn is_separator(c: char) -> bool {
    matches!(c, '\u{2028}' | '\u{2029}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_replaced_and_long_text_is_cut() {
        assert_eq!(one_line("a place, ä", LONG), "a place, ä");
        assert_eq!(one_line("\x1b[31m\r\na\tb\u{85}\u{2028}\0", LONG), "?[31m??a?b???");
        assert_eq!(one_line("äbcdef", 6), "äbcdef");
        assert_eq!(one_line("äbcdefg", 6), "äbc...");
        assert_eq!(one_line("", 0), "");
    }
}
