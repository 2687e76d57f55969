"""The calibration finds the parameters that made the targets, and says so when it cannot meet them."""

import csv
import io
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv.pop(1)).resolve()
CALIBRATE = Path(__file__).resolve().parents[3] / "pipelines" / "circulation" / "calibrate.py"


class Calibrate(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.case = Path(self.folder.name) / "case.toml"
        self.case.write_text("[circulation]\n")

    def tearDown(self):
        self.folder.cleanup()

    def beat(self, *overrides):
        words = [str(PROGRAM), str(self.case)]
        for pair in overrides:
            words += ["--set", f"circulation.{pair}"]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        return {k: float(v) for k, v in next(csv.DictReader(io.StringIO(done.stdout))).items()}

    def run_tool(self, *words):
        return subprocess.run([sys.executable, str(CALIBRATE), str(self.case), "--program", str(PROGRAM), *words],
                              capture_output=True, text=True)

    def test_finds_what_made_the_targets(self):
        true = {"vein_flow_L_per_min": 4.7, "peripheral_resistance_mmHg_s_per_mL": 1.2, "compliance_mL_per_mmHg": 1.3}
        figures = self.beat(*(f"{key}={value}" for key, value in true.items()))
        out = Path(self.folder.name) / "fit.json"
        words = []
        for name in ("stroke_volume_mL", "systolic_pressure_mmHg", "diastolic_pressure_mmHg"):
            words += ["--target", f"{name}={figures[name]}"]
        done = self.run_tool(*words, "--json", str(out))
        self.assertEqual(done.returncode, 0, done.stderr)
        found = json.loads(out.read_text())
        for key, value in true.items():
            self.assertAlmostEqual(found["parameters"][key] / value, 1, delta=2e-3, msg=key)
        self.assertIn("compliance_mL_per_mmHg = 1.3", done.stdout)

    def test_says_what_cannot_be_met(self):
        done = self.run_tool("--target", "stroke_volume_mL=40", "--free", "compliance_mL_per_mmHg")
        self.assertEqual(done.returncode, 3)
        self.assertIn("free other keys", done.stderr)

    def test_refuses_wrong_usage(self):
        for words, text in ((["--target", "stroke=1"], "stroke_volume_mL"), (["--target", "stroke_volume_mL=x"], "number"), ([], "no --target"),
                            (["--target", "stroke_volume_mL=70", "--free", "upstream"], "upstream"),
                            (["--target", "stroke_volume_mL=70", "--free", "lv_m1", "--free", "lv_m2"], "targets")):
            done = self.run_tool(*words)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(text, done.stderr)


if __name__ == "__main__":
    unittest.main()
