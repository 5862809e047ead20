//! `check.json`, and what `check --json` prints.

use serde_json::{Value, json};

use super::Checked;
use crate::check::{Finding, Mistake, Mode, Telling, Verdict};

impl Checked<'_> {
    /// Everything that the check found, for programs.
    pub fn to_json(&self) -> Value {
        let r = self.report;
        let finding = |f: &Finding| {
            json!({
                "name": f.mistake.name,
                "group": f.mistake.group.name(),
                "title": f.mistake.title,
                "what": f.mistake.what,
                "remedy": f.mistake.remedy,
                "mode": f.mode.name(),
                "amount": f.amount,
                "rmse": f.error,
                "removed": f.removed,
                "tied": f.tied,
            })
        };
        let telling = |t: &Telling| {
            json!({
                "pixel": [t.x, t.y],
                "given": t.given,
                "mistaken": t.mistaken,
                "right": t.right,
                "explain": self.asked.explain(r.size, t),
            })
        };
        let name = |m: &&Mistake| m.name;
        json!({
            "size": r.size,
            "verdict": verdict_name(r.verdict),
            "mode": r.mode.name(),
            "also": r.also.iter().map(|m| m.name()).collect::<Vec<_>>(),
            "right_as": r.right_as.map(Mode::name),
            "rmse": r.error,
            "rmse_of_means": r.error_of_means,
            "max": r.largest,
            "findings": r.findings.iter().map(finding).collect::<Vec<_>>(),
            "cannot_show": r.cannot_show.iter().map(name).collect::<Vec<_>>(),
            "pictures": r.pictures,
            "telling": r.telling.iter().map(telling).collect::<Vec<_>>(),
        })
    }
}

/// What the verdict is called in JSON.
fn verdict_name(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Right => "right",
        Verdict::Mistake => "mistake",
        Verdict::Unexplained => "none of these",
    }
}
