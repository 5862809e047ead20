//! A check in words: the verdict, the mistakes that explain the picture, the pixels that show them.

use super::{Asked, Checked};
use crate::check::{self, Finding, Mode, Report, Verdict};
use crate::report::lines::wrap;
use crate::report::numbers::{count, value};

/// A check in words, on the way to lines of a terminal.
struct Told<'a> {
    report: &'a Report,
    asked: &'a Asked<'a>,
    /// The file was compressed with a loss.
    lossy: bool,
    columns: usize,
}

impl Checked<'_> {
    /// The verdict, the mistakes and the pixels that show them, in lines of `columns` characters.
    pub fn to_text(&self, columns: usize) -> String {
        let told = Told {
            report: self.report,
            asked: &self.asked,
            lossy: self.given.lossy,
            columns,
        };
        told.text()
    }
}

impl Told<'_> {
    fn text(&self) -> String {
        let r = self.report;
        let mut text = format!(
            "{}: {}x{}, held against {} pictures of {}\n\n",
            self.asked.image.display(),
            r.size[0],
            r.size[1],
            count(r.pictures),
            self.asked.scene
        );
        text += &match r.verdict {
            Verdict::Right => self.right(),
            Verdict::Mistake => self.mistake(),
            Verdict::Unexplained => self.unexplained(),
        };
        text + &self.right_as() + &self.cannot_show()
    }

    fn paragraph(&self, indent: usize, words: &str) -> String {
        let lines = wrap(words, Some(self.columns), indent);
        let lines = lines.lines().map(|line| format!("{:indent$}{line}\n", ""));
        lines.collect()
    }

    fn right(&self) -> String {
        let r = self.report;
        let mut words = format!(
            "The picture is right, within rmse {}: it is {}.",
            value(r.error),
            r.mode.describe()
        );
        if !r.also.is_empty() {
            let also: Vec<&str> = r.also.iter().map(|m| m.describe()).collect();
            words += &format!(" On this scene that is the same as {}.", also.join("; "));
        }
        let mut text = self.paragraph(0, &words);
        text += &format!("Largest difference of a value: {}.\n", value(r.largest));
        if !r.findings.is_empty() {
            text += "\nHad it been meant for something else, it would have this mistake:\n";
            for f in &r.findings {
                text +=
                    &self.paragraph(2, &format!("As {}: {}", f.mode.describe(), f.mistake.title));
            }
        }
        text
    }

    fn mistake(&self) -> String {
        let r = self.report;
        let Some(best) = r.findings.first() else {
            return String::new();
        };
        let mut text = self.paragraph(0, &explained(r.mode, best));
        text += &self.finding(1, best, true);
        let (tied, rest): (Vec<&Finding>, Vec<&Finding>) =
            r.findings[1..].iter().partition(|f| f.tied);
        if !tied.is_empty() {
            text += "\nOn this scene these cannot be told from it:\n";
        }
        for (i, f) in tied.iter().enumerate() {
            text += &self.finding(2 + i, f, true);
        }
        if !rest.is_empty() {
            text += "\nLess of it is explained by:\n";
        }
        for (i, f) in rest.iter().enumerate() {
            text += &self.finding(2 + tied.len() + i, f, false);
        }
        text += &format!(
            "\nError (rmse of the stored values): {} against the right picture, {} with the mistake.\n",
            value(r.error),
            value(best.error)
        );
        text + &self.telling()
    }

    fn finding(&self, number: usize, f: &Finding, full: bool) -> String {
        let mut heading = format!(
            "{}  (removes {} of the error",
            f.mistake.title,
            share(f.removed)
        );
        if f.mode != self.report.mode {
            heading += &format!(", as {}", f.mode.describe());
        }
        heading += ")";
        let mut text = if full { "\n".to_owned() } else { String::new() };
        text += &self.paragraph(2, &format!("{number}. {heading}"));
        if full {
            text += &self.paragraph(5, f.mistake.what);
            if let Some(amount) = f.amount {
                text += &self.paragraph(
                    5,
                    &format!("It fits best at {} scene units.", value(amount)),
                );
            }
            text += &self.paragraph(
                5,
                &format!("To put it right: {}", uncapital(f.mistake.remedy)),
            );
        }
        text
    }

    fn telling(&self) -> String {
        if self.report.telling.is_empty() {
            return String::new();
        }
        let mut text = format!(
            "\nThe most telling pixels\n  {:>4} {:>4}   {:17} {:17} {:17}\n",
            "x", "y", "given", "with the mistake", "right"
        );
        for t in &self.report.telling {
            let [given, mistaken, right] = [t.given, t.mistaken, t.right].map(rgb);
            text += &format!(
                "  {:>4} {:>4}   {given:17} {mistaken:17} {right:17}\n",
                t.x, t.y
            );
        }
        text += "Each one explained, with the numbers of the right equation:\n";
        for t in &self.report.telling {
            text += &format!("  {}\n", self.asked.explain(self.report.size, t));
        }
        text
    }

    fn unexplained(&self) -> String {
        let r = self.report;
        let words = format!(
            "The picture is not right, and none of these mistakes explains it: nearest is {}, with an rmse of {}.{} Several \
             mistakes at once are not looked for; is it the same scene, with the same camera?",
            r.mode.describe(),
            value(r.error),
            if self.lossy {
                " The file is a JPEG; a PNG would say more."
            } else {
                ""
            }
        );
        let mut text = self.paragraph(0, &words);
        if !r.findings.is_empty() {
            text += "\nThe most that one of them removes:\n";
            for f in &r.findings {
                text += &format!(
                    "  {} ({} of the error)\n",
                    f.mistake.title,
                    share(f.removed)
                );
            }
        }
        text
    }

    /// What the picture is right as, where that was not asked for, and how to ask.
    fn right_as(&self) -> String {
        let Some(mode) = self.report.right_as else {
            return String::new();
        };
        let asked = [
            self.asked.mode.then_some("--mode"),
            self.asked.shading.then_some("--shading"),
        ];
        let asked: Vec<&str> = asked.into_iter().flatten().collect();
        let words = format!(
            "As {} it is right: leave {} out, or say {}.",
            mode.describe(),
            asked.join(" and "),
            asked_for(mode)
        );
        format!("\n{}", self.paragraph(0, &words))
    }

    fn cannot_show(&self) -> String {
        let names: Vec<&str> = self.report.cannot_show.iter().map(|m| m.name).collect();
        if names.is_empty() || self.report.verdict == Verdict::Unexplained {
            return String::new();
        }
        let words = format!(
            "{} of the {} mistakes would not show on this scene, so they are not ruled out: {}.",
            names.len(),
            check::all().len(),
            names.join(", ")
        );
        format!("\n{}", self.paragraph(0, &words))
    }
}

