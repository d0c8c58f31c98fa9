//! A report in a real browser: every plot is drawn, nothing is fetched, and a reader can use it.

use std::fs;
use std::path::PathBuf;

use report::browser;

use crate::demo_report;

/// The demo report, in this test run's own folder.
fn written(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    demo_report::demo().write_to(&path).expect("written");
    path
}

#[test]
fn every_plot_is_drawn_without_a_network() {
    let path = written("drawn.html");
    let Some(page) = browser::open(&path).expect("a page") else { return };
    page.assert_complete();
    // 12 plots and 2 zooms.
    assert_eq!(page.mark("plots"), Some("14"));
    assert!(!page.dom.contains("data-title=\"Share"), "no button may upload measured data");
    assert!(page.dom.contains("&lt;tags&gt;"), "text is shown as it was written");
}

#[test]
fn a_reader_can_zoom_hover_switch_traces_and_copy_tables() {
    let path = written("played.html");
    let script = r##"
        const marks = document.documentElement.dataset;
        const pause = (ms) => new Promise((next) => setTimeout(next, ms));
        const [whole, zoom] = document.querySelectorAll("#f2 .canvas");
        marks.samplesInZoom = zoom.data[0].x.length;
        Plotly.Fx.hover(whole, { xval: 10.0 }, "xy");
        await pause(200);
        marks.hover = whole.querySelector(".hoverlayer").textContent;
        const histogram = document.querySelector("#f9 .canvas");
        Plotly.Fx.hover(histogram, { xval: 2.0 }, "xy");
        await pause(200);
        marks.hoverWithoutUnit = histogram.querySelector(".hoverlayer").textContent;
        await Plotly.relayout(whole, { "xaxis.range": [3, 4] });
        marks.zoomed = whole.layout.xaxis.range.join(" to ");
        for (const name of ["mousedown", "mouseup"]) {
            whole.querySelector(".legendtoggle").dispatchEvent(new MouseEvent(name, { bubbles: true }));
        }
        await pause(1000);
        marks.switched = [whole.data[0].visible, zoom.data[0].visible, zoom.data[1].visible].join(" ");
        let copied = "";
        document.execCommand = () => { copied = document.querySelector("textarea").value; };
        Object.defineProperty(navigator, "clipboard", { value: undefined });
        const buttons = document.querySelectorAll("#s1 .copy button");
        buttons[0].click();
        await pause(50);
        marks.tabs = copied.split("\n").length + " lines, " + copied.split("\n")[4];
        buttons[1].click();
        await pause(50);
        marks.markdown = copied.split("\n").slice(1, 3).join(" ");
    "##;
    let Some(page) = browser::open_and_play(&path, script).expect("a page") else { return };
    page.assert_complete();
    let hover = page.mark("hover").expect("hovered");
    assert!(hover.contains("front left, new : ") && hover.contains(" kN"), "{hover}");
    let hover = page.mark("hover-without-unit").expect("hovered");
    assert!(hover.ends_with(|c: char| c.is_ascii_digit()), "{hover}");
    assert_eq!(page.mark("zoomed"), Some("3 to 4"));
    assert_eq!(page.mark("switched"), Some("legendonly legendonly true"));
    // Half a second at 1 kHz, both ends, and one neighbour on each side.
    assert_eq!(page.mark("samples-in-zoom"), Some("503"));
    assert_eq!(
        page.mark("tabs"),
        Some("6 lines, rear right\tmodelled | off\t\t\t0\t0\t\t7.568e-5")
    );
    let markdown = page.mark("markdown").expect("copied");
    assert!(markdown.starts_with("| --- | --- | ---: |"), "{markdown}");
    assert!(markdown.contains("| front left | rig | -18.00 | 18.00 |"), "{markdown}");
}

/// The checks above can fail: a page whose plot cannot be drawn says so.
#[test]
fn a_broken_page_is_noticed() {
    let path = written("broken.html");
    let html = fs::read_to_string(&path).expect("read");
    fs::write(&path, html.replacen("\"type\":\"scatter\"", "\"type\":\"scatter\",\"x\":{", 1))
        .expect("written");
    let Some(page) = browser::open(&path).expect("a page") else { return };
    assert!(std::panic::catch_unwind(|| page.assert_complete()).is_err());
}

/// The page cannot fetch even if somebody puts an address into it.
#[test]
fn the_page_itself_forbids_requests() {
    let path = written("fetching.html");
    let html = fs::read_to_string(&path).expect("read");
    let picture = "<img src=\"http://127.0.0.1:9/x.png\">\n</main>";
    fs::write(&path, html.replacen("</main>", picture, 1)).expect("written");
    let Some(page) = browser::open(&path).expect("a page") else { return };
    let errors = page.mark("page-errors").expect("a complaint");
    assert!(errors.contains("img-src refused http://127.0.0.1:9/x.png"), "{errors}");
}

/// Forms and other bases have no fallback to `default-src`: the policy names them.
#[test]
fn the_page_itself_forbids_forms_and_other_bases() {
    let path = written("posting.html");
    let script = r#"
        const base = document.createElement("base");
        base.href = "http://127.0.0.1:9/base/";
        document.head.append(base);
        const form = document.createElement("form");
        form.action = "http://127.0.0.1:9/form";
        document.body.append(form);
        form.submit();
    "#;
    let Some(page) = browser::open_and_play(&path, script).expect("a page") else { return };
    let errors = page.mark("page-errors").expect("a complaint");
    assert!(errors.contains("base-uri refused http://127.0.0.1:9/base/"), "{errors}");
    assert!(errors.contains("form-action refused http://127.0.0.1:9/form"), "{errors}");
}
