//! A written report opened in a headless Chromium, as its reader would open it; a page that changes
//! is visited by a [`Driven`] one.
//!
//! For tests only (feature `browser-test`). A report says itself how it went, by attributes of its
//! root element: `data-plots` and `data-plots-drawn`, `data-requests` (what the browser fetched
//! besides the file), `data-page-errors` and `data-ready`. Chromium gets no network either: all
//! traffic is sent to a port that is not open, and all names fail to resolve.
//!
//! ```no_run
//! # let report_html = std::path::Path::new("report.html");
//! if let Some(page) = report::browser::open(report_html).expect("a page") {
//!     page.assert_complete();
//! }
//! ```

mod driven;

pub use driven::Driven;

use std::fs;
use std::io::{self, Read, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

const FLAGS: [&str; 11] = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-sync",
    "--disable-extensions",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    // Nobody listens there; the loopback of this machine needs no proxy.
    "--proxy-server=127.0.0.1:9",
];

/// After this the browser is ended; only a hung browser comes near it.
const PATIENCE: Duration = Duration::from_secs(180);

/// How long the page's own clock runs, virtually, before it is read.
const PAGE_TIME_MS: u32 = 60_000;

/// A page after its scripts have run.
#[derive(Debug, Clone)]
pub struct Page {
    /// The document as the browser holds it.
    pub dom: String,
}

impl Page {
    /// A `data-…` attribute of the root element, without its prefix.
    pub fn mark(&self, name: &str) -> Option<&str> {
        let root = self.dom.split_once("<html")?.1.split_once('>')?.0;
        root.split_once(&format!(" data-{name}=\""))?.1.split_once('"').map(|(value, _)| value)
    }

    /// Panics unless every plot was drawn, nothing was fetched, and no script complained.
    ///
    /// # Panics
    /// With what the page says about itself.
    pub fn assert_complete(&self) {
        let marks = ["ready", "plots", "plots-drawn", "requests", "page-errors"]
            .map(|name| (name, self.mark(name).unwrap_or("missing")));
        assert_eq!(self.mark("ready"), Some("yes"), "{marks:?}");
        assert_eq!(self.mark("plots"), self.mark("plots-drawn"), "{marks:?}");
        assert_eq!(self.mark("requests"), Some("0"), "{marks:?}");
        // Plotly puts one such group into each finished drawing.
        let drawn = self.dom.matches("class=\"plot-container").count();
        assert_eq!(Some(drawn.to_string().as_str()), self.mark("plots"), "{marks:?}");
    }
}

/// Opens a file and returns the page when it has come to rest.
///
/// Without a Chromium it returns `None` and says SKIPPED on standard error; with
/// `REQUIRE_BROWSER=1` in the environment that is an error.
///
/// # Errors
/// No browser where one is required; a browser that does not start, hangs or returns nothing.
pub fn open(html: &Path) -> io::Result<Option<Page>> {
    let flags = ["--dump-dom".to_owned(), format!("--virtual-time-budget={PAGE_TIME_MS}")];
    let Some(output) = run(html, &flags)? else { return Ok(None) };
    if !output.contains("</html>") {
        return Err(io::Error::other("the browser returned no page"));
    }
    Ok(Some(Page { dom: output }))
}

/// Opens a file with a script added at its end, to play the reader: click, hover, zoom.
///
/// The script runs when the page is complete and may leave marks with
/// `document.documentElement.dataset`.
///
/// # Errors
/// As [`open`]; and a file that cannot be copied.
pub fn open_and_play(html: &Path, script: &str) -> io::Result<Option<Page>> {
    let page = fs::read_to_string(html)?;
    let scratch = Scratch::new()?;
    let copy = scratch.0.join("page.html");
    let player = format!(
        "<script>const wait = setInterval(async () => {{\n\
         if (!document.documentElement.dataset.ready) return;\n\
         clearInterval(wait);\n{script}\n}}, 20);</script>\n</body>"
    );
    fs::write(&copy, page.replacen("</body>", &player, 1))?;
    open(&copy)
}

/// Saves a picture of the page (PNG).
///
/// # Errors
/// As [`open`].
pub fn screenshot(html: &Path, png: &Path, width: u32, height: u32) -> io::Result<Option<()>> {
    let flags = [
        format!("--screenshot={}", std::path::absolute(png)?.display()),
        format!("--window-size={width},{height}"),
        "--hide-scrollbars".to_owned(),
        format!("--virtual-time-budget={PAGE_TIME_MS}"),
    ];
    Ok(run(html, &flags)?.map(|_| ()))
}

/// Prints the page on A4 (PDF).
///
/// # Errors
/// As [`open`].
pub fn print(html: &Path, pdf: &Path) -> io::Result<Option<()>> {
    let flags = [
        format!("--print-to-pdf={}", std::path::absolute(pdf)?.display()),
        "--no-pdf-header-footer".to_owned(),
        format!("--virtual-time-budget={PAGE_TIME_MS}"),
    ];
    Ok(run(html, &flags)?.map(|_| ()))
}

fn run(html: &Path, flags: &[String]) -> io::Result<Option<String>> {
    let Some(browser) = installed()? else { return Ok(None) };
    let profile = Scratch::new()?;
    let address = format!("file://{}", std::path::absolute(html)?.display());
    let child = Command::new(browser)
        .args(FLAGS)
        .arg("--host-resolver-rules=MAP * ~NOTFOUND")
        .arg(format!("--user-data-dir={}", profile.0.display()))
        .args(flags)
        .arg(&address)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    finish(child).map(Some)
}

/// The first browser that is installed; none, with a word on standard error.
fn installed() -> io::Result<Option<PathBuf>> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    let places = NAMES.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    if let Some(found) = places.into_iter().find(|place| place.is_file()) {
        return Ok(Some(found));
    }
    if std::env::var_os("REQUIRE_BROWSER").is_some_and(|v| v == "1") {
        return Err(io::Error::new(
            io::ErrorKind::NotFound,
            "REQUIRE_BROWSER=1, but no Chromium is installed (Debian: apt-get install chromium)",
        ));
    }
    // Straight to standard error: what a test prints by macro is swallowed when it passes.
    writeln!(io::stderr(), "SKIPPED: no Chromium found; no page was opened in a browser")?;
    Ok(None)
}

fn finish(mut child: Child) -> io::Result<String> {
    let mut pipe = child.stdout.take().ok_or_else(|| io::Error::other("no output pipe"))?;
    let reader = thread::spawn(move || {
        let mut output = Vec::new();
        pipe.read_to_end(&mut output).map(|_| String::from_utf8_lossy(&output).into_owned())
    });
    let started = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if started.elapsed() > PATIENCE {
            child.kill()?;
            child.wait()?;
            return Err(io::Error::new(io::ErrorKind::TimedOut, "the browser did not finish"));
        }
        thread::sleep(Duration::from_millis(20));
    };
    let output = reader.join().map_err(|_| io::Error::other("the reading thread stopped"))??;
    if status.success() {
        Ok(output)
    } else {
        Err(io::Error::other(format!("the browser ended with {status}")))
    }
}

/// A fresh folder, removed at the end.
#[derive(Debug)]
struct Scratch(PathBuf);

impl Scratch {
    fn new() -> io::Result<Self> {
        static COUNT: std::sync::atomic::AtomicU32 = std::sync::atomic::AtomicU32::new(0);
        let count = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let name = format!("report-browser-{}-{count}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path)?;
        Ok(Self(path))
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // A leftover in the temporary folder is no reason to fail a test.
        let _ = fs::remove_dir_all(&self.0);
    }
}