/// The verdict above a mistake, which explains the picture or only shows in it.
fn explained(mode: Mode, best: &Finding) -> String {
    let kind = mode.describe();
    if best.removed < 0.5 {
        format!(
            "The picture is not right. It is {kind} in which one mistake shows, though most of the error is noise:"
        )
    } else {
        format!("The picture is not right. It is {kind} with one mistake that explains it:")
    }
}

/// How the command line asks for a mode.
fn asked_for(mode: Mode) -> &'static str {
    match mode {
        Mode::Gouraud => "--mode raster --shading gouraud",
        Mode::Flat => "--mode raster --shading flat",
        Mode::Phong => "--mode raster --shading phong",
        Mode::Cast => "--mode cast",
        Mode::Trace => "--mode trace",
    }
}

/// "Use" -> "use", where a sentence goes on.
fn uncapital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_lowercase().collect::<String>() + letters.as_str()
    })
}

/// A part in percent, one decimal, never all where it is not.
fn share(part: f64) -> String {
    let percent = 100.0 * part;
    match percent {
        p if p >= 100.0 => "all".to_owned(),
        p if p > 99.9 => "more than 99.9 %".to_owned(),
        p => format!("{p:.1} %"),
    }
}

fn rgb(color: [f32; 3]) -> String {
    color.map(|x| format!("{x:.3}")).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mistake_that_removes_less_than_half_shows_and_explains_not() {
        let finding = |removed| Finding {
            mistake: &check::all()[0],
            mode: Mode::Trace,
            amount: None,
            error: 0.01,
            removed,
            tied: false,
        };
        let said = |removed| explained(Mode::Trace, &finding(removed));
        assert!(
            said(0.9)
                .ends_with("It is a traced picture (trace) with one mistake that explains it:")
        );
        assert!(said(0.3).contains("one mistake shows, though most of the error is noise"));
        assert!(!said(0.3).contains("explains it"));
    }
}
