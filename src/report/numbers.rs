//! Numbers as people read them: grouped counts, shares, three significant digits, ticks.

/// A count with its thousands grouped.
///
/// ```
/// use rastray::report::numbers::count;
/// assert_eq!(count(12345), "12,345");
/// ```
pub fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A share in percent: one decimal, never rounded to "none" or "all" where it is neither.
///
/// ```
/// use rastray::report::numbers::percent;
/// assert_eq!(percent(1, 3), "33.3 %");
/// assert_eq!(percent(1, 100_000), "< 0.1 %");
/// assert_eq!(percent(0, 7), "0 %");
/// ```
pub fn percent(part: usize, whole: usize) -> String {
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    match part {
        0 => "0 %".to_owned(),
        _ if part >= whole => "100 %".to_owned(),
        _ if share < 0.1 => "< 0.1 %".to_owned(),
        _ if share > 99.9 => "> 99.9 %".to_owned(),
        _ => format!("{share:.1} %"),
    }
}

/// A value with three significant digits; very small and very large ones as a power of ten.
///
/// ```
/// use rastray::report::numbers::value;
/// assert_eq!(value(0.08333), "0.0833");
/// assert_eq!(value(-2.0), "−2");
/// assert_eq!(value(1.25e-7), "1.25 × 10⁻⁷");
/// ```
pub fn value(x: f64) -> String {
    significant(x, 3)
}

/// The number at a tick of a scale: short, with a true minus sign.
///
/// ```
/// use rastray::report::numbers::tick;
/// assert_eq!(tick(0.05 * 0.75), "0.0375");
/// assert_eq!(tick(-0.5), "−0.5");
/// ```
pub fn tick(x: f64) -> String {
    significant(x, 4)
}

/// Seconds in the unit that suits them.
///
/// ```
/// use rastray::report::numbers::duration;
/// assert_eq!(duration(0.0421), "42.1 ms");
/// assert_eq!(duration(2.0), "2 s");
/// ```
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s >= 1.0 || s == 0.0 => format!("{} s", value(s)),
        s if s >= 1e-3 => format!("{} ms", value(1e3 * s)),
        s => format!("{} µs", value(1e6 * s)),
    }
}

/// `digits` significant digits without trailing zeros.
fn significant(x: f64, digits: usize) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !x.is_finite() {
        return if x.is_nan() {
            "–"
        } else if x > 0.0 {
            "∞"
        } else {
            "−∞"
        }
        .to_owned();
    }
    let scientific = format!("{:.*e}", digits - 1, x.abs());
    let (mantissa, exponent) = scientific.split_once('e').unwrap_or((&scientific, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let sign = if x < 0.0 { "−" } else { "" };
    if (-4..7).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        // The rounded mantissa, not x, decides the digits, so that both forms round alike.
        let rounded: f64 = scientific.parse().unwrap_or(x.abs());
        return format!("{sign}{}", trimmed(&format!("{rounded:.decimals$}")));
    }
    format!("{sign}{} × 10{}", trimmed(mantissa), superscript(exponent))
}

/// Without zeros at the end of the fraction.
fn trimmed(number: &str) -> &str {
    match number.contains('.') {
        true => number.trim_end_matches('0').trim_end_matches('.'),
        false => number,
    }
}

/// A whole number in superscript digits.
fn superscript(n: i32) -> String {
    let raise = |c: char| match c.to_digit(10) {
        Some(d) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][d as usize],
        None => '⁻',
    };
    n.to_string().chars().map(raise).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped() {
        for (n, text) in [
            (0, "0"),
            (999, "999"),
            (1000, "1,000"),
            (1_234_567, "1,234,567"),
        ] {
            assert_eq!(count(n), text);
        }
    }

    #[test]
    fn shares_do_not_round_to_none_or_all() {
        assert_eq!(percent(9_999, 10_000), "> 99.9 %");
        assert_eq!(percent(10_000, 10_000), "100 %");
        assert_eq!(percent(400, 10_000), "4.0 %");
        assert_eq!(percent(0, 0), "0 %");
    }

    #[test]
    fn values_keep_three_digits() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (0.610_4, "0.61"),
            (1234.5, "1230"),
            (0.000_123_4, "0.000123"),
            (1e-5, "1 × 10⁻⁵"),
            (9.999, "10"),
            (-3.2e9, "−3.2 × 10⁹"),
            (f64::INFINITY, "∞"),
        ] {
            assert_eq!(value(x), text, "{x}");
        }
        assert_eq!(duration(12e-6), "12 µs");
    }
}
