"""The drive of the pulse duplicator's two valves, as keys for [circulation] of a case:

    /usr/bin/python3 pipelines/circulation/pulse_duplicator.py porcine|pericardial

Lee et al. 2020 (pulse-duplicator-2020) drive the porcine valve by the pump's pressure and the pericardial one by the
pump's flow; both are measured there and shown in figures only. Here they are worked out backwards from what the text
prints: stroke volume, peak flow (from its peak Reynolds number), the largest pressure difference in forward flow, the
resistances and compliances. Assumed: the course of the flow, Q = Q_peak 16 s^2 (1 - s)^2; the ventricle's pressure while
the valve is shut (smooth rise and fall between 8 mmHg and the aorta's pressure); the mitral flow, sin^2; the valve as a
quadratic resistance that takes the printed pressure difference at peak flow, and the inertia of the blood in the test
section. The pump then is what makes its model (common/circulation/pulse_duplicator.hpp) give these:

    porcine      P_C = P + R_2 Q,    P_pump = P_C + R_1 (Q + C dP_C/dt)
    pericardial  P_2 = P + R_out Q,  P_1 = P_2 + R_VIA (Q + C_2 dP_2/dt - Q_MV),  Q_pump = (P_1 - P_2)/R_VIA + C_1 dP_1/dt

Units: mmHg, mL, s.
"""

import argparse

import numpy as np

PERIOD_S = 60 / 70
DIAMETER_CM, VISCOSITY, DENSITY = 2.8, 0.01, 1.0  # cm, g/(cm s), g/cm3
LENGTH_CM = 10.1
REST_MMHG, RISE_S, FALL_S = 8.0, 0.06, 0.09  # assumed
DYN_PER_CM2 = 1333.22  # one mmHg

VALVES = {
    "porcine": dict(stroke=69.4, reynolds=20576, drop=22.8, rc=0.0218, rp=1.31, c=0.915),
    "pericardial": dict(stroke=71.6, reynolds=19330, drop=19.7, rc=0.0282, rp=1.22, c=1.27),
}


def smooth(s):
    s = np.clip(s, 0, 1)
    return s**3 * (10 - 15 * s + 6 * s**2)


def derivative(values, step):
    return (np.roll(values, -1) - np.roll(values, 1)) / (2 * step)


def windkessel(flow, v, step):
    """Periodic pressure before R_c and stored pressure, for a periodic flow."""
    decay = np.exp(-step / (v["rp"] * v["c"]))
    stored = np.empty_like(flow)
    pressure = v["rp"] * flow.mean()
    for _ in range(60):
        for i, q in enumerate(flow):
            stored[i] = pressure
            steady = v["rp"] * q
            pressure = steady + (pressure - steady) * decay
    return stored + v["rc"] * flow, stored


def target(v):
    """Time, flow through the valve, the ventricle's pressure, the stored pressure of the Windkessel at the start."""
    area = np.pi / 4 * DIAMETER_CM**2
    peak = v["reynolds"] * VISCOSITY * area / (DENSITY * DIAMETER_CM)
    ejection = v["stroke"] / peak * 30 / 16
    count = 4000
    step = PERIOD_S / count
    t = np.arange(count) * step
    s = np.clip((t - RISE_S) / ejection, 0, 1)
    flow = peak * 16 * s**2 * (1 - s) ** 2
    aorta, stored = windkessel(flow, v, step)
    inertia = DENSITY * LENGTH_CM / area / DYN_PER_CM2
    ejecting = aorta + v["drop"] * (flow / peak) ** 2 + inertia * derivative(flow, step)
    opening, end = np.searchsorted(t, RISE_S), np.searchsorted(t, RISE_S + ejection)
    pressure = ejecting.copy()
    before, after = t < RISE_S, t > RISE_S + ejection
    pressure[before] = REST_MMHG + (ejecting[opening] - REST_MMHG) * smooth(t[before] / RISE_S)
    fall = smooth((t[after] - t[end]) / FALL_S)
    pressure[after] = ejecting[end] + (REST_MMHG - ejecting[end]) * fall
    return t, flow, pressure, aorta, stored, peak, ejection


def keys(name, time_key, value_key, t, values, knots):
    at = np.linspace(0, PERIOD_S, knots, endpoint=False)
    inside = np.interp(at, t, values, period=PERIOD_S)
    print(f"{time_key} = [" + ", ".join(f"{x:.4f}" for x in at) + "]")
    print(f"{value_key} = [" + ", ".join(f"{x:.1f}" for x in inside) + "]")


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("valve", choices=VALVES)
    parser.add_argument("--knots", type=int, default=60)
    options = parser.parse_args()
    v = VALVES[options.valve]
    t, flow, pressure, aorta, stored, peak, ejection = target(v)
    step = t[1]
    print(f"# peak flow {peak:.1f} mL/s, ejection {ejection:.4f} s from {RISE_S} s, aorta {aorta.min():.1f} to {aorta.max():.1f} mmHg")
    print(f"period_s = {PERIOD_S:.6f}")
    print(f"aortic_pressure_mmHg = {stored[0]:.1f}")
    if options.valve == "porcine":
        r1, r2, c = 0.15, 0.15, 0.1
        inner = pressure + r2 * flow
        pump = inner + r1 * (flow + c * derivative(inner, step))
        keys(options.valve, "pressure_time_s", "pressure_mmHg", t, pump, options.knots)
        return
    c1, c2, r_via, r_out, r_mv = 0.0275, 0.0347, 0.15, 0.0898, 0.028
    filling_from = RISE_S + ejection + FALL_S
    s = np.clip((t - filling_from) / (PERIOD_S - filling_from), 0, 1)
    mitral = v["stroke"] * 2 / (PERIOD_S - filling_from) * np.sin(np.pi * s) ** 2
    chamber = pressure + r_out * flow - r_mv * mitral
    through = flow + c2 * derivative(chamber, step) - mitral
    pump_side = chamber + r_via * through
    pump = through + c1 * derivative(pump_side, step)
    keys(options.valve, "flow_time_s", "flow_mL_per_s", t, pump, options.knots)


if __name__ == "__main__":
    main()
