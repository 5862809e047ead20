//! Running text in lines of a terminal.

/// Breaks text between words into lines of `width` characters less an indent.
///
/// ```
/// use rastray::report::lines::wrap;
/// assert_eq!(wrap("one two three four", Some(14), 4), "one two\nthree four");
/// ```
pub fn wrap(text: &str, width: Option<usize>, indent: usize) -> String {
    let Some(width) = width else {
        return text.to_owned();
    };
    let room = width.saturating_sub(indent).max(1);
    let mut lines = vec![String::new()];
    let mut length = 0;
    for word in text.split(' ') {
        let more = word.chars().count();
        if length > 0 && length + 1 + more > room {
            lines.push(String::new());
            length = 0;
        }
        if let Some(line) = lines.last_mut() {
            if length > 0 {
                line.push(' ');
                length += 1;
            }
            line.push_str(word);
            length += more;
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_broken_between_words() {
        let text = "one two three four";
        assert_eq!(wrap(text, None, 7), text);
        assert_eq!(wrap(text, Some(100), 7), text);
        assert_eq!(wrap(text, Some(14), 4), "one two\nthree four");
        // A word that is too long stands alone.
        assert_eq!(
            wrap("a longerthanthat b", Some(10), 4),
            "a\nlongerthanthat\nb"
        );
        assert_eq!(wrap("", Some(10), 4), "");
    }
}
