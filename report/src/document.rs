//! The report: a head, and sections of blocks in the order in which they were added.

use std::fs;
use std::path::Path;

use crate::error::Error;
use crate::page;
use crate::plot::Plot;
use crate::table::Table;
use crate::tile::Tile;

/// A whole report.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub(crate) title: String,
    pub(crate) subtitle: String,
    pub(crate) facts: Vec<(String, String)>,
    pub(crate) sections: Vec<Section>,
}

impl Report {
    /// An empty report.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            subtitle: String::new(),
            facts: Vec::new(),
            sections: Vec::new(),
        }
    }

    /// The line under the title.
    #[must_use]
    pub fn subtitle(self, text: &str) -> Self {
        Self { subtitle: text.to_owned(), ..self }
    }

    /// A name and a value for the head: scenario, seed, program version.
    #[must_use]
    pub fn fact(mut self, name: &str, value: &str) -> Self {
        self.facts.push((name.to_owned(), value.to_owned()));
        self
    }

    /// Adds a section.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// The page as a string.
    ///
    /// # Errors
    /// What does not fit together: see [`Error`].
    pub fn to_html(&self) -> Result<String, Error> {
        page::render(self)
    }

    /// Writes the page. A reader never sees half a file: it is written to a file next to `path` and
    /// renamed.
    ///
    /// # Errors
    /// What does not fit together, or a file that cannot be written: see [`Error`].
    pub fn write_to(&self, path: impl AsRef<Path>) -> Result<(), Error> {
        let path = path.as_ref();
        let html = self.to_html()?;
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.partial", std::process::id()));
        let partial = path.with_file_name(name);
        fs::write(&partial, html).and_then(|()| fs::rename(&partial, path)).map_err(|source| {
            // Best effort: the error that matters is the one reported.
            let _ = fs::remove_file(&partial);
            Error::Write { path: path.to_owned(), source }
        })
    }
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Block {
    Text(String),
    Heading(String),
    Preformatted(String),
    Note(String),
    Warning(String),
    Tiles(Vec<Tile>),
    Table(Table),
    Plots(Vec<Plot>),
}

/// A heading and what stands under it.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    pub(crate) heading: String,
    pub(crate) blocks: Vec<Block>,
}

impl Section {
    /// An empty section.
    pub fn new(heading: &str) -> Self {
        Self { heading: heading.to_owned(), blocks: Vec::new() }
    }

    /// A paragraph of plain text; an empty line starts another one.
    #[must_use]
    pub fn text(self, text: &str) -> Self {
        self.block(Block::Text(text.to_owned()))
    }

    /// A smaller heading for what follows within the section.
    #[must_use]
    pub fn heading(self, text: &str) -> Self {
        self.block(Block::Heading(text.to_owned()))
    }

    /// Text kept as it is set, in equal widths: an equation, a command, a file.
    #[must_use]
    pub fn preformatted(self, text: &str) -> Self {
        self.block(Block::Preformatted(text.to_owned()))
    }

    /// A remark in a quiet box.
    #[must_use]
    pub fn note(self, text: &str) -> Self {
        self.block(Block::Note(text.to_owned()))
    }

    /// Something the reader must not miss.
    #[must_use]
    pub fn warning(self, text: &str) -> Self {
        self.block(Block::Warning(text.to_owned()))
    }

    /// A row of key numbers.
    #[must_use]
    pub fn tiles(self, tiles: impl IntoIterator<Item = Tile>) -> Self {
        self.block(Block::Tiles(tiles.into_iter().collect()))
    }

    /// A table.
    #[must_use]
    pub fn table(self, table: Table) -> Self {
        self.block(Block::Table(table))
    }

    /// A plot over the whole width.
    #[must_use]
    pub fn plot(self, plot: Plot) -> Self {
        self.plots([plot])
    }

    /// Plots side by side where the page is wide enough.
    #[must_use]
    pub fn plots(self, plots: impl IntoIterator<Item = Plot>) -> Self {
        self.block(Block::Plots(plots.into_iter().collect()))
    }

    fn block(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }
}
