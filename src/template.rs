//! Studies that the program writes: a pair of a wheel and a rail, with comments to go on from.

use std::path::{Component, Path, PathBuf};

use minijinja::{Environment, context};
use serde_json::Value;

use crate::study::Setting;

/// The pair and its calibration.
const PAIR: &str = include_str!("../data/templates/pair.toml");
/// A load case for any pair.
const LOAD_CASE: &str = include_str!("../data/templates/load_case.toml");

/// A wheel or a rail.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Body {
    /// A standard, by its name.
    Standard(String),
    /// A measured profile, by its file.
    File(PathBuf),
    /// The closed section of the body, by its file.
    Section(PathBuf),
}

/// A pair with its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pair {
    /// Name of the study.
    pub name: String,
    /// The wheel.
    pub wheel: Body,
    /// The rail.
    pub rail: Body,
}

impl Body {
    /// What a reader calls it.
    fn title(&self) -> String {
        match self {
            Self::Standard(name) => name.clone(),
            Self::File(file) | Self::Section(file) => {
                file.file_name().unwrap_or_default().to_string_lossy().into_owned()
            }
        }
    }

    /// Its key without its section, and the value as TOML; the file relative to `folder`.
    fn key(&self, folder: &Path) -> (&'static str, String) {
        match self {
            Self::Standard(name) => ("profile", quoted(name)),
            Self::File(file) => ("profile_file", quoted(&relative(file, folder).to_string_lossy())),
            Self::Section(file) => ("section_file", quoted(&relative(file, folder).to_string_lossy())),
        }
    }
}

impl Pair {
    /// The keys of its study that differ from those of any other, `option` saying where each was given. Files are relative to the working folder.
    pub fn settings(&self, option: &dyn Fn(&str) -> String) -> Vec<Setting> {
        let here = Path::new("");
        let of = |section: &str, body: &Body| {
            let (key, value) = body.key(here);
            (format!("{section}.{key}"), value)
        };
        let keys =
            [("name".to_owned(), quoted(&self.name)), of("wheel", &self.wheel), of("rail", &self.rail)];
        keys.into_iter()
            .map(|(key, value)| Setting::new(option(&key), &key, &value).expect("a dotted key"))
            .collect()
    }

    /// The text of its study in `file`, with a load case or without, and with `settings` in the place of the keys.
    pub fn study(&self, file: &Path, load_case: bool, settings: &[Setting]) -> String {
        let folder = file.parent().unwrap_or(Path::new(""));
        let body = |body: &Body| {
            let (key, value) = body.key(folder);
            let of = |name: &str| (key == name).then_some(&value);
            context! { standard => of("profile"), file => of("profile_file") }
        };
        let title = format!("{} on {}", self.wheel.title(), self.rail.title());
        let filled = Environment::new().render_str(
            PAIR,
            context! {
                title => one_line(&title),
                file => one_line(&file.file_name().unwrap_or_default().to_string_lossy()),
                name => quoted(&self.name),
                description => quoted(&format!("{title}.")),
                rail => body(&self.rail),
                wheel => body(&self.wheel),
            },
        );
        let mut text = filled.expect("the template has these keys") + "\n";
        if load_case {
            text += LOAD_CASE;
        }
        settings.iter().fold(text, |text, setting| with(&text, setting))
    }
}

/// A text as a value of TOML.
fn quoted(text: &str) -> String {
    Value::from(text).to_string()
}

/// A text for a comment.
fn one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// A file as a study in `folder` names it; both are relative to the working folder or absolute. Where there is no way up from the folder, the file is
/// absolute.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let below = |path: &Path| {
        path.components()
            .filter(|part| *part != Component::CurDir)
            .map(|part| part.as_os_str().to_owned())
            .collect::<Vec<_>>()
    };
    let plain =
        |path: &Path| path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    match (file.is_absolute(), plain(folder)) {
        (false, true) if below(folder).is_empty() => file.to_path_buf(),
        (false, true) => {
            let (file, folder) = (below(file), below(folder));
            let shared = file.iter().zip(&folder).take_while(|(a, b)| a == b).count().min(file.len() - 1);
            let up = folder[shared..].iter().map(|_| "..".into());
            up.chain(file[shared..].iter().cloned()).collect()
        }
        (true, _) => file.to_path_buf(),
        (false, false) => std::path::absolute(file).unwrap_or_else(|_| file.to_path_buf()),
    }
}

