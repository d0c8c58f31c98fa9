//! Reports as their reader has them: the page's text and structure, and the page in a browser.

mod browser;
mod demo_report;
mod page;
