//! What is said of dampers that are near an effect without having its equation.

use crate::support::{SERIES, investigate, names, sensors};
use identification::result::Errors;
use signal::random::Random;
use virtual_bench::series_model::neighbour::{Draw, NEIGHBOURS, NeighbourDamper, Reach};

/// How far the sines of the tests reach.
const REACH: Reach =
    Reach { speed_m_per_s: 0.154, stroke_m: 7e-3, extension_m: 7e-3, compression_m: 7e-3 };

#[test]
#[ignore = "a table of some twenty minutes"]
fn table_of_neighbours() {
    for (which, info) in NEIGHBOURS.iter().enumerate() {
        let draw = Draw::new(which, SERIES, REACH, &mut Random::new(21, which as u64));
        let specimen = NeighbourDamper { model: SERIES, neighbour: Some(draw.at(0.12)) };
        let found = investigate(&specimen, &sensors());
        let near = info.near.unwrap_or("-");
        let errors = &found.result.errors;
        let train = |errors: Option<Errors>| errors.map_or(f64::NAN, |errors| errors.train_rmse_n);
        println!(
            "{:22} near {near:20} {:?} {:?}: {:.0} N, {:.0} N with effects, floor {:?} N",
            info.name,
            names(&found),
            found.result.verdict,
            train(errors.refitted),
            train(errors.with_effects),
            found.result.noise_floor_n,
        );
    }
}
