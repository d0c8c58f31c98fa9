//! The page as text: its skeleton, its escaping, what it must not contain, and its bytes.

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;
use report::{Error, Plot, Report, Samples, Section, Table, Tile};

use crate::demo_report;

/// The page without style, policy and scripts, which are the same in every report.
fn skeleton(report: &Report) -> String {
    let html = report.to_html().expect("a page");
    let body = html.split_once("<main>").expect("a main part").1;
    body.split_once("</main>").expect("an end").0.trim().to_owned()
}

fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).expect("a folder");
    path
}

#[test]
fn a_small_report_has_this_structure() {
    let report = Report::new("Run 7").subtitle("160 km/h").fact("seed", "1").section(
        Section::new("Summary")
            .text("One.\n\nTwo.")
            .tiles([Tile::number("force", 18.0124, "kN"), Tile::text("state", "ok").good()])
            .plot(
                Plot::new("Force")
                    .x("time", "s")
                    .y("force", "kN")
                    .line("front left", &[0.0, 0.5, 1.0], &[0.0, 1.234_567_89, f64::NAN])
                    .caption("Rises."),
            )
            .warning("Short."),
    );
    insta::assert_snapshot!(skeleton(&report), @r##"
    <header>
    <h1>Run 7</h1>
    <p class="subtitle">160 km/h</p>
    <dl class="facts">
    <div><dt>seed</dt><dd>1</dd></div>
    </dl>
    </header>
    <noscript><p class="note">The plots of this report need JavaScript; text and tables do not.</p></noscript>
    <section id="s1">
    <h2>Summary</h2>
    <p>One.</p>
    <p>Two.</p>
    <dl class="tiles">
    <div class="tile"><dt>force</dt><dd>18.01 <span class="unit">kN</span></dd></div>
    <div class="tile good"><dt>state</dt><dd><span class="sign">✓</span>ok</dd></div>
    </dl>
    <div class="figures">
    <figure id="f1">
    <figcaption><b>Figure 1.</b> Force</figcaption>
    <div class="views zooms-0">
    <div class="view"><p></p><div class="canvas" style="height:340px"></div></div>
    </div>
    <p class="caption">Rises.</p>
    <p class="small-print">front left: 1 of 3 samples are not finite and left out.</p>
    <script type="application/json">[{"data":[{"legendgroup":"0","line":{"color":"#0b4f8a","dash":"solid","width":2.0},"meta":"kN","mode":"lines","name":"front left","showlegend":true,"type":"scatter","x":[0,0.5,1],"y":[0,1.23457,null],"yaxis":"y"}],"layout":{"annotations":[],"bargap":0.0,"hovermode":"x unified","shapes":[],"showlegend":false,"xaxis":{"anchor":"y","title":{"text":"time (s)"}},"yaxis":{"autorangeoptions":{"include":[]},"domain":[0.0,1.0],"title":{"text":"force (kN)"}}}}]</script>
    </figure>
    </div>
    <p class="warning" role="alert">Short.</p>
    </section>
    "##);
}

#[test]
fn a_report_without_plots_carries_no_plot_library() {
    let html = Report::new("Words").section(Section::new("A").text("b")).to_html().expect("a page");
    assert!(html.len() < 30_000, "{} bytes", html.len());
}

#[test]
fn contents_appear_from_five_sections_on() {
    let with = |count: usize| {
        let report =
            (0..count).fold(Report::new("R"), |r, k| r.section(Section::new(&format!("Part {k}"))));
        skeleton(&report)
    };
    assert!(!with(4).contains("<nav>"));
    assert!(with(5).contains("<li><a href=\"#s5\">Part 4</a></li>"));
    assert!(with(5).contains("<section id=\"s5\">"));
}

#[test]
fn no_address_is_in_the_page() {
    let html = demo_report::demo().to_html().expect("a page");
    for scheme in ["http://", "https://", "ws://", "wss://", "ftp://"] {
        for (at, _) in html.match_indices(scheme) {
            let address: String = html[at..].chars().take(40).collect();
            assert!(address.starts_with("http://www.w3.org/"), "{address}");
        }
    }
    for loading in ["<link", "<img", "<iframe", "src=\"", "@import", "url(http"] {
        let own = html.split_once("plotly.js").expect("the library").0;
        assert!(!own.contains(loading), "{loading}");
    }
    let policy =
        html.split_once("http-equiv=\"Content-Security-Policy\" content=\"").expect("a policy").1;
    let policy: Vec<&str> = policy.split('"').next().expect("its end").split("; ").collect();
    for directive in ["default-src 'none'", "form-action 'none'", "base-uri 'none'"] {
        assert!(policy.contains(&directive), "{directive} is not in {policy:?}");
    }
}

#[test]
fn same_input_same_bytes() {
    let (a, b) = (demo_report::demo().to_html(), demo_report::demo().to_html());
    assert!(a.expect("a page") == b.expect("a page"));
}

#[test]
fn the_demo_of_twenty_seconds_stays_small() {
    let html = demo_report::demo().to_html().expect("a page");
    assert!(html.len() < 2_500_000, "{} bytes", html.len());
}

#[test]
fn writing_leaves_one_whole_file() {
    let folder = folder("writing");
    let path = folder.join("report.html");
    fs::write(&path, "old").expect("written");
    let report = Report::new("New");
    report.write_to(&path).expect("written");
    assert_eq!(fs::read_to_string(&path).expect("read"), report.to_html().expect("a page"));
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);
}

