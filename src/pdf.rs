//! Pages as PDF, printed by the Chromium of the machine without its window.

use std::ffi::OsStr;
use std::path::{Path, PathBuf, absolute};
use std::process::Command;
use std::time::Duration;

use railspring_profiles::error::{InputError, Result};

use crate::child::{Limits, Stop, run};
use crate::engine::list::{NewFile, Results};
use crate::engine::output::OutputFolder;

/// Names of the browser on the search path.
const BROWSERS: [&str; 6] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome", "msedge"];
/// Key of the messages.
const KEY: &str = "--pdf";
/// Longest that a page may take.
const LONGEST: Duration = Duration::from_secs(180);
/// Most bytes that the browser may say.
const SAID: u64 = 1 << 20;

/// What prints pages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Printer {
    browser: PathBuf,
}

impl Printer {
    /// The browser of this machine.
    ///
    /// # Errors
    /// [`InputError`] with key `--pdf` if there is none on the search path.
    pub fn find() -> Result<Self> {
        Self::find_on(&std::env::var_os("PATH").unwrap_or_default())
    }

    fn find_on(path: &OsStr) -> Result<Self> {
        let folders: Vec<PathBuf> = std::env::split_paths(path).collect();
        // the first name that is there, in whichever folder
        let files = BROWSERS.iter().flat_map(|name| {
            folders
                .iter()
                .map(move |folder| folder.join(name).with_extension(std::env::consts::EXE_EXTENSION))
        });
        let browser = files.into_iter().find(|file| file.is_file()).ok_or_else(|| {
            InputError::new(
                KEY,
                format!("none of {} on the search path", BROWSERS.join(", ")),
                "Chromium or Chrome, which prints the page",
                "install Chromium (Debian: apt install chromium), or print report.html from any browser and leave out --pdf",
            )
        })?;
        Ok(Self { browser })
    }

    /// What has to be known about how pages are printed, if anything.
    pub fn remark() -> Option<&'static str> {
        let without = sandbox().contains(&NO_SANDBOX);
        without.then_some(
            "--pdf as root: Chromium prints the page without its sandbox, which root cannot have; run as another user to keep it",
        )
    }

    /// Prints a page of a folder beside it, and says under which name.
    ///
    /// # Errors
    /// [`InputError`] with key `--pdf` and the browser's last words if there is no PDF; a folder that cannot be written.
    pub fn print(&self, folder: &OutputFolder, page: &str) -> Result<String> {
        let failed = |value: String| {
            InputError::new(
                KEY,
                value,
                format!("a PDF of {page} by {}", self.browser.display()),
                format!("print {} from the browser itself, and leave out --pdf", folder.file(page).display()),
            )
        };
        let place = tempfile::tempdir().map_err(|cause| failed(cause.to_string()))?;
        let file = place.path().join("page.pdf");
        let page_at = absolute(folder.file(page)).map_err(|cause| failed(cause.to_string()))?;
        let mut command = Command::new(&self.browser);
        command
            .args(["--headless", "--disable-gpu", "--no-pdf-header-footer", "--disable-dev-shm-usage"])
            .args(["--no-first-run", "--disable-extensions"])
            .args(sandbox())
            .arg(with_value("--user-data-dir=", place.path()))
            .arg(with_value("--print-to-pdf=", &file))
            .arg(url(&page_at));
        let ended = run(&mut command, &Limits { time: LONGEST, output: SAID, memory: None }, &|| Ok(()))
            .map_err(|stop| match stop {
                Stop::Failed(cause) => failed(cause.to_string()),
                Stop::Time => failed(format!("not finished after {} s", LONGEST.as_secs())),
                Stop::Output => failed("more messages than a browser has".into()),
                Stop::Memory => failed("more memory than allowed".into()),
                Stop::Asked(cause) => failed(cause.to_string()),
            })?;
        let content = std::fs::read(&file).unwrap_or_default();
        if !ended.status.success() || !content.starts_with(b"%PDF") {
            let last = ended.messages.lines().map(str::trim).rfind(|line| !line.is_empty());
            return Err(failed(last.unwrap_or("no PDF").to_string()).into());
        }
        let name = Path::new(page).with_extension("pdf").display().to_string();
        let results = Results::new(folder);
        match results.entry(page) {
            // beside a listed page, and gone with it
            Some(entry) => {
                let file = NewFile { reproducible: false, ..NewFile::new(&name, content, &entry.key) };
                results.write(vec![file], &[])?;
            }
            None => folder.write(&name, &content)?,
        }
        Ok(name)
    }
}

