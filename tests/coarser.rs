//! The coarse study with still coarser bodies, where bytes and words are compared.

/// `studies/coarse.toml` with bodies of half its degrees of freedom.
pub fn coarser() -> String {
    const BODIES: &str = "wheel_section_element_mm = 20\nwheel_arc_element_mm = 120\n";
    const COARSER: &str = "wheel_section_element_mm = 40\nwheel_arc_element_mm = 300\nrail_length_element_mm = 60\ngrowth = 2.5\n";
    let coarse = include_str!("studies/coarse.toml");
    assert!(coarse.contains(BODIES));
    coarse.replace(BODIES, COARSER)
}
