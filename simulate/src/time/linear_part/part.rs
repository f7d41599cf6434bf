//! A linear part and its steps, as solvers of contacts see them.

use faer::MatRef;

/// A linear part, prepared for steps of one length.
pub trait LinearPart {
    /// The state at the end of a step; the default one is any that takes no memory.
    type State: Default;
    /// What acts on the part at the end of a step besides the forces at its interface, and where its interface is then.
    type Load;
    /// A step of this part.
    type Step<'s>: LinearStep
    where
        Self: 's;

    /// The step from `state` to `next`, at whose end `load` acts. What `next` held is overwritten; it is a state when the step is
    /// finished.
    fn predict<'s>(
        &'s self,
        state: &'s Self::State,
        load: &Self::Load,
        next: &'s mut Self::State,
    ) -> Self::Step<'s>;

    /// The state at the end of a whole step from `state` under `load` and known `forces` at the interface.
    fn advance(&self, state: &Self::State, load: &Self::Load, forces: &[f64]) -> Self::State {
        let mut next = Self::State::default();
        self.predict(state, load, &mut next).finish(forces);
        next
    }
}

/// A step between its start and the forces at its end. A coordinate of the interface is a displacement (m) with a force (N), or a
/// rotation (rad) with a moment (N·m); forces are those on the part.
pub trait LinearStep {
    /// Displacements of the interface at the end of the step without forces there.
    fn free(&self) -> &[f64];

    /// Displacements of the interface at the end of the step per unit force there: symmetric and positive semi-definite. A
    /// held coordinate has a row and a column of zeros.
    fn flexibility(&self) -> MatRef<'_, f64>;

    /// Completes the state at the end of the step under `forces` at the interface.
    fn finish(self, forces: &[f64]);
}
