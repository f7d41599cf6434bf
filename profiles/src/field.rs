//! The fields of this library that an [`InputError`](crate::error::InputError) can name.
//!
//! The library is independent of the files from which its values come. Its errors name the field, in the key and,
//! in backticks, in the remedy; a program that read the value from a file translates the name into its own.

use std::fmt;

macro_rules! fields {
    ($($(#[$meaning:meta])* $variant:ident = $name:literal,)*) => {
        /// A value that the library takes.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum InputField {
            $($(#[$meaning])* $variant,)*
        }

        impl InputField {
            /// All fields.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// Name in errors.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }
        }
    };
}

fields! {
    /// Part of a file that is the profile, where it is not known whose it is.
    ProfilePart = "profile_part",
    /// Unit of such a file.
    ProfileUnit = "profile_unit",
    /// Whether such a file is that of a wheel or a rail.
    ProfileKind = "profile_kind",
    /// Name of the rail's standard section.
    RailName = "rail_name",
    /// The rail's measured head.
    RailProfile = "rail_profile",
    /// The body under a measured head.
    RailBody = "rail_body",
    /// Whether a measured head is placed on the standard section first.
    RailAligned = "rail_aligned",
    /// Part of the file of a measured head that is the profile.
    RailProfilePart = "rail_profile_part",
    /// Unit of the file of a measured head.
    RailProfileUnit = "rail_profile_unit",
    /// Length of the rail.
    RailLength = "rail_length",
    /// A rail mesh made elsewhere.
    RailMesh = "rail_mesh",
    /// Unit of its coordinates.
    RailMeshUnit = "rail_mesh_unit",
    /// Nodes of its running surface.
    RailContactSurface = "rail_contact_surface",
    /// Nodes at its foot.
    RailHeldNodes = "rail_held_nodes",
    /// Materials of the groups of a rail mesh.
    RailMaterials = "rail_materials",
    /// Name of the wheel's standard profile.
    WheelName = "wheel_name",
    /// The wheel's measured profile.
    WheelProfile = "wheel_profile",
    /// Whether a measured wheel is placed on the standard first.
    WheelAligned = "wheel_aligned",
    /// Part of the file of a measured wheel that is the profile.
    WheelProfilePart = "wheel_profile_part",
    /// Unit of the file of a measured wheel.
    WheelProfileUnit = "wheel_profile_unit",
    /// Distance of the tape circle from the flange back.
    TapeCircle = "tape_circle",
    /// Diameter at the tape circle.
    TapeDiameter = "tape_diameter",
    /// Height of the flange.
    FlangeHeight = "flange_height",
    /// Thickness of the flange.
    FlangeThickness = "flange_thickness",
    /// Diameter of the bore.
    BoreDiameter = "bore_diameter",
    /// Diameter of the hub.
    HubDiameter = "hub_diameter",
    /// Depth of the rim.
    RimDepth = "rim_depth",
    /// Least thickness of the web.
    WebThickness = "web_thickness",
    /// Place of the web at the hub.
    WebHubY = "web_hub_y",
    /// Place of the web at the rim.
    WebRimY = "web_rim_y",
    /// A wheel mesh made elsewhere.
    WheelMesh = "wheel_mesh",
    /// Unit of its coordinates.
    WheelMeshUnit = "wheel_mesh_unit",
    /// Nodes of its running surface.
    WheelContactSurface = "wheel_contact_surface",
    /// Nodes at its bore.
    WheelHeldNodes = "wheel_held_nodes",
    /// Materials of the groups of a wheel mesh.
    WheelMaterials = "wheel_materials",
    /// Track gauge.
    Gauge = "gauge",
    /// Depth below the top of the rail at which the gauge is measured.
    GaugeHeight = "gauge_height",
    /// Distance between the flange backs.
    FlangeBack = "flange_back",
    /// Lateral shift of the wheel.
    LateralShift = "lateral_shift",
    /// Inclination of the rail.
    Inclination = "inclination",
    /// Young's modulus.
    Young = "young",
    /// Poisson's ratio.
    Poisson = "poisson",
    /// Mass density.
    Density = "density",
    /// Material damping.
    Damping = "damping",
    /// Edge of a contact element across the track.
    ContactElement = "contact_element",
    /// Edge of a contact element along the track.
    ContactElementAlong = "contact_element_along",
    /// Half the length of the contact window.
    WindowHalfLength = "window_half_length",
    /// Growth of the elements along the track.
    Growth = "growth",
    /// Number of layers below the running surface.
    Layers = "layers",
    /// Thickness of the first layer.
    FirstLayer = "first_layer",
    /// Growth of the layers.
    LayerGrowth = "layer_growth",
    /// Growth of the elements of the section.
    SectionGrowth = "section_growth",
    /// Largest element of the rail's section.
    RailSectionElement = "rail_section_element",
    /// Largest element of the wheel's section.
    WheelSectionElement = "wheel_section_element",
    /// Largest element along the rail.
    RailLengthElement = "rail_length_element",
    /// Largest element around the wheel.
    WheelArcElement = "wheel_arc_element",
    /// Depth to which the contact zone goes down the rail's gauge face.
    RailZoneFaceDepth = "rail_zone.face_depth",
    /// Lateral end of the rail's contact zone.
    RailZoneFieldY = "rail_zone.field_y",
    /// Depth to which the contact zone goes down the flange.
    WheelZoneFaceDepth = "wheel_zone.face_depth",
    /// Lateral end of the wheel's contact zone.
    WheelZoneFieldY = "wheel_zone.field_y",
    /// How the contact conditions are enforced.
    Enforcement = "enforcement",
    /// Loads of the load curve.
    Loads = "loads",
    /// Vertical preloads of the horizontal stiffness.
    HorizontalPreloads = "horizontal_preloads",
    /// Number of beam elements of the rail.
    BeamElements = "beam_elements",
    /// Distance between the surface nodes of the rail beam.
    NodeSpacing = "node_spacing",
    /// Penalty stiffness between the profile and the surface nodes of the rail beam.
    Penalty = "penalty",
    /// Numerical dissipation of the time integration of the moving solver.
    Dissipation = "dissipation",
    /// Horizontal stiffness of the contact spring.
    HorizontalStiffness = "horizontal_stiffness",
    /// Time step of a scenario.
    TimeStep = "time_step",
    /// Steps of the integration within each time step of a scenario.
    InnerSteps = "inner_steps",
    /// Number of time steps of a scenario.
    Steps = "steps",
    /// Coulomb friction of a scenario.
    Friction = "friction",
    /// Gravity of a scenario.
    Gravity = "gravity",
    /// Suspended mass of a scenario.
    SuspendedMass = "suspended_mass",
    /// Spring of the vertical suspension.
    VerticalStiffness = "vertical_suspension.stiffness",
    /// Damper of the vertical suspension.
    VerticalDamping = "vertical_suspension.damping",
    /// Spring of the lateral suspension.
    LateralStiffness = "lateral_suspension.stiffness",
    /// Damper of the lateral suspension.
    LateralDamping = "lateral_suspension.damping",
    /// Force on the suspended mass.
    VerticalForce = "vertical_force",
    /// Lateral force on the wheel.
    LateralForce = "lateral_force",
    /// Torsion of the rail.
    RailTorsion = "rail_torsion",
    /// Mass of the wheel.
    WheelMass = "wheel_mass",
    /// Position along the rail at the start.
    StartX = "start_x",
    /// Speed along the rail.
    Speed = "speed",
    /// Whether the solid model runs a scenario.
    SolidModel = "solid_model",
}

impl fmt::Display for InputField {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl From<InputField> for String {
    fn from(field: InputField) -> Self {
        field.name().into()
    }
}
