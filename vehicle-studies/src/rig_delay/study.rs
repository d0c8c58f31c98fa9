//! Critical speeds at every delay of a list.

use super::answer::{OnRigs, Point, RigDelay, Speeds};
use super::page::page;
use super::procedure::{OWN_KEY, Question};
use super::text::text;
use crate::critical_speed::{Ascent, Fold, LinearSpeed, set_off};
use crate::error::StudyError;
use crate::one_force::refuse_other_bogie;
use crate::study::Study;
use crate::trip::track::rough_start;
use crate::trip::{Equipped, Rigs};
use firmware_core::line::Sensitivity;
use firmware_core::vehicle::DAMPER_SLOTS;
use report::Report;
use scenario::run::{CYCLE_S, Run, SlotForce};

/// Seed of the track on which the delay is measured.
const SEED: u64 = 1;

impl Study for Question {
    const NAME: &'static str = "rig-delay";
    const ANSWERS: &'static str = "delays";
    const OWN_KEY: Option<&'static str> = Some(OWN_KEY);
    type Answer = RigDelay;

    fn fits(&self, run: &Run) -> Result<(), StudyError> {
        refuse_other_bogie(run)?;
        if run.slots.is_empty() { Err(StudyError::NoDamper) } else { Ok(()) }
    }

    fn answer(
        &self,
        run: &Run,
        equipped: &Equipped<'_>,
        own: Option<f64>,
        answer: &mut RigDelay,
    ) -> Result<(), StudyError> {
        let (fold, speeds) = self.speeds(equipped)?;
        answer.modelled = Some(speeds);
        answer.hunting_hz = fold.cycle.last().and_then(|last| last.motion.frequency_hz);
        let delay_s = 1e-3 * own.unwrap_or_default();
        let (mut all, mut as_in_scenario) = ([false; DAMPER_SLOTS], [false; DAMPER_SLOTS]);
        for ((all, on_rig), slot) in all.iter_mut().zip(&mut as_in_scenario).zip(&run.slots) {
            // What a rig stands for is as late as the rig.
            let is_late = matches!(slot.force, SlotForce::Rig { .. } | SlotForce::StandIn { .. });
            (*all, *on_rig) = (true, is_late);
        }
        let behind = |slots| {
            let rigs = Rigs::late_by(&run.rig, delay_s, slots);
            self.on_rigs(
                run,
                &equipped.behind(rigs.ok_or(StudyError::NoDelay(delay_s))?),
                answer.hunting_hz,
            )
        };
        if as_in_scenario.contains(&true) {
            answer.as_in_scenario = Some(behind(as_in_scenario)?);
        }
        if all != as_in_scenario {
            answer.all_on_rigs = Some(behind(all)?);
        }
        Ok(())
    }

    fn text(&self, points: &[Point]) -> String {
        text(points, self)
    }

    fn page(&self, points: &[Point], report: Report) -> Report {
        page(points, self, report)
    }
}

impl Question {
    fn speeds(&self, equipped: &Equipped<'_>) -> Result<(Fold, Speeds), StudyError> {
        let fold = Fold::of(equipped, &self.procedure)?;
        let linear = LinearSpeed::of(equipped, &self.procedure, self.stroke_m)?;
        let hunts_from_kmh =
            if self.hunts_from { Ascent::of(equipped, &self.procedure)?.mean_kmh } else { None };
        let speeds = Speeds { fold: fold.dies, linear: linear.critical, hunts_from_kmh };
        Ok((fold, speeds))
    }

    fn on_rigs(
        &self,
        run: &Run,
        equipped: &Equipped<'_>,
        hunting_hz: Option<f64>,
    ) -> Result<OnRigs, StudyError> {
        let (_, speeds) = self.speeds(equipped)?;
        let measured_delay_s = self.measured_delay_s(equipped, 3.6 * run.speed_m_per_s)?;
        let on_rigs = equipped
            .dampers
            .iter()
            .enumerate()
            .filter(|(slot, _)| equipped.rigs.as_ref().is_some_and(|rigs| rigs.has(*slot)));
        let costs = on_rigs.map(|(_, damper)| {
            Some(100.0 * Sensitivity::of(damper, hunting_hz?).cost(measured_delay_s?))
        });
        let costs: Vec<Option<f64>> = costs.collect();
        let rigs = costs.len();
        let lost: Option<Vec<f64>> = costs.into_iter().collect();
        let damping_lost_percent = lost.map(|lost| signal::statistics::mean(&lost));
        Ok(OnRigs { rigs, measured_delay_s, damping_lost_percent, speeds })
    }

    /// The delay of the force at a speed (km/h), mean over the rigs (s); none where the vehicle
    /// leaves its track too early.
    fn measured_delay_s(
        &self,
        equipped: &Equipped<'_>,
        kmh: f64,
    ) -> Result<Option<f64>, StudyError> {
        let length_m = self.measured_s * kmh / 3.6;
        let track = rough_start(&self.procedure.band(SEED), length_m);
        let track = track.view();
        let (trip, mut state, _) = set_off(equipped, &self.procedure, &track, kmh)?;
        trip.go(&mut state, self.measured_s, |_| {})?;
        let delays: Option<Vec<f64>> =
            state.delays().map(|blocks| Some(blocks.residual(CYCLE_S)?.mean_s)).collect();
        Ok(delays
            .filter(|delays| !delays.is_empty())
            .map(|delays| signal::statistics::mean(&delays)))
    }
}