/// Chromium's option for running without its sandbox.
const NO_SANDBOX: &str = "--no-sandbox";

/// Chromium refuses to run as root with its sandbox; the page is that of this program.
fn sandbox() -> &'static [&'static str] {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        let root = std::fs::metadata("/proc/self").is_ok_and(|of| of.uid() == 0);
        if root {
            return &[NO_SANDBOX];
        }
    }
    &[]
}

/// An option whose value is a path.
fn with_value(option: &str, path: &Path) -> std::ffi::OsString {
    let mut text = std::ffi::OsString::from(option);
    text.push(path);
    text
}

/// The address of a file: what is no letter, digit or one of a few marks is spelled as bytes.
fn url(path: &Path) -> String {
    let text = path.to_string_lossy().replace('\\', "/");
    let spelled = text.bytes().map(|byte| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b'-' | b'_' | b'.' | b'~' | b':' => {
            char::from(byte).to_string()
        }
        other => format!("%{other:02X}"),
    });
    let begin = if text.starts_with('/') { "file://" } else { "file:///" };
    spelled.fold(begin.to_string(), |url, letter| url + &letter)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::inputs::Inputs;

    /// Goal: names of files become addresses that a browser takes for the same file.
    #[test]
    fn paths_become_addresses() {
        assert_eq!(url(Path::new("/tmp/a b/r\u{e9}port#1.html")), "file:///tmp/a%20b/r%C3%A9port%231.html");
    }

    /// Goal: without a browser on the search path the option, what is missing and the remedy are named; a folder that has one is found.
    #[test]
    fn a_missing_browser_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let said = Printer::find_on(folder.path().as_os_str()).unwrap_err().to_string();
        assert!(
            said.contains("--pdf") && said.contains("chromium") && said.contains("apt install"),
            "{said}"
        );
        let browser = folder.path().join("google-chrome").with_extension(std::env::consts::EXE_EXTENSION);
        std::fs::write(&browser, "").unwrap();
        assert_eq!(Printer::find_on(folder.path().as_os_str()).unwrap(), Printer { browser });
    }

    /// Prints a page with a script in the place of a browser; what is said, and whether the PDF is there.
    #[cfg(unix)]
    fn printed(script: &str) -> (Result<String>, Option<Vec<u8>>) {
        use std::os::unix::fs::PermissionsExt;
        let place = tempfile::tempdir().unwrap();
        let browser = place.path().join("chromium");
        std::fs::write(&browser, format!("#!/bin/sh\n{script}\n")).unwrap();
        std::fs::set_permissions(&browser, std::fs::Permissions::from_mode(0o755)).unwrap();
        let folder = OutputFolder::create(&place.path().join("out"), &Inputs::none()).unwrap();
        folder.write("report.html", b"<p>").unwrap();
        let said = Printer { browser }.print(&folder, "report.html");
        (said, std::fs::read(folder.file("report.pdf")).ok())
    }

    /// Goal: a browser that fails, or that writes no PDF, is an error with its last words, and leaves no file.
    #[cfg(unix)]
    #[test]
    fn a_browser_that_fails_is_quoted() {
        let to_file = "for a in \"$@\"; do case $a in --print-to-pdf=*) file=${a#*=};; esac; done";
        let scripts = [
            "echo begin >&2; echo 'no display' >&2; echo >&2; exit 3".to_string(),
            "echo begin >&2; echo 'no display' >&2".into(),
            format!("{to_file}; echo '<html>' > $file; echo 'no display' >&2"),
            format!("{to_file}; echo '%PDF-1.4' > $file; echo 'no display' >&2; exit 1"),
        ];
        for script in scripts {
            let (said, pdf) = printed(&script);
            let said = said.unwrap_err().to_string();
            assert!(said.contains("= no display: ") && said.contains("report.html"), "{script}: {said}");
            assert_eq!(pdf, None, "{script}");
        }
    }

    /// Goal: what the browser prints of the page of the folder stands beside it, byte for byte.
    #[cfg(unix)]
    #[test]
    fn a_page_is_printed_beside_it() {
        let (said, pdf) = printed(
            "for a in \"$@\"; do case $a in --print-to-pdf=*) file=${a#*=};; file://*/out/report.html) page=$a;; esac; done; test -n \"$page\" && printf '%%PDF-1.4 of it' > $file",
        );
        assert_eq!((said.unwrap().as_str(), pdf.as_deref()), ("report.pdf", Some(&b"%PDF-1.4 of it"[..])));
    }
}
