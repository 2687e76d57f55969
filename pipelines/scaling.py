"""What more ranks would give: the measured work of one rank and the sizes of the messages, put into a model.

  make bench && python3 pipelines/scaling.py            prints tables (Markdown) from runs/bench/bench.json

Work: seconds a cell of the fluid step and of the coupled step on one rank, divided over the slabs. Messages, counted in the
sources (common/fluid/boundary.cpp, poisson.cpp; common/coupling/transfer.cpp): ghost planes to two neighbours, two
all-to-alls of the pressure's slab ends, sums of the leaflets' nodal vectors. A slab has at least three planes. The network
is assumed (--latency_us, --GB_per_s); inside one machine the memory is shared, and there the measured pair of ranks counts.
"""

import argparse
import json
import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
GHOSTS = 3           # layers of a velocity component
BYTES = 8
REDUCTIONS = 4       # scalars a step: speed, energy, flow, mean mode


def measured(name, ranks):
    path = ROOT / "runs" / "bench" / "bench.json"
    try:
        entries = json.loads(path.read_text())
    except OSError:
        sys.exit(f"error: {path.relative_to(ROOT)} is missing; run 'make bench' first")
    for entry in entries:
        if entry["name"] == name and entry["ranks"] == ranks:
            return entry["value"]
    sys.exit(f"error: {path.relative_to(ROOT)} has no '{name}' on {ranks} rank(s); run 'make bench' again")


class Network:
    def __init__(self, latency_s, bytes_per_s):
        self.latency_s, self.bytes_per_s = latency_s, bytes_per_s

    def message(self, size):
        return self.latency_s + size / self.bytes_per_s

    def sum(self, size, ranks):
        return 2 * math.ceil(math.log2(ranks)) * self.latency_s + 2 * size / self.bytes_per_s if ranks > 1 else 0


def fluid_parts(nx, nz, ranks, seconds_a_cell, memory_bytes_per_s, network):
    """Seconds of one step: work, ghosts, all-to-all, dense slab ends."""
    plane = nx * nx
    planes = math.ceil(nz / ranks)
    work = seconds_a_cell * plane * planes
    if ranks == 1:
        return {"work": work, "ghosts": 0, "all-to-all": 0, "slab ends": 0, "sums": 0}
    # Up and down: three components with all layers, the projected w and the pressure with one.
    ghosts = 2 * (3 * network.message(GHOSTS * plane * BYTES) + 2 * network.message(plane * BYTES))
    to_all = 2 * ((ranks - 1) * network.latency_s + 2 * plane * BYTES / network.bytes_per_s)
    ends = 4 * ranks * plane * BYTES / memory_bytes_per_s  # (2 P)^2 factors of each of the plane / P modes of a rank
    return {"work": work, "ghosts": ghosts, "all-to-all": to_all, "slab ends": ends,
            "sums": REDUCTIONS * network.sum(BYTES, ranks)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--latency_us", type=float, default=2.0)
    parser.add_argument("--GB_per_s", type=float, default=10.0, help="of one rank's link")
    parser.add_argument("--nodes_per_h2", type=float, default=6000, help="leaflet nodes at h = 1 mm (half a cell apart)")
    options = parser.parse_args()
    network = Network(options.latency_us * 1e-6, options.GB_per_s * 1e9)
    memory = measured("triad", 1) * 1e9
    cell = measured("fluid_cube_128_step", 1) * 1e-3 / 128**3
    pair = measured("fluid_cube_128_step", 1) / measured("fluid_cube_128_step", 2)
    print(f"Measured: {1e9 * cell:.1f} ns a cell and step on one rank, {memory / 1e9:.1f} GB/s; two ranks of one machine {pair:.2f} "
          f"times as fast.\nAssumed: {options.latency_us:g} us, {options.GB_per_s:g} GB/s.\n")
    print("| box | ranks | planes a slab | step, ms | speed-up | work | ghosts | all-to-all | slab ends | sums |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for nx, nz in ((128, 128), (256, 256), (512, 512), (60, 120), (120, 240)):
        alone = sum(fluid_parts(nx, nz, 1, cell, memory, network).values())
        for ranks in (2, 8, 16, 64, 1024):
            name = f"{nx} x {nx} x {nz}"
            if nz // ranks < GHOSTS:
                print(f"| {name} | {ranks} | - | not possible: at most {nz // GHOSTS} slabs | | | | | | |")
                continue
            parts = fluid_parts(nx, nz, ranks, cell, memory, network)
            total = sum(parts.values())
            shares = " | ".join(f"{100 * value / total:.0f} %" for value in parts.values())
            print(f"| {name} | {ranks} | {math.ceil(nz / ranks)} | {1e3 * total:.3g} | {alone / total:.1f} | {shares} |")
    print("\nThe coupled valve:\n")
    print("| level | ranks | step, ms | of that nodal sums, ms | speed-up |\n|---|---|---|---|---|")
    for level, h in (("draft", 1.0), ("standard", 0.75), ("fine", 0.5)):
        one, two = (measured(f"coupled_step_{level}", ranks) * 1e-3 for ranks in (1, 2))
        serial = max(0.0, 2 * two / one - 1)  # what does not get faster with ranks, from the measured pair
        nodes = options.nodes_per_h2 / h**2
        for ranks in (2, 8, 16, 64):
            if int(60 / h) // ranks < GHOSTS:
                print(f"| {level} | {ranks} | not possible: at most {int(60 / h) // GHOSTS} slabs | | |")
                continue
            # Velocities and forces, and two products in one of four steps for the stability limit.
            sums = 3 * network.sum(3 * nodes * BYTES, ranks)
            total = one * (serial + (1 - serial) / ranks) + sums
            print(f"| {level} | {ranks} | {1e3 * total:.3g} | {1e3 * sums:.3g} | {one / total:.1f} |")


if __name__ == "__main__":
    main()
