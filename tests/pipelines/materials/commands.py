"""valsalva-material from a user's side: what it lists, its curves, its exit codes. Usage: commands.py valsalva-material"""

import csv
import subprocess
import sys
import tempfile
import unittest

MATERIAL = sys.argv.pop(1)


def run(*words, **more):
    return subprocess.run([MATERIAL, *words], capture_output=True, text=True, **more)


class Commands(unittest.TestCase):
    def refuses(self, code, text, *words):
        done = run(*words)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(text, done.stderr)
        self.assertEqual(done.stdout, "")

    def test_lists_laws_and_sets(self):
        laws, sets = run("--laws").stdout, run("--sets").stdout
        for law in ("neo-hookean", "mooney-rivlin", "st-venant-kirchhoff", "ogden", "exponential-neo-hookean", "hgo", "holzapfel",
                    "straightened-fibre", "fung", "lee-sacks"):
            self.assertIn(f"\n{law}\n", "\n" + laws)
        for paper in ("tavr-ifed-2022", "pulse-duplicator-2020", "contact-fsi-2021", "thickness-anisotropy-2016",
                      "leaflet-flutter-2022"):
            self.assertIn(paper + "/", sets)
        self.assertEqual(sets.count("source:"), sets.count("\n  source:"))

    def test_every_set_gives_a_finite_curve_in_every_test(self):
        names = [line for line in run("--sets").stdout.splitlines() if line and not line.startswith(" ")]
        for name in names:
            for test, to in (("uniaxial1", 1.1), ("uniaxial2", 1.1), ("equibiaxial", 1.1), ("shear", 0.2)):
                done = run("--set", name, "--test", test, "--to", str(to), "--points", "5")
                self.assertEqual(done.returncode, 0, done.stderr)
                rows = list(csv.DictReader(done.stdout.splitlines()))
                self.assertEqual(len(rows), 5)
                self.assertNotIn("nan", done.stdout)
                self.assertNotIn("inf", done.stdout)
                self.assertEqual(float(rows[0]["energy_Pa"]), 0, name)

    def test_the_closed_form_of_the_neo_hookean_pull(self):
        done = run("--law", "neo-hookean", "--parameter", "mu_Pa=1000", "--test", "uniaxial1", "--to", "2", "--points", "2")
        last = list(csv.DictReader(done.stdout.splitlines()))[-1]
        self.assertAlmostEqual(float(last["cauchy1_Pa"]), 1000 * (4 - 0.5), places=6)

    def test_a_stream_answers_line_by_line_and_goes_on_after_an_error(self):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as loads:
            loads.write("stretch1,stretch2,shear\n2,,0\n")
            loads.flush()
            done = run("--law", "neo-hookean", "--loads", loads.name, "--stream", "mu_Pa", input="1000\n-1\nx\n2000\n")
        one, bad, word, two = done.stdout.splitlines()
        self.assertAlmostEqual(float(one.split(",")[0]), 1750, places=6)
        self.assertIn("expected a positive number", bad)
        self.assertTrue(word.startswith("error: mu_Pa"))
        self.assertAlmostEqual(float(two.split(",")[0]), 3500, places=6)

    def test_wrong_usage(self):
        self.refuses(2, "did you mean '--points'?", "--point", "3")
        self.refuses(2, "did you mean 'contact-fsi-2021/stent'?", "--set", "contact-fsi-2021/stend", "--test", "uniaxial1")
        self.refuses(2, "neither --set nor --law")
        self.refuses(2, "'mu_Pa' (shear modulus) is missing", "--law", "neo-hookean", "--test", "uniaxial1")
        self.refuses(2, "expected uniaxial1", "--set", "contact-fsi-2021/stent", "--test", "biaxial")
        self.refuses(2, "expected key=value", "--law", "neo-hookean", "--parameter", "mu_Pa")
        self.refuses(2, "--to: found 'x'", "--set", "contact-fsi-2021/stent", "--test", "uniaxial1", "--to", "x")
        self.refuses(2, "needs a value", "--set")
        self.refuses(2, "expected one of --test and --loads", "--set", "contact-fsi-2021/stent")
        self.refuses(4, "cannot be opened", "--set", "contact-fsi-2021/stent", "--loads", "/no/such/file.csv")


if __name__ == "__main__":
    unittest.main()
