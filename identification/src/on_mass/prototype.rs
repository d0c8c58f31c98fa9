use super::*;
use measurement::body_record::*;
use std::path::PathBuf;
use std::time::Instant;

#[test]
#[ignore = "prototype"]
fn bouc_wen() {
    let dir = PathBuf::from(std::env::var("YAWBENCH_RECORDS").unwrap()).join("bouc-wen");
    let text = "sample_rate_hz = 750\n[on_mass]\nstart=\"rest\"\n[[file]]\nnamed=\"*multisine*\"\n[file.on_mass]\nperiod_samples = 8192\n";
    let map = std::env::temp_dir().join("bw.toml");
    std::fs::write(&map, text).unwrap();
    let read = |name: &str| {
        read_body_records(&[dir.join(name)], Some(&map)).unwrap().into_iter().map(record::Record::new).collect::<Vec<_>>()
    };
    let mut train = read("train-multisine.csv");
    let mut test = read("test-multisine.csv");
    test.extend(read("test-sinesweep.csv"));
    println!("noise {:?} of mean {:?}", train[0].noise, train[0].noise_of_mean());
    let t = Instant::now();
    println!("{:?} {:.2?}", linear::start(&train), t.elapsed());
    let progress = |[done, of]: [usize; 2], what: &str| println!("{:.1?} {done}/{of} {what}", t.elapsed());
    let stop = std::sync::atomic::AtomicBool::new(false);
    let control = OnMassControl { progress: &progress, stop: &stop };
    let found = search::search(&mut train, &[], control).unwrap();
    println!("substeps {} warm {}", train[0].substeps(), train[0].warm_up);
    for round in &found.rounds {
        println!("accepted {:?}, alt {:?}", round.accepted.map(|l| l.name), round.alternatives.iter().map(|l| l.name).collect::<Vec<_>>());
        for c in &round.candidates {
            if let Some(j) = &c.judged {
                println!("  {:24} train {:.4e} left out {:.4e} {:.3?}", c.law.name, j.rms(&train), j.left_out_rms(&train), &j.fit.values);
            } else { println!("  {} none", c.law.name); }
        }
    }
    for stage in &found.stages {
        println!("stage {:?} train {:.4e} left out {:.4e}: {:?}", stage.model.laws.iter().map(|l| l.name).collect::<Vec<_>>(), stage.rms(&train), stage.left_out_rms(&train), stage.fit.values);
        for r in &mut test {
            r.set_substeps(train[0].substeps());
            let motion = stage.model.simulate(&stage.fit.values, r, [0.0; 2]).unwrap();
            println!("    {} {:.4e}", r.name, periods::rms(motion.iter().zip(&r.motion).map(|(a, b)| a - b)));
        }
    }
    let last = found.stages.last().unwrap();
    let fit = search::refined(last, &mut train, control);
    println!("refined {:?} {:.1?}", fit.values, t.elapsed());
    for r in &mut test {
        r.set_substeps(train[0].substeps());
        let motion = last.model.simulate(&fit.values, r, [0.0; 2]).unwrap();
        println!("    {} {:.4e}", r.name, periods::rms(motion.iter().zip(&r.motion).map(|(a, b)| a - b)));
        let n = motion.len() / 10;
        println!("    {} first tenth {:.4e}", r.name, periods::rms(motion.iter().zip(&r.motion).take(n).map(|(a, b)| a - b)));
    }
}
