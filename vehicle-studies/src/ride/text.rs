//! Rides as a table in print, with the conditions for which they hold.

use super::answer::Point;
use super::assessment::Ride;
use super::procedure::Procedure;
use super::sperling::Direction;
use super::vibration::Vibration;
use crate::over_seeds::OverSeeds;
use crate::text_table::{pace, table};
use scenario::setting::Setting;

/// The points as a table for a terminal, and under which conditions they hold.
pub(super) fn text(points: &[Point], procedure: &Procedure) -> String {
    let mut rows = vec![heads(points)];
    rows.extend(points.iter().map(|point| cells(point, procedure)));
    let mut lines = table(&rows, points);
    lines.push(String::new());
    lines.extend(conditions(points, procedure));
    lines.extend(pace(points));
    lines.join("\n")
}

fn heads(points: &[Point]) -> Vec<String> {
    let keys = points.first().map(|point| point.at.as_slice()).unwrap_or_default();
    let mut heads: Vec<String> = keys.iter().map(Setting::called).collect();
    heads.extend(
        [
            "W lateral",
            "seeds",
            "grade",
            "W vertical",
            "seeds",
            "grade",
            "2019 lat",
            "2019 vert",
            "N_MV",
            "rms lat",
            "rms vert",
            "peak lat",
            "peak vert",
            "bogie Hz",
        ]
        .map(str::to_owned),
    );
    heads
}

fn cells(point: &Point, procedure: &Procedure) -> Vec<String> {
    let mut cells: Vec<String> = point.values_in_words();
    let Some(ride) = &point.answer.ride else { return cells };
    for direction in [Direction::Lateral, Direction::Vertical] {
        let index = worst_sperling(ride, direction);
        cells.push(index.map_or_else(dash, |index| format!("{:.2}", index.mean)));
        let range = |index: OverSeeds| format!("{:.2} to {:.2}", index.lowest, index.highest);
        cells.push(index.map_or_else(dash, range));
        let grade = |index: OverSeeds| procedure.kind.grade(index.mean).name().to_owned();
        cells.push(index.map_or_else(dash, grade));
    }
    let both = |of: fn(&Vibration) -> Option<f64>| {
        [Direction::Lateral, Direction::Vertical].map(|direction| {
            let worst = ride.worst(|place| of(place.along(direction)));
            worst.map_or_else(dash, |value| format!("{value:.2}"))
        })
    };
    cells.extend(both(|vibration| vibration.sperling_2019.map(|over| over.mean)));
    cells.push(ride.worst(|place| place.n_mv).map_or_else(dash, |n_mv| format!("{n_mv:.2}")));
    cells.extend(both(|vibration| Some(vibration.rms_m_per_s2.mean)));
    cells.extend(both(|vibration| Some(vibration.peak_m_per_s2.highest)));
    let bogie = ride.bogies.first().and_then(|bogie| bogie.lateral.peaks.first());
    cells.push(bogie.map_or_else(dash, |peak| format!("{:.2}", peak.frequency_hz)));
    cells
}

fn dash() -> String {
    "-".to_owned()
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
             accelerations in m/s2 against the track, peaks below 40 Hz",
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
        "bogie Hz: highest peak of the first bogie's lateral acceleration between 0.5 and 20 Hz".to_owned(),
    ]
}
