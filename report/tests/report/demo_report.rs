//! A report with every element: made-up damper-like data, 20 s at 1 kHz. No physics in it.

use report::{Cell, Plot, Report, Section, Table, Tile, equal_bins, logarithmic_bins};

/// Twenty seconds of a stroke with a slow beat, and the force of a worn damper under it.
struct Record {
    time_s: Vec<f64>,
    stroke_mm: Vec<f64>,
    force_kn: Vec<f64>,
    velocity_mm_per_s: Vec<f64>,
}

fn record(clearance_mm: f64, phase: f64) -> Record {
    let time_s: Vec<f64> = (0..20_000).map(|k| f64::from(k) * 1e-3).collect();
    let stroke_mm: Vec<f64> = time_s
        .iter()
        .map(|t| {
            let beat = 2.2 + 1.1 * libm::sin(0.7 * t + phase);
            beat * libm::sin(21.4 * t + phase) + 0.05 * libm::sin(173.0 * t)
        })
        .collect();
    let mut body_mm = stroke_mm[0];
    let mut force_kn = Vec::new();
    for &x in &stroke_mm {
        // A spring with a gap in series with a dashpot that relieves: enough for a loop.
        let gap = x - body_mm;
        let free = 0.5 * clearance_mm;
        let stretch = gap - gap.clamp(-free, free);
        let force = (12.5 * stretch).clamp(-18.0, 18.0);
        body_mm += 1e-3 * force / 0.22;
        force_kn.push(force);
    }
    let velocity_mm_per_s = (0..stroke_mm.len())
        .map(|k| if k == 0 { 0.0 } else { (stroke_mm[k] - stroke_mm[k - 1]) * 1e3 })
        .collect();
    Record { time_s, stroke_mm, force_kn, velocity_mm_per_s }
}

/// Repeatable noise between -1 and 1.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }
}

/// The report of `examples/demo.rs` and of the browser test.
pub(crate) fn demo() -> Report {
    let new = record(0.2, 0.0);
    let worn = record(4.0, 0.9);
    Report::new("Every element of a report")
        .subtitle("Made-up data in the shape of a yaw damper's, 20 s at 1 kHz")
        .fact("scenario", "scenarios/demo <no file>.toml")
        .fact("seed", "1")
        .fact("trajectory", "9f86d081884c7d65")
        .section(summary(&new))
        .section(time_histories(&new, &worn))
        .section(loops(&new, &worn))
        .section(spectra())
        .section(timing())
        .section(sweeps())
        .section(closing())
}

fn summary(new: &Record) -> Section {
    let peak = new.force_kn.iter().copied().fold(0.0, f64::max);
    Section::new("Summary")
        .text("A paragraph of plain text. It may hold <tags>, \"quotes\" & ampersands.\n\nAn empty line starts another paragraph.")
        .tiles([
            Tile::text("state", "completed").good(),
            Tile::number("largest force", peak, "kN"),
            Tile::number("stroke, mean peak", 3.46159, "mm"),
            Tile::count("cycles", 20_000),
            Tile::number("cycle time p99.9", 312.25, "µs"),
            Tile::count("frames lost", 3).bad(),
            Tile::number("energy error", 7.568e-5, ""),
        ])
        .table(
            Table::new("Dampers")
                .text("damper")
                .text("place")
                .number("force min", "kN")
                .number("force max", "kN")
                .number("force rms", "kN")
                .number_with_digits("stroke rms", "mm", 3)
                .number("frequency", "Hz")
                .number("work", "J/s")
                .row(damper_row("front left", "rig", [-18.0, 18.0, 11.374, 1.618, 3.406, 52.18]))
                .row(damper_row("front right", "modelled", [-18.0, 18.0, 11.36, 1.611, 3.406, 51.9]))
                .row(damper_row("rear left", "modelled", [-9.21, 9.44, 4.0312, 0.613, 3.4, 10.052]))
                .row([
                    "rear right".into(),
                    "modelled | off".into(),
                    Cell::Empty,
                    Cell::Empty,
                    0.0.into(),
                    0.0.into(),
                    Cell::Empty,
                    7.568e-5.into(),
                ]),
        )
        .note("A note: the profile in use is calibrated and not measured.")
        .warning("3 frames were lost; the force of those cycles was held.")
}

