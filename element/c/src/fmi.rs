//! The element as a functional mock-up unit of FMI 3.0 for co-simulation (modes inside) and model exchange (modes as states of the importer). Signatures are those of `fmi3Functions.h` of the standard.
//!
//! Of the standard's functions those do nothing but refuse that belong to what the description does not offer: variables of other types, clocks, configuration, serialised states, scheduled execution.

mod instance;
mod functions;
mod refused;
