//! The watch over a damper on a rig: the model that its measured force is compared with, and the
//! limit at which its residual counts as drift.
//!
//! ```toml
//! [[slot]]
//! place = "front left"
//! on = "rig"
//! [slot.watch]                       # all of it may be left out: watch = {}
//! damper = { file = "model.toml" }   # the model; the scenario's [damper] where absent
//! settle_s = 2.0                     # left out at the start: the dashpot settles
//! learn_s = 10.0                     # then the usual residual is learnt
//! window_s = 10.0                    # over which the running rms forgets
//! limit_ratio = 3.0                  # drift: running rms above so many times the learnt one
//! limit_n = 400.0                    # or, instead: above a stated force
//! ```

use crate::cycle::CYCLE_S;
use crate::damper::DamperFile;
use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use firmware_core::damper::Damper;
use serde::{Deserialize, Serialize};

/// A watch as it stands in a scenario.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct WatchFile {
    /// The model of the damper on the rig.
    #[serde(default)]
    pub damper: DamperFile,
    /// Time at the start that is left out.
    pub settle_s: Option<Quantity>,
    /// Time over which the usual residual is learnt.
    pub learn_s: Option<Quantity>,
    /// Time constant of the running rms.
    pub window_s: Option<Quantity>,
    /// Drift is a running rms above so many times the learnt one.
    pub limit_ratio: Option<Quantity>,
    /// Drift is a running rms above this force.
    pub limit_n: Option<Quantity>,
}

/// A watch ready to run.
#[derive(Debug, Clone, PartialEq)]
pub struct WatchSetup {
    /// The model.
    pub damper: Damper,
    /// Time at the start that is left out (s).
    pub settle_s: f64,
    /// Time over which the usual residual is learnt (s).
    pub learn_s: f64,
    /// Time constant of the running rms (s).
    pub window_s: f64,
    /// When the residual counts as drift.
    pub limit: Limit,
}

/// When a residual counts as drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Limit {
    /// Above so many times the learnt rms.
    Ratio(f64),
    /// Above a force (N).
    Force(f64),
}

const SETTLE_S: f64 = 2.0;
const LEARN_S: f64 = 10.0;
const WINDOW_S: f64 = 10.0;
const LIMIT_RATIO: f64 = 3.0;

impl WatchFile {
    /// This watch with every default written out; `base` is the scenario's damper.
    #[must_use]
    pub fn with_defaults(&self, base: &DamperFile) -> Self {
        let or = Quantity::or;
        let limit_ratio = if self.limit_n.is_none() {
            Some(or(self.limit_ratio.as_ref(), LIMIT_RATIO))
        } else {
            None
        };
        Self {
            damper: self.damper.over(base),
            settle_s: Some(or(self.settle_s.as_ref(), SETTLE_S)),
            learn_s: Some(or(self.learn_s.as_ref(), LEARN_S)),
            window_s: Some(or(self.window_s.as_ref(), WINDOW_S)),
            limit_ratio,
            limit_n: self.limit_n.clone(),
        }
    }

    /// Builds the watch, whose damper names no file any more; `base` is the scenario's damper.
    ///
    /// # Errors
    /// The first number that does not fit, with file and line.
    pub(crate) fn build(
        &self,
        source: &Source,
        base: &DamperFile,
    ) -> Result<WatchSetup, ScenarioError> {
        let time = |given: &Option<Quantity>, key: &str, least: f64, default: f64| match given {
            Some(value) => {
                let range = format!("{least} to 86400 s");
                value.within(source, key, least, 86_400.0, &range)
            }
            None => Ok(default),
        };
        if let (Some(_), Some(force)) = (&self.limit_ratio, &self.limit_n) {
            return Err(force.error(source, "limit_ratio and limit_n given, expected one of them"));
        }
        let limit = match (&self.limit_ratio, &self.limit_n) {
            (_, Some(force)) => Limit::Force(force.positive(source, "limit_n")?),
            (Some(ratio), None) => {
                Limit::Ratio(ratio.within(source, "limit_ratio", 1.1, 1e6, "1.1 to 1e6")?)
            }
            (None, None) => Limit::Ratio(LIMIT_RATIO),
        };
        debug_assert!(self.damper.file.is_none(), "the model is read before");
        let damper = self.damper.over(base).build(source)?;
        Ok(WatchSetup {
            damper,
            settle_s: time(&self.settle_s, "settle_s", 0.0, SETTLE_S)?,
            learn_s: time(&self.learn_s, "learn_s", CYCLE_S, LEARN_S)?,
            window_s: time(&self.window_s, "window_s", CYCLE_S, WINDOW_S)?,
            limit,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn built(text: &str) -> Result<WatchSetup, ScenarioError> {
        let source = Source::from_text(Path::new("watch.toml"), text);
        let file: WatchFile = source.parse()?;
        let base = DamperFile { ke_n_per_m: Some(Quantity::plain(9e6)), ..DamperFile::default() };
        file.build(&source, &base)
    }

    #[test]
    fn an_empty_watch_has_the_scenarios_damper_and_the_defaults() {
        let watch = built("").unwrap();
        assert_eq!((watch.settle_s, watch.learn_s, watch.window_s), (2.0, 10.0, 10.0));
        assert_eq!(watch.limit, Limit::Ratio(3.0));
        assert_eq!(watch.damper.nominal().ke_n_per_m, 9e6);
        let written = WatchFile::default().with_defaults(&DamperFile::default());
        let text = toml::to_string(&written).unwrap();
        assert_eq!(built(&text).unwrap(), watch);
        let own = built("limit_n = 400.0\ndamper = { ke_n_per_m = 1.1e7 }").unwrap();
        assert_eq!((own.limit, own.damper.nominal().ke_n_per_m), (Limit::Force(400.0), 1.1e7));
    }

    #[test]
    fn what_does_not_fit_is_named() {
        let refused = |text: &str| built(text).unwrap_err().to_string();
        let both = refused("limit_n = 400.0\nlimit_ratio = 3.0");
        assert!(both.contains("watch.toml:1") && both.contains("expected one of them"), "{both}");
        let low = refused("limit_ratio = 0.5");
        assert!(low.contains("limit_ratio") && low.contains("1.1 to 1e6"), "{low}");
        assert!(refused("window_s = 0.0").contains("window_s"));
    }
}
