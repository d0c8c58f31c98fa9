#!/usr/bin/env python3
"""A locomotive that has no memory for its track and reads it from a track server.

It was written from can-protocol/yawbench.dbc alone, from the comments of the bus and of TRACK_*,
and shares no code with yawbench: where the two disagree, one of them or the document is wrong.

It prints one JSON object: "samples" is what the server offers, "received" what was taken of them,
and "refused" counts the frames whose CRC did not fit.
"""

import argparse
import json
import pathlib
import secrets
import socket
import struct
import sys
import time
import zlib

REQUEST, OFFER, CENTRE_LINE, RAILS = 0x540, 0x541, 0x542, 0x543
ITEMS = ["first_um", "step_um", "samples", "ways", "fingerprint"]
THERE_AND_BACK, INVALID = 2, -(1 << 23)
CHANNELS = ["vertical", "alignment", "cross_level", "gauge"]
COUNTED_SAMPLES = 262144  # of the fingerprint, 12 bytes each
LARGEST_REQUEST = 200  # below 256, so that its number says which of them a sample is
QUIET_S, PATIENCE_S, CONNECT_S = 0.2, 5.0, 60.0  # the last leaves time to start a server by hand


def crc(data, register, width, polynomial):
    """CRC of either width, not reflected, without a final xor."""
    top = 1 << (width - 1)
    for byte in data:
        register ^= byte << (width - 8)
        for _ in range(8):
            register = (register << 1) ^ (polynomial if register & top else 0)
        register &= (1 << width) - 1
    return register


def checksum(can_id, payload, mask=0):
    """CRC of a frame of 8 bytes; the mask is that of the seal, 0 for a plain frame."""
    behind_data_id = crc(struct.pack(">H", 0x5000 + can_id), 0xFF, 8, 0x1D)
    return crc(payload, behind_data_id ^ mask, 8, 0x1D) ^ 0xFF


class Bus:
    def __init__(self, interface):
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        # The frames of the server alone: with the flags in the mask, neither extended nor remote.
        mask = socket.CAN_SFF_MASK | socket.CAN_EFF_FLAG | socket.CAN_RTR_FLAG
        filters = [part for can_id in (OFFER, CENTRE_LINE, RAILS) for part in (can_id, mask)]
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER,
                               struct.pack(f"={len(filters)}I", *filters))
        self.socket.bind((interface,))

    def send(self, can_id, data):
        self.socket.send(struct.pack("=IB3x8s", can_id, len(data), data))

    def receive(self, timeout):
        """Id and payload of a frame; TimeoutError if none comes."""
        self.socket.settimeout(timeout)
        can_id, length, data = struct.unpack("=IB3x8s", self.socket.recv(16))
        return can_id, data[:length]


class Line:
    """A stream with frames in SLIP (RFC 1055): id, high byte first, and payload."""
    END, ESC, ESC_END, ESC_ESC = b"\xc0", b"\xdb", b"\xdb\xdc", b"\xdb\xdd"

    def __init__(self, path):
        if pathlib.Path(path).is_socket():
            pathlib.Path(path).unlink()  # left over
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listener:
            listener.bind(path)
            listener.listen(1)
            listener.settimeout(CONNECT_S)
            print("listening", file=sys.stderr, flush=True)
            self.socket, _ = listener.accept()
        pathlib.Path(path).unlink()
        self.rest, self.frames = b"", []

    def send(self, can_id, data):
        packet = struct.pack(">H", can_id) + data
        packet = packet.replace(self.ESC, self.ESC_ESC).replace(self.END, self.ESC_END)
        self.socket.sendall(self.END + packet + self.END)

    def receive(self, timeout):
        self.socket.settimeout(timeout)
        while not self.frames:
            heard = self.socket.recv(4096)
            if not heard:
                raise RuntimeError("the server closed the line")
            *packets, self.rest = (self.rest + heard).split(self.END)
            self.frames += filter(None, packets)  # nothing is between two ENDs
        packet = self.frames.pop(0)
        packet = packet.replace(self.ESC_END, self.END).replace(self.ESC_ESC, self.ESC)
        return int.from_bytes(packet[:2], "big"), packet[2:]