/// The text of a study with a key. It stands in the place of the line that has it, or of the line after a `#`
/// that has its default. A key that has neither goes to the end of its section, and a section that is not
/// there to the end.
fn with(text: &str, setting: &Setting) -> String {
    let (section, name) = setting.key().rsplit_once('.').unwrap_or(("", setting.key()));
    let value = setting.toml().map(|value| format!("{name} = {value}"));
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let header = |line: &String| line.starts_with('[');
    let begin = match section {
        "" => Some(0),
        _ => lines.iter().position(|line| *line == format!("[{section}]")).map(|at| at + 1),
    };
    let Some(begin) = begin else {
        if let Some(value) = value {
            lines.extend([String::new(), format!("[{section}]"), value]);
        }
        return lines.join("\n") + "\n";
    };
    let end = lines[begin..].iter().position(header).map_or(lines.len(), |at| begin + at);
    let is_it = |line: &str| line.split_once('=').is_some_and(|(key, _)| key.trim() == name);
    let place =
        |is: &dyn Fn(&str) -> bool| lines[begin..end].iter().position(|line| is(line)).map(|at| begin + at);
    let own = place(&is_it);
    let default = place(&|line| line.strip_prefix("# ").is_some_and(is_it));
    match (own.or(default), value) {
        (Some(at), Some(value)) => lines[at] = value,
        (Some(at), None) if own.is_some() => drop(lines.remove(at)),
        (_, None) => {}
        (None, Some(value)) => {
            let last = lines[begin..end].iter().rposition(|line| !line.is_empty() && !line.starts_with('#'));
            lines.insert(last.map_or(begin, |at| begin + at + 1), value);
        }
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Study;

    fn pair() -> Pair {
        let body = |standard: &str| Body::Standard(standard.into());
        Pair { name: "mine".into(), wheel: body("S1002"), rail: body("60E1") }
    }

    /// Goal: the text that is written is the study of its keys: the same springs, with settings or without, and no others than what the schema has by
    /// default but for the pair.
    #[test]
    fn the_text_is_the_study() {
        let path = Path::new("mine.toml");
        for settings in [
            &[][..],
            &["contact.friction=0.3", "rail.inclination=1:20", "wheel.bore_mm=180", "wheel.body=s-web"],
            &["calibration.shifts_mm=[]", "material.young_gpa=200", "name=other", "track.gauge_height_mm=12"],
            &[
                "contact.friction=",
                "calibration.loads_kn=[1, 2, 3, 4]",
                "output.vertical=up",
                "rail.profile=54E1",
            ],
        ] {
            let settings: Vec<Setting> = settings.iter().map(|text| Setting::parse(text).unwrap()).collect();
            let text = pair().study(path, true, &settings);
            let written = Study::parse(path, &text).unwrap_or_else(|mistakes| panic!("{mistakes}\n{text}"));
            let given = pair().settings(&|key| key.into());
            let kept = settings.iter().filter(|setting| setting.toml().is_some()).cloned();
            let all: Vec<Setting> = given.into_iter().chain(kept).collect();
            let study = Study::parse_with(Path::new(""), "", &all).unwrap_or_else(|m| panic!("{m}"));
            assert_eq!(written.statics(), study.statics(), "{text}");
            assert_eq!((&written.name, written.scenarios.len()), (&study.name, 1));
        }
        assert!(Study::parse(path, &pair().study(path, false, &[])).unwrap().scenarios.is_empty());
    }

    /// Goal: a file is named from the folder of the study, with every name quoted.
    #[test]
    fn files_are_named_from_the_study() {
        let at =
            |file: &str, folder: &str| relative(Path::new(file), Path::new(folder)).display().to_string();
        assert_eq!(at("worn.whl", ""), "worn.whl");
        assert_eq!(at("worn.whl", "out/x"), "../../worn.whl");
        assert_eq!(at("out/w/a.prr", "./out/x"), "../w/a.prr");
        assert_eq!(at("/m/a.prr", "out"), "/m/a.prr");
        assert_eq!(at("a/b", "a/b/c"), "../../b");
        let file = PathBuf::from("my \"worn\" wheel.whl");
        let pair = Pair { wheel: Body::File(file), ..pair() };
        let text = pair.study(Path::new("out/x/study.toml"), false, &[]);
        assert!(text.contains("profile_file = \"../../my \\\"worn\\\" wheel.whl\"\n"), "{text}");
    }
}
