//! Steps of a track: its interface is the rail under the wheel.

use std::cell::RefCell;
use std::rc::Rc;

use faer::MatRef;

use crate::time::linear_part::{LinearPart, LinearStep};
use crate::time::newmark::{Motion, Newmark};
use railspring_calibrate::beam::{ChainFactor, Meeting};
use railspring_profiles::error::Result;

use super::dynamics::{TrackDynamics, TrackLoad, gains};
use super::state::{Rows, TrackState, add, dot};
use super::structure::{Carrier, Direction};

/// A track over steps of one length.
pub struct TrackSteps<'a, const N: usize> {
    dynamics: &'a TrackDynamics<'a, N>,
    scheme: Newmark,
    factor: ChainFactor<N>,
    /// The element of the last step, prepared.
    meeting: RefCell<Option<Rc<Meeting<N>>>>,
}

/// A step of a track.
pub struct TrackStep<'s, const N: usize> {
    steps: &'s TrackSteps<'s, N>,
    next: &'s mut TrackState<N>,
    meeting: Rc<Meeting<N>>,
    under: Rows<N>,
    free: [f64; 1],
    flexibility: [f64; 1],
}

impl<'a, const N: usize> TrackDynamics<'a, N> {
    /// The track over steps of `scheme`.
    ///
    /// # Errors
    /// [`NumericsError`](railspring_profiles::error::NumericsError) for equations without a solution.
    pub fn over(&'a self, scheme: Newmark) -> Result<TrackSteps<'a, N>> {
        let factor = self.factor(1.0, gains(&scheme)).ok_or_else(|| self.failure())?;
        Ok(TrackSteps { dynamics: self, scheme, factor, meeting: RefCell::new(None) })
    }
}

impl<const N: usize> LinearPart for TrackSteps<'_, N> {
    type State = TrackState<N>;
    type Load = TrackLoad;
    type Step<'s>
        = TrackStep<'s, N>
    where
        Self: 's;

    fn predict<'s>(
        &'s self,
        state: &'s TrackState<N>,
        load: &TrackLoad,
        next: &'s mut TrackState<N>,
    ) -> TrackStep<'s, N> {
        let Self { dynamics, scheme, factor, .. } = self;
        let gains = gains(scheme);
        next.displacements.clone_from(&state.displacements);
        next.velocities.clone_from(&state.velocities);
        next.accelerations.resize(state.accelerations.len(), [0.0; N]);
        next.masses.clone_from(&state.masses);
        let TrackState { displacements, velocities, accelerations, masses } = &mut *next;
        let moved = displacements.as_flattened_mut().iter_mut().zip(velocities.as_flattened_mut());
        for ((u, v), a) in moved.zip(state.accelerations.as_flattened()) {
            [*u, *v] = scheme.predicted(&Motion { u: *u, v: *v, a: *a });
        }
        for mass in masses.iter_mut() {
            let [u, v] = scheme.predicted(mass);
            *mass = Motion { u, v, a: 0.0 };
        }
        accelerations.fill([0.0; N]);
        dynamics.add_forces([displacements, velocities], masses, load.ground, accelerations);
        dynamics.pass_on(1.0, gains, masses, accelerations);
        dynamics.clear_held(accelerations);

        let (element, xi) = dynamics.place(load.x);
        let meeting = {
            let mut last = self.meeting.borrow_mut();
            match &*last {
                Some(known) if known.element() == element => known.clone(),
                _ => last.insert(Rc::new(factor.meeting(element))).clone(),
            }
        };
        let mut under = dynamics.row(Carrier::Rail, Direction::Vertical, xi);
        for (node, dof) in [(element, 0), (element, 1), (element + 1, 0), (element + 1, 1)] {
            if dynamics.held.binary_search(&(node, dof)).is_ok() {
                under[node - element][dof] = 0.0;
            }
        }
        factor.forward(&meeting, accelerations);
        let eliminated = meeting.eliminated(&under);
        let product = |a: &Rows<N>, b: &Rows<N>| {
            (0..2).map(|n| (0..N).map(|i| a[n][i] * b[n][i]).sum::<f64>()).sum::<f64>()
        };
        let over = meeting.over(&[accelerations[element], accelerations[element + 1]]);
        let free = dot(&under, displacements, element) + gains[0] * product(&eliminated, &over);
        let flexibility = gains[0] * product(&eliminated, &meeting.over(&eliminated));
        TrackStep { steps: self, next, meeting, under, free: [free], flexibility: [flexibility] }
    }
}

impl<const N: usize> LinearStep for TrackStep<'_, N> {
    fn free(&self) -> &[f64] {
        &self.free
    }

    fn flexibility(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.flexibility, 1, 1)
    }

    fn finish(self, forces: &[f64]) {
        let TrackSteps { dynamics, scheme, factor, .. } = self.steps;
        let gains = gains(scheme);
        let TrackState { displacements, velocities, accelerations, masses } = self.next;
        // the right-hand side is eliminated towards the element of the wheel already, to which nothing of its second node was carried of this force
        let element = self.meeting.element();
        let on = self.meeting.eliminated(&self.under);
        add(&on, accelerations, element, forces[0]);
        factor.backward(&self.meeting, accelerations);
        dynamics.settle(1.0, gains, masses, accelerations);
        let moved = displacements.as_flattened_mut().iter_mut().zip(velocities.as_flattened_mut());
        for ((u, v), a) in moved.zip(accelerations.as_flattened()) {
            *u += gains[0] * a;
            *v += gains[1] * a;
        }
        for mass in masses {
            mass.u += gains[0] * mass.a;
            mass.v += gains[1] * mass.a;
        }
    }
}
