#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes tests/kat/kalman.txt: a filter's life step by step, from the continuous model to 50 digits.

Each line is an operation with its arguments, then the five states and the upper triangle of the covariance after it.
Transition and process noise come from one matrix exponential (Van Loan, IEEE TAC 23 (1978)), the measurement update
from the information form: nothing is shared with the code under test.
Usage: tests/oracle/kalman.py > tests/kat/kalman.txt      (needs mpmath)
"""
import random
from mpmath import mp, mpf, matrix, expm, eye, zeros

mp.dps = 50
HEADWAY, VE, AE, VL, AL = range(5)
H = {"ego_speed": [0, 1, 0, 0, 0], "distance": [1, 0, 0, 0, 0], "rate": [0, -1, 0, 1, 0]}


def discretise(dt, q_ego, q_lead):
    a = zeros(5)
    a[HEADWAY, VE], a[HEADWAY, VL], a[VE, AE], a[VL, AL] = -1, 1, 1, 1
    noise = zeros(5)
    noise[AE, AE], noise[AL, AL] = q_ego, q_lead
    big = zeros(10)
    for i in range(5):
        for j in range(5):
            big[i, j], big[i, 5 + j], big[5 + i, 5 + j] = -a[i, j], noise[i, j], a[j, i]
    e = expm(big * dt)
    f = e[5:10, 5:10].T
    return f, f * e[0:5, 5:10]


class Filter:
    def __init__(self, t_ns, speed, speed_sigma, accel_sigma):
        self.t_ns, self.x, self.p = t_ns, zeros(5, 1), eye(5)
        self.x[VE] = speed
        self.p[VE, VE], self.p[AE, AE] = speed_sigma**2, accel_sigma**2

    def open_lead(self, distance, distance_sigma, rate, rate_sigma, accel_sigma):
        # the lead's states are linear in the ego's and in three independent errors
        ego = self.p[VE : AE + 1, VE : AE + 1]
        m = matrix([[0, 0, 1, 0, 0], [1, 0, 0, 0, 0], [0, 1, 0, 0, 0], [1, 0, 0, 1, 0], [0, 0, 0, 0, 1]])
        d = zeros(5)
        d[0:2, 0:2] = ego
        d[2, 2], d[3, 3], d[4, 4] = distance_sigma**2, rate_sigma**2, accel_sigma**2
        self.p = m * d * m.T
        self.x = matrix([distance, self.x[VE], self.x[AE], self.x[VE] + rate, 0])

    def predict(self, t_ns, q_ego, q_lead):
        if t_ns <= self.t_ns:
            return
        f, q = discretise(mpf(t_ns - self.t_ns) / 10**9, q_ego, q_lead)
        self.x, self.p, self.t_ns = f * self.x, f * self.p * f.T + q, t_ns

    def update(self, what, z, sigma):
        h = matrix([H[what]])
        info = self.p**-1
        vector = info * self.x + h.T * (z / mpf(sigma) ** 2)
        self.p = (info + h.T * h / mpf(sigma) ** 2) ** -1
        self.x = self.p * vector

    def set_lead_accel(self, accel, sigma):
        for i in range(5):
            self.p[AL, i] = self.p[i, AL] = 0
        self.p[AL, AL], self.x[AL] = mpf(sigma) ** 2, accel


def show(f, name, *args):
    numbers = [float(a).hex() for a in args]
    state = [float(f.x[i]).hex() for i in range(5)]
    cov = [float(f.p[i, j]).hex() for i in range(5) for j in range(i, 5)]
    print(" ".join([name] + numbers + state + cov))


def main():
    random.seed(1)
    print("# operation, arguments, headway ve ae vl al, upper triangle of the covariance by rows")
    ms = 10**6
    f = Filter(0, 20.5, 0.0625, 2)
    show(f, "open_ego", 0, 20.5, 0.0625, 2)
    t = 0

    def step(name, *args):
        getattr(f, name if name in ("predict", "open_lead", "set_lead_accel") else "update")(
            *(args if name in ("predict", "open_lead", "set_lead_accel") else (name,) + args))
        show(f, name, *args)

    def dyadic(x):
        return round(x * 1024) / 1024

    for _ in range(4):
        t += 20 * ms
        step("predict", t, 5, 5)
        step("ego_speed", dyadic(random.gauss(20.5, 0.05)), 0.0625)
    step("open_lead", 31.25, 0.25, -1.5, 0.125, 2)
    for k in range(12):
        t += 23 * ms
        step("predict", t, 5, 2.5)
        step("ego_speed", dyadic(random.gauss(20.4, 0.05)), 0.0625)
        if k % 2:
            step("predict", t - ms, 5, 2.5)
            step("distance", dyadic(random.gauss(31 - 0.05 * k, 0.25)), 0.25)
            step("rate", dyadic(random.gauss(-1.6, 0.1)), 0.125)
    step("set_lead_accel", -0.5, 0.125)
    t += 300 * ms
    step("predict", t, 5, 5)
    step("distance", 30, 0.25)


main()
