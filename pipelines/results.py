"""Prints the results of a run folder as a Markdown page: what docs/results keeps of a case.

    python3 pipelines/results.py runs/demo > docs/results/demo-draft.md
"""

import json
import os
import sys
from pathlib import Path

from stages import ORDER


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return f"{os.cpu_count()} cores of {model}, {memory:.0f} GiB"


def number(value):
    return f"{value:.4g}" if isinstance(value, (int, float)) else str(value)


def main():
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_dir():
        sys.exit("usage: python3 pipelines/results.py RUN_FOLDER (a folder of stages, as runs/demo)")
    folder = Path(sys.argv[1])
    found = {s: json.loads((folder / s / "summary.json").read_text()) for s in ORDER if (folder / s / "summary.json").is_file()}
    if not found:
        sys.exit(f"{folder}: no summary.json of any stage; run 'make run CASE=...' first")
    first = next(iter(found.values()))
    print(f"# {first['case']}, {first['fidelity']}\n")
    print(f"Command: `make run CASE={first['case']} FIDELITY={first['fidelity']}`. Machine: {machine()}. "
          "Written by `python3 pipelines/results.py " + str(folder) + "`.\n")
    print("| stage | version | ranks | steps | wall s | peak MiB |\n|---|---|---|---|---|---|")
    for stage, s in found.items():
        print(f"| {stage} | {s['version']} | {s['ranks']} | {s['steps']} | {s['wall_s']:.0f} | {s['peak_rss_MiB']:.0f} |")
    print(f"\nWall time of all stages: {sum(s['wall_s'] for s in found.values()):.0f} s.")
    for stage, s in found.items():
        if not s["metrics"] and not s["checks"]:
            continue
        print(f"\n## {stage}")
        if s["metrics"]:
            print("\n| metric | value |\n|---|---|")
            for name, value in sorted(s["metrics"].items()):
                print(f"| {name} | {number(value)} |")
        if s["checks"]:
            print("\n| check | value | limit | passed |\n|---|---|---|---|")
            for name, c in sorted(s["checks"].items()):
                print(f"| {name} | {number(c['value'])} | {number(c['limit'])} | {'yes' if c['pass'] else '**no**'} |")
        for name, note in sorted(s.get("notes", {}).items()):
            print(f"\n{name}: {note}.")


if __name__ == "__main__":
    main()
