//! The figures of a page: numbered, and kept as files.

use serde::Serialize;

use super::accessible;

/// A figure as the page shows it.
#[derive(Debug, Clone, Serialize)]
pub struct Figure {
    /// The picture, as SVG inside the page.
    pub svg: String,
    /// What it shows.
    pub caption: String,
    /// Its number on the page.
    pub number: usize,
}

/// Numbers the figures and keeps their files.
#[derive(Default)]
pub struct Collector {
    /// The figures by name, as SVG files.
    pub figures: Vec<(String, String)>,
}

impl Collector {
    /// Numbers a figure, and keeps its file under a name.
    pub fn add(&mut self, name: &str, svg: String, caption: String) -> Figure {
        let inline = accessible::inline(&svg, &caption);
        self.figures.push((name.to_string(), svg));
        Figure { svg: inline, caption, number: self.figures.len() }
    }
}
