//! A small study: the linear critical speed of Cooperrider's bogie.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use vehicle_studies::critical_speed::STROKES_M;
use vehicle_studies::critical_speed::{Procedure, Question};
use vehicle_studies::grid::Grid;
use vehicle_studies::study::{Varied, VariedStudy};

/// A flag that is not set.
pub(crate) static GO: AtomicBool = AtomicBool::new(false);

/// A fresh folder with the bogie's scenario and vehicle.
pub(crate) fn bogie(name: &str) -> PathBuf {
    let place = std::env::temp_dir().join(format!("vehicle-studies-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place).unwrap();
    let vehicle =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/vehicles/cooperrider-bogie.toml");
    std::fs::copy(vehicle, place.join("vehicle.toml")).unwrap();
    let scenario =
        "title = \"bogie\"\nvehicle = \"vehicle.toml\"\nspeed_kmh = 200.0\nduration_s = 1.0\n";
    std::fs::write(place.join("bogie.toml"), scenario).unwrap();
    place
}

/// Its linear critical speed at the usual strokes.
pub(crate) fn linear(place: &Path) -> VariedStudy<Question> {
    let procedure = Procedure { from_kmh: 240.0, to_kmh: 260.0, ..Procedure::default() };
    let study = Question { procedure, ascent: false, fold: false, strokes_m: STROKES_M.to_vec() };
    let varied = Varied { scenario: place.join("bogie.toml"), grid: Grid::default() };
    VariedStudy { varied, study }
}
