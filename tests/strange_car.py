#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""A car that nothing here has seen: its DBC and a candump log, encoded by cantools. Other identifiers (one of 29 bits), both
byte orders, odd scales, German names, four target slots on a bus of their own, and signals that look like what is wanted.

--plant NAME makes the DBC that is written (or the log) wrong in one way, while the log stays as the right one has it.
"""
import argparse
import math
import random

import cantools

DBC = """VERSION "strange"

NS_ :

BS_:

BU_: A B

BO_ {ego} FAHRDYNAMIK: 8 A
 SG_ ZAEHLER : 3|4@0+ (1,0) [0|15] "" B
 SG_ FAHRZEUG_GESCHW : {geschw} (0.05625,0) [0|460] "{geschw_unit}" B
 SG_ GIERRATE : 36|12@1- ({gier_scale},0) [0|0] "{gier_unit}" B
 SG_ MotorSpeed : 55|16@0+ (0.25,0) [0|16383] "rpm" B

BO_ 613 PEDALE: 4 A
 SG_ BREMSE_Pedal : 9|1@1+ (1,0) [0|1] "" B
 SG_ FAHRPEDAL_Position : 23|8@0+ (0.4,0) [0|100] "%" B
 SG_ BREMSE_Temp : 31|8@0+ (1,-40) [-40|215] "degC" B

BO_ 1203 TEMPOMAT: 8 A
 SG_ SET_Speed : 0|8@1+ (1,0) [0|250] "km/h" B
 SG_ TRIP_Distance : 23|16@0+ (1,0) [0|65535] "m" B
"""
SLOT = """
BO_ {id} ZIEL_{slot:02d}: 8 B
 SG_ GUELTIG : 0|1@1+ (1,0) [0|1] "" A
 SG_ ABSTAND : {abstand} ({abstand_scale},0) [0|0] "m" A
 SG_ RELATIV_GESCHW : 39|13@0- ({rel_scale},0) [0|0] "{rel_unit}" A
 SG_ QUER_ABSTAND : 48|10@1- ({quer_scale},0) [0|0] "m" A
