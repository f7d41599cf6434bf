//! Records that know whether they are as the program wrote them.

use serde::Serialize;

use crate::output::to_json;

/// A record with the hash of its own content in it. A copy of its file, in any folder, then says whether a number was edited in it; another
/// layout of the same values changes nothing.
pub trait Sealed: Serialize + Clone {
    /// Where the hash stands in it.
    fn seal(&mut self) -> &mut String;

    /// The hash of all else.
    fn content_hash(&self) -> String {
        let mut content = self.clone();
        content.seal().clear();
        blake3::hash(&to_json(&content)).to_hex().to_string()
    }

    /// The same with its hash.
    #[must_use]
    fn sealed(mut self) -> Self {
        *self.seal() = self.content_hash();
        self
    }

    /// Whether it is as it was written.
    fn is_as_written(&self) -> bool {
        *self.clone().seal() == self.content_hash()
    }
}

#[cfg(test)]
mod tests {
    use super::Sealed;
    use crate::records::StiffnessRecord;
    use crate::report::samples;

    /// Goal: a sealed record is as written after it was read from its file, in another layout too; with any number, text or hash changed it is not.
    #[test]
    fn an_edit_is_seen() {
        let record = samples::stiffness().sealed();
        let text = serde_json::to_string(&record).unwrap();
        let read = |text: &str| serde_json::from_str::<StiffnessRecord>(text).unwrap();
        assert!(read(&text).is_as_written() && !samples::stiffness().is_as_written());
        let b = record.law.constants.b_kn_per_m;
        let [from, to] = [b, b * (1.0 + 1e-15)].map(|b| format!("\"b_kn_per_m\":{b:?}"));
        assert!(text.contains(&from) && from != to);
        for (from, to) in [(&*from, &*to), ("\"beam\"", "\"foot\""), (&record.input_hash, &"0".repeat(64))] {
            assert!(!read(&text.replacen(from, to, 1)).is_as_written(), "{from}");
        }
    }
}