#[test]
fn a_report_that_cannot_be_written_leaves_nothing() {
    let folder = folder("not-writing");
    let path = folder.join("missing").join("report.html");
    let error = Report::new("R").write_to(&path).expect_err("no such folder");
    assert!(matches!(error, Error::Write { .. }), "{error}");
    assert!(error.to_string().starts_with(&format!("cannot write {}: ", path.display())));

    let occupied = folder.join("report.html");
    fs::create_dir(&occupied).expect("a folder in the way");
    Report::new("R").write_to(&occupied).expect_err("a folder is in the way");
    assert_eq!(fs::read_dir(&folder).expect("a folder").count(), 1);

    let bad = Section::new("S").table(Table::new("T").text("a").row([]));
    let refused = folder.join("refused.html");
    Report::new("R").section(bad).write_to(&refused).expect_err("a row without cells");
    assert!(!refused.exists());
}

#[test]
fn what_does_not_fit_is_named() {
    let error = |plot: Plot| {
        let report = Report::new("R").section(Section::new("S").plot(plot));
        report.to_html().expect_err("refused").to_string()
    };
    let plot = || Plot::new("P");
    assert_eq!(
        error(plot().line("a", &[1.0, 2.0], &[1.0])),
        "plot \"P\", trace \"a\": 2 x values but 1 y values"
    );
    assert_eq!(
        error(plot().bars("a", &[1.0, 2.0], &[1.0, 2.0])),
        "plot \"P\", trace \"a\": 1 x values but 2 y values"
    );
    assert_eq!(
        error(plot().map("z", "", &[1.0, 2.0], &[1.0], &[1.0])),
        "plot \"P\": the map has 1 values, its axes need 2"
    );
    assert_eq!(
        error(plot().span("s", 2.0..=1.0)),
        "plot \"P\", \"s\": 2 to 1 is no range on these axes"
    );
    assert_eq!(
        error(plot().log_x().zoom("z", 0.0..=1.0)),
        "plot \"P\", \"z\": 0 to 1 is no range on these axes"
    );
    assert_eq!(
        error(plot().limit("l", f64::NAN)),
        "plot \"P\", \"l\": NaN to NaN is no range on these axes"
    );
}

#[test]
fn thinning_and_gaps_are_stated_under_the_plot() {
    let x: Vec<f64> = (0..10_000).map(f64::from).collect();
    let mut y = x.clone();
    y[17] = f64::INFINITY;
    let plot = Plot::new("P").log_x().line("a", &x, &y);
    let page = skeleton(&Report::new("R").section(Section::new("S").plot(plot)));
    assert!(page.contains("Drawn with at most about 4000 of 10000 samples"));
    // The first x is zero and has no place on a log axis.
    assert!(page.contains("a: 2 of 10000 samples are not finite or not positive and left out."));
}

