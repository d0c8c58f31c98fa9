//! Tables with typed columns: units in the head, numbers aligned, and two buttons that copy the
//! table as tab-separated text (for a spreadsheet) or as Markdown.

use crate::error::Error;
use crate::html::{escape, with_unit};
use crate::number::significant;

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

#[derive(Debug, Clone, PartialEq)]
struct Column {
    head: String,
    /// Significant digits of a column of numbers; none for a column of words.
    digits: Option<usize>,
}

/// A table with a caption. Declare the columns first, then add rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    caption: String,
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without columns yet.
    pub fn new(caption: &str) -> Self {
        Self { caption: caption.to_owned(), columns: Vec::new(), rows: Vec::new() }
    }

    /// Adds a column of words, aligned left.
    #[must_use]
    pub fn text(mut self, head: &str) -> Self {
        self.columns.push(Column { head: head.to_owned(), digits: None });
        self
    }

    /// Adds a column of numbers with their unit, aligned right, four significant digits.
    #[must_use]
    pub fn number(self, head: &str, unit: &str) -> Self {
        self.number_with_digits(head, unit, 4)
    }

    /// Adds a column of numbers with a stated number of significant digits.
    #[must_use]
    pub fn number_with_digits(mut self, head: &str, unit: &str, digits: usize) -> Self {
        self.columns.push(Column { head: with_unit(head, unit), digits: Some(digits) });
        self
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

    pub(crate) fn html(&self) -> Result<String, Error> {
        let mut html = format!(
            "<div class=\"table\">\n<table>\n<caption>{}</caption>\n<thead><tr>",
            escape(&self.caption)
        );
        html.extend(self.columns.iter().map(head_html));
        html.push_str("</tr></thead>\n<tbody>\n");
        for (index, row) in self.rows.iter().enumerate() {
            if row.len() != self.columns.len() {
                return Err(Error::RowLength {
                    table: self.caption.clone(),
                    row: index + 1,
                    expected: self.columns.len(),
                    found: row.len(),
                });
            }
            html.push_str("<tr>");
            html.extend(
                row.iter().zip(&self.columns).map(|(cell, column)| cell_html(cell, column)),
            );
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody>\n</table>\n</div>\n");
        Ok(html)
    }
}

fn head_html(column: &Column) -> String {
    let class = if column.digits.is_some() { " class=\"n\"" } else { "" };
    format!("<th scope=\"col\"{class}>{}</th>", escape(&column.head))
}

fn cell_html(cell: &Cell, column: &Column) -> String {
    let class = if column.digits.is_some() { " class=\"n\"" } else { "" };
    match cell {
        Cell::Text(text) => format!("<td{class}>{}</td>", escape(text)),
        Cell::Count(count) => format!("<td class=\"n\">{count}</td>"),
        Cell::Number(value) => {
            format!("<td class=\"n\">{}</td>", significant(*value, column.digits.unwrap_or(4)))
        }
        Cell::Empty => "<td class=\"n empty\">–</td>".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::{Cell, Table};

    #[test]
    fn a_table_is_plain_html_with_units_in_its_head() {
        let table = Table::new("Bus <0>")
            .text("frame")
            .number("rate", "1/s")
            .number_with_digits("share", "%", 2)
            .row(["command".into(), 1000_u64.into(), 13.449.into()])
            .row(["fault".into(), 0_u64.into(), Cell::Empty]);
        insta::assert_snapshot!(table.html().expect("rows fit"), @r#"
        <div class="table">
        <table>
        <caption>Bus &lt;0&gt;</caption>
        <thead><tr><th scope="col">frame</th><th scope="col" class="n">rate (1/s)</th><th scope="col" class="n">share (%)</th></tr></thead>
        <tbody>
        <tr><td>command</td><td class="n">1000</td><td class="n">13</td></tr>
        <tr><td>fault</td><td class="n">0</td><td class="n empty">–</td></tr>
        </tbody>
        </table>
        </div>
        "#);
    }

    #[test]
    fn a_row_that_does_not_fit_is_named() {
        let table = Table::new("Dampers").text("a").number("b", "N").row(["x".into()]);
        let error = table.html().expect_err("one cell for two columns");
        assert_eq!(error.to_string(), "table \"Dampers\", row 1: 1 cells for 2 columns");
    }
}
