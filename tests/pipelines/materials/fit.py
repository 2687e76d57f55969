"""The fit tool recovers known constants from noisy synthetic tests, tells what data cannot determine, and answers bad
data with exit code 2 and the place. Usage: fit.py path/to/valsalva-material"""

import csv
import json
import random
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FIT = ROOT / "pipelines/materials/fit.py"
MATERIAL = sys.argv.pop(1)


def run_fit(data, *options):
    return subprocess.run([sys.executable, str(FIT), str(data), "--program", MATERIAL, *options], capture_output=True, text=True)


def curve(loads, *material):
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        file.write("stretch1,stretch2,shear\n" + "".join(f"{a},{b},0\n" for a, b in loads))
        file.flush()
        done = subprocess.run([MATERIAL, *material, "--loads", file.name], capture_output=True, text=True, check=True)
    return list(csv.DictReader(done.stdout.splitlines()))


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.data = Path(self.folder.name) / "data.csv"

    def write(self, header, rows):
        self.data.write_text(header + "\n" + "".join(",".join(str(x) for x in row) + "\n" for row in rows))

    def fitted(self, *options):
        out = Path(self.folder.name) / "fit.json"
        done = run_fit(self.data, "--json", str(out), *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(out.read_text())


class Recovers(Folder):
    def test_hgo_from_three_biaxial_protocols_with_noise(self):
        noise = random.Random(7)
        steps = [i / 20 for i in range(1, 21)]
        loads = [(1 + a * t, 1 + b * t) for a, b in ((0.09, 0.09), (0.09, 0.03), (0.03, 0.12)) for t in steps]
        truth = {"c10_Pa": 15140, "c01": 13.48, "k1_Pa": 152600, "k2": 107.3}
        states = curve(loads, "--set", "tavr-ifed-2022/porcine-pericardium")
        largest = max(float(s["nominal1_Pa"]) for s in states)
        stress = lambda s, key: (float(s[key]) + noise.gauss(0, 0.002 * largest)) / 1e3
        self.write("stretch1,stretch2,nominal1_kPa,nominal2_kPa",
                   [(s["stretch1"], s["stretch2"], stress(s, "nominal1_Pa"), stress(s, "nominal2_Pa")) for s in states])
        result = self.fitted("--law", "hgo", "--fibre-angles", "7.81,-7.81", "--confidence", "0.99")
        for key, value in truth.items():
            found = result["parameters"][key]
            self.assertLess(found["low"], value, key)
            self.assertGreater(found["high"], value, key)
        self.assertAlmostEqual(result["parameters"]["k2"]["value"] / 107.3, 1, delta=0.03)
        self.assertAlmostEqual(result["rms_residual_Pa"] / (0.002 * largest), 1, delta=0.2)
        self.assertEqual(result["degrees_of_freedom"], 116)

    def test_exactly_from_clean_uniaxial_cauchy_stress(self):
        states = curve([(1 + 0.02 * i, "") for i in range(-5, 16)], "--set", "thickness-anisotropy-2016/leaflet-ogden")
        self.write("# clean\nstretch1,cauchy1_MPa", [(s["stretch1"], float(s["cauchy1_Pa"]) / 1e6) for s in states])
        found = self.fitted("--law", "ogden")["parameters"]
        self.assertAlmostEqual(found["mu1_Pa"]["value"] / 59782.4, 1, delta=1e-6)
        self.assertAlmostEqual(found["alpha1"]["value"] / 12.97, 1, delta=1e-6)

    def test_the_fibre_angle(self):
        loads = [(1 + 0.004 * i, 1 + 0.003 * i) for i in range(1, 26)]
        states = curve(loads, "--set", "tavr-ifed-2022/native-leaflet")
        self.write("stretch1,stretch2,nominal1_Pa,nominal2_Pa",
                   [(s["stretch1"], s["stretch2"], s["nominal1_Pa"], s["nominal2_Pa"]) for s in states])
        result = self.fitted("--law", "hgo", "--fibre-angles", "15,-15", "--free-angle", "--weights", "relative")
        self.assertAlmostEqual(result["parameters"]["fibre_angle_deg"]["value"], 26.21, delta=0.01)
        self.assertEqual(len(result["fibre_angles_deg"]), 2)

    def test_intervals_cover_the_truth_as_often_as_they_say(self):
        # 30 noisy Mooney-Rivlin pulls: 95 % intervals of one parameter must cover it in 25 or more (binomial: 99.9 %).
        sys.path.insert(0, str(FIT.parent))
        import fit as tool
        loads = [(1 + 0.03 * i, "") for i in range(1, 21)]
        clean = curve(loads, "--law", "mooney-rivlin", "--parameter", "c1_Pa=20000", "--parameter", "c2_Pa=10000")
        law = tool.Law(MATERIAL, "mooney-rivlin")
        noise, covered = random.Random(3), 0
        for _ in range(30):
            self.write("stretch1,nominal1_Pa",
                       [(s["stretch1"], float(s["nominal1_Pa"]) + noise.gauss(0, 500)) for s in clean])
            data = tool.Measurements(str(self.data))
            p = tool.fit(data, law, {}, {"c2_Pa": 5e3}, [], starts=1)["parameters"]["c1_Pa"]
            covered += p["low"] < 20000 < p["high"]
        self.assertGreaterEqual(covered, 25)
        self.assertLess(p["high"] / p["low"], 1.5)

    def test_the_same_bits_twice(self):
        states = curve([(1 + 0.02 * i, "") for i in range(1, 12)], "--set", "contact-fsi-2021/leaflet-fibre")
        self.write("stretch1,nominal1_Pa", [(s["stretch1"], s["nominal1_Pa"]) for s in states])
        options = ("--law", "exponential-neo-hookean")
        self.assertEqual(self.fitted(*options), self.fitted(*options))


class Warns(Folder):
    def test_of_what_the_data_do_not_determine(self):
        # A pull along the fibres says nothing of the second family across.
        states = curve([(1 + 0.01 * i, "") for i in range(1, 21)], "--set", "contact-fsi-2021/leaflet-fibre")
        self.write("stretch1,nominal1_Pa", [(s["stretch1"], s["nominal1_Pa"]) for s in states])
        result = self.fitted("--law", "holzapfel", "--fibre-angles", "0,90")
        for key in ("a2_Pa", "b2"):
            self.assertIn(f"{key}: the data do not determine it", result["warnings"])
            self.assertIsNone(result["parameters"][key]["high"])
        self.assertAlmostEqual(result["parameters"]["b1"]["value"] / 30.86, 1, delta=1e-3)

    def test_of_an_exponent_beyond_the_cap(self):
        states = curve([(1 + 0.01 * i, 1 + 0.01 * i) for i in range(1, 14)], "--set", "tavr-ifed-2022/porcine-pericardium")
        self.write("stretch1,stretch2,nominal1_Pa,nominal2_Pa",
                   [(s["stretch1"], s["stretch2"], s["nominal1_Pa"], s["nominal2_Pa"]) for s in states])
        result = self.fitted("--law", "hgo", "--fibre-angles", "7.81,-7.81")
        self.assertTrue(any("beyond 6" in w for w in result["warnings"]), result["warnings"])


class Refuses(Folder):
    def expect(self, code, text, *options, rows="stretch1,nominal1_kPa\n1.1,3\n1.2,6\n1.3,9\n1.4,12\n"):
        self.data.write_text(rows)
        done = run_fit(self.data, *(options or ("--law", "neo-hookean")))
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(text, done.stderr)
        self.assertNotIn("Traceback", done.stderr)

    def test_bad_data_with_the_line_and_what_is_expected(self):
        h = "stretch1,nominal1_kPa\n"
        self.expect(2, "data.csv:1: unknown column 'strech1'; did you mean 'stretch1'?", rows="strech1,nominal1_kPa\n1.1,3\n")
        self.expect(2, "data.csv:3: nominal1_kPa = 'three'; expected a number", rows=h + "1.1,3\n1.2,three\n")
        self.expect(2, "data.csv:2: nominal1_kPa = 'nan'; expected a number", rows=h + "1.1,nan\n")
        self.expect(2, "data.csv:2: stretch1 = -1.1; expected a ratio of lengths", rows=h + "-1.1,3\n")
        self.expect(2, "data.csv:2: stretch1 = 25; expected a ratio of lengths", rows=h + "25,3\n")
        self.expect(2, "data.csv:2: 3 columns; expected 2", rows=h + "1.1,3,4\n")
        self.expect(2, "data.csv:2: both stretches are empty", rows=h + ",3\n")
        self.expect(2, "data.csv:2: nominal1_kPa is empty", rows=h + "1.1,\n")
        self.expect(2, "stretch1 has no stress", rows="stretch1,protocol\n1.1,a\n")
        self.expect(2, "expected one stress column a direction", rows="stretch1,nominal1_kPa,cauchy1_kPa\n1.1,3,3\n")
        self.expect(2, "2 measured stresses; expected 3", rows=h + "1.1,3\n1.2,4\n")
        self.expect(2, "no header line", rows="# nothing\n")
        self.expect(2, "all measured stresses are zero", rows=h + "1.1,0\n1.2,0\n1.3,0\n")

    def test_bad_options(self):
        self.expect(2, "did you mean 'neo-hookean'?", "--law", "neo-hokean")
        self.expect(2, "no parameter 'mu'; did you mean 'mu_Pa'?", "--law", "neo-hookean", "--fix", "mu=3")
        self.expect(2, "every parameter is fixed", "--law", "neo-hookean", "--fix", "mu_Pa=3")
        self.expect(2, "4 measured stresses for 4 free parameters", "--law", "hgo", "--fibre-angles", "0")
        self.expect(2, "at most 0 fibre families", "--law", "neo-hookean", "--fibre-angles", "0")
        self.expect(2, "the body has no fibre direction", "--law", "fung", "--fix", "b2=1", "--fix", "b3=1")
        self.expect(2, "--free-angle", "--law", "hgo", "--free-angle")
        self.expect(4, "not found; build it", "--law", "neo-hookean", "--program", "/no/such/program")

    def test_a_missing_file(self):
        done = run_fit(Path(self.folder.name) / "none.csv", "--law", "neo-hookean")
        self.assertEqual(done.returncode, 4)
        self.assertIn("none.csv", done.stderr)


if __name__ == "__main__":
    unittest.main()
