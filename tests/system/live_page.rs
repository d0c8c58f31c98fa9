//! `yawbench run --serve`: a page that shows a run and ends it, for its own browser and for nobody
//! else.

use crate::support::command::{folder, output, repository, yawbench};
use crate::support::live_page::ServedRun;
use crate::support::schema::misfits;
use report::browser::Driven;
use serde_json::Value;
use std::io::{Read as _, Write as _};
use std::net::TcpListener;

/// A run that is longer than any test: it is ended from the page. Without a clock a machine that is
/// busy makes no cycle late, which could end the run before; the creep law that takes longest makes
/// it last without asking for gigabytes of free disk.
fn long_run() -> ServedRun {
    let place = folder("long-run");
    let read =
        |name: &str| std::fs::read_to_string(repository().join("scenarios").join(name)).unwrap();
    let fastsim = "{ fastsim = { cells_along = 16, cells_across = 16 } }";
    let vehicle = read("vehicles/ss9.toml").replace("\"linear_saturated\"", fastsim);
    assert!(vehicle.contains(fastsim), "{vehicle}");
    std::fs::write(place.join("slow.toml"), vehicle).unwrap();
    let scenario = read("ss9-160kmh.toml").replace("vehicles/ss9.toml", "slow.toml");
    let path = place.join("long.toml");
    std::fs::write(&path, scenario).unwrap();
    let run = ServedRun::begin(&path, &["--duration", "600", "--pace", "fast"]);
    std::fs::remove_dir_all(place).unwrap();
    run
}

#[test]
fn a_page_shows_a_run_and_its_button_ends_it() {
    let run = long_run();
    let (mut facts, mut rows, mut has_pressed) = (Value::Null, Vec::new(), false);
    let (mut states, mut last) = (Vec::new(), Value::Null);
    for (name, event) in run.events() {
        if name == "facts" {
            facts = event;
            continue;
        }
        let state = event["state"].as_str().unwrap().to_owned();
        if states.last() != Some(&state) {
            states.push(state);
        }
        let new = event["update"]["samples"].as_array().cloned().unwrap_or_default();
        rows.extend(new.iter().map(|row| row[0].as_i64().unwrap()));
        if states.last().is_some_and(|state| state == "RUN") && !has_pressed {
            assert_eq!(run.press(), 200);
            has_pressed = true;
        }
        last = event;
    }
    let outcome = run.finish();
    assert_eq!(outcome.code, Some(0), "{}", outcome.errors);
    let said = "ended from the page: the files hold the run up to this point";
    assert!(outcome.errors.contains(said), "{}", outcome.errors);
    assert_eq!(outcome.summary["state"], "stopped");
    assert_eq!(outcome.summary["stopped_by"], "page");
    let schema = std::fs::read_to_string(repository().join("docs/schema/summary.schema.json"));
    let schema = serde_json::from_str(&schema.unwrap()).unwrap();
    assert_eq!(misfits(&schema, &outcome.summary), Vec::<String>::new());

    assert_eq!(facts["slots"][0]["place"], "front left");
    let is = |slot: usize| facts["slots"][slot]["is"].as_str().unwrap();
    assert_eq!((is(0), is(1)), ("rig", "modelled"));
    // What comes before RUN may pass between two looks; the last row is one of RAMP_OUT.
    let end: Vec<&str> = states.iter().rev().take(2).rev().map(String::as_str).collect();
    assert_eq!(end, ["RUN", "RAMP_OUT"], "{states:?}");
    assert!(states.iter().all(|state| !state.is_empty()), "{states:?}");
    assert!(rows.len() > 50 && rows.is_sorted(), "{} rows", rows.len());
    let words = last["end"]["words"].as_str().unwrap();
    assert!(words.starts_with("The run has ended: ended from the page"), "{words}");
    assert!(last["end"]["files"].as_str().unwrap().contains("report.html"), "{last}");
    let update = &last["update"];
    assert_eq!(update["cycle"], outcome.summary["cycles"]);
    assert_eq!(update["timing"]["skipped"], outcome.summary["overruns"]);
    let interlocks = update["interlocks"].as_array().unwrap();
    let tracking = interlocks.iter().find(|lock| lock["check"] == "tracking").unwrap();
    assert!(tracking["margin_percent"].as_f64().is_some_and(|margin| margin > 0.0), "{tracking}");
    assert_eq!(tracking["action"], "power off");
    assert_eq!(update["rigs"][0]["slot"], 0);
}

