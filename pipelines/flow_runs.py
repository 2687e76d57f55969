"""What the studies of benchmark flows share: a case of the library is run by valsalva-cycle with some values of its own,
and read back. A run that is finished is not repeated."""

import csv
import json
import os
import subprocess
import sys

import numpy as np

from structure_runs import BIN, ROOT, provenance

CASES = ROOT / "pipelines" / "cases"
REFERENCE = ROOT.parent / "shared" / "reference" / "fluid"


def run(case, folder, values, ranks=1, again=False):
    """Runs the case with the values ("table.key": text) unless the folder holds their results; what study.json says."""
    note = folder / "study.json"
    if not again and note.exists() and json.loads(note.read_text())["values"] == values:
        return json.loads(note.read_text())
    folder.mkdir(parents=True, exist_ok=True)
    note.unlink(missing_ok=True)
    source = provenance()
    words = [str(BIN / "valsalva-cycle"), str(CASES / f"{case}.toml"), "--out", str(folder)]
    words += [word for key, value in values.items() for word in ("--set", f"{key}={value}")]
    if ranks > 1:
        words = ["mpirun", "-np", str(ranks), "--oversubscribe"] + words
    print(" ".join(words), flush=True)
    with open(folder / "log.txt", "w") as log:
        code = subprocess.run(words, env=dict(os.environ, OMP_NUM_THREADS="1"), stdout=log, stderr=log).returncode
    if code != 0:
        sys.exit(f"{case} ended with {code}:\n" + (folder / "log.txt").read_text()[-1000:])
    summary = json.loads((folder / "summary.json").read_text())
    result = {"case": case, "values": values, "ranks": ranks, "wall_s": round(summary["wall_s"], 1), "steps": summary["steps"],
              "metrics": summary["metrics"], "source": source}
    note.write_text(json.dumps(result, indent=1))
    return result


def made(note):
    """The last columns of every study's row: how the run of a study.json was made."""
    return {"steps": note["steps"], "ranks": note["ranks"], "wall_s": note["wall_s"],
            **{key: note["source"][key] for key in ("commit", "machine", "load_at_start")}}


def finished(runs, key):
    """Folder and study.json of all finished runs of a study, in the order of key(study)."""
    notes = [(path.parent, json.loads(path.read_text())) for path in runs.glob("*/study.json")]
    return sorted(notes, key=lambda one: key(one[1]["study"]))


def columns(path):
    """A table of numbers with a line of names: name -> array; empty cells are NaN."""
    with open(path, newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    return {name: np.array([float(row[i]) if row[i].strip() else np.nan for row in rows[1:]])
            for i, name in enumerate(rows[0])}


def reference(name):
    """The same of a published table in ../shared/reference/fluid; None where that folder is absent."""
    return columns(REFERENCE / name) if (REFERENCE / name).exists() else None
