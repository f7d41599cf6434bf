//! The balance of energy of a run: what the bodies have, what the loads have given, and where it has gone.
//!
//! Average acceleration keeps the balance of every linear part to rounding: the work of a force in a step is the mean of its values at both
//! ends times the way, that of a damper its mean velocity squared. What is left over, the drift, is the work of contact forces over gaps that
//! open or close within a step, and of nonlinear springs between two states; it falls with the square of the step where the contact is
//! stiff and smooth.

/// Energies of a run at the end of a time step, and works since t = 0, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyBalance {
    /// Kinetic energy of all masses.
    pub kinetic: f64,
    /// Elastic energy of bodies, springs and contact.
    pub elastic: f64,
    /// Work of forces and weights.
    pub work: f64,
    /// What material and dampers have taken.
    pub damped: f64,
    /// What friction has taken.
    pub friction: f64,
    /// What there is more than the balance says: energy less that of the start and less the work, with what damping and friction have taken.
    pub drift: f64,
}

impl EnergyBalance {
    /// What is stored, J.
    pub fn stored(&self) -> f64 {
        self.kinetic + self.elastic
    }
}

/// What a part of a model has at the end of a step, and its works in it, J.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PartEnergy {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Elastic energy.
    pub elastic: f64,
    /// Work of the loads on it in the step.
    pub work: f64,
    /// What damping took in the step.
    pub damped: f64,
    /// What friction took in the step.
    pub friction: f64,
}

impl std::ops::Add for PartEnergy {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            kinetic: self.kinetic + other.kinetic,
            elastic: self.elastic + other.elastic,
            work: self.work + other.work,
            damped: self.damped + other.damped,
            friction: self.friction + other.friction,
        }
    }
}

/// The balance from step to step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EnergyLedger {
    start: f64,
    balance: EnergyBalance,
}

impl EnergyLedger {
    /// From the state at t = 0.
    pub fn new(start: PartEnergy) -> Self {
        let PartEnergy { kinetic, elastic, .. } = start;
        Self {
            start: kinetic + elastic,
            balance: EnergyBalance { kinetic, elastic, ..EnergyBalance::default() },
        }
    }

    /// With one more step, of all parts together.
    pub fn entered(self, step: PartEnergy) -> Self {
        self.worked(&step).stored(&step)
    }

    /// With the works of one more step, of all parts together; what is stored at its end is not yet known.
    pub fn worked(mut self, step: &PartEnergy) -> Self {
        self.balance.work += step.work;
        self.balance.damped += step.damped;
        self.balance.friction += step.friction;
        self
    }

    /// With what all parts together have stored at the end of the last step.
    pub fn stored(mut self, PartEnergy { kinetic, elastic, .. }: &PartEnergy) -> Self {
        let EnergyBalance { work, damped, friction, .. } = self.balance;
        let drift = kinetic + elastic - self.start - work + damped + friction;
        self.balance = EnergyBalance { kinetic: *kinetic, elastic: *elastic, drift, ..self.balance };
        self
    }

    /// The balance at the end of the last step.
    pub fn balance(&self) -> EnergyBalance {
        self.balance
    }
}
