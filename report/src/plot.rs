//! The description of a plot, as it is written at the call site.

use std::ops::RangeInclusive;

use crate::error::Error;
use crate::series::{Kind, Samples, Trace};

/// One axis: what it carries, in which unit, on which scale.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Axis {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) log: bool,
    pub(crate) range: Option<RangeInclusive<f64>>,
}

/// One y axis with its traces; panels of a plot stand below each other over the same x.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Panel {
    pub(crate) y: Axis,
    pub(crate) traces: Vec<Trace>,
    pub(crate) marks: Vec<Mark>,
}

/// What is drawn over or under the data of a panel.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Mark {
    Limit { label: String, y: f64 },
    At { label: String, x: f64 },
    Span { label: String, x: RangeInclusive<f64> },
    Note { text: String, x: f64, y: f64 },
}

/// A second view of the same data, next to the first.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Zoom {
    pub(crate) caption: String,
    pub(crate) x: RangeInclusive<f64>,
    pub(crate) y: Option<RangeInclusive<f64>>,
}

/// An interactive plot.
///
/// Axes first, then what is drawn. Everything after [`Plot::panel_below`] belongs to that panel.
/// Traces of the same name share colour and legend entry, also across panels. Samples that are not
/// finite (on a log axis: not positive) are gaps, and the page says how many.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) x: Axis,
    pub(crate) panels: Vec<Panel>,
    pub(crate) zooms: Vec<Zoom>,
    pub(crate) equal_aspect: bool,
    pub(crate) height_px: Option<u32>,
    pub(crate) palette: Vec<String>,
    pub(crate) marked: bool,
}

