//! One check of the table: which limits its signal has, and what stands in the file.

use crate::error::ScenarioError;
use crate::quantity::Quantity;
use crate::source::Source;
use firmware_core::supervision::{Action, Condition, Rule};
use serde::{Deserialize, Serialize};

/// One check as it stands in a scenario. Which of the limits it has depends on its signal.
#[derive(Debug, Clone, PartialEq, Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct CheckFile {
    /// A force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_n: Option<Quantity>,
    /// A multiple of the largest force of the slot's model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_ratio: Option<Quantity>,
    /// A change of the force.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_n_per_cycle: Option<Quantity>,
    /// A displacement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_m: Option<Quantity>,
    /// A speed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_m_per_s: Option<Quantity>,
    /// An acceleration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_m_per_s2: Option<Quantity>,
    /// A temperature.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_degc: Option<Quantity>,
    /// A share.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_share: Option<Quantity>,
    /// A number of cycles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit_cycles: Option<Quantity>,
    /// Cycles in a row beyond the limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after_cycles: Option<Quantity>,
    /// What happens then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub action: Option<ActionFile>,
}

/// An action by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize)]
pub enum ActionFile {
    /// It is written down.
    #[serde(rename = "log")]
    Log,
    /// The last believed force is held.
    #[serde(rename = "hold")]
    Hold,
    /// The run ends in order.
    #[serde(rename = "ramp out")]
    RampOut,
    /// SAFE.
    #[serde(rename = "stop")]
    Stop,
    /// SAFE, and the rig drops its pressure.
    #[serde(rename = "power off")]
    PowerOff,
}

/// A limit by its key.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Limit {
    Force,
    Ratio,
    ForcePerCycle,
    Displacement,
    Speed,
    Acceleration,
    Temperature,
    Share,
    Cycles,
}

/// A signal of the table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Signal {
    /// Its key.
    pub(super) name: &'static str,
    /// The limits that it may have, of which a file gives one at most; the default is the first.
    /// Each with the least and the most that it may be.
    pub(super) limits: &'static [(Limit, f64, f64)],
    /// Most cycles of its debounce; none where it has no debounce.
    pub(super) most_cycles: Option<u32>,
    /// What may happen beyond its limit.
    pub(super) actions: &'static [ActionFile],
}

impl Limit {
    const ALL: [Self; 9] = [
        Self::Force,
        Self::Ratio,
        Self::ForcePerCycle,
        Self::Displacement,
        Self::Speed,
        Self::Acceleration,
        Self::Temperature,
        Self::Share,
        Self::Cycles,
    ];

    const fn key(self) -> &'static str {
        match self {
            Self::Force => "limit_n",
            Self::Ratio => "limit_ratio",
            Self::ForcePerCycle => "limit_n_per_cycle",
            Self::Displacement => "limit_m",
            Self::Speed => "limit_m_per_s",
            Self::Acceleration => "limit_m_per_s2",
            Self::Temperature => "limit_degc",
            Self::Share => "limit_share",
            Self::Cycles => "limit_cycles",
        }
    }

    const fn of(self, file: &CheckFile) -> Option<&Quantity> {
        match self {
            Self::Force => file.limit_n.as_ref(),
            Self::Ratio => file.limit_ratio.as_ref(),
            Self::ForcePerCycle => file.limit_n_per_cycle.as_ref(),
            Self::Displacement => file.limit_m.as_ref(),
            Self::Speed => file.limit_m_per_s.as_ref(),
            Self::Acceleration => file.limit_m_per_s2.as_ref(),
            Self::Temperature => file.limit_degc.as_ref(),
            Self::Share => file.limit_share.as_ref(),
            Self::Cycles => file.limit_cycles.as_ref(),
        }
    }

    const fn place(self, file: &mut CheckFile) -> &mut Option<Quantity> {
        match self {
            Self::Force => &mut file.limit_n,
            Self::Ratio => &mut file.limit_ratio,
            Self::ForcePerCycle => &mut file.limit_n_per_cycle,
            Self::Displacement => &mut file.limit_m,
            Self::Speed => &mut file.limit_m_per_s,
            Self::Acceleration => &mut file.limit_m_per_s2,
            Self::Temperature => &mut file.limit_degc,
            Self::Share => &mut file.limit_share,
            Self::Cycles => &mut file.limit_cycles,
        }
    }
}

impl ActionFile {
    pub(super) const ALL: [Self; 5] =
        [Self::Log, Self::Hold, Self::RampOut, Self::Stop, Self::PowerOff];

    const fn action(self) -> Action {
        match self {
            Self::Log => Action::Log,
            Self::Hold => Action::Hold,
            Self::RampOut => Action::RampOut,
            Self::Stop => Action::Stop,
            Self::PowerOff => Action::PowerOff,
        }
    }

    fn of(action: Action) -> Self {
        let named = Self::ALL.into_iter().find(|named| named.action() == action);
        debug_assert!(named.is_some(), "{action:?} has no name");
        named.unwrap_or(Self::PowerOff)
    }
}

/// What a file says of a signal.
pub(super) struct Check<'a> {
    pub(super) signal: &'a Signal,
    pub(super) given: Option<&'a CheckFile>,
    pub(super) source: &'a Source,
}