"""
RIGHT = dict(ego=0x98FEF117, geschw="15|13@0+", geschw_unit="km/h", gier_scale=0.05, gier_unit="deg/s",
             abstand="2|14@1+", abstand_scale=0.0125, rel_scale=0.015625, rel_unit="m/s", quer_scale=0.05, id=0x3A1)
# What the DBC that is handed out says instead
WRONG = {
    "none": {},
    "sign": {"rel_scale": -0.015625},
    "rel_unit": {"rel_unit": "km/h"},
    "scale": {"abstand_scale": 0.016},
    "geschw_unit": {"geschw_unit": "m/s"},
    "order": {"geschw": "8|13@1+"},
    "lateral": {"quer_scale": -0.05},
    "yaw_unit": {"gier_unit": "rad/s"},
    "yaw_small": {"gier_scale": 0.05 * math.pi / 180},
    "id": {"ego": 0x98FEF118},
}
# What a counter in the log says at its n-th frame
COUNTS = {"counter_repeats": lambda n: n // 2, "counter_still": lambda n: 5, "counter_skips": lambda n: 3 * n}
# Targets of a radar that repeats itself
FROZEN = [(33.3, 0.0, 0.1), (50.0, 0.0, 3.0)]
SLOTS = 4


def dbc(what):
    return DBC.format(**what) + "".join(SLOT.format(**dict(what, id=what["id"] + i, slot=i)) for i in range(SLOTS))


class Drive:
    """Ego speed and yaw rate that vary; slot 0 a lead, slot 1 standing objects one after the other, slot 2 oncoming cars."""

    def __init__(self, seed):
        self.rng = random.Random(seed)
        self.t = 0.0
        self.lead = 40.0
        self.standing = [100.0, 3.0]
        self.oncoming = [150.0, 4.0]

    def ego(self):
        return 16 + 7 * math.sin(self.t / 9)

    def yaw(self):
        return 0.12 * math.sin(self.t / 5)

    def lead_speed(self):
        return self.ego() - 3 * math.cos(self.t / 4)

    def step(self, dt):
        v, w = self.ego(), self.yaw()
        self.t += dt
        self.lead += (self.lead_speed() - v) * dt
        self.standing[0] -= v * dt
        self.standing[1] -= w * self.standing[0] * dt
        self.oncoming[0] -= (v + 14) * dt
        if self.standing[0] < 3 or abs(self.standing[1]) > 20:
            self.standing = [self.rng.uniform(60, 110), self.rng.uniform(-4, 4)]
        if self.oncoming[0] < 3:
            self.oncoming = [self.rng.uniform(100, 180), 4.0]

    def targets(self):
        v = self.ego()
        return [(self.lead, self.lead_speed() - v, 0.2), (self.standing[0], -v, self.standing[1]),
                (self.oncoming[0], -v - 14, self.oncoming[1]), None]


class Log:
    def __init__(self, db, plant, spread, seed):
        self.db, self.plant, self.spread, self.rng = db, plant, spread, random.Random(seed)
        self.lines = []
        self.counter = 0
        self.count = COUNTS.get(plant, lambda n: n)

    def send(self, t, iface, name, **values):
        m = self.db.get_message_by_name(name)
        data = m.encode({s.name: values.get(s.name, 0) for s in m.signals}, strict=False)
        wide = "%08X" % m.frame_id if m.is_extended_frame else "%03X" % m.frame_id
        line = "(%017.6f) %s %s#%s\n" % (t, iface, wide, data.hex().upper())
        self.lines.append(line)
        if self.plant == "twice" and name == "FAHRDYNAMIK":
            self.lines.append(line)

    def ego(self, t, d):
        speed = {"frozen": 13.8, "parked": 0.0}.get(self.plant, d.ego() + self.rng.gauss(0, 0.02))
        self.send(t, "can3", "FAHRDYNAMIK", ZAEHLER=self.count(self.counter) % 16, FAHRZEUG_GESCHW=speed * 3.6,
                  GIERRATE=math.degrees(d.yaw()), MotorSpeed=2000 + 50 * speed)
        self.counter += 1

    def targets(self, d):
        if self.plant == "alone":
            return d.targets()[:1] + [None] * 3
        if self.plant in ("radar_frozen", "parked"):
            return FROZEN + [None, None]
        return FROZEN + d.targets()[2:] if self.plant == "slots_frozen" else d.targets()

    def scan(self, t, d):
        for i, target in enumerate(self.targets(d)):
            name = "ZIEL_%02d" % i
            if target in FROZEN:
                self.send(t + i * self.spread * 1e-3, "can7", name, GUELTIG=1, ABSTAND=target[0], QUER_ABSTAND=target[2])
            elif target:
                self.send(t + i * self.spread * 1e-3, "can7", name, GUELTIG=int(self.plant != "invalid"), ABSTAND=target[0] +
                          self.rng.gauss(0, 0.1), RELATIV_GESCHW=target[1] + self.rng.gauss(0, 0.05),
                          QUER_ABSTAND=target[2] + self.rng.gauss(0, 0.05))
            else:
                self.send(t + i * self.spread * 1e-3, "can7", name)


def main():
    p = argparse.ArgumentParser()
    p.add_argument("--plant", choices=sorted(WRONG) + sorted(COUNTS) + ["twice", "frozen", "invalid", "radar_frozen", "slots_frozen",
                                                                           "parked", "alone"], default="none")
    p.add_argument("--seconds", type=float, default=90)
    p.add_argument("--spread", type=float, default=0.4, help="ms from slot to slot")
    p.add_argument("--dbc", required=True)
    p.add_argument("--log", required=True)
    a = p.parse_args()
    with open(a.dbc, "w") as f:
        f.write(dbc(dict(RIGHT, **WRONG.get(a.plant, {}))))
    drive = Drive(1)
    log = Log(cantools.database.load_string(dbc(RIGHT)), a.plant, a.spread, 2)
    for ms in range(int(a.seconds * 1000)):
        t = 1.7e9 + ms * 1e-3
        drive.step(1e-3)
        if ms % 25 == 1:
            log.ego(t, drive)
        if ms % 60 == 7:
            log.scan(t, drive)
        if ms % 100 == 3:
            braking = math.cos(drive.t / 9) < -0.5
            log.send(t, "can3", "PEDALE", BREMSE_Pedal=int(braking), FAHRPEDAL_Position=0 if braking else 20,
                     BREMSE_Temp=80)
            log.send(t, "can3", "TEMPOMAT", SET_Speed=100, TRIP_Distance=int(drive.t * 16))
    with open(a.log, "w") as f:
        f.writelines(sorted(log.lines, key=lambda line: line[:19]))


main()
