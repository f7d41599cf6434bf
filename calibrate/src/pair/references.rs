//! What a pair has with every reference.

use crate::calibration::Reference;

/// Something with every reference of a pair, in this order. Against the held foot there is something only where the rail was condensed on its
/// foot as well: it takes a body and as many loads again, for a comparison with laws of that reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByReference<T> {
    /// Against the held foot of the rail.
    pub foot: Option<T>,
    /// Against the rail's section.
    pub beam: T,
    /// Of the approach of the surfaces alone.
    pub local: T,
    /// Of the profiles on half-spaces; none where they were not pressed, or carry no loads for a law.
    pub half_spaces: Option<T>,
}

impl<T> ByReference<T> {
    /// What there is with a reference.
    pub fn get(&self, reference: Reference) -> Option<&T> {
        match reference {
            Reference::Foot => self.foot.as_ref(),
            Reference::Beam => Some(&self.beam),
            Reference::Local => Some(&self.local),
            Reference::HalfSpaces => self.half_spaces.as_ref(),
        }
    }

    /// All of them with their references.
    pub fn iter(&self) -> impl Iterator<Item = (Reference, &T)> {
        let others = [(Reference::Beam, &self.beam), (Reference::Local, &self.local)];
        let half_spaces = self.half_spaces.iter().map(|of| (Reference::HalfSpaces, of));
        self.foot.iter().map(|of| (Reference::Foot, of)).chain(others).chain(half_spaces)
    }

    /// What `of` makes of each.
    pub fn map<U>(&self, mut of: impl FnMut(&T) -> U) -> ByReference<U> {
        ByReference {
            foot: self.foot.as_ref().map(&mut of),
            beam: of(&self.beam),
            local: of(&self.local),
            half_spaces: self.half_spaces.as_ref().map(of),
        }
    }
}
