//! Units. Inside, every quantity is SI (N, m, kg, s, rad); these factors
//! convert in input and output, where the unit is part of the name.

/// One millimetre in metres.
pub const MILLIMETRE: f64 = 1e-3;
/// One square millimetre in square metres.
pub const SQUARE_MILLIMETRE: f64 = 1e-6;
/// One kilonewton in newtons.
pub const KILONEWTON: f64 = 1e3;
/// One kilonewton a metre in newtons a metre.
pub const KILONEWTON_PER_METRE: f64 = 1e3;
/// One megapascal in pascals.
pub const MEGAPASCAL: f64 = 1e6;
/// One gigapascal in pascals.
pub const GIGAPASCAL: f64 = 1e9;
/// One tonne in kilograms.
pub const TONNE: f64 = 1e3;

/// A length (m) in millimetres, to the nanometre, as messages have it: 0.07 m is 70, not 70.00000000000001.
pub fn in_millimetres(length: f64) -> f64 {
    (length * 1e9).round() / 1e6
}
