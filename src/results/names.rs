//! Names of the files of an output folder, and which of them are made from which.

/// The laws and the horizontal stiffness.
pub const STIFFNESS: &str = "stiffness.json";
/// The calibrated load curve with the reference in use.
pub const LOAD_CURVE: &str = "load_curve.csv";
/// The contact patches under some loads of the calibration.
pub const PATCHES: &str = "contact_patches.json";
/// The same at fixed loads, as a table.
pub const BY_ANGLE_ROWS: &str = "stiffness_by_angle.csv";
/// The verdict.
pub const VERIFICATION: &str = "verification.json";
/// The report.
pub const REPORT: &str = "report.html";
/// The report as it is printed, if it was.
pub const REPORT_PDF: &str = "report.pdf";
/// What independent programs say.
pub const CROSSCHECK: &str = "crosscheck.json";
/// The page about it.
pub const CROSSCHECK_PAGE: &str = "crosscheck.html";
/// Where on the bodies tool and reference differ.
pub const DIFFERENCES: &str = "crosscheck/differences.json";
/// The figures of the report.
pub const FIGURES: &str = "figures/";

/// What is made from springs and histories, and goes when one of them changes.
pub const OF_THE_RUNS: [&str; 4] = [VERIFICATION, REPORT, REPORT_PDF, FIGURES];
/// What is made from the verdict.
pub const OF_THE_VERDICT: [&str; 3] = [REPORT, REPORT_PDF, FIGURES];
