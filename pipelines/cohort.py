"""A cohort: one row a case, run as a batch; a failing case does not stop the others.

The file is CSV. Columns: `name` (the run folder), `case` (a case of the library or a path), `fidelity` (optional), and
any number of `table.key` columns, whose non-empty cells override the case. The summary is
runs/cohort-<file>/cohort.csv, one row a case, with the status and all metrics; cohort.html shows it.
"""

import csv
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from stages import BIN, CaseError, Chain


def read_rows(path):
    try:
        with open(path, newline="") as file:
            reader = csv.DictReader(line for line in file if not line.startswith("#"))
            rows = [{k: (v or "").strip() for k, v in row.items() if k} for row in reader]
            columns = reader.fieldnames or []
    except OSError as error:
        raise CaseError(f"COHORT={path}: cannot be read: {error.strerror}") from None
    for column in ("name", "case"):
        if column not in columns:
            raise CaseError(f"{path}: the column '{column}' is missing; found {', '.join(columns) or 'nothing'}")
    unknown = [c for c in columns if c not in ("name", "case", "fidelity") and "." not in c]
    if unknown:
        raise CaseError(f"{path}: column '{unknown[0]}' is no table.key; overrides are written as in --set")
    names = [row["name"] for row in rows]
    repeated = next((name for name in names if names.count(name) > 1), None)
    if repeated is not None:
        raise CaseError(f"{path}: the name '{repeated}' stands in two rows; each case needs its own run folder")
    return rows


def run_row(row, options):
    """One case in a process of its own, its output in runs/<name>/log.txt."""
    words = [sys.executable, str(Path(__file__).with_name("pipeline.py")), "run", row["case"], "--runs", str(options.runs)]
    fidelity = row.get("fidelity") or options.fidelity
    if fidelity:
        words += ["--fidelity", fidelity]
    ranks = options.ranks or (1 if options.jobs > 1 else None)
    if ranks:
        words += ["--ranks", str(ranks)]
    for pair in options.overrides + [f"{k}={v}" for k, v in row.items() if "." in k and v] + [f"case.name={row['name']}"]:
        words += ["--set", pair]
    words += ["--force"] * options.force + ["--resume"] * options.resume
    folder = options.runs / row["name"]
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "log.txt", "w") as log:
        code = subprocess.run(words, stdout=log, stderr=subprocess.STDOUT).returncode
    print(f"{row['name']}: {'ok' if code == 0 else f'failed with exit code {code}'}, see {folder / 'log.txt'}", flush=True)
    return code


def last_error(log):
    lines = [line for line in log.read_text().splitlines() if line.startswith("error")] if log.is_file() else []
    return lines[-1] if lines else ""


def summarise(row, code, options):
    """The row of the summary table: status, the stage reached, every metric found."""
    result = {"name": row["name"], "case": row["case"], "status": "ok" if code == 0 else f"failed ({code})"}
    try:
        chain = Chain(row["case"], None, [f"case.name={row['name']}"], None, options.runs)
        for stage in chain.stages():
            summary = chain.summary(stage)
            if summary:
                result["last_stage"] = stage
                result.update({f"{stage}.{name}": value for name, value in summary["metrics"].items()})
    except CaseError as error:
        result["message"] = str(error)
    if code:
        result["message"] = last_error(options.runs / row["name"] / "log.txt") or result.get("message", "")
    return result


def run(options):
    rows = read_rows(options.file)
    with ThreadPoolExecutor(max(1, options.jobs)) as pool:
        codes = list(pool.map(lambda row: run_row(row, options), rows))
    results = [summarise(row, code, options) for row, code in zip(rows, codes)]
    columns = list(dict.fromkeys(key for result in results for key in result))
    folder = options.runs / f"cohort-{Path(options.file).stem}"
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "cohort.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(results)
    page = folder / "cohort.html"
    made = subprocess.run([str(BIN / "valsalva-report"), "--cohort", str(folder / "cohort.csv"), "--out", str(page)]).returncode
    failed = sum(code != 0 for code in codes)
    print(f"cohort: {len(rows) - failed} of {len(rows)} cases done; table: {folder / 'cohort.csv'}" + ("" if made else f"; page: {page}"))
    return 3 if failed else made
