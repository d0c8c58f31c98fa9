//! The rig's side of the arming exchange: it answers, and arms on one frame only.
use super::agreement::Agreement;
use super::configuration::Configuration;
use super::item::ArmItem;
use super::limits::Limits;
use super::message::{ArmMessage, ArmSide};
use super::quiet::{Foreign, Heard, Quiet};
use super::readiness::{Readiness, Requirements};
use crate::{MessageId, Node, Profile, RunState, SessionCode, SessionHistory};

/// What the rig knows of itself when a message comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigStatus {
    /// Its run state.
    pub state: RunState,
    /// Whether a reset over the bus may end SAFE or FAULT now.
    pub may_reset: bool,
    /// Its readiness.
    pub readiness: Readiness,
    /// What it requires of that itself.
    pub requirements: Requirements,
    /// Its own configuration, with its own limits.
    pub configuration: Configuration,
}

/// What a message led to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RigEvent {
    /// The rig is armed. Measurements are sealed from cycle 0.
    Armed(Agreement),
    /// The session ended before its first command: the rig is to go back to STANDBY.
    Lapsed,
    /// A latched rig is to leave SAFE or FAULT for INIT.
    Reset,
}

/// The rig's side of all its exchanges since its start.
#[derive(Clone, Debug, PartialEq)]
pub struct RigArming {
    node: Node,
    history: SessionHistory,
    counter: u8,
    exchange: Option<Exchange>,
    session: Option<Agreement>,
    /// Cycles that remain for the first command of the session; `None` once it came.
    first_command: Option<u16>,
}

/// An exchange that has begun.
#[derive(Clone, Debug, PartialEq)]
struct Exchange {
    host_number: u32,
    rig_number: u32,
    /// Own limits, replaced by the tighter ones as the host asks.
    limits: Limits,
    /// Which of [`Limits::ITEMS`] the host asked.
    asked: [bool; 4],
    /// Cycles since the host's last message.
    silent: u16,
}

/// How often the rig draws a number whose session code is not new before it gives up: an honest
/// source fails once in 15 draws, and so never 64 times in a row.
const DRAWS: usize = 64;

impl RigArming {
    /// Cycles of silence after which an exchange is forgotten.
    pub const SILENT_CYCLES: u16 = 5000;

    /// Cycles within which an armed rig must accept a first command: longer than a host needs to
    /// ask again for an answer that was lost.
    pub const FIRST_COMMAND_CYCLES: u16 = 500;

    /// A rig that has just started. A rig with a memory that survives its power gives the codes of
    /// its last sessions, any other an empty history.
    pub const fn new(node: Node, history: SessionHistory) -> Self {
        let (exchange, session, first_command) = (None, None, None);
        Self { node, history, counter: 0, exchange, session, first_command }
    }

    /// The session, while the rig is armed.
    pub const fn session(&self) -> Option<&Agreement> {
        self.session.as_ref()
    }

    /// The codes of the last sessions.
    pub const fn history(&self) -> &SessionHistory {
        &self.history
    }

    /// The rig accepted a sealed command: from now on its watchdog rules.
    pub const fn commanded(&mut self) {
        self.first_command = None;
    }

    /// The session is over, whatever ended it: the next one needs a new exchange.
    pub const fn end_session(&mut self) {
        (self.session, self.first_command) = (None, None);
    }

    /// One cycle passed. [`RigEvent::Lapsed`] when an armed rig waited too long for its first
    /// command.
    pub fn cycle(&mut self) -> Option<RigEvent> {
        if let Some(exchange) = &mut self.exchange {
            exchange.silent = exchange.silent.saturating_add(1);
        }
        if self.exchange.as_ref().is_some_and(|open| open.silent > Self::SILENT_CYCLES) {
            self.exchange = None;
        }
        match self.first_command?.checked_sub(1) {
            Some(remaining) => {
                self.first_command = Some(remaining);
                None
            }
            None => self.lapse(),
        }
    }

    /// Ends a session that has not had a command yet.
    fn lapse(&mut self) -> Option<RigEvent> {
        self.first_command?;
        self.end_session();
        Some(RigEvent::Lapsed)
    }

    /// Take notice of a message of the host. Gives the answer to send, and what happened. `quiet`
    /// counts the cycles on the rig's bus; `draw` gives a number that this rig has not used before:
    /// random, or seeded in virtual time.
    pub fn receive(
        &mut self,
        request: &ArmMessage,
        status: &RigStatus,
        quiet: &mut Quiet,
        draw: impl FnMut() -> u32,
    ) -> (Option<ArmMessage>, Option<RigEvent>) {
        if (request.side, request.node) != (ArmSide::Host, self.node) {
            return (None, None);
        }
        if let Some(exchange) = &mut self.exchange {
            exchange.silent = 0;
        }
        let value = request.value;
        let mut event = None;
        let answer = match request.item {
            ArmItem::HostNumber => self.open(value, status, quiet, draw),
            ArmItem::Configuration => self.compare(value, status),
            ArmItem::Arm => self.arm(value, status, quiet, &mut event),
            ArmItem::Reset => self.reset(value, status, &mut event),
            ArmItem::Refused => {
                self.exchange = None;
                return (None, self.lapse());
            }
            item => match status.readiness.get(item) {
                Some(value) => Ok((item, value)),
                None => self.limit(item, value),
            },
        };
        let (item, value) = answer.unwrap_or_else(|reason| {
            // A refused exchange is over: the next attempt needs a fresh number.
            self.exchange = None;
            (ArmItem::Refused, u32::from(reason.code()))
        });
        let counter = self.counter;
        self.counter = Profile::Classical.next_counter(counter);
        let (side, node, state) = (ArmSide::Rig, self.node, status.state);
        (Some(ArmMessage { side, node, counter, state, item, value }), event)
    }

