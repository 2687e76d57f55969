"""A table of bad inputs: each must end with its exit code and a message that holds the given words, and leave no result.

Usage: bad_inputs.py BUILD_BIN
"""

import os
import resource
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from inputs import make_inputs

BIN = Path(sys.argv[1]).resolve()
INPUT, NUMERICAL, ENVIRONMENT = 2, 3, 4

# (what is wrong, stage, case text or None, further arguments, exit code, words of the message)
# In arguments and case texts, {name} is the path of a file that inputs.py makes.
COMMAND_LINE = [
    ("no case file", "crimp", None, [], INPUT, ["no case file"]),
    ("unknown option", "crimp", "", ["--resme"], INPUT, ["unknown option", "did you mean '--resume'"]),
    ("two case files", "crimp", "", ["other.toml"], INPUT, ["second case file"]),
    ("value missing", "crimp", "", ["--fidelity"], INPUT, ["value is missing"]),
    ("unknown fidelity", "crimp", "", ["--fidelity", "drft"], INPUT, ["draft, standard, fine or reference", "did you mean 'draft'"]),
    ("steps of zero", "crimp", "", ["--steps", "0"], INPUT, ["--steps", "positive integer"]),
    ("steps that are no number", "crimp", "", ["--steps", "many"], INPUT, ["--steps", "many"]),
    ("override without a value", "crimp", "", ["--set", "crimp.speed"], INPUT, ["table.key=value"]),
    ("override of an unknown key", "cycle", "", ["--set", "fluid.spacin_mm=1"], INPUT, ["did you mean 'fluid.spacing_mm'"]),
    ("case file that does not exist", "cycle", None, ["nowhere.toml"], INPUT, ["nowhere.toml", "case file"]),
    ("case file that is a folder", "cycle", None, ["{folder}"], INPUT, ["cannot be read"]),
]
CASE_FILE = [
    ("file cut short", "crimp", "[device]\nsize_mm = ", [], INPUT, ["case.toml:2", "not valid TOML"]),
    ("binary file", "crimp", "\x00\x01\x02", [], INPUT, ["not valid TOML"]),
    ("unknown table", "crimp", "[devise]\nsize_mm = 26\n", [], INPUT, ["case.toml:1", "unknown table", "did you mean 'device'"]),
    ("unknown key", "crimp", "[device]\nsise_mm = 26\n", [], INPUT, ["case.toml:2", "did you mean 'device.size_mm'"]),
    ("another unit", "cycle", "[fluid]\nspacing_cm = 0.1\n", [], INPUT, ["unknown key 'fluid.spacing_cm'", "fluid.spacing_mm"]),
    ("text for a number", "crimp", "[device]\nsize_mm = \"26\"\n", [], INPUT, ["device.size_mm", "a number"]),
    ("number for a flag", "crimp", "[device]\ntissue = 1\n", [], INPUT, ["device.tissue", "true or false"]),
    ("NaN", "crimp", "[device]\nthickness_mm = nan\n", [], INPUT, ["device.thickness_mm", "finite"]),
    ("infinity", "crimp", "[device]\nthickness_mm = inf\n", [], INPUT, ["device.thickness_mm", "finite"]),
    ("negative stiffness", "crimp", "[device]\nc10_kPa = -15\n", [], INPUT, ["device.c10_kPa", "found -15", "> 0"]),
    ("negative Young's modulus", "crimp", "[device]\nframe_youngs_modulus_GPa = -50\n", [], INPUT, ["frame_youngs_modulus_GPa", "> 0"]),
    ("Poisson number above a half", "crimp", "[device]\nframe_poisson = 0.7\n", [], INPUT, ["frame_poisson", "[0, 0.5]"]),
    ("zero grid spacing", "cycle", "[fluid]\nspacing_mm = 0\n", [], INPUT, ["fluid.spacing_mm"]),
    ("a table written as a value", "cycle", "fluid = true\n", [], INPUT, ["[fluid]"]),
    ("wrong choice", "crimp", "[device]\nframe = \"supra-anular\"\n", [], INPUT, ["did you mean 'supra-annular'"]),
    ("key given twice", "crimp", "[device]\nsize_mm = 23\nsize_mm = 26\n", [], INPUT, ["case.toml:3", "not valid TOML"]),
]
STATES = [
    ("parent that was never run", "crimp", "[device]\nsize_mm = 26\n", [], INPUT, ["no state of stage 'stent'", "make stent"]),
    ("parent file that does not exist", "crimp", "[device]\nsize_mm = 26\n", ["--from", "nowhere.h5"], INPUT, ["nowhere.h5"]),
    ("parent that is text", "crimp", "[device]\nsize_mm = 26\n", ["--from", "{text_h5}"], INPUT, ["no readable Valsalva state"]),
    ("parent that is other HDF5", "crimp", "[device]\nsize_mm = 26\n", ["--from", "{other_h5}"], INPUT, ["no Valsalva state"]),
    ("parent cut short", "crimp", "[device]\nsize_mm = 26\n", ["--from", "{cut_state}"], INPUT, ["cut short"]),
    ("state of the wrong stage", "crimp", "[device]\nsize_mm = 26\n", ["--from", "{segment_state}"], INPUT, ["'segment'", "'stent'"]),
    ("parent that is not finished", "crimp", "[device]\nsize_mm = 26\n", ["--from", "{unfinished_stent_state}"], INPUT, ["has not finished"]),
    ("parent without its tissue", "crimp", "[device]\nsize_mm = 26\n", ["--from", "{stent_state_without_frame}"], INPUT, ["no mesh 'frame'"]),
    ("parent with NaN", "crimp", "[device]\nsize_mm = 26\n", ["--from", "{stent_state_with_nan}"], INPUT, ["not finite"]),
    ("nothing to resume", "crimp", "[device]\nsize_mm = 26\n", ["--resume", "--from", "{stent_state}"], INPUT, ["--resume"]),
    ("mesher without segment", "mesher", "[anatomy]\n", [], INPUT, ["no state of stage 'segment'"]),
    ("parent that was never run, result elsewhere", "crimp", "[device]\nsize_mm = 26\n", ["--out", "results/here/crimp"], INPUT, ["no state of stage 'stent'", "make stent"]),
]
IMAGES = [
    ("image that does not exist", "segment", "[anatomy]\nimage = \"nowhere.nrrd\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["nowhere.nrrd"]),
    ("reference data that is absent", "segment", "[anatomy]\nimage = \"shared:absent/ct.nii.gz\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["absent/ct.nii.gz"]),
    ("image cut short", "segment", "[anatomy]\nimage = \"{cut_nrrd}\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["cut.nrrd"]),
    ("text as an image", "segment", "[anatomy]\nimage = \"{text_nrrd}\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["text.nrrd"]),
    ("zero spacing", "segment", "[anatomy]\nimage = \"{zero_spacing_nrrd}\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["spacing"]),
    ("image of NaN", "segment", "[anatomy]\nimage = \"{nan_nrrd}\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["finite"]),
    ("seed outside the image", "segment", "[anatomy]\nimage = \"{blank_nrrd}\"\nannulus_centre_mm = [500, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["outside"]),
    ("image without contrast", "segment", "[anatomy]\nimage = \"{blank_nrrd}\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["threshold"]),
    ("empty mask", "segment", "[anatomy]\nkind = \"labels\"\nimage = \"{blank_nrrd}\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["label"]),
    ("empty surface", "segment", "[anatomy]\nkind = \"surface\"\nimage = \"{empty_stl}\"\nannulus_centre_mm = [0, 0, 0]\nannulus_normal = [0, 0, 1]\n", [], INPUT, ["empty.stl"]),
    ("annulus normal of length zero", "segment", "[anatomy]\nimage = \"{blank_nrrd}\"\nannulus_centre_mm = [8, 8, 8]\nannulus_normal = [0, 0, 0]\n", [], INPUT, ["annulus_normal"]),
]
DEVICE = [
    ("graph file that does not exist", "stent", "[device]\nframe = \"graph\"\ngraph_file = \"nowhere.json\"\n", [], INPUT, ["nowhere.json"]),
    ("graph that is no JSON", "stent", "[device]\nframe = \"graph\"\ngraph_file = \"{text_json}\"\n", [], INPUT, ["text.json"]),
    ("size that the library lacks", "stent", "[device]\nsize_mm = 24\n", [], INPUT, ["size_mm", "24"]),
]
FILE_SYSTEM = [
    ("result folder below a file", "stent", "[device]\nsize_mm = 26\n", ["--out", "{text_json}/stent"], ENVIRONMENT, ["cannot be created or written"]),
    ("result folder in /proc", "stent", "[device]\nsize_mm = 26\n", ["--out", "/proc/stent"], ENVIRONMENT, ["cannot be created or written"]),
]
TABLE = COMMAND_LINE + CASE_FILE + STATES + IMAGES + DEVICE + FILE_SYSTEM


def paths_below(folder):
    """Files and folders: a refused run leaves not even an empty folder behind."""
    return sorted(str(p.relative_to(folder)) for p in folder.rglob("*"))


def small_files_only():
    """Every write past 64 KiB fails, as on a full disk."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64 << 10, 64 << 10))


def start(words, folder, before=None):
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                       VALSALVA_SHARED=str(folder), PMIX_MCA_gds="hash")  # no large scratch file of PMIx: one row limits file sizes
    return subprocess.run(words, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          timeout=120, preexec_fn=before)


def verdict(name, done, code, words):
    found = [f"exit code {done.returncode}, expected {code}"] if done.returncode != code else []
    found += [f"'{word}' is missing in the message" for word in words if word not in done.stdout]
    if found:
        print(f"FAILED  {name}: {'; '.join(found)}\n        {done.stdout.strip()[-600:]}")
    return not found


def check_row(row, inputs):
    name, stage, text, arguments, code, words = row
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        command = [str(BIN / f"valsalva-{stage}")]
        if text is not None:
            (folder / "case.toml").write_text(text.format(**inputs))
            command.append("case.toml")
        before = paths_below(folder)
        good = verdict(name, start(command + [a.format(**inputs) for a in arguments], folder), code, words)
        left = [f for f in paths_below(folder) if f not in before]
        if left:
            print(f"FAILED  {name}: it left {', '.join(left)}")
        return good and not left


def check_full_disk():
    """A state that cannot be written whole: exit 4, nothing half-written, the message says what to do."""
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        (folder / "case.toml").write_text("[device]\nsize_mm = 26\n")
        done = start([str(BIN / "valsalva-stent"), "case.toml"], folder, small_files_only)
        good = verdict("full disk", done, ENVIRONMENT, ["write failed", "--resume"])
        left = [f for f in paths_below(folder) if f.endswith((".h5", ".part"))]
        if left:
            print(f"FAILED  full disk: it left {', '.join(left)}")
        return good and not left


def main():
    with tempfile.TemporaryDirectory() as folder:
        inputs = make_inputs(Path(folder), BIN)
        results = [check_row(row, inputs) for row in TABLE] + [check_full_disk()]
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    return 0 if all(results) else 1


if __name__ == "__main__":
    sys.exit(main())
