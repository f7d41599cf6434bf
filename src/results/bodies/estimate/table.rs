//! What is expected of a study, as the terminal shows it.

use std::fmt::Write;

use serde_json::{Value, json};

use crate::results::bodies::estimate::machine::{GIB, available};
use crate::results::bodies::estimate::needs::{Estimate, StageEstimate};

impl Estimate {
    /// What is expected, a line each.
    pub fn text(&self) -> String {
        let mut text = format!(
            "expected: {} degrees of freedom, {} contact nodes, {:.0} million values in the factors",
            self.degrees_of_freedom(),
            self.contact_nodes.iter().sum::<usize>(),
            self.bodies.iter().map(|body| (body.parts * body.values) as f64).sum::<f64>() / 1e6
        );
        for StageEstimate { stage, memory, seconds } in &self.stages {
            let _ = write!(text, "\n  {stage}: about {:.1} GiB and {}", memory / GIB, duration(*seconds));
        }
        if let Some(StageEstimate { memory, seconds, .. }) = &self.finer {
            let _ = write!(
                text,
                "\n  not counted: meshes that mesh.target_error refines; the calibration on the next finer ones: about {:.1} GiB and {}",
                memory / GIB,
                duration(*seconds)
            );
        }
        if let Some(bytes) = available() {
            let _ = write!(text, "\n  available: {:.1} GiB", bytes / GIB);
        }
        text
    }

    /// The same for a program: bytes and seconds.
    pub fn json(&self) -> Value {
        let stage = |stage: &StageEstimate| json!({ "stage": stage.stage, "memory_bytes": stage.memory, "seconds": stage.seconds });
        json!({
            "degrees_of_freedom": self.degrees_of_freedom(),
            "contact_nodes": self.contact_nodes.iter().sum::<usize>(),
            "stages": self.stages.iter().map(stage).collect::<Vec<_>>(),
            "available_bytes": available(),
        })
    }
}

/// Seconds in words, in two digits.
fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "1 s".into(),
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.0} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_read_well() {
        assert_eq!([0.2, 42.4, 150.0, 9000.0].map(duration), ["1 s", "42 s", "2 min", "2 h"]);
    }
}