fn damper_row(name: &str, place: &str, values: [f64; 6]) -> Vec<Cell> {
    [Cell::from(name), Cell::from(place)].into_iter().chain(values.map(Cell::from)).collect()
}

fn time_histories(new: &Record, worn: &Record) -> Section {
    let mut noise = noise(7);
    let acceleration = |gain: f64, omega: f64, noise: &mut dyn FnMut() -> f64| -> Vec<f64> {
        new.time_s.iter().map(|t| gain * (libm::sin(omega * t) + 0.6 * noise())).collect()
    };
    let wheelset = acceleration(2.4, 21.4, &mut noise);
    let bogie = acceleration(0.9, 21.4, &mut noise);
    let carbody = acceleration(0.12, 8.0, &mut noise);
    Section::new("Time histories")
        .plot(
            Plot::new("Lateral acceleration, one panel for each body")
                .x("time", "s")
                .y("wheelset 1", "m/s²")
                .line("wheelset 1", &new.time_s, &wheelset)
                .panel_below("bogie", "m/s²")
                .line("bogie, front", &new.time_s, &bogie)
                .limit("limit", 1.3)
                .panel_below("carbody", "m/s²")
                .line("carbody", &new.time_s, &carbody)
                .span("curve", 8.0..=13.0)
                .at("damper off", 15.0)
                .caption("Wheelset above bogie above carbody, as it should be."),
        )
        .plot(
            Plot::new("Yaw damper force, with one swing enlarged")
                .x("time", "s")
                .y("force", "kN")
                .line("front left, new", &new.time_s, &new.force_kn)
                .line("front right, worn", &worn.time_s, &worn.force_kn)
                .limit("relief", 18.0)
                .limit("relief", -18.0)
                .zoom(
                    "one swing: the worn damper rests while it crosses its clearance",
                    10.0..=10.5,
                ),
        )
}

fn loops(new: &Record, worn: &Record) -> Section {
    Section::new("Loops")
        .text("The area of a loop is the work of one cycle.")
        .plots([
            Plot::new("Force over displacement")
                .x("displacement", "mm")
                .y("force", "kN")
                .line("new", &new.stroke_mm[9_000..11_400], &new.force_kn[9_000..11_400])
                .line(
                    "worn, 2a = 4 mm",
                    &worn.stroke_mm[9_000..11_400],
                    &worn.force_kn[9_000..11_400],
                )
                .height_px(400),
            Plot::new("Force over velocity")
                .x("velocity", "mm/s")
                .y("force", "kN")
                .scatter("new", &new.velocity_mm_per_s, &new.force_kn)
                .scatter("worn, 2a = 4 mm", &worn.velocity_mm_per_s, &worn.force_kn)
                .height_px(400),
        ])
        .plot(
            Plot::new("The dead zone")
                .x("displacement", "mm")
                .y("force", "kN")
                .line("worn, 2a = 4 mm", &worn.stroke_mm, &worn.force_kn)
                .zoom_box("around zero force", -2.5..=2.5, -4.0..=4.0)
                .height_px(360),
        )
        .plot(
            Plot::new("A path in equal scales")
                .x("lateral", "mm")
                .y("vertical", "mm")
                .line("axle", &new.stroke_mm[..3_000], &worn.stroke_mm[..3_000])
                .equal_aspect()
                .height_px(420),
        )
}

