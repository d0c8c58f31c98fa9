#!/usr/bin/env python3
"""A damper rig behind the frames of can-protocol/yawbench.dbc.

It was written from that file and from docs/write-your-own-rig.md alone and shares no code with
yawbench: where the two disagree, one of them or the documents are wrong.

It knows the classical profile, in LOCK_STEP and by CLOCK, and simulates an ideal ram and a damper.
With --lie it does one thing wrong, which the host has to find.
"""

import argparse
import functools
import secrets
import socket
import struct
import sys
import time
import zlib

PROTOCOL_VERSION = 2
DBC_HASH = 0xFEA11EEF  # CRC-32 over the BO_ and SG_ lines, stated in the comment of the DBC
CLASSICAL, CLOCK, LOCK_STEP = 0, 0, 1
INIT, STANDBY, ARMED, RAMP_IN, RUN, RAMP_OUT, SAFE, FAULT = range(8)
HOLD, FOLLOW, FOLLOW_WITH_VELOCITY, CENTRE = range(4)

# Where a command may lead from the rig's own state. A latched rig stays where it is.
FOLLOWS = {
    ARMED: {ARMED, STANDBY, RAMP_IN, RUN, SAFE, FAULT},
    RAMP_IN: {RAMP_IN, RUN, RAMP_OUT, STANDBY, SAFE, FAULT},
    RUN: {RUN, RAMP_OUT, STANDBY, SAFE, FAULT},
    RAMP_OUT: {RAMP_OUT, STANDBY, SAFE, FAULT},
}

# Frame ids; those below PRESSURE_OFF and SYNC have the node added.
PRESSURE_OFF, SYNC, CMD, MEAS, FAULT_FRAME = 0x040, 0x080, 0x100, 0x200, 0x300
TELEMETRY, ARM_REQUEST, ARM_ANSWER, HEARTBEAT = 0x400, 0x600, 0x610, 0x700
OWN_FRAMES = (MEAS, FAULT_FRAME, TELEMETRY, ARM_ANSWER, HEARTBEAT)

# Items of ARM_REQUEST and ARM_ANSWER.
HOST_NUMBER, RIG_NUMBER = 0x0101, 0x0102
STROKE_UM, VELOCITY_UM_PER_S, ACCELERATION_MM_PER_S2, FORCE_N = 0x0201, 0x0202, 0x0203, 0x0204
ALIVE, ENABLED, ZERO_AGE_S, SHUNT_CHECK, FORCE_AT_REST_N = range(0x0301, 0x0306)
STROKE_LEFT_OUT_UM, STROKE_LEFT_IN_UM = 0x0306, 0x0307
CONFIGURATION_HASH = 0x0401
ARM, ARMED_ITEM, QUIET_CYCLES, REFUSED, STATE = range(0x0501, 0x0506)
RESET = 0x0601
UNKNOWN = 0xFFFFFFFF

CLEARED, PEER_SILENT, CONFIGURATION_MISMATCH, FORCE_LIMIT, PRESSURE_LOST = 0, 1, 4, 16, 34

OWN_LIMITS = {
    STROKE_UM: 100_000,
    VELOCITY_UM_PER_S: 1_000_000,
    ACCELERATION_MM_PER_S2: 50_000,
    FORCE_N: 30_000,
}
READINESS = range(ALIVE, STROKE_LEFT_IN_UM + 1)
WATCHDOG_CYCLES = 5
LARGEST_STEP = 5
QUIET_NEEDED = 300
FIRST_COMMAND_WITHIN = 500
LOST_HOST_S = 1.0  # LOCK_STEP has no clock
HEARTBEAT_S = 0.02

LIES = ["constant-force", "frozen-force", "reversed-force", "no-zero", "wrong-hash", "wrong-seal",
        "displacement-off"]


def crc_table(width, polynomial):
    top, table = 1 << (width - 1), []
    for byte in range(256):
        register = byte << (width - 8)
        for _ in range(8):
            register = (register << 1) ^ (polynomial if register & top else 0)
        table.append(register & ((1 << width) - 1))
    return table


CRC8, CRC16 = crc_table(8, 0x1D), crc_table(16, 0x1021)


def crc8(data, register):
    for byte in data:
        register = CRC8[register ^ byte]
    return register


def crc16(data, register=0xFFFF):
    for byte in data:
        register = ((register << 8) & 0xFFFF) ^ CRC16[(register >> 8) ^ byte]
    return register