    /// The host's number: the rig draws its own, once per number of the host.
    fn open(
        &mut self,
        host_number: u32,
        status: &RigStatus,
        quiet: &mut Quiet,
        mut draw: impl FnMut() -> u32,
    ) -> Result<(ArmItem, u32), ArmItem> {
        if self.session.is_some() || !may_exchange(status.state) {
            return Err(ArmItem::State);
        }
        match &self.exchange {
            Some(open) if open.host_number == host_number => {
                return Ok((ArmItem::RigNumber, open.rig_number));
            }
            Some(_) => quiet.restart(Heard {
                message: MessageId::ArmRequest(self.node),
                who: Foreign::AnotherHost,
            }),
            None => {}
        }
        let history = self.history;
        let is_new = |number: &u32| history.allows(SessionCode::of(host_number, *number));
        let rig_number = (0..DRAWS).map(|_| draw()).find(is_new).ok_or(ArmItem::RigNumber)?;
        let (limits, asked, silent) = (status.configuration.limits, [false; 4], 0);
        self.exchange = Some(Exchange { host_number, rig_number, limits, asked, silent });
        Ok((ArmItem::RigNumber, rig_number))
    }

    /// A limit: the tighter of both. An item that is none has no place here.
    fn limit(&mut self, item: ArmItem, asked: u32) -> Result<(ArmItem, u32), ArmItem> {
        let exchange = self.exchange.as_mut().ok_or(ArmItem::RigNumber)?;
        let agreed = exchange.limits.get(item).ok_or(item)?.min(asked);
        exchange.limits.set(item, agreed);
        for (limit, asked) in Limits::ITEMS.into_iter().zip(&mut exchange.asked) {
            *asked |= limit == item;
        }
        Ok((item, agreed))
    }

    fn compare(&self, hash: u32, status: &RigStatus) -> Result<(ArmItem, u32), ArmItem> {
        let own = self.agreement(status)?.configuration.hash();
        if hash == own { Ok((ArmItem::Configuration, own)) } else { Err(ArmItem::Configuration) }
    }

    fn arm(
        &mut self,
        value: u32,
        status: &RigStatus,
        quiet: &Quiet,
        event: &mut Option<RigEvent>,
    ) -> Result<(ArmItem, u32), ArmItem> {
        if let Some(session) = &self.session {
            // ARMED was lost: say it again, to who knows the value and to nobody else.
            let again = (ArmItem::Armed, session.armed_value());
            return if session.arm_value() == value { Ok(again) } else { Err(ArmItem::State) };
        }
        let agreement = self.agreement(status)?;
        if agreement.arm_value() != value {
            return Err(ArmItem::Arm);
        }
        self.objection(status).map_or(Ok(()), Err)?;
        if !quiet.is_quiet() {
            return Ok((ArmItem::Quiet, u32::from(quiet.remaining())));
        }
        self.history.remember(agreement.code());
        self.exchange = None;
        (self.session, self.first_command) = (Some(agreement), Some(Self::FIRST_COMMAND_CYCLES));
        *event = Some(RigEvent::Armed(agreement));
        Ok((ArmItem::Armed, agreement.armed_value()))
    }

    /// What stands against arming a rig whose number was returned.
    fn objection(&self, status: &RigStatus) -> Option<ArmItem> {
        if status.state != RunState::Standby {
            return Some(ArmItem::State);
        }
        let exchange = self.exchange.as_ref()?;
        let unasked = Limits::ITEMS.into_iter().zip(exchange.asked).find_map(|(item, asked)| {
            (!asked || exchange.limits.get(item) == Some(0)).then_some(item)
        });
        unasked.or_else(|| status.readiness.shortfall(&status.requirements).map(|short| short.item))
    }

    fn reset(
        &mut self,
        value: u32,
        status: &RigStatus,
        event: &mut Option<RigEvent>,
    ) -> Result<(ArmItem, u32), ArmItem> {
        let exchange = self.exchange.take().ok_or(ArmItem::RigNumber)?;
        if !matches!(status.state, RunState::Safe | RunState::Fault) {
            return Err(ArmItem::State);
        }
        if value != exchange.rig_number || !status.may_reset {
            return Err(ArmItem::Reset);
        }
        *event = Some(RigEvent::Reset);
        Ok((ArmItem::Reset, exchange.host_number))
    }

    /// What the exchange has led to so far.
    fn agreement(&self, status: &RigStatus) -> Result<Agreement, ArmItem> {
        let Exchange { host_number, rig_number, limits, .. } =
            *self.exchange.as_ref().ok_or(ArmItem::RigNumber)?;
        let configuration = Configuration { limits, ..status.configuration };
        Ok(Agreement { host_number, rig_number, configuration })
    }
}

/// The states in which a rig gives its number: idle, or latched and perhaps to be reset.
const fn may_exchange(state: RunState) -> bool {
    matches!(state, RunState::Standby | RunState::Safe | RunState::Fault)
}
