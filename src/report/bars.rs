//! The value axis below horizontal bars, with its grid.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::number::WIDTH;
use super::plot::{Area, Drawn, LIGHT, label, nice_range, px, stroke, tick};

/// A value axis over the width of a figure, below rows that are `base` high.
pub struct ValueAxis {
    left: u32,
    base: i32,
    low: f64,
    high: f64,
    step: f64,
}

impl ValueAxis {
    /// An axis from the pixel `left` on that holds all `values` and zero, `base` pixels below the top.
    pub fn over(values: impl Iterator<Item = f64>, left: u32, base: u32) -> Self {
        let (low, high, step) = nice_range(values, true);
        Self { left, base: px(base), low, high, step }
    }

    /// Pixel of a value.
    pub fn x(&self, value: f64) -> i32 {
        let length = f64::from(px(WIDTH - self.left - 24));
        px(self.left) + (length * (value - self.low) / (self.high - self.low)) as i32
    }

    /// The lines of the grid with their values; the bars lie on top of them.
    ///
    /// # Errors
    /// Those of drawing.
    pub fn draw_grid(&self, area: &Area<'_>) -> Drawn {
        for n in 0..=((self.high - self.low) / self.step).round() as usize {
            let value = self.low + n as f64 * self.step;
            let x = self.x(value);
            area.draw(&PathElement::new([(x, 0), (x, self.base)], stroke(LIGHT, 7)))?;
            let style = label(11, HPos::Center, VPos::Top);
            area.draw(&Text::new(tick(value, self.step), (x, self.base + px(5)), style))?;
        }
        Ok(())
    }

    /// The line below the bars, and what it measures.
    ///
    /// # Errors
    /// Those of drawing.
    pub fn draw_axis(&self, area: &Area<'_>, name: &str) -> Drawn {
        let (from, to) = (self.x(self.low), self.x(self.high));
        area.draw(&PathElement::new([(from, self.base), (to, self.base)], stroke(BLACK, 8)))?;
        let style = label(12, HPos::Center, VPos::Top);
        area.draw(&Text::new(name.to_owned(), ((from + to) / 2, self.base + px(23)), style))?;
        Ok(())
    }
}
