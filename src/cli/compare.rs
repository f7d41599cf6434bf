//! The command that puts two results side by side.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::json;

use super::failure::Failure;
use super::output::remark;
use super::pdf_args::PdfArgs;
use super::results::Results;
use crate::compare::{Comparison, Side, compare, page};
use crate::engine::inputs::Inputs;
use crate::engine::output::OutputFolder;
use crate::pdf::Printer;
use crate::results::files::RESULT_FILES;

/// Most values of a group that are printed.
const LISTED: usize = 10;

/// What is compared, and where the page goes.
#[derive(Debug, Args)]
pub(super) struct CompareArgs {
    /// A result: an output folder, or a stiffness.json, of which the springs alone are compared
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The other result
    #[arg(value_name = "B")]
    b: PathBuf,
    /// The page
    #[arg(short, long, value_name = "FILE", default_value = "compare.html")]
    output: PathBuf,
    #[command(flatten)]
    pdf: PdfArgs,
    /// Print the comparison as one JSON object
    #[arg(long)]
    pub json: bool,
    /// Print errors only
    #[arg(short, long)]
    quiet: bool,
}

/// Compares and writes the page.
///
/// # Errors
/// Results that cannot be read or have nothing in common, and a page that cannot be written.
pub(super) fn run(args: &CompareArgs) -> Result<(), Failure> {
    let printer = args.pdf.printer()?;
    let inputs = Inputs::of([&args.a, &args.b].into_iter().flat_map(|side| result_files(side)));
    let (folder, name) = OutputFolder::of_file("-o", &args.output, &inputs)?;
    let sides = [Side::read(&args.a)?, Side::read(&args.b)?];
    let found = compare(&sides[0], &sides[1])?;
    folder.write(&name, page(&sides[0], &sides[1], &found).as_bytes())?;
    if let Some(printer) = printer {
        Printer::remark().filter(|_| !args.quiet).iter().for_each(|line| remark(line));
        printer.print(&folder, &name)?;
    }
    let results = Results::of("compare").with_more(text(&found), json!(found));
    Ok(results.at(&args.output).print(args.json, args.quiet)?)
}

/// The files of a result that are compared: the file, or those of a folder that a command of this program writes.
fn result_files(side: &Path) -> Vec<PathBuf> {
    if side.is_file() {
        return vec![side.to_path_buf()];
    }
    let files = std::fs::read_dir(side).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_result = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        RESULT_FILES.iter().any(|file| file.matches(&name))
    };
    files.filter(is_result).collect()
}

/// The comparison for a reader: who, the numbers in columns, what differs.
fn text(found: &Comparison) -> Vec<String> {
    let mut lines = Vec::new();
    for (letter, side) in [("A", &found.a), ("B", &found.b)] {
        let verdict = side.verdict.as_ref().map_or_else(String::new, |verdict| format!("; {verdict}"));
        lines.push(format!("{letter}: {}: {}, {}{verdict}", side.path, side.pair, side.program));
    }
    for group in &found.groups {
        if group.rows.len() > LISTED {
            lines.push(format!("{}: {} values, on the page and with --json", group.name, group.rows.len()));
            continue;
        }
        let common = group.unit();
        let unit = |unit: &str| if unit == "1" { String::new() } else { format!(", {unit}") };
        let name = format!("{}{}", group.name, common.map_or_else(String::new, unit));
        let heading = [name, "A".into(), "B".into(), "change".into(), "beyond the bands".into()];
        let rows = group.rows.iter().map(|row| {
            let [a, b, change, beyond] = row.texts();
            let unit = if common.is_some() { String::new() } else { unit(&row.unit) };
            [format!("  {}{unit}", row.quantity), a, b, change, beyond]
        });
        lines.extend(columns(&[heading].into_iter().chain(rows).collect::<Vec<_>>()));
    }
    // a verdict beside none is said in a note
    let both = found.a.verdict.is_some() && found.b.verdict.is_some();
    let changed =
        found.lines.iter().map(|line| (line, line.texts())).filter(|(_, texts)| both && !texts[2].is_empty());
    lines.extend(
        changed.map(|(line, [a, b, change])| {
            format!("{change}: {}: {}: A {a}; B {b}", line.subject, line.meaning)
        }),
    );
    lines.extend(
        found.inputs.iter().map(|input| format!("input  {}: A {}; B {}", input.key, input.a, input.b)),
    );
    lines.extend(found.not_compared.iter().map(|sentence| format!("note   {sentence}")));
    lines.extend(found.summary.iter().cloned());
    lines
}

/// Rows as lines with columns that stand below each other.
fn columns<const N: usize>(rows: &[[String; N]]) -> Vec<String> {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..N).map(width).collect();
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(&widths).map(|(cell, width)| {
            let blanks = width - cell.chars().count();
            format!("{cell}{}", " ".repeat(blanks))
        });
        cells.collect::<Vec<_>>().join("  ").trim_end().to_string()
    };
    rows.iter().map(line).collect()
}
