//! Names of files that say what was measured: `{vehicle}_{axle}_{date}`.

use railspring_profiles::error::InputError;

/// A pattern of names: placeholders with text between them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pattern(Vec<Piece>);

#[derive(Debug, Clone, PartialEq)]
enum Piece {
    Text(String),
    /// What stands here is a value of this name, at least a character and none of `/`.
    Value(String),
}

impl Pattern {
    /// The pattern of a text; `key` is the key that gives it.
    ///
    /// # Errors
    /// [`InputError`] for braces that do not match, a placeholder without a name or with that of another one, two of them with nothing between
    /// them, and for none at all.
    pub fn parse(text: &str, key: &str) -> Result<Self, InputError> {
        let refused =
            |expected: &str, remedy: &str| Err(InputError::new(key, format!("{text:?}"), expected, remedy));
        let mut pieces: Vec<Piece> = Vec::new();
        let mut rest = text;
        while let Some(at) = rest.find(['{', '}']) {
            let (before, after) = (&rest[..at], &rest[at..]);
            let Some((name, after)) = after.strip_prefix('{').and_then(|inside| inside.split_once('}'))
            else {
                return refused("braces that enclose names", "write placeholders as `{vehicle}`");
            };
            if name.trim().is_empty() || name.contains('{') {
                return refused("placeholders with names", "write placeholders as `{vehicle}`");
            }
            let value = Piece::Value(name.trim().to_owned());
            if pieces.contains(&value) {
                return refused("each placeholder once", "give the second one another name");
            }
            if !before.is_empty() {
                pieces.push(Piece::Text(before.into()));
            } else if let Some(Piece::Value(_)) = pieces.last() {
                return refused(
                    "text between two placeholders, which says where the first one ends",
                    "write it between them, or take a single placeholder",
                );
            }
            pieces.push(value);
            rest = after;
        }
        if pieces.is_empty() {
            return refused("at least one placeholder", "write it as `{vehicle}`");
        }
        if !rest.is_empty() {
            pieces.push(Piece::Text(rest.into()));
        }
        Ok(Self(pieces))
    }

    /// The values in a name, if it is one of this pattern; each is as short as the rest of the pattern allows.
    pub fn values(&self, name: &str) -> Option<Vec<(String, String)>> {
        let mut values = Vec::new();
        let mut in_vain = vec![false; (self.0.len() + 1) * (name.len() + 1)];
        self.from(0, name, 0, &mut in_vain, &mut values).then(|| {
            values.reverse();
            values
        })
    }

    /// Whether the pieces from one on are the name from a byte on; the values are added from the last one on. What was tried in vain is not
    /// tried again.
    fn from(
        &self,
        piece: usize,
        name: &str,
        at: usize,
        in_vain: &mut [bool],
        values: &mut Vec<(String, String)>,
    ) -> bool {
        let tried = piece * (name.len() + 1) + at;
        if in_vain[tried] {
            return false;
        }
        let rest = &name[at..];
        let is_it = match self.0.get(piece) {
            None => rest.is_empty(),
            Some(Piece::Text(text)) => {
                rest.starts_with(text.as_str())
                    && self.from(piece + 1, name, at + text.len(), in_vain, values)
            }
            Some(Piece::Value(key)) => {
                let ends =
                    rest.char_indices().take_while(|(_, c)| *c != '/').map(|(at, c)| at + c.len_utf8());
                let end = ends.into_iter().find(|end| self.from(piece + 1, name, at + end, in_vain, values));
                values.extend(end.map(|end| (key.clone(), rest[..end].to_owned())));
                end.is_some()
            }
        };
        in_vain[tried] = !is_it;
        is_it
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(pattern: &str, name: &str) -> Option<String> {
        let found = Pattern::parse(pattern, "name_pattern").unwrap().values(name)?;
        Some(found.into_iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>().join(" "))
    }

    /// Goal: values are what stands between the texts of a pattern, the first ones as short as can be; a name that is another one has none, and a long
    /// one takes no time.
    #[test]
    fn names_are_taken_apart() {
        let whole = Some("vehicle=4711 axle=2 wheel=L date=2024-05-12".into());
        assert_eq!(values("{vehicle}_{axle}_{wheel}_{date}", "4711_2_L_2024-05-12"), whole);
        assert_eq!(values("{a}_{b}", "x_y_z"), Some("a=x b=y_z".into()));
        assert_eq!(values("{a}_{b}_z", "x_y_z_z"), Some("a=x b=y_z".into()));
        assert_eq!(values("{month}/V{vehicle}", "May/V\u{fc}1"), Some("month=May vehicle=\u{fc}1".into()));
        assert_eq!(values("{vehicle}", "May/V1"), None);
        assert_eq!(values("{a}_{b}", "_y"), None);
        assert_eq!(values("V{a}", "W1"), None);
        assert_eq!(values("{a}_{b}_{c}_{d}_{e}_{f}_{g}_{h}!", &"_".repeat(250)), None);
    }

    /// Goal: a pattern that cannot be taken apart is refused with its key.
    #[test]
    fn patterns_that_say_nothing_are_refused() {
        for pattern in ["", "May", "{a", "a}", "{a{b}", "{}", "{a}{b}", "{a}_{a}"] {
            let refused = Pattern::parse(pattern, "wheel[0].name_pattern").unwrap_err();
            assert_eq!(refused.key, "wheel[0].name_pattern", "{pattern}");
        }
    }
}
