//! The host's side of the arming exchange: it asks, one item after the other.
use super::agreement::Agreement;
use super::configuration::Configuration;
use super::item::ArmItem;
use super::limits::Limits;
use super::message::{ArmMessage, ArmSide};
use super::quiet::Quiet;
use super::readiness::Requirements;
use super::refusal::{Refusal, Shortfall};
use crate::{Node, Profile, RunState, Sender, SessionCode, SessionHistory};

/// What the host asks, in this order; each waits for its answer.
const ARM_STEPS: [ArmItem; 14] = [
    ArmItem::HostNumber,
    ArmItem::Stroke,
    ArmItem::Velocity,
    ArmItem::Acceleration,
    ArmItem::Force,
    ArmItem::Alive,
    ArmItem::Enabled,
    ArmItem::ZeroAge,
    ArmItem::ShuntCheck,
    ArmItem::ForceAtRest,
    ArmItem::StrokeOut,
    ArmItem::StrokeIn,
    ArmItem::Configuration,
    ArmItem::Arm,
];
/// The same for the reset of a latched rig.
const RESET_STEPS: [ArmItem; 2] = [ArmItem::HostNumber, ArmItem::Reset];

/// What the host wants of one rig.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HostPlan {
    /// The rig.
    pub node: Node,
    /// A number that this host has not used before: random, or seeded in virtual time.
    pub number: u32,
    /// The limits that the host asks for.
    pub asked: Limits,
    /// The limits that its run needs at least.
    pub needed: Limits,
    /// What it requires of the rig's readiness.
    pub requirements: Requirements,
    /// The configuration; its limits are replaced by the agreed ones.
    pub configuration: Configuration,
    /// When to ask again and when to give up.
    pub patience: Patience,
}

/// When a side asks again and when it gives up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Cycles until a question is repeated.
    pub repeat_cycles: u16,
    /// How often each question is sent at most.
    pub attempts: u8,
    /// Cycles that the host waits for quiet altogether.
    pub quiet_cycles: u16,
}

impl Default for Patience {
    /// Every 20 cycles, 10 times; 3000 cycles for quiet.
    fn default() -> Self {
        Self { repeat_cycles: 20, attempts: 10, quiet_cycles: 3000 }
    }
}

/// Where the exchange stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HostOutcome {
    /// This item is being asked.
    Pending(ArmItem),
    /// The rig is armed. Commands are sealed from cycle 0.
    Armed(Agreement),
    /// The rig took the request to reset itself.
    Reset,
    /// The rig is not armed, or was not reset.
    Refused(Refusal),
}

/// The host's side of one exchange with one rig.
#[derive(Clone, Debug, PartialEq)]
pub struct HostArming {
    plan: HostPlan,
    history: SessionHistory,
    /// What remains to be asked; the first of it is pending.
    steps: &'static [ArmItem],
    attempts: u8,
    /// Cycles until the pending item is sent.
    wait: u16,
    /// Cycles spent waiting for quiet.
    unquiet: u16,
    counter: u8,
    rig_number: u32,
    agreed: Limits,
    boot: u32,
    outcome: HostOutcome,
    /// Whether a refusal is still to be sent to the rig.
    must_close: bool,
}

impl HostArming {
    /// An exchange that arms. `history` holds the codes of this host's last sessions.
    pub const fn new(plan: HostPlan, history: SessionHistory) -> Self {
        Self::of_steps(plan, history, &ARM_STEPS)
    }

    /// An exchange that resets a latched rig; only node, number and patience of the plan count.
    pub fn reset(plan: HostPlan) -> Self {
        Self::of_steps(plan, SessionHistory::default(), &RESET_STEPS)
    }

    const fn of_steps(plan: HostPlan, history: SessionHistory, steps: &'static [ArmItem]) -> Self {
        Self {
            agreed: plan.asked,
            plan,
            history,
            steps,
            attempts: 0,
            wait: 0,
            unquiet: 0,
            counter: 0,
            rig_number: 0,
            boot: 0,
            outcome: HostOutcome::Pending(ArmItem::HostNumber),
            must_close: false,
        }
    }

    /// Where the exchange stands.
    pub const fn outcome(&self) -> HostOutcome {
        self.outcome
    }

    /// One cycle: the message to send in it, if any. `quiet` counts the cycles on the rig's bus.
    pub fn cycle(&mut self, quiet: &Quiet) -> Option<ArmMessage> {
        let HostOutcome::Pending(item) = self.outcome else {
            return core::mem::take(&mut self.must_close)
                .then(|| self.message(ArmItem::Refused, ArmItem::Arm.code().into()));
        };
        if let Some(wait) = self.wait.checked_sub(1) {
            self.wait = wait;
            return None;
        }
        if item == ArmItem::Arm && !self.may_arm(quiet) {
            return None;
        }
        if self.attempts >= self.plan.patience.attempts {
            self.refuse(Refusal::Unanswered { item, attempts: self.attempts });
            return None;
        }
        self.attempts += 1;
        self.wait = self.plan.patience.repeat_cycles.saturating_sub(1);
        Some(self.message(item, self.value(item)))
    }