fn spectra() -> Section {
    let mut noise = noise(3);
    let frequency: Vec<f64> = (1..=10_000).map(|k| f64::from(k) * 0.05).collect();
    let mut density = |peak_hz: f64, level: f64| -> Vec<f64> {
        frequency
            .iter()
            .map(|f| {
                let r = f / peak_hz;
                level * (1.2 + noise()) / ((1.0 - r * r) * (1.0 - r * r) + 0.02 * r * r)
            })
            .collect()
    };
    let (soft, stiff) = (density(3.2, 1e-3), density(3.8, 4e-4));
    Section::new("Spectra").plot(
        Plot::new("Power spectral density of the bogie's lateral acceleration")
            .x("frequency", "Hz")
            .y("PSD", "(m/s²)²/Hz")
            .log_x()
            .log_y()
            .line("Ke = 3 MN/m", &frequency, &soft)
            .line("Ke = 15 MN/m", &frequency, &stiff)
            .note("3.8 Hz", 3.8, 0.02)
            .x_range(0.1..=500.0),
    )
}

fn timing() -> Section {
    let mut noise = noise(11);
    let times_us: Vec<f64> =
        (0..20_000).map(|_| 60.0 * libm::exp(0.35 * (noise() + noise() + noise()))).collect();
    let jitter: Vec<f64> = (0..20_000).map(|_| 4.0 * (noise() + noise() + noise())).collect();
    let (edges, counts) = logarithmic_bins(&times_us, 60);
    let (jitter_edges, jitter_counts) = equal_bins(&jitter, 50);
    Section::new("Timing and bus").plots([
        Plot::new("Cycle time")
            .x("cycle time", "µs")
            .y("cycles", "")
            .log_x()
            .log_y()
            .bars("cycles", &edges, &counts)
            .at("p99", 157.0),
        Plot::new("Jitter of the wake-up").x("jitter", "µs").y("cycles", "").bars(
            "cycles",
            &jitter_edges,
            &jitter_counts,
        ),
    ])
}

fn sweeps() -> Section {
    let stiffness: Vec<f64> = (3..=15).map(f64::from).collect();
    let clearance: Vec<f64> = (0..=12).map(|k| 0.2 + f64::from(k) * 0.65).collect();
    let speed = |ke: f64, gap: f64| 262.0 - 150.0 / ke - 11.0 * gap * (1.0 - 0.02 * ke);
    let mean: Vec<f64> = stiffness.iter().map(|&k| speed(k, 0.2)).collect();
    let low: Vec<f64> = mean.iter().map(|v| v - 4.0).collect();
    let high: Vec<f64> = mean.iter().map(|v| v + 6.0).collect();
    let paper: Vec<f64> = stiffness.iter().map(|k| 212.0 + 4.0 * (k - 3.0)).collect();
    let map: Vec<f64> =
        clearance.iter().flat_map(|&g| stiffness.iter().map(move |&k| speed(k, g))).collect();
    Section::new("Sweeps, maps, rankings")
        .plots([
            Plot::new("Critical speed over stiffness")
                .x("Ke", "MN/m")
                .y("critical speed", "km/h")
                .band("range of 5 seeds", &stiffness, &low, &high)
                .points("mean", &stiffness, &mean)
                .dashed("paper", &stiffness, &paper),
            Plot::new("Critical speed over stiffness and clearance")
                .x("Ke", "MN/m")
                .y("2a", "mm")
                .map("critical speed", "km/h", &stiffness, &clearance, &map),
        ])
        .plot(
            Plot::new("Candidates by held-out error")
                .x("held-out error", "% of rms force")
                .named_bars(
                    "held-out error",
                    &["seal_friction", "asymmetric_damping", "cavitation", "none <refitted>"],
                    &[2.1, 6.4, 9.0, 9.2],
                ),
        )
        .preformatted("F = Ce v   for |F| <= F_relief\nF_seal = Fc + (Fs - Fc) exp(-|v| / vs)")
}

fn closing() -> Section {
    Section::new("What could not be tested").table(
        Table::new("Not testable on these records")
            .text("effect")
            .text("why")
            .text("test that would show it")
            .row(["clearance_impact".into(), "needs 5 kHz".into(), "sine, 2 mm, 4 Hz".into()])
            .row(["temperature_fade".into(), "constant <20 °C>".into(), "warm-up".into()]),
    )
}
