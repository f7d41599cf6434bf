//! Figures as a page shows them to those who do not see them.

/// Height over width from which a drawing is tall.
const TALL: f64 = 0.7;

/// A figure for a page: the drawing without its declaration, as an image whose text is `title` and the words in the drawing.
///
/// The words are the labels of the axes and the names of the curves; numbers at the ticks are left to the eye and to the result files.
pub(crate) fn inline(svg: &str, title: &str) -> String {
    let svg = svg.trim_start_matches("<?xml version=\"1.0\" encoding=\"UTF-8\"?>").trim_start();
    let text = escaped(&alternative(svg, title));
    let class = if is_tall(svg) { "class=\"tall\" " } else { "" };
    svg.replacen("<svg ", &format!("<svg role=\"img\" aria-label=\"{text}\" {class}"), 1)
}

/// Whether a drawing is so tall that it takes more of a printed page than others.
fn is_tall(svg: &str) -> bool {
    let length = |name: &str| -> Option<f64> {
        svg.split_once(&format!("{name}=\""))?.1.split_once('"')?.0.parse().ok()
    };
    length("height").zip(length("width")).is_some_and(|(height, width)| height > TALL * width)
}

/// The first sentence of the title, and the words of the drawing in their order, each once.
fn alternative(svg: &str, title: &str) -> String {
    let first =
        title.split_once(". ").map_or(title, |(first, _)| first).trim_end_matches('.').replace('`', "");
    let mut words: Vec<String> = Vec::new();
    for part in svg.split("<text").skip(1) {
        let inside = part.split_once('>').and_then(|(_, rest)| rest.split_once("</text>"));
        let word = inside.map_or("", |(inside, _)| inside).trim();
        // plain text again, which is escaped as a whole
        let word = word
            .replace("&lt;", "<")
            .replace("&gt;", ">")
            .replace("&quot;", "\"")
            .replace("&apos;", "'")
            .replace("&amp;", "&");
        let is_name = word.chars().filter(|letter| letter.is_alphabetic()).count() > 2;
        if is_name && !words.contains(&word) {
            words.push(word);
        }
    }
    match words.is_empty() {
        true => format!("{first}."),
        false => format!("{first}. In the figure: {}.", words.join("; ")),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('"', "&quot;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::inline;

    /// Goal: an image has the first sentence of its caption and the words in it, each once, and no tick; nothing ends the attribute.
    #[test]
    fn a_figure_has_a_text() {
        let svg = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg width=\"860\"><text x=\"1\">\nload P, kN\n</text><text>\n120\n</text><text>a &quot;b&quot; &lt;law&gt;</text><text>load P, kN</text></svg>";
        let page = inline(svg, "Law of the pair. More.");
        assert!(
            page.starts_with("<svg role=\"img\" aria-label=\"Law of the pair. In the figure: load P, kN; a &quot;b&quot; &lt;law&gt;.\" width"),
            "{page}"
        );
        assert!(inline("<svg width=\"860\" height=\"700\">", "T").contains(" class=\"tall\" width"));
        assert!(!inline("<svg width=\"860\" height=\"600\">", "T").contains("tall"));
    }
}