impl Check<'_> {
    /// Its limit, where the file gives one.
    ///
    /// # Errors
    /// A limit that the signal does not have, two limits, or a number out of range.
    pub(super) fn limit(&self) -> Result<Option<(Limit, f64)>, ScenarioError> {
        let (signal, source) = (self.signal, self.source);
        let Some(file) = self.given else { return Ok(None) };
        let mut found = None;
        for limit in Limit::ALL {
            let Some(given) = limit.of(file) else { continue };
            let Some((_, least, most)) = signal.limits.iter().find(|(own, ..)| *own == limit)
            else {
                return Err(given.error(source, self.found(limit.key(), &self.limit_keys())));
            };
            if found.is_some() {
                let both = format!("{}: expected one of {}", signal.name, self.limit_keys());
                return Err(given.error(source, both));
            }
            let range = format!("{least} to {most}");
            let value = given.within(source, &self.key(limit.key()), *least, *most, &range)?;
            found = Some((limit, value));
        }
        Ok(found)
    }

    /// Its limit in the unit of its default.
    ///
    /// # Errors
    /// As for [`Check::limit`].
    pub(super) fn limit_or(&self, usual: f64) -> Result<f64, ScenarioError> {
        debug_assert!(self.signal.limits.len() == 1, "{} has several limits", self.signal.name);
        Ok(self.limit()?.map_or(usual, |(_, value)| value))
    }

    /// Its debounce.
    ///
    /// # Errors
    /// A number of cycles that is not whole or out of range, or of a signal without a debounce.
    pub(super) fn cycles_or(&self, usual: u32) -> Result<u32, ScenarioError> {
        let Some(given) = self.given.and_then(|file| file.after_cycles.as_ref()) else {
            return Ok(usual);
        };
        let key = "after_cycles";
        let Some(most) = self.signal.most_cycles else {
            return Err(given.error(self.source, self.found(key, &self.limit_keys())));
        };
        let range = format!("a whole number from 1 to {most}");
        let value = given.within(self.source, &self.key(key), 1.0, f64::from(most), &range)?;
        if value.fract() == 0.0 {
            Ok(value as u32)
        } else {
            Err(given.refused(self.source, &self.key(key), range))
        }
    }

    /// Its action.
    ///
    /// # Errors
    /// An action that the signal does not have.
    pub(super) fn action_or(&self, usual: Action) -> Result<Action, ScenarioError> {
        let Some(given) = self.given.and_then(|file| file.action) else { return Ok(usual) };
        let allowed = self.signal.actions;
        if !allowed.contains(&given) {
            let names: Vec<_> = allowed.iter().map(|action| action.action().name()).collect();
            return Err(self.source.whole_error(format!(
                "[plausibility] {}: found action = \"{}\", expected one of {}",
                self.signal.name,
                given.action().name(),
                names.join(", ")
            )));
        }
        Ok(given.action())
    }

    /// A rule with the default for whatever the file leaves out.
    ///
    /// # Errors
    /// The first thing that does not fit.
    pub(super) fn rule(&self, usual: Rule) -> Result<Rule, ScenarioError> {
        Ok(Rule {
            limit: self.limit_or(usual.limit)?,
            debounce_cycles: self.cycles_or(usual.debounce_cycles)?,
            action: self.action_or(usual.action)?,
        })
    }

    /// The same for a condition.
    ///
    /// # Errors
    /// The first thing that does not fit.
    pub(super) fn condition(&self, usual: Condition) -> Result<Condition, ScenarioError> {
        self.limit()?;
        let (cycles, action) = (self.cycles_or(usual.cycles)?, self.action_or(usual.action)?);
        Ok(Condition { cycles, action })
    }

    fn key(&self, key: &str) -> String {
        format!("{}.{key}", self.signal.name)
    }

    fn limit_keys(&self) -> String {
        let keys: Vec<_> = self.signal.limits.iter().map(|(limit, ..)| limit.key()).collect();
        let cycles = self.signal.most_cycles.map(|_| "after_cycles");
        keys.into_iter().chain(cycles).chain(["action"]).collect::<Vec<_>>().join(", ")
    }

    fn found(&self, key: &str, expected: &str) -> String {
        format!("{}: found {key}, expected {expected}", self.signal.name)
    }
}

impl Signal {
    /// What a file says of it, with every default written out.
    pub(super) fn with_defaults(
        &self,
        given: Option<&CheckFile>,
        limit: Option<f64>,
        cycles: Option<u32>,
        action: Action,
    ) -> CheckFile {
        let mut file = given.cloned().unwrap_or_default();
        let has_limit = self.limits.iter().any(|(limit, ..)| limit.of(&file).is_some());
        if let (false, Some((key, ..)), Some(limit)) = (has_limit, self.limits.first(), limit) {
            *key.place(&mut file) = Some(Quantity::plain(limit));
        }
        let cycles = cycles.map(|cycles| Quantity::plain(f64::from(cycles)));
        file.after_cycles = file.after_cycles.or(cycles);
        file.action = file.action.or(Some(ActionFile::of(action)));
        file
    }
}