impl Plot {
    /// An empty plot.
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            caption: String::new(),
            x: Axis::default(),
            panels: vec![Panel::default()],
            zooms: Vec::new(),
            equal_aspect: false,
            height_px: None,
            palette: Vec::new(),
            marked: false,
        }
    }

    /// A sentence or two under the plot: what to see in it.
    #[must_use]
    pub fn caption(self, text: &str) -> Self {
        Self { caption: text.to_owned(), ..self }
    }

    /// Names the x axis and its unit (empty for a pure number).
    #[must_use]
    pub fn x(mut self, name: &str, unit: &str) -> Self {
        (self.x.name, self.x.unit) = (name.to_owned(), unit.to_owned());
        self
    }

    /// Names the y axis of the panel and its unit (empty for a pure number).
    #[must_use]
    pub fn y(mut self, name: &str, unit: &str) -> Self {
        let axis = &mut self.panel().y;
        (axis.name, axis.unit) = (name.to_owned(), unit.to_owned());
        self
    }

    /// Starts another panel under the last one, over the same x, and names its y axis.
    #[must_use]
    pub fn panel_below(mut self, name: &str, unit: &str) -> Self {
        self.panels.push(Panel::default());
        self.y(name, unit)
    }

    /// Makes the x axis logarithmic.
    #[must_use]
    pub fn log_x(mut self) -> Self {
        self.x.log = true;
        self
    }

    /// Makes the y axis of the panel logarithmic.
    #[must_use]
    pub fn log_y(mut self) -> Self {
        self.panel().y.log = true;
        self
    }

    /// Shows this range of x at first; the reader may zoom out.
    #[must_use]
    pub fn x_range(mut self, range: RangeInclusive<f64>) -> Self {
        self.x.range = Some(range);
        self
    }

    /// Shows this range of y at first, in this panel.
    #[must_use]
    pub fn y_range(mut self, range: RangeInclusive<f64>) -> Self {
        self.panel().y.range = Some(range);
        self
    }

    /// One unit of y is as long as one unit of x.
    #[must_use]
    pub fn equal_aspect(self) -> Self {
        Self { equal_aspect: true, ..self }
    }

    /// Sets the height of the drawing; the default grows with the number of panels.
    #[must_use]
    pub fn height_px(self, height: u32) -> Self {
        Self { height_px: Some(height), ..self }
    }

    /// Gives these names the first colours, in this order, drawn or not: what is the same in
    /// several plots of a report looks the same in all of them.
    #[must_use]
    pub fn palette<S: AsRef<str>>(mut self, names: &[S]) -> Self {
        self.palette = names.iter().map(|name| name.as_ref().to_owned()).collect();
        self
    }

    /// Marks the plot among its neighbours: the one to look at.
    #[must_use]
    pub fn marked(self) -> Self {
        Self { marked: true, ..self }
    }

    /// Draws a line through samples; a loop where x goes back and forth.
    #[must_use]
    pub fn line(self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.trace(Trace::new(name, Kind::Line { dashed: false }, x, y))
    }

    /// Draws a line through samples that were chosen from a longer record; the page states the
    /// number of samples in the record.
    #[must_use]
    pub fn line_of(self, name: &str, x: &[f64], y: &[f64], of: Samples) -> Self {
        debug_assert!(of.all >= y.len() as u64, "{} of {of:?}", y.len());
        let trace = Trace::new(name, Kind::Line { dashed: false }, x, y);
        self.trace(Trace { of: Some(of), ..trace })
    }

    /// Draws a dashed line: a model over a record, a nominal curve, a reference.
    #[must_use]
    pub fn dashed(self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.trace(Trace::new(name, Kind::Line { dashed: true }, x, y))
    }

    /// Draws a wide grey line for others to be compared with: the record under its models. It takes
    /// none of the colours.
    #[must_use]
    pub fn backdrop(self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.trace(Trace::new(name, Kind::Backdrop, x, y))
    }

    /// Draws a line with a mark at every sample: a sweep of few points.
    #[must_use]
    pub fn points(self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.trace(Trace::new(name, Kind::LineWithPoints, x, y))
    }

    /// Draws marks only.
    #[must_use]
    pub fn scatter(self, name: &str, x: &[f64], y: &[f64]) -> Self {
        self.trace(Trace::new(name, Kind::Scatter, x, y))
    }

    /// Draws bars between edges (one more than heights), as [`crate::equal_bins`] gives them.
    #[must_use]
    pub fn bars(self, name: &str, edges: &[f64], heights: &[f64]) -> Self {
        self.trace(Trace::new(name, Kind::Bars, edges, heights))
    }

    /// Draws lying bars, one for each name, the first on top: a ranking. Lengths go along x. Names
    /// of further traces follow below.
    #[must_use]
    pub fn named_bars<S: AsRef<str>>(self, name: &str, names: &[S], lengths: &[f64]) -> Self {
        let names = names.iter().map(|n| n.as_ref().to_owned()).collect();
        self.trace(Trace::new(name, Kind::NamedBars { names }, lengths, &[]))
    }

    /// Fills between a lower and an upper curve: a spread, a tolerance.
    #[must_use]
    pub fn band(self, name: &str, x: &[f64], lower: &[f64], upper: &[f64]) -> Self {
        self.trace(Trace::new(name, Kind::Band { upper: upper.to_vec() }, x, lower))
    }

    /// Colours a grid by `z`, given row by row (one row for each y), with the name and unit of z.
    #[must_use]
    pub fn map(self, name: &str, unit: &str, x: &[f64], y: &[f64], z: &[f64]) -> Self {
        let kind = Kind::Map { z: z.to_vec(), unit: unit.to_owned() };
        self.trace(Trace::new(name, kind, x, y))
    }

    /// Draws a horizontal limit line across the panel.
    #[must_use]
    pub fn limit(self, label: &str, y: f64) -> Self {
        self.mark(Mark::Limit { label: label.to_owned(), y })
    }

    /// Draws a vertical line at one x: an event.
    #[must_use]
    pub fn at(self, label: &str, x: f64) -> Self {
        self.mark(Mark::At { label: label.to_owned(), x })
    }

    /// Shades a span of x: a curve, a run-in, a fault.
    #[must_use]
    pub fn span(self, label: &str, x: RangeInclusive<f64>) -> Self {
        self.mark(Mark::Span { label: label.to_owned(), x })
    }

    /// Points at one place with a few words.
    #[must_use]
    pub fn note(self, text: &str, x: f64, y: f64) -> Self {
        self.mark(Mark::Note { text: text.to_owned(), x, y })
    }

    /// Adds a second view next to the first: this range of x with every sample in it, y to fit.
    #[must_use]
    pub fn zoom(mut self, caption: &str, x: RangeInclusive<f64>) -> Self {
        self.zooms.push(Zoom { caption: caption.to_owned(), x, y: None });
        self
    }

    /// Adds a second view of a box of x and y (of the first panel): the dead zone of a loop.
    #[must_use]
    pub fn zoom_box(
        mut self,
        caption: &str,
        x: RangeInclusive<f64>,
        y: RangeInclusive<f64>,
    ) -> Self {
        self.zooms.push(Zoom { caption: caption.to_owned(), x, y: Some(y) });
        self
    }

    fn panel(&mut self) -> &mut Panel {
        // There is one from the start and none is ever removed.
        let last = self.panels.len() - 1;
        &mut self.panels[last]
    }

    fn trace(mut self, trace: Trace) -> Self {
        self.panel().traces.push(trace);
        self
    }

    fn mark(mut self, mark: Mark) -> Self {
        self.panel().marks.push(mark);
        self
    }

    /// Checks lengths and ranges.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let range = |label: &str, r: &RangeInclusive<f64>, log: bool| {
            let (from, to) = (*r.start(), *r.end());
            if from.is_finite() && to.is_finite() && from < to && (!log || from > 0.0) {
                return Ok(());
            }
            Err(Error::Range { plot: self.title.clone(), label: label.to_owned(), from, to })
        };
        let point = |label: &str, v: f64, log: bool| {
            if v.is_finite() && (!log || v > 0.0) {
                return Ok(());
            }
            Err(Error::Range { plot: self.title.clone(), label: label.to_owned(), from: v, to: v })
        };
        self.x.range.iter().try_for_each(|r| range("x axis", r, self.x.log))?;
        for panel in &self.panels {
            panel.y.range.iter().try_for_each(|r| range("y axis", r, panel.y.log))?;
            panel.traces.iter().try_for_each(|t| t.check(&self.title))?;
            for mark in &panel.marks {
                match mark {
                    Mark::Limit { label, y } => point(label, *y, panel.y.log)?,
                    Mark::At { label, x } => point(label, *x, self.x.log)?,
                    Mark::Span { label, x } => range(label, x, self.x.log)?,
                    Mark::Note { text, x, y } => {
                        point(text, *x, self.x.log)?;
                        point(text, *y, panel.y.log)?;
                    }
                }
            }
        }
        for zoom in &self.zooms {
            range(&zoom.caption, &zoom.x, self.x.log)?;
            let log_y = self.panels.first().is_some_and(|p| p.y.log);
            zoom.y.iter().try_for_each(|y| range(&zoom.caption, y, log_y))?;
        }
        Ok(())
    }
}
