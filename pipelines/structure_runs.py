"""What the studies of the structure share: scenes are written as case files, run by valsalva-cycle and read back; results
are written whole, with command, commit and machine."""

import csv
import io
import json
import math
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BIN = Path(os.environ.get("VALSALVA_BIN", ROOT / "build" / "bin"))


def provenance():
    """Command, commit and machine of this run, and how busy the machine is."""
    git = lambda *words: subprocess.run(["git", *words], cwd=ROOT, stdout=subprocess.PIPE, text=True).stdout.strip()
    with open("/proc/cpuinfo") as file:
        model = next((line.split(":")[1].strip() for line in file if line.startswith("model name")), "unknown")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2 ** 30
    script = Path(sys.argv[0]).resolve()
    name = script.relative_to(ROOT) if script.is_relative_to(ROOT) else script.name
    return {"command": " ".join(["python3", str(name)] + sys.argv[1:]),
            "commit": git("rev-parse", "--short", "HEAD") + (" with changes" if git("status", "--porcelain", "-uno") else ""),
            "machine": f"{os.cpu_count()} cores of {model}, {memory:.0f} GiB",
            "load_at_start": round(os.getloadavg()[0], 2), "date": time.strftime("%Y-%m-%d %H:%M:%S")}


def replace(path, text):
    """Writes the whole file or nothing."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text)
    os.replace(partial, path)


def write_csv(path, rows, source):
    """Rows (dictionaries), after a line of comment that says where they come from."""
    text = io.StringIO()
    text.write("# " + "; ".join(f"{key}: {value}" for key, value in source.items()) + "\n")
    writer = csv.DictWriter(text, rows[0].keys(), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    replace(path, text.getvalue())


def toml(scene):
    """A dictionary of tables (dictionaries) and repeated tables (lists of them) as a case file."""
    def value(v):
        if isinstance(v, bool):
            return "true" if v else "false"
        if isinstance(v, str):
            return json.dumps(v)
        if isinstance(v, (list, tuple)):
            return "[" + ", ".join(value(x) for x in v) + "]"
        return repr(v)

    lines = []
    for name, tables in scene.items():
        for table in tables if isinstance(tables, list) else [tables]:
            lines.append(f"[[{name}]]" if isinstance(tables, list) else f"[{name}]")
            lines += [f"{key} = {value(v)}" for key, v in table.items()]
    return "\n".join(lines) + "\n"


def run(scene, folder, timeout_s=900, threads=1):
    """A scene (dictionary or text) as a case file in the folder, run by valsalva-cycle; see run_program."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    case = folder / "case.toml"
    case.write_text(scene if isinstance(scene, str) else toml(scene))
    return run_program([BIN / "valsalva-cycle", case], folder / "out", timeout_s, threads)


def run_program(words, out, timeout_s=900, threads=1):
    """What came of a stage's run into the folder `out`: exit code, the last message, seconds, steps, metrics, last row of the
    history, whether an output holds a value that is not finite, whether a state was left."""
    out = Path(out)
    for old in out.glob("*"):
        old.unlink()
    words = [str(word) for word in words] + ["--out", str(out)]
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads), OMPI_ALLOW_RUN_AS_ROOT="1",
                       OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    try:
        done = subprocess.run(words, cwd=ROOT, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=timeout_s)
        code, text = done.returncode, done.stdout
    except subprocess.TimeoutExpired as expired:
        code, text = None, (expired.stdout or b"").decode()
    text = text.replace(f"{ROOT}/", "")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    result = {"exit": code, "wall_s": time.monotonic() - start,
              "processor_s": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
              "message": next((line for line in reversed(text.splitlines()) if "error" in line.lower()),
                              text.strip().splitlines()[-1] if text.strip() else ""), "text": text,
              "metrics": {}, "last": {}, "state": any(out.glob("state_*.h5"))}
    result["nan"] = any(not_finite(path) for path in out.glob("state_*.h5"))
    summary = out / "summary.json"
    if summary.exists():
        text = summary.read_text()
        bad = "nan" in text.lower()
        result["nan"] |= bad
        if not bad:
            result["summary"] = json.loads(text)
            result["metrics"] = {name: entry.get("value") if isinstance(entry, dict) else entry
                                 for name, entry in result["summary"].get("metrics", {}).items()}
    history = out / "history.csv"
    if history.exists():
        with open(history, newline="") as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        for row in rows:
            for entry in row.values():
                try:
                    result["nan"] |= not math.isfinite(float(entry))
                except (TypeError, ValueError):
                    pass
        if rows:
            result["last"] = {key: float(v) for key, v in rows[-1].items() if v not in (None, "")}
        result["rows"] = rows
    return result


def not_finite(path):
    """Whether any array of floating point numbers in a state file holds a value that is not finite."""
    import h5py
    import numpy

    found = []

    def look(_, item):
        if isinstance(item, h5py.Dataset) and item.dtype.kind == "f":
            found.append(not numpy.isfinite(item[()]).all())

    with h5py.File(path) as file:
        file.visititems(look)
    return any(found)


def table(header, rows):
    return "\n".join(["| " + " | ".join(header) + " |", "|" + "---|" * len(header)] +
                     ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows])
