//! Tables with typed columns and two faces: the [`page`] and the [`terminal`].
//!
//! Units stand in the head and numbers are aligned. On the page two buttons copy the table as
//! tab-separated text (for a spreadsheet) or as Markdown. Both faces show the same digits.

mod page;
mod terminal;

/// A table with a caption. Declare the columns first, then add rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    caption: String,
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

/// One value in a table.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number in the unit of its column, shown with the digits of its column.
    Number(f64),
    /// A count, shown with all its digits.
    Count(u64),
    /// Does not apply; shown as a dash, copied as nothing.
    Empty,
}

#[derive(Debug, Clone, PartialEq)]
struct Column {
    head: String,
    unit: String,
    format: Format,
}

/// How a column shows its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    /// Words, aligned left.
    Words,
    /// Numbers that the caller has written out, aligned right.
    Written,
    /// Significant digits.
    Significant(usize),
    /// Digits behind the decimal point.
    Decimals(usize),
}

impl Table {
    /// A table without columns yet; an empty caption is not shown.
    pub fn new(caption: &str) -> Self {
        Self { caption: caption.to_owned(), columns: Vec::new(), rows: Vec::new() }
    }

    /// Adds a column of words, aligned left.
    #[must_use]
    pub fn text(self, head: &str) -> Self {
        self.column(head, "", Format::Words)
    }

    /// Adds a column of numbers that are written out already, such as ranges, aligned right.
    #[must_use]
    pub fn written(self, head: &str, unit: &str) -> Self {
        self.column(head, unit, Format::Written)
    }

    /// Adds a column of numbers with their unit, aligned right, four significant digits.
    #[must_use]
    pub fn number(self, head: &str, unit: &str) -> Self {
        self.number_with_digits(head, unit, 4)
    }

    /// Adds a column of numbers with a stated number of significant digits.
    #[must_use]
    pub fn number_with_digits(self, head: &str, unit: &str, digits: usize) -> Self {
        self.column(head, unit, Format::Significant(digits))
    }

    /// Adds a column of numbers with a stated number of decimals, so that their decimal points
    /// stand in one line.
    #[must_use]
    pub fn fixed(self, head: &str, unit: &str, decimals: usize) -> Self {
        self.column(head, unit, Format::Decimals(decimals))
    }

    /// Adds a row: one cell per column, `["front left".into(), 12.7.into()]`.
    #[must_use]
    pub fn row(mut self, cells: impl IntoIterator<Item = Cell>) -> Self {
        self.rows.push(cells.into_iter().collect());
        self
    }

    /// Adds many rows.
    #[must_use]
    pub fn rows<R: IntoIterator<Item = Cell>>(self, rows: impl IntoIterator<Item = R>) -> Self {
        rows.into_iter().fold(self, Self::row)
    }

    fn column(mut self, head: &str, unit: &str, format: Format) -> Self {
        self.columns.push(Column { head: head.to_owned(), unit: unit.to_owned(), format });
        self
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl<T: Into<Self>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}
