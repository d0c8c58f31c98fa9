//! Rides as a table, with the conditions for which they hold.

use super::answer::Point;
use super::assessment::Ride;
use super::grade::mean_comfort;
use super::procedure::Procedure;
use super::sperling::Direction;
use super::vibration::Vibration;
use crate::over_seeds::OverSeeds;
use crate::point_table::{self, key_cells, keyed};
use report::{Cell, Table};

const DIRECTIONS: [Direction; 2] = [Direction::Lateral, Direction::Vertical];

/// The points as text for a terminal, and under which conditions they hold.
pub(super) fn text(points: &[Point], procedure: &Procedure) -> String {
    point_table::text(&[table(points, procedure)], points, &conditions(points, procedure))
}

/// The points as a table.
pub(super) fn table(points: &[Point], procedure: &Procedure) -> Table {
    let mut table = keyed("Ride", points);
    for direction in DIRECTIONS {
        let name = direction.name();
        table = table.fixed(&format!("W {name}"), "", 2).written("over seeds", "").text("grade");
    }
    table = DIRECTIONS
        .iter()
        .fold(table, |table, direction| table.fixed(&format!("2019 {}", direction.name()), "", 2));
    table = table.fixed("N_MV", "", 2).text("EN 12299");
    for quantity in ["rms", "peak"] {
        for direction in DIRECTIONS {
            table = table.fixed(&format!("{quantity} {}", direction.name()), "m/s2", 2);
        }
    }
    table.fixed("bogie", "Hz", 2).rows(points.iter().map(|point| row(point, procedure)))
}

fn row(point: &Point, procedure: &Procedure) -> Vec<Cell> {
    let ride = point.answer.ride.as_ref();
    let mut row = key_cells(point);
    for direction in DIRECTIONS {
        let index = ride.and_then(|ride| worst_sperling(ride, direction));
        let range = |index: OverSeeds| format!("{:.2} to {:.2}", index.lowest, index.highest);
        row.push(index.map(|index| index.mean).into());
        row.push(index.map(range).into());
        row.push(index.map(|index| procedure.kind.grade(index.mean).name()).into());
    }
    let both = |of: fn(&Vibration) -> Option<f64>| {
        DIRECTIONS.map(|direction| {
            let worst = |ride: &Ride| ride.worst(|place| of(place.along(direction)));
            Cell::from(ride.and_then(worst))
        })
    };
    row.extend(both(|vibration| vibration.sperling_2019.map(|over| over.mean)));
    let n_mv = ride.and_then(|ride| ride.worst(|place| place.n_mv));
    row.push(n_mv.into());
    row.push(n_mv.map(mean_comfort).into());
    row.extend(both(|vibration| Some(vibration.rms_m_per_s2.mean)));
    row.extend(both(|vibration| Some(vibration.peak_m_per_s2.highest)));
    let peak = ride.and_then(|ride| ride.bogies.first()?.lateral.peaks.first());
    row.push(peak.map(|peak| peak.frequency_hz).into());
    row
}

/// The index of the floor's worse end, by windows of 20 s.
pub(super) fn worst_sperling(ride: &Ride, direction: Direction) -> Option<OverSeeds> {
    let all = ride.ends().iter().filter_map(|place| place.along(direction).sperling_1985);
    all.max_by(|a, b| a.mean.total_cmp(&b.mean))
}

/// What every ride holds for.
pub(super) fn conditions(points: &[Point], procedure: &Procedure) -> Vec<String> {
    let rides = || points.iter().filter_map(|point| point.answer.ride.as_ref());
    let mut tracks: Vec<String> = rides().map(|ride| ride.track.in_words()).collect();
    tracks.dedup();
    let speeds: Vec<f64> = rides().map(|ride| ride.speed_kmh).collect();
    let speed = match signal::statistics::min_max(&speeds) {
        Some((low, high)) if high - low > 1e-6 => format!("{low:.0} to {high:.0} km/h"),
        Some((low, _)) => format!("{low:.0} km/h"),
        None => "-".to_owned(),
    };
    let [excellent, good, qualified] = procedure.kind.sperling();
    vec![
        format!(
            "{speed} on straight {}; {} s of each after {} s of run-in",
            tracks.join("; "),
            procedure.section_s,
            procedure.run_in_s
        ),
        format!(
            "floor {} m above the rails on the centre line above the bogies, the worse of them; \
             accelerations against the track, peaks below 40 Hz",
            procedure.floor_height_m
        ),
        format!(
            "W: Sperling index of GB 5599-85 with windows of 20 s, mean and range over seeds; excellent \
             to {excellent}, good to {good}, qualified to {qualified} ({}); 2019: GB/T 5599-2019 with \
             windows of 5 s",
            match procedure.kind {
                super::grade::Kind::Locomotive => "locomotives",
                super::grade::Kind::Coach => "coaches",
            }
        ),
        "N_MV: mean comfort of EN 12299 from two directions, blocks of 5 s; below 1.5 very comfortable, \
         2.5 comfortable, 3.5 medium"
            .to_owned(),
        "bogie: highest peak of the first bogie's lateral acceleration between 0.5 and 20 Hz".to_owned(),
    ]
}