class Reader:
    def __init__(self, link, session, drop):
        self.link, self.session, self.drop = link, session, drop
        self.offer, self.code, self.sample_frames, self.refused = {}, None, 0, 0
        self.codes = bytearray()  # of whole samples, in the order of the fingerprint
        self.next, self.end = 0, 0  # the sample that comes next, and the end of the request
        self.centre_line = None  # of the sample that comes next
        self.heard, self.progress, self.lost, self.asked_again = 0.0, 0.0, False, False

    def ask(self):
        """Asks for what is missing of the request. Nothing asked for: which track is it?"""
        payload = struct.pack("<BHI", self.end - self.next, self.session, self.next)
        self.link.send(REQUEST, bytes([checksum(REQUEST, payload)]) + payload)
        self.heard = time.monotonic()

    def until(self, done):
        """Asks until it is done, again as soon as a frame is missing or none comes any more."""
        self.progress = time.monotonic()
        self.ask()
        while not done():
            try:
                self.hear(*self.link.receive(QUIET_S))
            except TimeoutError:
                pass
            now = time.monotonic()
            if now - self.progress > PATIENCE_S:
                raise RuntimeError(f"no progress for {PATIENCE_S:g} s, at sample {self.next}")
            # At once, but once: behind a gap, frames of the old request are still under way.
            if (self.lost and not self.asked_again) or now - self.heard >= QUIET_S:
                self.ask()
                self.asked_again = True
            self.lost = False

    def hear(self, can_id, data):
        if len(data) != 8:
            return
        if can_id == OFFER:
            item, session, value = struct.unpack("<BHI", data[1:])
            if checksum(OFFER, data[1:]) != data[0]:
                self.refused += 1
            elif session == self.session and item < len(ITEMS) and ITEMS[item] not in self.offer:
                # FIRST_UM is in two's complement.
                signed = item == 0 and value >= 1 << 31
                self.offer[ITEMS[item]] = value - (1 << 32) * signed
                self.heard = self.progress = time.monotonic()
        elif can_id in (CENTRE_LINE, RAILS) and self.code is not None:
            self.sample_frames += 1
            if not self.drop or self.sample_frames % self.drop:
                self.hear_sample(can_id, data)

    def hear_sample(self, can_id, data):
        """Takes the sample that comes next, and no other: a gap is asked for again from there."""
        sample = self.next + (data[1] - self.next) % 256
        if sample >= self.end:
            sample -= 256  # not asked for, so it was there before
        mask = (self.code + sample // 15 * (2 * self.code + 1)) >> 8 & 0xFF
        if sample < 0 or checksum(can_id, data[1:], mask) != data[0]:
            self.refused += 1
            return
        self.heard = time.monotonic()
        if sample == self.next and can_id == CENTRE_LINE:
            self.centre_line, self.asked_again = data[2:], False
        elif sample == self.next and self.centre_line is not None:
            self.codes += self.centre_line + data[2:]
            self.next, self.centre_line, self.asked_again = self.next + 1, None, False
            self.progress = self.heard
        elif sample >= self.next:
            self.lost = True

    def read(self, limit):
        self.until(lambda: len(self.offer) == len(ITEMS))
        numbers = struct.pack("<II", self.session, self.offer["fingerprint"])
        self.code = crc(numbers, 0xFFFF, 16, 0x1021)
        has_end = self.offer["ways"] != THERE_AND_BACK
        if limit is None and not has_end:
            raise RuntimeError("the track has no end: say with --samples how much of it to read")
        wanted = min(limit or self.offer["samples"], self.offer["samples"] if has_end else limit)
        while self.next < wanted:
            self.end = min(self.next + LARGEST_REQUEST, wanted)
            self.until(lambda: self.next == self.end)

    def summary(self):
        computed = None
        counted = min(self.offer["samples"], COUNTED_SAMPLES)
        if self.next >= counted:
            head = struct.pack("<iII", *map(self.offer.get, ("first_um", "step_um", "ways")))
            computed = f"{zlib.crc32(head + self.codes[:counted * 12]):08x}"
        codes = [int.from_bytes(self.codes[at:at + 3], "little", signed=True)
                 for at in range(0, len(self.codes), 3)]
        largest = {name: max((abs(code) for code in codes[at::4] if code != INVALID), default=0)
                   for at, name in enumerate(CHANNELS)}
        offered = self.offer | {"fingerprint": f"{self.offer['fingerprint']:08x}"}
        return {"session": self.session, **offered, "computed_fingerprint": computed,
                "received": self.next, "refused": self.refused,
                "largest_mm": {name: code / 1e5 for name, code in largest.items()}}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    where = parser.add_mutually_exclusive_group(required=True)
    where.add_argument("--bus", help="CAN interface")
    where.add_argument("--listen", metavar="PATH", help="Unix socket that the server connects to")
    parser.add_argument("--session", type=int, default=secrets.randbits(16),
                        help="0 to 65535; drawn if not given")
    parser.add_argument("--samples", type=int, help="how many to read; all if not given")
    parser.add_argument("--drop", type=int, default=0, help="ignore every N-th sample frame")
    options = parser.parse_args()
    if not 0 <= options.session <= 0xFFFF:
        parser.error("--session: 0 to 65535")
    try:
        link = Bus(options.bus) if options.bus else Line(options.listen)
        reader = Reader(link, options.session, options.drop)
        reader.read(options.samples)
    except (RuntimeError, OSError) as error:
        print(f"track_reader: {error}", file=sys.stderr)
        return 1
    summary = reader.summary()
    print(json.dumps(summary))
    if summary["computed_fingerprint"] not in (None, summary["fingerprint"]):
        print("track_reader: the samples do not have the offered fingerprint", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