#[test]
fn nobody_but_its_own_page_is_answered() {
    let run = long_run();
    let (own, token) = (format!("http://{}", run.address), run.token());
    let (origin, token) = (("Origin", own.as_str()), ("X-Yawbench-Token", token.as_str()));
    let evil = ("Origin", "http://evil.example");
    for (line, fields, status) in [
        ("POST /ramp-out", &[][..], 403),
        ("POST /ramp-out", &[origin], 403),
        ("POST /ramp-out", &[token], 403),
        ("POST /ramp-out", &[evil, token], 403),
        ("POST /ramp-out", &[origin, ("X-Yawbench-Token", "0")], 403),
        ("POST /ramp-out", &[origin, token, ("Sec-Fetch-Site", "cross-site")], 403),
        ("POST /ramp-out", &[origin, token, ("Content-Length", "9")], 413),
        ("POST /ramp-out", &[origin, token, ("Transfer-Encoding", "chunked")], 400),
        ("GET /ramp-out", &[origin, token], 405),
        ("OPTIONS /ramp-out", &[evil], 403),
        ("GET /events", &[evil], 403),
        ("GET /", &[("Host", "evil.example")], 400),
        ("POST /arm", &[origin, token], 404),
        ("GET /../summary.json", &[], 404),
        ("GET /record.npy", &[], 404),
    ] {
        let (answered, text) = run.ask(line, fields);
        assert_eq!(answered, status, "{line} {fields:?}: {text}");
        assert!(!text.contains("Access-Control"), "{text}");
    }
    let rebound = "GET / HTTP/1.1\r\nHost: evil.example:80\r\n\r\n";
    assert_eq!(run.answer_to(rebound.as_bytes()).0, 403);
    let long = format!("GET / HTTP/1.1\r\nCookie: {}\r\n\r\n", "a".repeat(100_000));
    assert_eq!(run.answer_to(long.as_bytes()).0, 431);
    for garbage in [&b"\x16\x03\x01\x02\x00"[..], b"\r\n\r\n", b"\0\0\0\0", b"GET\r\n\r\n"] {
        assert_eq!(run.answer_to(garbage).0, 400, "{garbage:?}");
    }
    // Idle connections and streams that nobody reads leave the button room.
    let idle: Vec<_> = (0..30)
        .map(|number| {
            let mut line = run.connect();
            let begin = if number % 2 == 0 { "GET /events HTTP/1.1\r\nHost: " } else { "GET /" };
            let rest =
                if number % 2 == 0 { format!("{}\r\n\r\n", run.address) } else { String::new() };
            // It may have been hung up on already, for the next one.
            let _ = line.write_all(format!("{begin}{rest}").as_bytes());
            line
        })
        .collect();
    assert_eq!(run.press(), 200);
    drop(idle);
    let outcome = run.finish();
    assert_eq!(outcome.code, Some(0), "{}", outcome.errors);
}

#[test]
fn a_request_that_does_not_end_is_answered_and_closed() {
    let run = long_run();
    let mut slow = run.connect();
    slow.write_all(b"GET / HTTP/1.1\r\nHost: ").unwrap();
    let mut answer = String::new();
    // The server's patience is the clock of this test.
    slow.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 408 "), "{answer}");
    assert_eq!(run.press(), 200);
    assert_eq!(run.finish().code, Some(0));
}

