//! `trade.csv` and `trade.json`: every number, for spreadsheets and programs.

use crate::error::Error;
use crate::trade::accuracy::Accuracy;
use crate::trade::cost::WEIGHTS;
use crate::trade::finding::{Row, Trade};

/// Comma-separated values, a header line, one line a setting, cheapest first. Numbers have all their digits; a time that is
/// inconclusive is that word.
pub(super) fn csv(trade: &Trade) -> String {
    let mut head: Vec<String> = ["setting", "arguments"].map(String::from).into();
    for truth in ["full", "local", "ideal"] {
        let columns = [
            "rmse",
            "mean",
            "p99",
            "max",
            "rmse interior",
            "rmse silhouette",
            "FLIP",
        ];
        head.extend(columns.map(|c| format!("{truth} {c}")));
    }
    head.extend(WEIGHTS.iter().map(|(name, ..)| (*name).to_owned()));
    let rest = [
        "work a pixel",
        "ns/pixel",
        "95% low",
        "95% high",
        "rounds",
        "on front",
    ];
    head.extend(rest.map(String::from));
    let lines = std::iter::once(head).chain(trade.rows.iter().map(cells));
    lines
        .map(|cells| {
            cells
                .iter()
                .map(|c| quoted(c))
                .collect::<Vec<_>>()
                .join(",")
                + "\n"
        })
        .collect()
}

fn cells(row: &Row) -> Vec<String> {
    let mut cells = vec![row.setting.clone(), row.arguments.clone()];
    for accuracy in [&row.full, &row.local, &row.ideal] {
        cells.extend(errors(accuracy.as_ref()));
    }
    cells.extend(WEIGHTS.iter().map(|(_, of, _)| of(&row.counts).to_string()));
    cells.push(row.work.to_string());
    let time = row.time.as_ref();
    cells.push(match time {
        None => String::new(),
        Some(time) => time
            .ns_per_pixel
            .map_or("inconclusive".to_owned(), |ns| ns.to_string()),
    });
    let interval = time.and_then(|t| t.interval);
    let end = |i: usize| interval.map_or_else(String::new, |ends| ends[i].to_string());
    cells.extend([end(0), end(1)]);
    cells.push(time.map_or_else(String::new, |t| t.rounds.to_string()));
    cells.push(if row.front { "yes" } else { "no" }.to_owned());
    cells
}

fn errors(accuracy: Option<&Accuracy>) -> [String; 7] {
    let Some(a) = accuracy else {
        return Default::default();
    };
    let numbers = [
        a.all.rmse,
        a.all.mean,
        a.all.p99,
        a.all.max,
        a.interior.rmse,
        a.silhouette.rmse,
        a.flip,
    ];
    numbers.map(|x| x.to_string())
}

/// A cell, in quotes where it needs them.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

/// The whole trade as JSON.
///
/// # Errors
/// [`Error::Limit`] where a number is not one that JSON can hold.
pub(super) fn json(trade: &Trade) -> Result<String, Error> {
    serde_json::to_string_pretty(trade)
        .map(|text| text + "\n")
        .map_err(|e| Error::limit(format!("cannot write trade.json: {e}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_with_commas_and_quotes_are_quoted() {
        assert_eq!(quoted("plain"), "plain");
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
    }
}
