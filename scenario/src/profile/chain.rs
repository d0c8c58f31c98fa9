//! Tangent-continuous chains of arcs and lines.
//!
//! Along an arc the sine of the slope angle is linear in `outward`. A list of nodes
//! `(outward, sine)` is therefore a chain of arcs with common tangents: between two nodes the
//! radius is `delta outward / delta sine`, and equal sines make a straight line. Only one height
//! has to be given; the others follow.

use super::{Section, Shape};

/// A chain under construction: nodes, in any order of travel.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    nodes: Vec<Node>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    outward_m: f64,
    sine: f64,
}

impl Chain {
    /// Starts at `outward_m` with the given slope.
    pub(crate) fn start(outward_m: f64, slope: f64) -> Self {
        Self { nodes: vec![Node { outward_m, sine: sine_of(slope) }] }
    }

    /// A chain whose tangents at the given places are known.
    pub(crate) fn through(places: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let node = |(outward_m, slope)| Node { outward_m, sine: sine_of(slope) };
        Self { nodes: places.into_iter().map(node).collect() }
    }

    /// Continues on an arc up to `outward_m`.
    pub(crate) fn arc_to(mut self, radius_m: f64, outward_m: f64) -> Self {
        let last = self.last();
        let sine = (last.sine + (outward_m - last.outward_m) / radius_m).clamp(-0.9999, 0.9999);
        self.nodes.push(Node { outward_m, sine });
        self
    }

    /// Continues on an arc until the slope is reached.
    pub(crate) fn arc_to_slope(mut self, radius_m: f64, slope: f64) -> Self {
        let last = self.last();
        let sine = sine_of(slope);
        let outward_m = last.outward_m + radius_m * (sine - last.sine);
        self.nodes.push(Node { outward_m, sine });
        self
    }

    /// Continues straight up to `outward_m`.
    pub(crate) fn line_to(mut self, outward_m: f64) -> Self {
        let sine = self.last().sine;
        self.nodes.push(Node { outward_m, sine });
        self
    }

    /// Continues so that the slope is `slope` at `outward_m`: the arc between follows.
    pub(crate) fn blend_to(mut self, outward_m: f64, slope: f64) -> Self {
        self.nodes.push(Node { outward_m, sine: sine_of(slope) });
        self
    }

    /// Goes on from the other end: the node that was first becomes the last.
    pub(crate) fn turn(mut self) -> Self {
        self.nodes.reverse();
        self
    }

    /// Outward position of the last node (m).
    pub(crate) fn end_m(&self) -> f64 {
        self.last().outward_m
    }

    /// Innermost and outermost node (m).
    pub(crate) fn ends_m(&self) -> (f64, f64) {
        self.nodes.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), node| {
            (first.min(node.outward_m), last.max(node.outward_m))
        })
    }

    /// Height of the last node over the place `anchor_m` of the chain, down positive (m).
    pub(crate) fn depth_below(&self, anchor_m: f64) -> f64 {
        let profile = super::Profile::new(
            "",
            super::Provenance::Derived,
            "",
            self.sections(anchor_m, 0.0),
            self.ends_m().1,
        );
        profile.at(self.end_m()).down_m
    }

    /// The sections, shifted vertically so that the chain passes `(anchor_m, down_m)`.
    pub(crate) fn sections(&self, anchor_m: f64, down_m: f64) -> Vec<Section> {
        let mut nodes = self.nodes.clone();
        nodes.sort_by(|a, b| a.outward_m.total_cmp(&b.outward_m));
        let mut sections = Vec::with_capacity(nodes.len());
        let mut height_m = 0.0;
        for (from, to) in nodes.iter().zip(nodes.iter().skip(1)) {
            let length_m = to.outward_m - from.outward_m;
            if length_m <= 0.0 {
                continue;
            }
            let rise = to.sine - from.sine;
            let shape = if rise.abs() < 1e-12 {
                let slope = from.sine / cosine(from.sine);
                let shape = Shape::Line { down_m: height_m, slope };
                height_m += slope * length_m;
                shape
            } else {
                let radius_m = length_m / rise;
                let centre_down_m = height_m + radius_m * cosine(from.sine);
                height_m = centre_down_m - radius_m * cosine(to.sine);
                Shape::Arc {
                    centre_outward_m: from.outward_m - radius_m * from.sine,
                    centre_down_m,
                    radius_m,
                }
            };
            sections.push(Section { first_m: from.outward_m, shape });
        }
        let index = sections.partition_point(|section| section.first_m <= anchor_m);
        let here = sections
            .get(index.saturating_sub(1))
            .map_or(0.0, |section| section.at(anchor_m).down_m);
        for section in &mut sections {
            match &mut section.shape {
                Shape::Line { down_m: at, .. } | Shape::Arc { centre_down_m: at, .. } => {
                    *at += down_m - here;
                }
                Shape::Series { .. } => {}
            }
        }
        sections
    }

    fn last(&self) -> Node {
        self.nodes.last().copied().unwrap_or(Node { outward_m: 0.0, sine: 0.0 })
    }
}

/// Sine of the angle whose tangent is `slope`.
pub(crate) fn sine_of(slope: f64) -> f64 {
    slope / libm::sqrt(1.0 + slope * slope)
}

fn cosine(sine: f64) -> f64 {
    libm::sqrt(1.0 - sine * sine)
}
