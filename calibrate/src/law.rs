//! The normal stiffness law `k(f) = a + b·(f/f0)^c` (publication, eq. 11).
