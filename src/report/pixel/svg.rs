//! A few words of SVG: text and numbers into elements.

/// Text as it may stand in an element or an attribute.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            // XML has no way to write control characters.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// At most `most` characters, the end cut off.
pub(super) fn cut(text: &str, most: usize) -> String {
    if text.chars().count() <= most {
        return text.to_owned();
    }
    let start: String = text.chars().take(most.saturating_sub(1)).collect();
    format!("{}…", start.trim_end())
}

/// A point on the drawing.
pub(super) type Point = [f64; 2];

/// Points as a path's data.
pub(super) fn path(points: &[Point], closed: bool) -> String {
    let mut data = String::new();
    for (i, [x, y]) in points.iter().enumerate() {
        data += &format!("{}{x:.1} {y:.1}", if i == 0 { "M" } else { "L" });
    }
    if closed {
        data.push('Z');
    }
    data
}

/// Elements one after the other.
#[derive(Default)]
pub(super) struct Drawing(pub(super) String);

impl Drawing {
    pub(super) fn push(&mut self, element: &str) {
        self.0 += element;
        self.0.push('\n');
    }

    pub(super) fn path(&mut self, class: &str, data: &str) {
        self.push(&format!("<path class=\"{class}\" d=\"{data}\"/>"));
    }

    pub(super) fn line(&mut self, class: &str, from: Point, to: Point) {
        self.path(class, &path(&[from, to], false));
    }

    pub(super) fn circle(&mut self, class: &str, [x, y]: Point, radius: f64) {
        self.push(&format!(
            "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>"
        ));
    }

    pub(super) fn text(&mut self, class: &str, [x, y]: Point, text: &str) {
        self.push(&format!(
            "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\">{}</text>",
            escape(text)
        ));
    }

    /// A patch of a colour.
    pub(super) fn swatch(&mut self, [x, y]: Point, [width, height]: [f64; 2], rgb: [u8; 3]) {
        let [r, g, b] = rgb;
        self.push(&format!(
            "<rect class=\"swatch\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width}\" height=\"{height}\" \
             fill=\"rgb({r},{g},{b})\"/>"
        ));
    }

    /// A hit's number in a disc.
    pub(super) fn badge(&mut self, [x, y]: Point, number: usize) {
        self.circle("badge", [x, y], 8.5);
        self.text("badge-text", [x, y + 3.6], &number.to_string());
    }
}
