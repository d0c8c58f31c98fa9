//! Rigs that are lost while the vehicle goes on, with what is expected of each.
//!
//! Every fault of the table that is one rig's own is injected into the first of three rigs, whose
//! slots go on with their models: it is found by the same signals within the same cycles as where
//! it ends a run, and the two others go on. With one rig nothing real is left, and the run is
//! ramped out.

use super::faulty_bus::FaultyBus;
use super::kind::Fault;
use super::session::{Injected, Injection, in_memory, inject, nodes};
use super::table::{BEGIN, Expected, ROWS, Row};
use crate::BenchError;
use crate::bus::BusChoice;
use firmware_core::compensation::Compensator;
use firmware_core::damper::Damper;
use scenario::run::{IfRigDropsOut, Run, SlotForce};

/// Cycles that a run goes on after its rig is to have dropped out.
const WATCHED: u64 = 1000;

/// The same run with its first dampers on so many rigs, on nodes 1, 2 and so on, and what follows
/// where one of them is lost.
#[must_use]
pub fn on_rigs(run: &Run, count: usize, if_lost: IfRigDropsOut) -> Run {
    let mut run = run.clone();
    for (number, slot) in run.slots.iter_mut().take(count).enumerate() {
        let own = number as u8 + 1;
        match &mut slot.force {
            SlotForce::Rig { node, if_drops_out, .. } => (*node, *if_drops_out) = (own, if_lost),
            SlotForce::Modelled(model) => slot.force = rig(own, model.clone(), if_lost),
            SlotForce::StandIn { model, .. } => slot.force = rig(own, (**model).clone(), if_lost),
        }
    }
    run
}

fn rig(node: u8, model: Damper, if_drops_out: IfRigDropsOut) -> SlotForce {
    SlotForce::Rig {
        node,
        bus: None,
        virtual_clearance_2a_m: 0.0,
        virtual_compliance_m_per_n: 0.0,
        specimen: Box::new(model.clone()),
        model: Box::new(model),
        watch: None,
        compensator: Compensator::None,
        accept_delay_error: false,
        if_drops_out,
    }
}

/// The faults of the table that one rig has, with what is expected where the vehicle may go on
/// without it, beside so many others.
pub fn drop_out_rows(others: usize) -> Vec<Row> {
    let lost = |row: &Row| {
        let Expected::Ends(signals, within) = row.expected else { return None };
        let expected = match others {
            0 => Expected::RampsOut(signals, within),
            _ => Expected::DropsOut(signals, within),
        };
        is_of_one_rig(row.fault).then_some(Row { expected, ..*row })
    };
    ROWS.iter().filter_map(lost).collect()
}

/// Whether a fault is that of one rig: not of the bus, of the host, or of a second sender.
const fn is_of_one_rig(fault: Fault) -> bool {
    !matches!(
        fault,
        Fault::GarbageBeside
            | Fault::StuckCounter
            | Fault::PlainSender
            | Fault::SenderAhead(_)
            | Fault::PlainCommander
            | Fault::Down
            | Fault::NoRoom { .. }
            | Fault::SkipSlots(_)
    )
}

/// Injects every fault of one rig into the first of a run's rigs, beside so many others.
///
/// # Errors
/// A rig cannot be armed.
pub fn drop_outs(
    run: &Run,
    others: usize,
    mut each: impl FnMut(&Row, &Injected, bool),
) -> Result<bool, BenchError> {
    let run = on_rigs(run, 1 + others, IfRigDropsOut::Model);
    in_memory(&run, |session, node| {
        let mut all_right = true;
        for row in drop_out_rows(others) {
            let Row { fault, lasts, expected, number, .. } = row;
            let seed = u64::from(number);
            let mut bus = FaultyBus::new(&run.rig, node, seed).beside(nodes(session));
            let until = BEGIN + expected.within().unwrap_or(0) + WATCHED;
            let injection = Injection { fault, begin: BEGIN, lasts, until };
            let injected = inject(session, &run, &mut bus, &injection)
                .map_err(|why| why.on(&BusChoice::Memory))?;
            let is_right = expected.is_met_by(&injected);
            all_right &= is_right;
            each(&row, &injected, is_right);
        }
        Ok(all_right)
    })
}
