//! A table on a page: plain HTML, numbers aligned by their class.

use super::{Cell, Column, Format, Table};
use crate::error::Error;
use crate::html::{escape, with_unit};

impl Table {
    pub(crate) fn html(&self) -> Result<String, Error> {
        let mut html = "<div class=\"table\">\n<table>\n".to_owned();
        if !self.caption.is_empty() {
            html.extend(["<caption>", &escape(&self.caption), "</caption>\n"]);
        }
        html.push_str("<thead><tr>");
        html.extend(self.columns.iter().map(Column::html));
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
            let cells = row.iter().zip(&self.columns);
            html.extend(cells.map(|(cell, column)| cell.html(column.format)));
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody>\n</table>\n</div>\n");
        Ok(html)
    }
}

impl Column {
    fn html(&self) -> String {
        let (class, head) = (self.format.class(), with_unit(&self.head, &self.unit));
        format!("<th scope=\"col\"{class}>{}</th>", escape(&head))
    }
}

impl Format {
    /// The class of what is aligned right.
    fn class(self) -> &'static str {
        if self == Self::Words { "" } else { " class=\"n\"" }
    }
}

impl Cell {
    fn html(&self, format: Format) -> String {
        match self {
            Self::Text(text) => format!("<td{}>{}</td>", format.class(), escape(text)),
            Self::Count(count) => format!("<td class=\"n\">{count}</td>"),
            Self::Number(value) => format!("<td class=\"n\">{}</td>", format.number(*value)),
            Self::Empty => "<td class=\"n empty\">–</td>".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn the_page_shows_the_digits_of_the_terminal() {
        let table = Table::new("")
            .fixed("rms", "kN", 2)
            .written("range", "")
            .row([11.316.into(), "1 to 2".into()]);
        let html = table.html().expect("rows fit");
        assert!(html.contains("<td class=\"n\">11.32</td><td class=\"n\">1 to 2</td>"), "{html}");
        assert!(!html.contains("caption"), "{html}");
        assert_eq!(table.lines()[1], " 11.32  1 to 2");
    }
}
