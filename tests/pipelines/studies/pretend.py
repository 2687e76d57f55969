"""A folder of programs that pretend to be the stages: they leave a state, a summary and what they were called with. The
beat's figures are 10 + 2 h^2 (gradient), 2 - 0.3 h (orifice), 70 + h^2 (volume), its steps 1000 / h."""

import os
import stat
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
STAGE = '''#!/usr/bin/python3
import hashlib, json, sys
from pathlib import Path

words = sys.argv[1:]
stage = Path(sys.argv[0]).name.split("-")[1]
sets = dict(words[i + 1].split("=", 1) for i, word in enumerate(words) if word == "--set")
if "--version" in words:
    print("valsalva pretended")
elif "--digest" in words:
    print(hashlib.sha256(json.dumps(sets, sort_keys=True).encode()).hexdigest())
else:
    out = Path(words[words.index("--out") + 1])
    out.mkdir(parents=True, exist_ok=True)
    with open(Path(__file__).parent / "calls.txt", "a") as file:
        file.write(stage + " " + " ".join(words) + "\\n")
    if stage == "cycle" and sets.get("cycle.kernel") == "ib3":
        print("error: coupling: leaflet node 7 at (1, 2, 3) mm moves at 3e4 mm/s")
        sys.exit(3)
    h = float(sets.get("fluid.spacing_mm", 1))
    metrics = {"mean_gradient_mmHg": 10 + 2 * h ** 2, "eoa_cm2": 2 - 0.3 * h, "stroke_volume_mL": 70 + h ** 2,
               "regurgitant_volume_mL": 3 + h, "leaflet_von_mises_p99_kPa": 3000 + 100 * h, "cells": 1e5 / h ** 3}
    (out / "state_000001.h5").write_bytes(b"")
    (out / "summary.json").write_text(json.dumps({
        "status": "ok", "version": "pretended", "steps": int(1000 / h), "simulated_s": 0.88, "peak_rss_MiB": 200, "inputs": {},
        "parameters_sha256": hashlib.sha256(json.dumps(sets, sort_keys=True).encode()).hexdigest(), "metrics": metrics}))
'''


def programs(folder):
    for stage in ("segment", "mesher", "stent", "crimp", "deploy", "cycle"):
        path = Path(folder) / f"valsalva-{stage}"
        path.write_text(STAGE)
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
    os.environ["VALSALVA_BIN"] = str(folder)
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(ROOT / "pipelines"))


class Expect:
    def __init__(self):
        self.failed = 0

    def __call__(self, what, holds, seen=""):
        print(f"{'ok    ' if holds else 'FAILED'} {what}")
        if not holds:
            self.failed += 1
            print(seen)
