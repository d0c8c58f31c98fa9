#!/usr/bin/env python3
"""A rig that knows its own DBC and nothing else: no session, no seal, no state of a bench of ours.

    python3 tests/vcan/foreign_rig.py --bus vcan0 --messages servo --time-out-s 0.1

It reads scenarios/rigs/own-messages/servo.dbc or plain.dbc with cantools, and talks by python-can.
Every set point is followed and answered with a measurement. Where none comes for a while, it
measures by its own clock, and after its time-out, if it has one, it stops.
"""

import argparse
import math
import pathlib
import random
import time

import can
import cantools

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "scenarios/rigs/own-messages"
CYCLE_S = 1e-3
# The damper: stiffness (N/m), damping (N s/m), relief force (N), slope beyond it (N s/m).
KE, CE, RELIEF, C2 = 12.5e6, 1.0e6, 11.1e3, 80.0e3
STATE_CYCLES = 50


class Damper:
    """A spring in series with a dashpot that has a relief force."""

    def __init__(self):
        self.force_n = 0.0

    def move(self, velocity_m_per_s):
        size = abs(self.force_n)
        slip = size / CE if size < RELIEF else RELIEF / CE + (size - RELIEF) / C2
        slip = math.copysign(slip, self.force_n)
        self.force_n += KE * (velocity_m_per_s - slip) * CYCLE_S


class Rig:
    """Ram and damper, and what it was sent last."""

    def __init__(self, time_out_s):
        self.time_out_s = time_out_s
        self.ram_m = 2.5e-3
        self.target_m, self.velocity_m_per_s = self.ram_m, 0.0
        self.enabled = False
        self.told_at = time.monotonic()
        self.damper = Damper()
        self.cycles = 0
        self.sequence = 0
        self.noise = random.Random(1)

    def told(self, target_m, velocity_m_per_s, enabled):
        self.target_m, self.velocity_m_per_s = target_m, velocity_m_per_s
        self.enabled = enabled
        self.told_at = time.monotonic()

    def timed_out(self):
        silent_s = time.monotonic() - self.told_at
        return self.time_out_s is not None and silent_s > self.time_out_s

    def cycle(self, passed_s):
        """One cycle: the reference runs on at its velocity for the time that has passed."""
        before_m = self.ram_m
        if self.enabled and not self.timed_out():
            self.target_m += self.velocity_m_per_s * passed_s
            step_m = max(-0.5e-3, min(0.5e-3, self.target_m - self.ram_m))
            self.ram_m += step_m
        self.damper.move((self.ram_m - before_m) / CYCLE_S)
        self.cycles += 1

    def measured(self):
        """Force (N) and displacement (m), as the sensors show them."""
        return self.damper.force_n + self.noise.gauss(0, 3), self.ram_m + self.noise.gauss(0, 1e-6)


class Servo:
    """The messages of servo.dbc."""

    def __init__(self):
        self.database = cantools.database.load_file(FOLDER / "servo.dbc")
        self.command = self.database.get_message_by_name("SetPoint")

    def take(self, rig, data):
        values = self.command.decode(data, decode_choices=False)
        rig.sequence = values["Sequence"]
        rig.told(values["SetPosition"] * 1e-3, values["SetVelocity"] * 1e-3, values["Mode"] == 1)

    def say(self, rig):
        force_n, displacement_m = rig.measured()
        yield "Measured", {
            "LoadCell": force_n, "Position": displacement_m * 1e3, "SensorsOk": 1,
            "Alive": rig.cycles % 256, "SequenceSeen": rig.sequence,
        }
        if rig.cycles % STATE_CYCLES == 0:
            state = 1 if rig.timed_out() else 2 if rig.enabled else 0
            yield "State", {"ServoState": state, "OilTemperature": 35}


class Plain:
    """The messages of plain.dbc: its cylinder counts inwards, a compression is positive."""

    def __init__(self):
        self.database = cantools.database.load_file(FOLDER / "plain.dbc")
        self.command = self.database.get_message_by_name("Drive")

    def take(self, rig, data):
        values = self.command.decode(data, decode_choices=False)
        if values["Page"] == 1:
            rig.told(values["Target"] * -1e-6, 0.0, True)

    def say(self, rig):
        force_n, displacement_m = rig.measured()
        yield "Sensors", {
            "Force": force_n * -1e-3, "Stroke": displacement_m * -1e6, "Life": rig.cycles % 15,
        }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--bus", required=True)
    parser.add_argument("--messages", choices=["servo", "plain"], required=True)
    parser.add_argument("--time-out-s", type=float)
    parser.add_argument("--own-clock-after-s", type=float, default=0.05,
                        help="silence after which it measures by its own clock")
    options = parser.parse_args()
    messages = {"servo": Servo, "plain": Plain}[options.messages]()
    rig = Rig(options.time_out_s)
    command = messages.command
    wanted = [{
        "can_id": command.frame_id, "can_mask": 0x1FFFFFFF,
        "extended": command.is_extended_frame,
    }]
    frames = {m.name: (m, m.frame_id, m.is_extended_frame) for m in messages.database.messages}
    with can.Bus(interface="socketcan", channel=options.bus, can_filters=wanted) as bus:
        rig.told_at = -math.inf
        last_at = time.monotonic()
        while True:
            frame = newer = bus.recv(CYCLE_S)
            # Of several set points the newest counts: a rig that is late does not stay so.
            while newer is not None:
                frame, newer = newer, bus.recv(0)
            now = time.monotonic()
            if frame is not None:
                messages.take(rig, frame.data)
                rig.cycle(CYCLE_S)
            elif now - rig.told_at < options.own_clock_after_s:
                continue
            else:
                rig.cycle(min(now - last_at, 0.05))
            last_at = now
            for name, values in messages.say(rig):
                message, frame_id, extended = frames[name]
                data = message.encode(values, strict=False)
                bus.send(can.Message(arbitration_id=frame_id, is_extended_id=extended, data=data))


if __name__ == "__main__":
    main()