@functools.lru_cache
def behind_data_id(can_id):
    return crc8(struct.pack(">H", 0x5000 + can_id), 0xFF)


def checksum(can_id, payload, mask=0):
    """CRC of a frame of 6 or 8 bytes; the mask is that of the seal, 0 for a plain frame."""
    return crc8(payload, behind_data_id(can_id) ^ mask) ^ 0xFF


def seal_mask(code, cycle):
    return (code + cycle // 15 * (2 * code + 1)) & 0xFF


def session_code(host_number, rig_number):
    return crc16(struct.pack("<II", host_number, rig_number))


def to_code(value, factor, bits):
    """The integer on the wire (round() rounds half to even), and whether it saturated."""
    code, limit = round(value / factor), (1 << (bits - 1)) - 1
    return max(-limit, min(limit, code)), abs(code) > limit


class Damper:
    """A dashpot with a relief valve, in series with a spring."""
    DASHPOT, SPRING, RELIEF = 100e3, 10e6, 15e3  # N s/m, N/m, N

    def __init__(self):
        self.force = 0.0

    def move(self, distance, dt):
        force = (self.force + self.SPRING * distance) / (1 + dt * self.SPRING / self.DASHPOT)
        self.force = max(-self.RELIEF, min(self.RELIEF, force))


class Exchange:
    """One arming exchange, from HOST_NUMBER on."""

    def __init__(self, host_number, used_bytes):
        self.host_number = host_number
        while True:
            self.rig_number = secrets.randbits(32)
            self.code = session_code(host_number, self.rig_number)
            if self.code & 0xFF and self.code & 0xFF not in used_bytes:
                break
        self.limits = {}
        self.asked = set()
        self.hash = None


class Session:
    """What holds from ARMED to STANDBY. Cycles are those of each sender, from 0."""

    def __init__(self, code, now):
        self.code, self.armed_at = code, now
        self.command_cycle, self.own_cycle = -1, 0
        self.displacement, self.velocity, self.mode = 0.0, 0.0, HOLD  # of the newest command
        self.fresh = False  # a command has come in this cycle
        self.cycles_without, self.last_command = 0, now


class Rig:
    def __init__(self, options):
        self.options, self.node = options, options.node
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.socket.bind((options.bus,))
        self.boot = secrets.randbits(32)
        self.state, self.counters = INIT, {}
        self.refused = False  # the last SYNC
        self.sync = None  # version, profile, pace, slow-down, period in us
        self.exchange, self.session, self.used_bytes = None, None, []
        self.host_boot = None
        self.position, self.velocity = 0.0, 0.0  # of the ram: m, m/s
        self.damper, self.frozen = Damper(), None
        self.limits = dict(OWN_LIMITS)
        self.limit_reached = False
        self.done = False
        now = time.monotonic()
        self.next_heartbeat, self.next_tick, self.quiet_since = now, now, now

    # Sending

    def send(self, base, body):
        """A plain frame: the counter and the state go before the body."""
        can_id = base + self.node
        counter = self.counters.get(can_id, 0)
        self.counters[can_id] = (counter + 1) % 15
        self.transmit(can_id, bytes([counter | self.state << 4]) + body)

    def transmit(self, can_id, payload, mask=0):
        data = bytes([checksum(can_id, payload, mask)]) + payload
        self.socket.send(struct.pack("<IB3x8s", can_id, len(data), data))

    def heartbeat(self):
        flags = 1 | (2 if self.state in (SAFE, FAULT) else 0)
        nibbles = PROTOCOL_VERSION | self.node << 4
        self.send(HEARTBEAT, struct.pack("<IBB", self.boot, flags, nibbles))
        self.next_heartbeat = time.monotonic() + HEARTBEAT_S

    def fault(self, code, detail):
        self.send(FAULT_FRAME, struct.pack("<HH", code, detail))

    def go_safe(self, code, detail, why):
        print(f"peer: SAFE, {why}", flush=True)
        self.state = SAFE
        self.fault(code, detail)
        self.heartbeat()

    def measure(self):
        """One MEAS, sealed."""
        session, lie = self.session, self.lie_now()
        force, displacement = self.damper.force, self.position
        if self.frozen is None or lie is None:
            self.frozen = force
        if lie == "constant-force":
            force = 5000.0
        elif lie == "frozen-force":
            force = self.frozen
        elif lie == "reversed-force":
            force = -force
        elif lie == "displacement-off":
            displacement += 0.010
        code = session.code ^ 0x2A if lie == "wrong-seal" else session.code
        force_code, force_saturated = to_code(force, 0.2, 20)
        place_code, place_saturated = to_code(displacement * 1000, 0.0002, 20)
        flags = (force_saturated or place_saturated) | self.limit_reached << 1
        values = (force_code & 0xFFFFF) | (place_code & 0xFFFFF) << 20
        cycle = session.own_cycle
        payload = (bytes([cycle % 15 | self.state << 4]) + values.to_bytes(5, "little")
                   + bytes([session.command_cycle % 15 | flags << 4]))
        self.transmit(MEAS + self.node, payload, seal_mask(code, cycle))
        session.own_cycle += 1

    def lie_now(self):
        late = self.session is not None and self.session.own_cycle >= self.options.after
        return self.options.lie if late else None

    # Receiving

    def hear(self, can_id, data):
        host_frames = (SYNC, ARM_REQUEST + self.node, HEARTBEAT, PRESSURE_OFF,
                       PRESSURE_OFF + self.node)
        if can_id == CMD + self.node and len(data) == 8:
            self.command(data)
        elif can_id in host_frames and len(data) == (6 if can_id < SYNC else 8) \
                and checksum(can_id, data[1:]) == data[0]:
            if can_id == SYNC:
                self.synchronise(data)
            elif can_id == ARM_REQUEST + self.node:
                item, value = struct.unpack("<HI", data[2:])
                if item == REFUSED:
                    self.closed_by_host()
                else:
                    self.send(ARM_ANSWER, struct.pack("<HI", *self.answer(item, value)))
            elif can_id == HEARTBEAT:
                boot, = struct.unpack("<I", data[2:6])
                if self.host_boot not in (None, boot):
                    self.quiet_since = time.monotonic()  # another host
                self.host_boot = boot
            elif self.state != FAULT:
                print("peer: FAULT, the host took the pressure away", flush=True)
                self.state, self.velocity = FAULT, 0.0
                self.fault(PRESSURE_LOST, 0)
                self.heartbeat()
        elif can_id in (base + self.node for base in OWN_FRAMES):
            self.quiet_since = time.monotonic()  # a second node under this number

    def synchronise(self, data):
        version, profile, pace = data[1] & 0xF, data[1] >> 4 & 3, data[1] >> 6
        period_us, slow_down = struct.unpack("<HB", data[2:5])
        wanted = (version, profile, pace, slow_down, period_us)
        if self.state in (INIT, STANDBY):
            if version != PROTOCOL_VERSION or profile != CLASSICAL or pace > LOCK_STEP \
                    or not period_us or not slow_down:
                if self.sync is not None or not self.refused:
                    self.state, self.sync, self.exchange = INIT, None, None
                    self.fault(CONFIGURATION_MISMATCH, version)
                self.refused = True
                return
            self.refused = False
            if wanted != self.sync:
                self.sync, self.exchange = wanted, None
                self.quiet_since = time.monotonic()
            self.state = STANDBY
        elif wanted != self.sync and self.state not in (SAFE, FAULT):
            self.fault(CONFIGURATION_MISMATCH, version)
            return
        self.heartbeat()

    def cycle_s(self):
        """Length of a cycle on this clock."""
        return self.sync[4] * 1e-6 * self.sync[3]

    # Arming

    def answer(self, item, value):
        """Item and value of the answer to one ARM_REQUEST."""
        exchange = self.exchange
        moving = self.state in (ARMED, RAMP_IN, RUN, RAMP_OUT)
        if item == HOST_NUMBER and not moving:
            if self.state == INIT:
                return self.refuse(STATE)
            if exchange is None or exchange.host_number != value:
                if exchange is not None:
                    self.quiet_since = time.monotonic()  # another host
                exchange = self.exchange = Exchange(value, self.used_bytes)
            return RIG_NUMBER, exchange.rig_number
        if exchange is None:
            return self.refuse(STATE)
        if item == RESET:
            if self.state not in (SAFE, FAULT):
                return self.refuse(STATE)
            if value != exchange.rig_number or self.velocity != 0.0:
                return self.refuse(RESET)
            self.state, self.sync, self.session, self.exchange = INIT, None, None, None
            self.fault(CLEARED, 0)
            return RESET, exchange.host_number
        if item == ARM and self.state == ARMED and value == exchange.rig_number ^ exchange.hash:
            return ARMED_ITEM, exchange.host_number ^ exchange.hash  # the first answer was lost
        if self.state != STANDBY:
            return self.refuse(STATE)
        exchange.asked.add(item)
        if item in OWN_LIMITS:
            exchange.limits[item] = min(value, OWN_LIMITS[item])
            return item, exchange.limits[item]
        if item in READINESS:
            return item, self.readiness(item)
        if item == CONFIGURATION_HASH:
            if len(exchange.limits) < len(OWN_LIMITS):
                return self.refuse(item)
            exchange.hash = self.configuration_hash(exchange.limits)
            if self.options.lie == "wrong-hash":
                return item, exchange.hash ^ 1
            return (item, exchange.hash) if value == exchange.hash else self.refuse(item)
        if item == ARM:
            return self.arm(value)
        return self.refuse(item)

    def closed_by_host(self):
        """The host refuses: the exchange is over, and so is a session without a command."""
        self.exchange = None
        if self.session is not None and self.session.command_cycle < 0:
            self.state, self.session = STANDBY, None

    def refuse(self, item):
        if self.state not in (ARMED, RAMP_IN, RUN, RAMP_OUT):
            self.exchange = None
        return REFUSED, item

    def readiness(self, item):
        left = OWN_LIMITS[STROKE_UM]
        place = round(self.position * 1e6)
        return {
            ALIVE: self.boot,
            ENABLED: 1,
            ZERO_AGE_S: UNKNOWN if self.options.lie == "no-zero" else 60,
            SHUNT_CHECK: 1,
            FORCE_AT_REST_N: round(abs(self.damper.force)),
            STROKE_LEFT_OUT_UM: max(0, left - place),
            STROKE_LEFT_IN_UM: max(0, left + place),
        }[item]

    def configuration_hash(self, limits):
        version, profile, pace, slow_down, period_us = self.sync
        return zlib.crc32(struct.pack(
            "<BBBBHH5I", version, profile, pace, slow_down, period_us, WATCHDOG_CYCLES,
            limits[STROKE_UM], limits[VELOCITY_UM_PER_S], limits[ACCELERATION_MM_PER_S2],
            limits[FORCE_N], DBC_HASH))

    def arm(self, value):
        exchange = self.exchange
        for item in (*OWN_LIMITS, *READINESS, CONFIGURATION_HASH):
            if item not in exchange.asked:
                return self.refuse(item)
        if value != exchange.rig_number ^ exchange.hash:
            return self.refuse(ARM)
        now = time.monotonic()
        missing = QUIET_NEEDED - int((now - self.quiet_since) / self.cycle_s())
        if missing > 0:
            return QUIET_CYCLES, missing
        self.used_bytes = (self.used_bytes + [exchange.code & 0xFF])[-16:]
        self.limits, self.session = exchange.limits, Session(exchange.code, now)
        self.state, self.next_tick = ARMED, now
        print("peer: ARMED", flush=True)
        return ARMED_ITEM, exchange.host_number ^ exchange.hash

    # Motion

    def command(self, data):
        """A CMD: accepted by its counter and its seal, obeyed where the states lead there."""
        session, counter = self.session, data[1] & 0xF
        if session is None:
            self.quiet_since = time.monotonic()  # another host: nobody commands an unarmed rig
            return
        if counter == 15:
            return
        step = (counter - session.command_cycle) % 15
        cycle = session.command_cycle + step
        if not 1 <= step <= LARGEST_STEP or \
                checksum(CMD + self.node, data[1:], seal_mask(session.code, cycle)) != data[0]:
            return
        if session.command_cycle < 0:
            # By CLOCK, half a period behind the host: MEAS arrives in the middle of its cycle.
            self.next_tick = time.monotonic() + self.cycle_s() / 2
        session.command_cycle = cycle
        state, mode = data[1] >> 4, data[7] >> 4
        place = int.from_bytes(data[2:5], "little", signed=True)
        velocity = int.from_bytes(data[5:7], "little", signed=True)
        valid = mode in (HOLD, CENTRE) or (place != -(1 << 23) and velocity != -(1 << 15))
        if state in FOLLOWS.get(self.state, ()) and valid:
            self.state, session.mode = SAFE if state == FAULT else state, mode
            session.displacement, session.velocity = place * 1e-7, velocity * 1e-5
            session.fresh, session.cycles_without = True, 0
            session.last_command = time.monotonic()
        if self.state in (SAFE, FAULT) and self.sync[2] == LOCK_STEP:
            self.measure()
        elif self.sync[2] == LOCK_STEP:
            self.cycle()
        if self.state == STANDBY:
            self.end_session()

    def cycle(self):
        """One cycle, and what was measured at its end."""
        self.move()
        if time.monotonic() >= self.next_heartbeat:
            self.heartbeat()  # slow messages come before MEAS
        self.measure()

    def move(self):
        """Moves the ram through one cycle."""
        session, dt = self.session, self.sync[4] * 1e-6
        before = self.position
        if self.state in (RAMP_IN, RUN, RAMP_OUT) and session.mode in (FOLLOW,
                                                                       FOLLOW_WITH_VELOCITY):
            ahead = session.velocity * dt if session.mode == FOLLOW_WITH_VELOCITY else 0.0
            target = (session.displacement if session.fresh else before) + ahead
        elif self.state in (RAMP_IN, RUN, RAMP_OUT) and session.mode == CENTRE:
            target = before - max(-0.005 * dt, min(0.005 * dt, before))
        else:  # brake, then hold; a rig without pressure stands here, too
            brake = self.limits[ACCELERATION_MM_PER_S2] * 1e-3 * dt
            velocity = max(0.0, abs(self.velocity) - brake)
            target = before + (velocity if self.velocity > 0 else -velocity) * dt
        far, stroke = self.limits[VELOCITY_UM_PER_S] * 1e-6 * dt, self.limits[STROKE_UM] * 1e-6
        self.limit_reached = abs(target - before) > far or abs(target) > stroke
        limited = max(-stroke, min(stroke, before + max(-far, min(far, target - before))))
        self.position, self.velocity = limited, (limited - before) / dt
        self.damper.move(limited - before, dt)
        session.fresh = False
        if abs(self.damper.force) > self.limits[FORCE_N] and self.state not in (SAFE, FAULT):
            self.go_safe(FORCE_LIMIT, 1000, "force above the limit")

    def end_session(self):
        print("peer: the host ended the session", flush=True)
        self.session, self.exchange = None, None
        self.done = self.options.exit_after_run

    # Time

    def tick(self, now):
        """What time alone brings: heartbeats, cycles by CLOCK, and the lost host."""
        if now >= self.next_heartbeat:
            self.heartbeat()
        session = self.session
        if session is None:
            return
        if session.command_cycle < 0:
            if now - session.armed_at > FIRST_COMMAND_WITHIN * self.cycle_s():
                print("peer: no command came", flush=True)
                self.state, self.session = STANDBY, None
        elif self.sync[2] == LOCK_STEP:
            if self.state not in (SAFE, FAULT):
                self.next_tick = now
                if now - session.last_command > LOST_HOST_S:
                    self.go_safe(PEER_SILENT, round(LOST_HOST_S / self.cycle_s()),
                                 "the host is silent")
            elif now >= self.next_tick:
                self.next_tick += self.cycle_s()
                self.move()  # to rest: a latched rig has its own clock
        elif now >= self.next_tick:
            self.next_tick = max(self.next_tick + self.cycle_s(), now)
            session.cycles_without = 0 if session.fresh else session.cycles_without + 1
            if self.state not in (SAFE, FAULT) and session.cycles_without >= WATCHDOG_CYCLES:
                self.go_safe(PEER_SILENT, session.cycles_without, "the host is silent")
            if session.cycles_without > FIRST_COMMAND_WITHIN:
                self.session = None  # latched, and nobody listens
            else:
                self.cycle()

    def run(self):
        while not self.done:
            by_clock = self.session is not None and self.session.command_cycle >= 0 \
                and (self.sync[2] == CLOCK or self.state in (SAFE, FAULT))
            deadline = min(self.next_heartbeat, self.next_tick) if by_clock else self.next_heartbeat
            self.socket.settimeout(max(1e-6, deadline - time.monotonic()))
            try:
                can_id, length, data = struct.unpack("<IB3x8s", self.socket.recv(16))
                if can_id <= 0x7FF:  # neither extended nor remote nor an error
                    self.hear(can_id, data[:length])
            except TimeoutError:
                pass
            self.tick(time.monotonic())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--bus", default="vcan0", help="CAN interface")
    parser.add_argument("--node", type=int, default=1, choices=range(1, 5))
    parser.add_argument("--exit-after-run", action="store_true",
                        help="end with the first session that the host ends")
    parser.add_argument("--lie", choices=LIES)
    parser.add_argument("--after", type=int, default=0,
                        help="measurements before the lie begins")
    Rig(parser.parse_args()).run()
    return 0


if __name__ == "__main__":
    sys.exit(main())
