//! The comment at the head of a scene file: what the scene asks, and what there is to see.
//!
//! In: the text of a `.toml` scene. Out: a [`Head`]. The comment is read as the shipped scenes write it: the first
//! paragraph is a question and its answer; paragraphs (parted by an empty comment line) say what to look at; a line
//! `# term: WORD, WORD` names the terms of the equation that the scene is about. Everything is optional, and nothing here
//! decides which words there are: that is [`crate::report::topic`]'s, which also has the error for a wrong one.

use crate::error::Place;

/// What the comment at the head of a scene file says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// The question, with its question mark; the whole first paragraph where there is none; empty without a comment.
    pub question: String,
    /// What stands behind the question in the first paragraph; may be empty.
    pub answer: String,
    /// The further paragraphs, each on one line.
    pub paragraphs: Vec<String>,
    /// The words of the line `term:`, in its order.
    pub terms: Vec<Word>,
}

/// A word with its place, for messages.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// The word, without space around it.
    pub text: String,
    /// Where it stands.
    pub place: Place,
}

impl Head {
    /// Reads the comment that `text` begins with; `file` is what messages call it.
    ///
    /// ```
    /// use rastray::import::Head;
    /// let head = Head::of("a.toml", "# Is it red? Yes.\n#\n# Look\n# at it.\n#\n# term: diffuse, shadow\n\n# no more");
    /// assert_eq!((head.question.as_str(), head.answer.as_str()), ("Is it red?", "Yes."));
    /// assert_eq!(head.paragraphs, ["Look at it."]);
    /// assert_eq!(head.terms[1].text, "shadow");
    /// assert_eq!(head.terms[1].place.to_string(), "a.toml:6:18");
    /// ```
    pub fn of(file: &str, text: &str) -> Self {
        let mut terms = Vec::new();
        let mut paragraphs = vec![String::new()];
        let mut start = 0;
        for line in text.split_inclusive('\n') {
            let Some(comment) = line.strip_prefix('#') else {
                break;
            };
            let comment_start = start + 1;
            start += line.len();
            let words = comment.trim();
            if let Some(list) = words.strip_prefix("term:") {
                // Where the list begins in the text: what was trimmed before it, and the key.
                let skipped = comment.len() - comment.trim_start().len() + "term:".len();
                terms.extend(listed(file, text, comment_start + skipped, list));
            } else if words.is_empty() {
                paragraphs.push(String::new());
            } else if let Some(paragraph) = paragraphs.last_mut() {
                let space = if paragraph.is_empty() { "" } else { " " };
                *paragraph += &format!("{space}{words}");
            }
        }
        let mut paragraphs = paragraphs.into_iter().filter(|p| !p.is_empty());
        let first = paragraphs.next().unwrap_or_default();
        let end = first.find('?').map_or(first.len(), |mark| mark + 1);
        Self {
            question: first[..end].to_owned(),
            answer: first[end..].trim().to_owned(),
            paragraphs: paragraphs.collect(),
            terms,
        }
    }
}

/// The words of a list with commas that stands at `start` of the text.
fn listed(file: &str, text: &str, start: usize, list: &str) -> Vec<Word> {
    let mut at = start;
    let mut words = Vec::new();
    for part in list.split(',') {
        let before = part.len() - part.trim_start().len();
        let word = part.trim();
        let span = at + before..at + before + word.len();
        words.push(Word {
            text: word.to_owned(),
            place: Place::span(file, text, span),
        });
        at += part.len() + 1;
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::shipped;

    #[test]
    fn a_file_without_a_comment_says_nothing() {
        for text in ["", "[camera]\n# later\n", "\n# not at the head"] {
            assert_eq!(Head::of("a.toml", text), Head::default(), "{text:?}");
        }
    }

    #[test]
    fn no_question_mark_and_other_line_ends_are_understood() {
        let head = Head::of(
            "a.toml",
            "#A title\r\n# of two lines.\r\n#\r\n#term:sum\r\nx = 1",
        );
        assert_eq!(head.question, "A title of two lines.");
        assert_eq!(head.answer, "");
        assert!(head.paragraphs.is_empty());
        assert_eq!(head.terms[0].text, "sum");
        assert_eq!(
            (head.terms[0].place.line, head.terms[0].place.column),
            (4, 7)
        );
    }

    #[test]
    fn empty_words_are_kept_for_the_error_about_them() {
        let words = |text: &str| -> Vec<String> {
            let head = Head::of("a.toml", text);
            head.terms.into_iter().map(|word| word.text).collect()
        };
        assert_eq!(words("# term: é, ,x"), ["é", "", "x"]);
        assert_eq!(words("# term:"), [""]);
    }

    #[test]
    fn every_lecture_scene_asks_answers_says_what_to_see_and_has_a_term() {
        for scene in shipped().iter().filter(|s| s.folder == "lecture") {
            let head = Head::of(scene.name, scene.text);
            assert!(head.question.ends_with('?'), "{}", scene.name);
            assert!(head.answer.ends_with('.'), "{}", scene.name);
            assert!(!head.paragraphs.is_empty(), "{}", scene.name);
            assert!(!head.terms.is_empty(), "{}", scene.name);
        }
    }
}