#[test]
fn the_caption_of_a_thinned_plot_had_the_number_of_samples_that_were_kept() {
    // Two of every hundred samples of a record were kept.
    let x: Vec<f64> = (0..10_000).map(f64::from).collect();
    let of = Samples { all: 500_000, not_finite: 3 };
    let short = &x[..1000];
    for (x, drawn) in [(&*x, "at most about 4000"), (short, "1000")] {
        let plot = Plot::new("P").line_of("a", x, x, of);
        let page = skeleton(&Report::new("R").section(Section::new("S").plot(plot)));
        assert!(page.contains(&format!("Drawn with {drawn} of 500000 samples, the smallest")));
        assert!(page.contains("a: 3 of 500000 samples are not finite and left out."));
    }
}

/// A report that carries the same text in every place that takes one.
fn everywhere(text: &str) -> Report {
    let line = [0.0, 1.0];
    Report::new(text).subtitle(text).fact(text, text).section(
        Section::new(text)
            .text(text)
            .preformatted(text)
            .note(text)
            .warning(text)
            .tiles([Tile::number(text, 1.0, text), Tile::text(text, text)])
            .table(Table::new(text).text(text).number(text, text).row([text.into(), 1.0.into()]))
            .plot(
                Plot::new(text)
                    .caption(text)
                    .x(text, text)
                    .y(text, text)
                    .line(text, &line, &line)
                    .named_bars(text, &[text], &[1.0])
                    .map(text, text, &[1.0], &[1.0], &[1.0])
                    .limit(text, 1.0)
                    .at(text, 1.0)
                    .span(text, 0.0..=1.0)
                    .note(text, 1.0, 1.0)
                    .zoom(text, 0.0..=1.0),
            ),
    )
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]
    #[test]
    fn no_text_changes_the_markup(text in "[<>&\"'/a-z!-]{1,12}") {
        // Tags of a page depend on its structure only, so any text gives those of harmless text.
        let tags = |text: &str| {
            let page = skeleton(&everywhere(text));
            page.split('<').skip(1).map(|t| t.split(['>', ' ']).next().unwrap_or("").to_owned())
                .collect::<Vec<_>>()
        };
        prop_assert_eq!(tags(&text), tags("harmless"));
    }
}

#[test]
fn a_hostile_name_stays_text() {
    let page = skeleton(&everywhere("</script><script>alert(1)</script>"));
    assert!(!page.contains("<script>"));
    assert!(page.contains("&lt;/script&gt;&lt;script&gt;alert(1)"));
}

#[test]
fn a_backdrop_takes_no_colour_and_a_palette_keeps_its_own() {
    let x = [0.0, 1.0];
    let plot = Plot::new("Force")
        .palette(&["after", "before"])
        .backdrop("measured", &x, &x)
        .line("before", &x, &x)
        .marked();
    let report = Report::new("t").section(Section::new("s").heading("Part <1>").plot(plot));
    let html = skeleton(&report);
    assert!(html.contains("<h3>Part &lt;1&gt;</h3>"), "{html}");
    assert!(html.contains("<figure id=\"f1\" class=\"marked\">"), "{html}");
    // Wide and grey; the second colour for the second name, although the first is not drawn.
    assert!(html.contains("\"color\":\"#cdd3d8\",\"dash\":\"solid\",\"width\":5"), "{html}");
    assert!(html.contains("\"color\":\"#e0700a\""), "{html}");
    assert!(html.contains("\"showlegend\":true"), "{html}");
}

#[test]
fn bars_of_two_kinds_stand_in_rows_of_their_own_and_are_filled() {
    let plot = Plot::new("Ranking").named_bars("added", &["friction"], &[90.0]).named_bars(
        "not added",
        &["delay", "offset"],
        &[3.0, -1.0],
    );
    let html = skeleton(&Report::new("t").section(Section::new("s").plot(plot)));
    assert!(html.contains("\"barmode\":\"overlay\""), "{html}");
    // A pattern without a background would be white on white.
    assert!(html.contains("\"bgcolor\":\"#e0700a\""), "{html}");
    // Three rows.
    assert!(html.contains("height:182px"), "{html}");
    let same = Plot::new("Pairs").named_bars("a", &["x"], &[1.0]).named_bars("b", &["x"], &[2.0]);
    let html = skeleton(&Report::new("t").section(Section::new("s").plot(same)));
    assert!(!html.contains("barmode"), "{html}");
}
