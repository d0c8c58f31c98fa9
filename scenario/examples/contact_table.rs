//! Writes the contact table of a wheel on a rail as CSV, for a look with any plotting program:
//! `cargo run -p scenario --example contact_table -- jm3_like > table.csv`

use firmware_core::wheel_rail::geometry::{TABLE_FIRST_SHIFT_M, TABLE_STEP_M};
use scenario::ScenarioError;
use scenario::contact_geometry::{ContactPair, Placement};
use scenario::profile::{Jm3Like, cn60, jm3_like, lma, s1002, uic60};

fn main() -> Result<(), ScenarioError> {
    let name = std::env::args().nth(1).unwrap_or_else(|| "jm3_like".to_owned());
    let pair = match name.as_str() {
        "lma" => ContactPair::new(&lma(), cn60(), Placement::CHINA)?,
        "s1002" => ContactPair::new(&s1002(), uic60(), Placement::UIC)?,
        _ => ContactPair::new(&jm3_like(&Jm3Like::default())?, cn60(), Placement::CHINA)?,
    };
    let tables = pair.tables();
    print!("zone,shift_m,touch_m,slope,radius_deviation_m,lateral_m,");
    println!("curvature_lateral_per_m,rail_radius_m");
    for (zone, rows) in [("tread", &tables.tread), ("flange", &tables.flange)] {
        for (index, row) in rows.iter().enumerate() {
            let shift_m = TABLE_FIRST_SHIFT_M + index as f64 * TABLE_STEP_M;
            print!("{zone},{shift_m},{},{},", row.touch_m, row.slope);
            print!("{},{},", row.radius_deviation_m, row.lateral_m);
            println!("{},{}", row.curvature_lateral_per_m, row.rail_radius_m);
        }
    }
    Ok(())
}
