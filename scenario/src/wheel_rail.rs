//! The wheel/rail part of a vehicle file: profiles, friction, creep law, rail support.

use crate::contact_geometry::{ContactPair, Placement};
use crate::error::ScenarioError;
use crate::inputs::Inputs;
use crate::known::Known;
use crate::profile::{self, Jm3Like, Part, Profile};
use crate::quantity::Quantity;
use crate::source::Source;
use files::{did_you_mean, quoted};
use firmware_core::vehicle::RailSupport;
use firmware_core::wheel_rail::creep::{ConicalPrescribed, CreepLaw, Fastsim};
use firmware_core::wheel_rail::hertz::Material;
use firmware_core::wheel_rail::table::ContactTable;
use firmware_core::wheel_rail::wheel::{Conical, Surface, Wheel};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Wheels on rails.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct WheelRailFile {
    /// Nominal rolling radius.
    pub wheel_radius_m: Quantity,
    /// Half the distance between the tape circles.
    pub half_tape_spacing_m: Quantity,
    /// Coefficient of friction.
    pub friction: Quantity,
    /// The creep law.
    pub creep: CreepFile,
    /// Real profiles, or a cone.
    pub surface: SurfaceFile,
    /// Rail mass under each wheel; without it the rail does not give way.
    pub rail_support: Option<RailSupportFile>,
}

/// A creep law by name, with what it needs.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum CreepFile {
    /// Kalker with cubic saturation.
    LinearSaturated,
    /// Polach's closed form.
    Polach,
    /// Kalker's simplified theory on a grid.
    Fastsim {
        /// Cells along the rolling direction.
        cells_along: u16,
        /// Cells across it.
        cells_across: u16,
    },
    /// Prescribed coefficients of classical bogie models.
    ConicalPrescribed {
        /// `G pi a b`.
        shear_force_n: Quantity,
        /// Longitudinal coefficient.
        psi: Quantity,
        /// Lateral coefficient.
        phi: Quantity,
    },
}

/// What the wheels run on.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
#[expect(clippy::large_enum_variant, reason = "one per vehicle")]
pub enum SurfaceFile {
    /// Two profiles by name or CSV file.
    Profiles {
        /// `lma`, `s1002`, `jm3_like` or a CSV file relative to this one.
        wheel: String,
        /// `cn60`, `uic60` or a CSV file relative to this one.
        rail: String,
        /// Inclination of the rails.
        rail_cant: Quantity,
        /// Gauge.
        gauge_m: Quantity,
        /// Depth at which the gauge is measured.
        gauge_depth_m: Quantity,
        /// Distance of the tape circle from the wheel's inner face.
        tape_circle_m: Quantity,
        /// Calibrated shape of a `jm3_like` wheel.
        jm3_like: Option<Jm3LikeFile>,
    },
    /// A cone under constant load.
    Conical {
        /// Change of rolling radius per lateral shift.
        conicity: Quantity,
        /// Wheel load.
        load_n: Quantity,
        /// Shift at which the flange begins.
        flange_gap_m: Quantity,
        /// Flange spring.
        flange_n_per_m: Quantity,
    },
}

/// Calibration of the JM3-like wheel; what is absent keeps its default.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "documented at the profile")]
pub struct Jm3LikeFile {
    pub small_amplitude_conicity: Option<Quantity>,
    pub large_amplitude_conicity: Option<Quantity>,
    pub flange_contact_shift_m: Option<Quantity>,
    pub contact_angle_slope_rad_per_m: Option<Quantity>,
}

/// Effective rail mass under one wheel.
#[derive(Debug, Clone, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
#[expect(missing_docs, reason = "the keys say it")]
pub struct RailSupportFile {
    pub mass_y_kg: Quantity,
    pub mass_z_kg: Quantity,
    pub stiffness_y_n_per_m: Quantity,
    pub stiffness_z_n_per_m: Quantity,
    pub damping_y_n_s_per_m: Quantity,
    pub damping_z_n_s_per_m: Quantity,
}

/// Lengths of wheels and tracks that are computed, models of a few centimetres included (m).
const LENGTH_M: [f64; 2] = [1e-3, 10.0];
/// Masses, stiffnesses and damping of a rail (kg, N/m, N s/m), and forces (N): far beyond any, so
/// that no equation overflows.
const RAIL_MASS_KG: [f64; 2] = [1e-3, 1e6];
const RATE: [f64; 2] = [1e-3, 1e15];
const FORCE_N: [f64; 2] = [1e-6, 1e12];

impl WheelRailFile {
    /// The rolling radius of the wheels (m).
    pub(crate) fn radius_m(&self, source: &Source) -> Result<f64, ScenarioError> {
        let [least, most] = LENGTH_M;
        self.wheel_radius_m.positive_within(source, "wheel_radius_m", least, most)
    }

    /// Half the distance between the tape circles (m).
    fn half_tape_m(&self, source: &Source) -> Result<f64, ScenarioError> {
        let [least, most] = LENGTH_M;
        self.half_tape_spacing_m.positive_within(source, "half_tape_spacing_m", least, most)
    }

