"""What the make targets of a case and of one stage call: fidelity carried on, up to date, forced, refused.

Usage: make_targets.py BUILD_BIN
"""

import contextlib
import io
import json
import os
import sys
import tempfile
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "pipelines"))

import pipeline  # noqa: E402
import stages  # noqa: E402

stages.BIN = Path(sys.argv[1]).resolve()
failures = []


def call(*arguments):
    """Exit code and what was printed."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        code = pipeline.main(list(arguments))
    return code, out.getvalue()


def expect(what, holds, seen):
    print(f"{'ok    ' if holds else 'FAILED'} {what}")
    if not holds:
        failures.append(what)
        print(seen)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        case = "dry-cantilever-beam"
        summary = Path("runs") / case / "cycle" / "summary.json"

        code, text = call("run", case, "--fidelity", "draft")
        expect("a case runs to its report", code == 0 and (Path("runs") / case / "report.html").is_file(), text)
        made = summary.stat().st_mtime_ns

        code, text = call("stage", "cycle", case)
        expect("one stage again: at the run's fidelity, so up to date",
               code == 0 and "fidelity draft" in text and "up to date" in text and summary.stat().st_mtime_ns == made, text)

        code, text = call("stage", "cycle", case, "--resume")
        expect("nothing is left to resume", code == 0 and "up to date" in text, text)

        code, text = call("stage", "cycle", case, "--force")
        expect("forced: runs again", code == 0 and summary.stat().st_mtime_ns != made, text)
        made = summary.stat().st_mtime_ns

        code, text = call("stage", "cycle", case, "--fidelity", "standard")
        expect("another fidelity asked for", code == 0 and json.loads(summary.read_text())["fidelity"] == "standard", text)

        code, text = call("stage", "cycle", case, "--set", "dynamics.load_steps=7")
        expect("changed parameters: runs again", code == 0 and "up to date" not in text, text)

        code, text = call("stage", "crimp", case)
        expect("a stage that the scene does not have is refused", code == 2 and "no stage 'crimp'" in text, text)
        code, text = call("run", "no-such-case")
        expect("a case that does not exist is refused", code == 2 and "no-such-case" in text, text)
    print(f"{len(failures)} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