#[test]
fn an_address_that_cannot_be_served_is_one_line_and_nothing_is_written() {
    let busy = TcpListener::bind("127.0.0.1:0").unwrap();
    let busy = busy.local_addr().unwrap().to_string();
    for (address, expected) in [
        ("0.0.0.0:8080", "expected a loopback address with a port"),
        ("192.0.2.1:0", "`ssh -L 8080:127.0.0.1:8080`"),
        ("8080", "expected a loopback address with a port, such as 127.0.0.1:8080"),
        (busy.as_str(), "expected a free port (Address already in use"),
    ] {
        let out = folder("not-served").join("out");
        let mut run = yawbench();
        run.arg("run").arg(repository().join("scenarios/ss9-160kmh.toml"));
        run.args(["--pace", "fast", "--duration", "1", "--serve", address, "--out"]);
        let result = output(run.arg(&out));
        let errors = String::from_utf8_lossy(&result.stderr);
        assert_eq!(result.status.code(), Some(2), "{address}: {errors}");
        assert!(errors.contains(&format!("--serve {address}")), "{errors}");
        assert!(errors.contains(expected) && errors.lines().count() == 1, "{errors}");
        assert!(!out.exists(), "{address}: something was written");
    }
}

#[test]
fn what_a_scenario_says_of_itself_is_text_on_the_page() {
    let place = folder("scenario-of-somebody-else");
    let scenario = std::fs::read_to_string(repository().join("scenarios/ss9-160kmh.toml")).unwrap();
    let vehicles = repository().join("scenarios/vehicles");
    let scenario = scenario.replace("\"vehicles", &format!("\"{}", vehicles.display()));
    let title = "<img src=x onerror='document.title=1'></script>\\r\\n\\r\\nevent: end";
    let scenario = format!("title = \"{title}\"\n{scenario}");
    let path = place.join("evil.toml");
    std::fs::write(&path, scenario).unwrap();
    let run = ServedRun::begin(&path, &["--pace", "fast", "--duration", "2"]);
    let events: Vec<(String, Value)> = run.events().collect();
    let shown: Vec<&str> = events.iter().map(|(name, _)| name.as_str()).collect();
    assert!(shown.iter().all(|name| matches!(*name, "facts" | "now")), "{shown:?}");
    let facts = events.iter().find(|(name, _)| name == "facts").map(|(_, facts)| facts);
    let title = facts.unwrap()["title"].as_str().unwrap();
    assert!(title.starts_with("<img src=x") && title.ends_with("event: end"), "{title}");
    assert_eq!(run.finish().code, Some(0));
    std::fs::remove_dir_all(place).unwrap();
}

#[test]
fn a_damper_for_which_a_rig_stands_is_named_as_such_and_warned_of() {
    let scenario = repository().join("scenarios/ss9-two-rigs-partner.toml");
    let run = ServedRun::begin(&scenario, &["--pace", "fast", "--duration", "8"]);
    let events: Vec<(String, Value)> = run.events().collect();
    let outcome = run.finish();
    assert_eq!(outcome.code, Some(0), "{}", outcome.errors);
    let facts = events.iter().find(|(name, _)| name == "facts").map(|(_, facts)| facts).unwrap();
    let partner = &facts["slots"][1];
    assert_eq!((&partner["is"], &partner["of"]), (&"partner".into(), &"front left".into()));
    assert_eq!(partner["is_reversed"], true);
    assert_eq!((&facts["slots"][0]["is"], &facts["slots"][0]["of"]), (&"rig".into(), &Value::Null));
    let end = &events.last().unwrap().1["end"];
    let warned = end["warnings"].as_array().unwrap().iter();
    let warned: Vec<&str> = warned.filter_map(Value::as_str).collect();
    let of_partner: Vec<&&str> =
        warned.iter().filter(|warning| warning.starts_with("front right: the force of")).collect();
    assert!(
        of_partner.len() == 1 && of_partner[0].contains("% rms away from moving oppositely"),
        "{warned:#?}"
    );
}

