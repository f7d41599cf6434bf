//! The reference pages of the book, made from the code: keys of a study, commands, files.

use std::collections::BTreeMap;
use std::path::PathBuf;

use clap::{Args, Command};
use railspring::cli::output::say;
use railspring::cli::{EXIT_CODES, command};
use railspring::engine::inputs::Inputs;
use railspring::engine::output::OutputFolder;
use railspring::results::files::{RESULT_FILES, ResultFile};
use railspring::study::sections;
use railspring_profiles::error::Error;
use serde_json::Value;

/// Said at the head of every page.
const MADE: &str =
    "This page is made from the program by `cargo xtask reference -o docs`; a test compares the two.";

/// Where the pages go.
#[derive(Debug, Args)]
pub struct ReferenceArgs {
    /// Folder to write the pages to
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

/// Writes the pages.
///
/// # Errors
/// A folder that cannot be written.
pub fn write(args: &ReferenceArgs) -> Result<(), Error> {
    let folder = OutputFolder::create(&args.output, &Inputs::none())?;
    let pages = [
        ("reference-keys.md", keys()),
        ("reference-commands.md", commands()),
        ("reference-files.md", files()),
    ];
    for (name, text) in pages {
        folder.write(name, text.as_bytes())?;
        say(&folder.file(name).display().to_string())?;
    }
    Ok(())
}

fn keys() -> String {
    let mut text = format!(
        "# Keys of a study\n\nA study is a TOML file. `railspring explain KEY` says the same in the terminal, `railspring schema` prints it as a JSON schema, and `--set KEY=VALUE` gives a key on the command line. {MADE}\n"
    );
    for section in sections() {
        let name = match section.name.as_str() {
            "" => "Above all sections".to_string(),
            name => format!("`[{name}]`"),
        };
        text += &format!(
            "\n## {name}\n\n{}.\n\n| key | meaning | value | default |\n|---|---|---|---|\n",
            plain(&section.meaning)
        );
        for key in section.keys {
            let options: Vec<String> =
                key.options.iter().map(|(value, said)| format!("`{value}`: {}", cell(said))).collect();
            let options =
                if options.is_empty() { String::new() } else { format!(". {}", options.join("; ")) };
            let default = match key.default.starts_with("none") {
                true => key.default.clone(),
                false => format!("`{}`", key.default),
            };
            text += &format!(
                "| `{}` | {}{options} | {} | {} |\n",
                key.key,
                cell(&key.meaning),
                cell(&key.value),
                cell(&default)
            );
        }
    }
    text
}

fn commands() -> String {
    let mut program = command();
    program.build();
    let mut text = format!(
        "# Commands, options and exit codes\n\n`railspring COMMAND --help` says the same. {MADE}\n\n## Exit codes\n\n| code | meaning |\n|---|---|\n"
    );
    for line in EXIT_CODES.lines().skip(1) {
        let (code, meaning) = line.trim().split_once(' ').unwrap_or((line.trim(), ""));
        text += &format!("| {code} | {} |\n", meaning.trim());
    }
    let mut open = vec![program];
    while let Some(mut command) = open.pop() {
        let inner =
            command.get_subcommands().filter(|inner| inner.get_name() != "help" && !inner.is_hide_set());
        let inner: Vec<Command> = inner.cloned().collect();
        open.extend(inner.into_iter().rev());
        // the version of the program is none of its commands
        let name = command.get_bin_name().unwrap_or(command.get_name()).to_string();
        let help = command.render_long_help().to_string();
        let help: Vec<&str> = help.lines().map(str::trim_end).collect();
        text += &format!("\n## {name}\n\n```text\n{}\n```\n", help.join("\n").trim_end());
    }
    text
}

fn files() -> String {
    let mut text = format!(
        "# Files of an output folder\n\n`*` stands for the name of a load case, a figure or a number. Units are in the names. {MADE}\n\n| file | written by | content |\n|---|---|---|\n"
    );
    for ResultFile { name, made_by, content, .. } in RESULT_FILES {
        text += &format!("| `{name}` | {made_by} | {content} |\n");
    }
    // what several files have in common stands once
    let mut parts = BTreeMap::new();
    for file in RESULT_FILES {
        let Some(schema) = file.schema.map(|schema| schema()) else { continue };
        text += &format!("\n## {}\n\n{}", file.name, fields(&schema));
        let defined = schema.get("$defs").and_then(Value::as_object).into_iter().flatten();
        parts.extend(defined.map(|(name, schema)| (name.clone(), schema.clone())));
    }
    text += "\n## Parts\n\nWhat the types in the tables above are made of.\n";
    for (name, schema) in parts {
        let of = fields(&schema);
        if !of.is_empty() {
            let meaning = schema.get("description").and_then(Value::as_str).unwrap_or_default();
            text += &format!("\n### {name}\n\n{}.\n\n{of}", cell(meaning));
        }
    }
    text
}

/// The fields of an object, or the values of a choice, as a table; empty for neither.
fn fields(schema: &Value) -> String {
    let mut rows = Vec::new();
    collect(schema, &mut rows);
    if rows.is_empty() {
        return String::new();
    }
    let rows: Vec<String> =
        rows.iter().map(|[name, kind, meaning]| format!("| `{name}` | {kind} | {meaning} |")).collect();
    format!("| field | type | meaning |\n|---|---|---|\n{}\n", rows.join("\n"))
}

fn collect(schema: &Value, rows: &mut Vec<[String; 3]>) {
    let meaning = |of: &Value| cell(of.get("description").and_then(Value::as_str).unwrap_or_default());
    for (name, of) in schema.get("properties").and_then(Value::as_object).into_iter().flatten() {
        rows.push([name.clone(), kind(of), meaning(of)]);
    }
    for option in schema.get("oneOf").and_then(Value::as_array).into_iter().flatten() {
        if let Some(value) = option.get("const") {
            rows.push([value.as_str().unwrap_or_default().into(), "value".into(), meaning(option)]);
        }
        collect(option, rows);
    }
}

/// The type of a field in words.
fn kind(schema: &Value) -> String {
    if let Some(to) = schema.get("$ref").and_then(Value::as_str) {
        return to.rsplit('/').next().unwrap_or(to).to_string();
    }
    if let Some(options) = schema.get("anyOf").and_then(Value::as_array) {
        return options.iter().map(kind).collect::<Vec<_>>().join(" or ");
    }
    let name = |of: &Value| match of.as_str().unwrap_or("any") {
        "null" => "none".to_string(),
        "array" => match schema.get("items") {
            Some(items) => format!("list of {}", kind(items)),
            None => "list".into(),
        },
        "string" => "text".into(),
        "integer" => "whole number".into(),
        "boolean" => "true or false".into(),
        "object" => match schema.get("additionalProperties").filter(|more| more.is_object()) {
            Some(more) => format!("names with {}", kind(more)),
            None => "object".into(),
        },
        other => other.to_string(),
    };
    match schema.get("type") {
        Some(Value::Array(all)) => all.iter().map(name).collect::<Vec<_>>().join(" or "),
        Some(one) => name(one),
        None => "any".into(),
    }
}

/// A text in one line of a table.
fn cell(text: &str) -> String {
    plain(text).replace('|', "\\|")
}

/// A text in one line, whose angles are not taken for tags, and whose links of the code's own documents are plain names.
fn plain(text: &str) -> String {
    text.split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
        .trim_end_matches('.')
        .replace('<', "&lt;")
        .replace("[`", "`")
        .replace("`]", "`")
}