    pub(crate) fn wheel(&self, source: &Source) -> Result<Wheel, ScenarioError> {
        let surface = match &self.surface {
            SurfaceFile::Profiles { .. } => Surface::Profiles,
            SurfaceFile::Conical { conicity, load_n, flange_gap_m, flange_n_per_m } => {
                Surface::Conical(Conical {
                    conicity: conicity.up_to(source, "conicity", 10.0)?,
                    load_n: load_n.positive_within(source, "load_n", FORCE_N[0], FORCE_N[1])?,
                    flange_gap_m: flange_gap_m.positive(source, "flange_gap_m")?,
                    flange_n_per_m: flange_n_per_m.up_to(source, "flange_n_per_m", RATE[1])?,
                })
            }
        };
        let creep = self.creep.law(source, &self.friction)?;
        if matches!(surface, Surface::Conical(_)) != matches!(creep, CreepLaw::ConicalPrescribed(_))
        {
            return Err(self.friction.error(
                source,
                "creep law conical_prescribed goes with surface conical, the others with profiles",
            ));
        }
        Ok(Wheel {
            tape_m: self.half_tape_m(source)?,
            radius_m: self.radius_m(source)?,
            friction: self.friction.within(source, "friction", 1e-3, 2.0, "0.001 to 2")?,
            material: Material::STEEL,
            surface,
            creep,
        })
    }

    pub(crate) fn rail_support(
        &self,
        source: &Source,
    ) -> Result<Option<RailSupport>, ScenarioError> {
        let Some(rail) = &self.rail_support else { return Ok(None) };
        Ok(Some(RailSupport {
            mass_kg: [
                rail.mass_y_kg.positive_within(
                    source,
                    "mass_y_kg",
                    RAIL_MASS_KG[0],
                    RAIL_MASS_KG[1],
                )?,
                rail.mass_z_kg.positive_within(
                    source,
                    "mass_z_kg",
                    RAIL_MASS_KG[0],
                    RAIL_MASS_KG[1],
                )?,
            ],
            stiffness_n_per_m: [
                rail.stiffness_y_n_per_m.positive_within(
                    source,
                    "stiffness_y_n_per_m",
                    RATE[0],
                    RATE[1],
                )?,
                rail.stiffness_z_n_per_m.positive_within(
                    source,
                    "stiffness_z_n_per_m",
                    RATE[0],
                    RATE[1],
                )?,
            ],
            damping_n_s_per_m: [
                rail.damping_y_n_s_per_m.up_to(source, "damping_y_n_s_per_m", RATE[1])?,
                rail.damping_z_n_s_per_m.up_to(source, "damping_z_n_s_per_m", RATE[1])?,
            ],
        }))
    }

    /// Solves the profiles into the run-time table; `None` for a cone.
    ///
    /// # Errors
    /// A profile that does not exist or does not fit.
    pub fn contact(&self, source: &Source) -> Result<Option<Contact>, ScenarioError> {
        self.contact_of(source, &mut Inputs::default())
    }

    /// The same; files of profiles are noted as inputs.
    pub(crate) fn contact_of(
        &self,
        source: &Source,
        inputs: &mut Inputs,
    ) -> Result<Option<Contact>, ScenarioError> {
        let SurfaceFile::Profiles {
            wheel,
            rail,
            rail_cant,
            gauge_m,
            gauge_depth_m,
            tape_circle_m,
            jm3_like,
        } = &self.surface
        else {
            return Ok(None);
        };
        let shape = jm3_like.as_ref().map_or(Ok(Jm3Like::default()), |file| file.shape(source))?;
        let tape_circle_m = tape_circle_m.positive(source, "tape_circle_m")?;
        let half_tape_m = self.half_tape_m(source)?;
        let placement = Placement {
            rail_cant: rail_cant.within(source, "rail_cant", 0.0, 0.1, "0 to 0.1")?,
            gauge_m: gauge_m.positive(source, "gauge_m")?,
            gauge_depth_m: gauge_depth_m.positive(source, "gauge_depth_m")?,
            back_to_back_m: 2.0 * (half_tape_m - tape_circle_m),
            tape_circle_m,
        };
        let wheel = match wheel.as_str() {
            "lma" => profile::lma(),
            "s1002" => profile::s1002(),
            "jm3_like" => {
                profile::jm3_like(&shape).map_err(|error| error.asked_by(source.path()))?
            }
            path => from_csv(source, path, Part::Wheel, inputs)?,
        };
        let rail = match rail.as_str() {
            "cn60" => profile::cn60(),
            "uic60" => profile::uic60(),
            path => from_csv(source, path, Part::Rail, inputs)?,
        };
        let radius_m = self.radius_m(source)?;
        let contact = Contact::new(&wheel, rail, placement, radius_m);
        contact.map(Some).map_err(|error| error.asked_by(source.path()))
    }
}

/// What a contact is solved from.
#[derive(Debug, Clone, PartialEq)]
struct Pair {
    wheel: Profile,
    rail: Profile,
    placement: Placement,
    radius_m: f64,
}