#[test]
fn a_browser_sees_traces_move_and_its_button_ends_the_run() {
    let run = long_run();
    let address = format!("http://{}/", run.address);
    let visited = Driven::visit(&address, (390, 844)).unwrap_or_else(|error| panic!("{error}"));
    let Some(mut browser) = visited else {
        assert_eq!(run.press(), 200);
        return;
    };
    let root = "document.documentElement.dataset";
    browser.wait_until(&format!("{root}.state === 'RUN' && Number({root}.drawn) > 5")).unwrap();
    // The traces move: other pixels, of a later time. They are drawn some frames after it is known.
    let picture = "document.getElementById('forces').toDataURL()";
    browser.evaluate(&format!("window.before = {picture}; 0")).unwrap();
    let time = browser.evaluate(&format!("{root}.time")).unwrap();
    let later = format!("Number({root}.time) > {} + 500", time.as_str().unwrap());
    browser.wait_until(&later).unwrap();
    browser.wait_until(&format!("{picture} !== window.before")).unwrap();
    // On a phone too the bar of an interlock is in sight without scrolling.
    let meter = "document.querySelector('#interlocks meter').getBoundingClientRect()";
    let loops = "[...document.querySelectorAll('#loops canvas')]";
    for (what, expected) in [
        ("document.querySelectorAll('#loops canvas').length", Value::from(4)),
        // 14 checks of the rig, and the limits of its commands.
        ("document.querySelectorAll('#interlocks tr').length", Value::from(17)),
        (&format!("{meter}.right <= innerWidth && {meter}.width > 40"), true.into()),
        (
            "(() => { const cells = document.querySelector('#interlocks tr').cells; \
              const [used, bar] = [Number(cells[2].textContent), cells[3].firstElementChild.value]; \
              return Math.abs(used - 100 * bar) < 1; })()",
            true.into(),
        ),
        ("document.querySelector('#loops figcaption').textContent", "front left (rig)".into()),
        // All loops have one scale, with units.
        (&format!("new Set({loops}.map((one) => one.dataset.across)).size"), 1.into()),
        (&format!("new Set({loops}.map((one) => one.dataset.up)).size"), 1.into()),
        ("/^(\\S+ ){3,}mm$/.test(document.getElementById('loop-0').dataset.across)", true.into()),
        ("/^(\\S+ ){3,}kN$/.test(document.getElementById('loop-0').dataset.up)", true.into()),
        // The last label of the histogram is whole: no ink at the edge, where it was cut.
        ("document.getElementById('histogram').dataset.across", "1 10 100 1000 10000 µs".into()),
        (
            "(() => { const canvas = document.getElementById('histogram'); \
              const [pen, right] = [canvas.getContext('2d'), canvas.width - 1]; \
              const edge = pen.getImageData(right, 0, 1, canvas.height).data; \
              return edge.every((value) => value === 0); })()",
            true.into(),
        ),
        ("document.querySelectorAll('#rigs tr').length", Value::from(1)),
        ("document.querySelectorAll('#times tr').length", Value::from(1)),
        ("document.getElementById('end').hidden", true.into()),
        ("document.documentElement.scrollWidth <= innerWidth", true.into()),
        (
            "performance.getEntriesByType('resource').every((one) => one.name.startsWith(location.origin))",
            true.into(),
        ),
    ] {
        assert_eq!(browser.evaluate(what).unwrap(), expected, "{what}");
    }
    // In sight wherever the page is scrolled to.
    let in_sight = "(() => { scrollTo(0, document.body.scrollHeight); \
                    const place = document.getElementById('ramp-out').getBoundingClientRect(); \
                    return place.top >= 0 && place.bottom <= innerHeight && place.height >= 44; })()";
    assert_eq!(browser.evaluate(in_sight).unwrap(), true);
    // An inline script is refused, whoever brings it in.
    let inline = "(() => { const one = document.createElement('script'); \
                  one.textContent = 'window.ran = true'; document.body.append(one); \
                  return window.ran === undefined; })()";
    assert_eq!(browser.evaluate(inline).unwrap(), true);
    browser.evaluate("document.getElementById('ramp-out').click()").unwrap();
    browser.wait_until("!document.getElementById('end').hidden").unwrap();
    browser
        .wait_until("document.getElementById('end-files').textContent.includes('report.html')")
        .unwrap();
    let words = browser.evaluate("document.getElementById('end-words').textContent").unwrap();
    assert!(words.as_str().unwrap().contains("ended from the page"), "{words}");
    let asked = browser.evaluate("document.getElementById('asked').textContent").unwrap();
    assert_eq!(asked, "Ramp-out asked for.");
    assert_eq!(browser.evaluate(&format!("{root}.errors")).unwrap(), "0");
    assert_eq!(browser.evaluate(&format!("{root}.state")).unwrap(), "ended");
    let outcome = run.finish();
    assert_eq!((outcome.code, &outcome.summary["stopped_by"]), (Some(0), &"page".into()));
}
