//! A trade as a folder: `index.html`, `trade.csv`, `trade.json`, `plot.svg`, `plot.png`.
//!
//! In: a [`Trade`] and a few pictures. Out: files with their names. The page needs no other file, has no script, and is
//! light or dark with the reader's system.

mod charts;
pub mod notes;
mod page;
mod plot;
mod table;
mod words;

use std::path::Path;

use crate::error::{Error, Note};
use crate::frame::Plane;
use crate::trade::finding::Trade;

use super::files::{View, create_folder, write_bytes_atomic};
use super::folder::File;
use super::formats::png_of_picture;

/// A trade with everything that its folder shows.
#[derive(Clone, Debug)]
pub struct TradeReport {
    /// Every number.
    pub trade: Trade,
    /// The scene as it was named on the command line, with the overrides: what follows `rastray render`.
    pub scene_arguments: String,
    /// The command line that made it.
    pub command: String,
    /// How linear values are shown.
    pub view: View,
    /// The truth at pixel centres.
    pub truth: Plane<[f32; 3]>,
    /// The picture of each answer; `None` where there is none.
    pub answers: Vec<Option<Plane<[f32; 3]>>>,
    /// What the importer dropped, invented or doubted, and what the run has to say.
    pub notes: Vec<Note>,
    /// What was run how.
    pub settings: Vec<(String, String)>,
}

impl TradeReport {
    /// All files.
    ///
    /// # Errors
    /// Pictures that are too large to encode.
    pub fn files(&self) -> Result<Vec<File>, Error> {
        let plot = charts::front(&self.trade);
        let file = |name: &str, bytes: Vec<u8>| File {
            name: name.to_owned(),
            bytes,
        };
        Ok(vec![
            file("trade.csv", table::csv(&self.trade).into_bytes()),
            file("trade.json", table::json(&self.trade)?.into_bytes()),
            file("plot.svg", (plot.file() + "\n").into_bytes()),
            file("plot.png", png_of_picture(&plot.picture(1.6)?)?),
            file("index.html", self.to_html()?.into_bytes()),
        ])
    }

    /// Writes all files into a folder, which is made where it is missing. Everything is encoded before the first write.
    ///
    /// # Errors
    /// As [`Self::files`]; [`Error::Io`].
    pub fn write(&self, folder: &Path) -> Result<(), Error> {
        let files = self.files()?;
        create_folder(folder)?;
        files
            .iter()
            .try_for_each(|f| write_bytes_atomic(&folder.join(&f.name), &f.bytes))
    }

    /// `trade.json`'s text.
    ///
    /// # Errors
    /// As [`Self::files`].
    pub fn to_json(&self) -> Result<String, Error> {
        table::json(&self.trade)
    }

    /// The result in a few lines: the answers with their commands, then the axes.
    pub fn to_text(&self) -> String {
        let trade = &self.trade;
        let mut text = String::new();
        if trade.measured < trade.settings {
            text += &format!(
                "{} of {} settings are measured so far; the same command goes on.\n\n",
                trade.measured, trade.settings
            );
        }
        let [width, height] = trade.size;
        for answer in &trade.answers {
            let target = words::target(answer.target);
            text += &format!("error below {target}, judged at {width} x {height}\n");
            text += &format!("  {}\n", words::answer(answer, trade));
            if let Some(command) = self.command_of(answer.row) {
                text += &format!("  {command}\n");
            }
        }
        text += &format!(
            "\n`rastray render {} --error 1/255` judges for the picture's own size.\n",
            self.scene_arguments
        );
        for axis in &trade.axes {
            text += &format!("\n{} ({})\n", axis.name, words::judged(axis));
            for sentence in words::sentences(axis) {
                text += &format!("  {sentence}\n");
            }
        }
        text
    }

    /// The command that draws a row.
    fn command_of(&self, row: Option<usize>) -> Option<String> {
        let row = self.trade.rows.get(row?)?;
        Some(format!(
            "rastray render {} {}",
            self.scene_arguments, row.arguments
        ))
    }
}