/// Pairs that were solved last. Every point of a map asks twice for the same, and solving takes
/// longer than a second of the locomotive.
static SOLVED: Known<Pair, Contact> = Known::nothing();

/// A solved pair of profiles.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The run-time table.
    pub table: Arc<ContactTable>,
    /// The pair itself, for conicity and plots.
    pub pair: ContactPair,
    /// Wheel and rail: what they are and where from.
    pub profiles: [ProfileNote; 2],
}

impl Contact {
    /// Solves a wheel of a rolling radius (m) on a rail.
    ///
    /// # Errors
    /// Profiles that do not fit each other.
    pub fn new(
        wheel: &Profile,
        rail: Profile,
        placement: Placement,
        radius_m: f64,
    ) -> Result<Self, ScenarioError> {
        let pair = Pair { wheel: wheel.clone(), rail, placement, radius_m };
        SOLVED.answer(pair, Self::solve)
    }

    fn solve(pair: &Pair) -> Result<Self, ScenarioError> {
        let Pair { wheel, rail, placement, radius_m } = pair;
        let profiles = [wheel, rail].map(|profile| ProfileNote {
            name: profile.name().to_owned(),
            provenance: profile.provenance(),
            about: profile.source().to_owned(),
        });
        let pair = ContactPair::new(wheel, rail.clone(), *placement)?;
        let table = Arc::new(ContactTable::new(&pair.tables(), *radius_m, Material::STEEL));
        Ok(Self { table, pair, profiles })
    }
}

/// What a report says about a profile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ProfileNote {
    /// Its name.
    pub name: String,
    /// Where its shape comes from.
    pub provenance: profile::Provenance,
    /// In words.
    pub about: String,
}

impl ProfileNote {
    /// One line for a report; calibrated shapes say so.
    pub fn line(&self) -> String {
        let provenance = match self.provenance {
            profile::Provenance::Published => "published",
            profile::Provenance::Derived => "derived",
            profile::Provenance::Calibrated => "CALIBRATED",
            profile::Provenance::Measured => "measured",
        };
        format!("Profile {} ({provenance}): {}", self.name, self.about)
    }
}

fn from_csv(
    source: &Source,
    path: &str,
    part: Part,
    inputs: &mut Inputs,
) -> Result<Profile, ScenarioError> {
    let (role, known) = match part {
        Part::Wheel => ("wheel profile", "lma, s1002, jm3_like"),
        Part::Rail => ("rail profile", "cn60, uic60"),
    };
    let (name, path) = (path, source.sibling(path));
    if !path.exists() {
        return Err(source.whole_error(format!(
            "profile \"{}\" not found, expected {known} or a CSV file{}",
            quoted(&path.display().to_string()),
            did_you_mean(name, known.split(", "))
        )));
    }
    let (profile, hash) = Profile::from_csv_hashed(&path, part)?;
    inputs.note(role, hash);
    Ok(profile)
}

impl CreepFile {
    fn law(&self, source: &Source, near: &Quantity) -> Result<CreepLaw, ScenarioError> {
        Ok(match self {
            Self::LinearSaturated => CreepLaw::LinearSaturated,
            Self::Polach => CreepLaw::Polach,
            Self::Fastsim { cells_along, cells_across } => {
                let grid = Fastsim::new(*cells_along, *cells_across).ok_or_else(|| {
                    near.error(
                        source,
                        format!(
                            "fastsim grid {cells_along} x {cells_across}, expected 1 to 256 cells each way"
                        ),
                    )
                })?;
                CreepLaw::Fastsim(grid)
            }
            Self::ConicalPrescribed { shear_force_n, psi, phi } => {
                CreepLaw::ConicalPrescribed(ConicalPrescribed {
                    shear_force_n: shear_force_n.positive_within(
                        source,
                        "shear_force_n",
                        FORCE_N[0],
                        FORCE_N[1],
                    )?,
                    psi: psi.positive(source, "psi")?,
                    phi: phi.positive(source, "phi")?,
                })
            }
        })
    }
}

impl Jm3LikeFile {
    fn shape(&self, source: &Source) -> Result<Jm3Like, ScenarioError> {
        let mut shape = Jm3Like::default();
        let given = [
            (
                &self.small_amplitude_conicity,
                "small_amplitude_conicity",
                &mut shape.small_amplitude_conicity,
            ),
            (
                &self.large_amplitude_conicity,
                "large_amplitude_conicity",
                &mut shape.large_amplitude_conicity,
            ),
            (
                &self.flange_contact_shift_m,
                "flange_contact_shift_m",
                &mut shape.flange_contact_shift_m,
            ),
            (
                &self.contact_angle_slope_rad_per_m,
                "contact_angle_slope_rad_per_m",
                &mut shape.contact_angle_slope_rad_per_m,
            ),
        ];
        for (value, key, slot) in given {
            if let Some(value) = value {
                *slot = value.positive(source, key)?;
            }
        }
        Ok(shape)
    }
}