    /// Whether the bus is quiet and the rig's heartbeat is that of the rig that answers. A host
    /// whose patience with the bus ends refuses.
    fn may_arm(&mut self, quiet: &Quiet) -> bool {
        let boot = quiet.boot(Sender::Rig(self.plan.node));
        if quiet.is_quiet() && boot == Some(self.boot) {
            return true;
        }
        self.unquiet = self.unquiet.saturating_add(1);
        if self.unquiet >= self.plan.patience.quiet_cycles {
            let item = ArmItem::Alive;
            self.refuse(match (quiet.is_quiet(), quiet.heard(), boot) {
                (false, Some(heard), _) => Refusal::NotQuiet(heard),
                (_, _, Some(found)) => {
                    Refusal::ByHost(Shortfall { item, found, needed: self.boot })
                }
                _ => Refusal::Unanswered { item, attempts: 0 },
            });
        }
        false
    }

    /// Take notice of an answer of the rig.
    pub fn receive(&mut self, answer: &ArmMessage) {
        let HostOutcome::Pending(pending) = self.outcome else { return };
        if (answer.side, answer.node) != (ArmSide::Rig, self.plan.node) || self.attempts == 0 {
            return;
        }
        let value = answer.value;
        match (pending, answer.item) {
            (_, ArmItem::Refused) => {
                let reason = u16::try_from(value).ok().and_then(ArmItem::from_code);
                self.refuse(Refusal::ByRig(reason.unwrap_or(ArmItem::Refused)));
                self.must_close = false;
            }
            (ArmItem::HostNumber, ArmItem::RigNumber) => {
                self.rig_number = value;
                let code = SessionCode::of(self.plan.number, value);
                let repeats = !self.history.allows(code);
                let item = ArmItem::RigNumber;
                self.judge(repeats.then_some(Shortfall { item, found: value, needed: 0 }));
            }
            (ArmItem::Arm, ArmItem::Armed) if value == self.agreement().armed_value() => {
                self.outcome = HostOutcome::Armed(self.agreement());
            }
            (ArmItem::Arm, ArmItem::Quiet) => self.wait_for_the_rig(value),
            (ArmItem::Reset, ArmItem::Reset) if value == self.plan.number => {
                self.outcome = HostOutcome::Reset;
            }
            (ArmItem::Arm | ArmItem::Reset, _) => {}
            (asked, answered) if asked == answered => self.take(asked, value),
            _ => {}
        }
    }

    /// The answer to a limit, an item of readiness or the configuration.
    fn take(&mut self, item: ArmItem, found: u32) {
        if let Some(asked) = self.plan.asked.get(item) {
            self.agreed.set(item, asked.min(found));
            let needed = self.plan.needed.get(item).unwrap_or(0);
            return self.judge((found < needed).then_some(Shortfall { item, found, needed }));
        }
        if item == ArmItem::Alive {
            self.boot = found;
        }
        let shortfall = match item {
            ArmItem::Configuration => {
                let needed = self.agreement().configuration.hash();
                (found != needed).then_some(Shortfall { item, found, needed })
            }
            _ => self.plan.requirements.shortfall(item, found),
        };
        self.judge(shortfall);
    }

    /// Ask the next item, or refuse.
    fn judge(&mut self, shortfall: Option<Shortfall>) {
        if let Some(shortfall) = shortfall {
            return self.refuse(Refusal::ByHost(shortfall));
        }
        let next = self.steps.split_first().map_or(self.steps, |(_, rest)| rest);
        if let Some(item) = next.first() {
            (self.steps, self.attempts, self.wait) = (next, 0, 0);
            self.outcome = HostOutcome::Pending(*item);
        }
    }

    /// The rig's bus was not quiet for long enough: ask again when it may be.
    fn wait_for_the_rig(&mut self, cycles: u32) {
        let cycles = u16::try_from(cycles).unwrap_or(u16::MAX).max(1);
        self.unquiet = self.unquiet.saturating_add(cycles);
        if self.unquiet >= self.plan.patience.quiet_cycles {
            return self.refuse(Refusal::ByRig(ArmItem::Quiet));
        }
        (self.wait, self.attempts) = (cycles, 0);
    }

    fn refuse(&mut self, refusal: Refusal) {
        self.outcome = HostOutcome::Refused(refusal);
        self.must_close = true;
    }

    fn agreement(&self) -> Agreement {
        Agreement {
            host_number: self.plan.number,
            rig_number: self.rig_number,
            configuration: Configuration { limits: self.agreed, ..self.plan.configuration },
        }
    }

    /// The value that an item is asked with.
    fn value(&self, item: ArmItem) -> u32 {
        match item {
            ArmItem::HostNumber => self.plan.number,
            ArmItem::Configuration => self.agreement().configuration.hash(),
            ArmItem::Arm => self.agreement().arm_value(),
            ArmItem::Reset => self.rig_number,
            _ => self.plan.asked.get(item).unwrap_or(0),
        }
    }

    fn message(&mut self, item: ArmItem, value: u32) -> ArmMessage {
        let counter = self.counter;
        self.counter = Profile::Classical.next_counter(counter);
        let (side, node, state) = (ArmSide::Host, self.plan.node, RunState::Standby);
        ArmMessage { side, node, counter, state, item, value }
    }
}
