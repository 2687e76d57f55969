"""pipelines/extremes.py and extremes_cycle.py: what becomes of rows, what is not run again, and which outputs are looked at."""

import json
import sys
import tempfile
from pathlib import Path

import pretend

expect = pretend.Expect()


def result(code, message="", **changes):
    return {"exit": code, "message": message, "nan": False, "state": code != 2, "processor_s": 1.0, "version": "pretended"} | changes


def limits(study):
    one = study.Extremes("cycle")
    one.note("load", "up", "1", result(0), 1e-3)
    one.note("load", "up", "2", result(0), 0.5)
    one.note("load", "up", "3", result(3, "error: node 7 at (1, 2, 3) mm moves at 3e4 mm/s. The last good state is x.h5"))
    one.note("load", "down", "0", result(2, "error: a.toml: found 0; expected more"))
    up, down = one.limits()
    expect("accurate until", up["accurate until (error to 2 %)"] == "1" and up["no longer at"].startswith("2 "), up)
    expect("stops at, and how", up["stops at"] == "3" and up["how"].startswith("exit 3, last state kept"), up)
    expect("refused: nothing written", down["how"].startswith("exit 2, nothing written"), down)
    expect("a place is seen where one is named", [row["place"] for row in one.rows] == ["", "", "yes", ""], one.rows)
    return one


def finite(runs, folder):
    import h5py
    import numpy

    for name, value in (("good", 1.0), ("bad", float("nan")), ("endless", float("inf"))):
        with h5py.File(folder / f"state_{name}.h5", "w") as file:
            file.create_group("restart")["array"] = numpy.array([0.0, value])
            file["numbers"] = numpy.array([1, 2])
    seen = [runs.not_finite(folder / f"state_{name}.h5") for name in ("good", "bad", "endless")]
    expect("every array of a state is looked at", seen == [False, True, True], seen)


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        pretend.programs(folder)
        import extremes
        import extremes_cycle
        import structure_runs

        finite(structure_runs, folder)
        one = limits(extremes)
        extremes.FOLDER = folder / "runs"
        extremes.RESULTS = folder / "none"
        one.write(folder / "out", {"command": "none"})
        table, _ = extremes.read(folder / "runs" / "extremes.csv")
        expect("the table of all parts", [row["part"] for row in table] == ["cycle"] * 4 and table[2]["exit"] == "3", table)
        expect("with a plot beside it", (folder / "runs" / "extremes.png").stat().st_size > 1000)

        path = folder / "out" / "cycle-extremes.csv"
        some = extremes.Extremes("cycle")
        some.note("load", "up", "2", result(0), 1e-4)
        some.note("load", "up", "4", result(2, "refused"))
        some.take_others(path, single_runs=True)
        expect("single runs take their places among the others", [(row["value"], row["error"]) for row in some.rows]
               == [("1", "1.00e-03"), ("2", "1.00e-04"), ("3", ""), ("0", ""), ("4", "")], some.rows)
        part = extremes.Extremes("cycle")
        part.note("load", "up", "5", result(0), 1e-4)
        part.take_others(path)
        expect("an extreme that is run as a whole has its rows alone", [row["value"] for row in part.rows] == ["5"], part.rows)

        structure_runs.not_finite = lambda path: False  # the states are empty files
        extremes_cycle.FOLDER = folder / "runs"
        first = extremes_cycle.run("case", {"fluid.spacing_mm": 2}, base={})
        calls = lambda: (folder / "calls.txt").read_text().splitlines()
        again = extremes_cycle.run("case", {"fluid.spacing_mm": 2}, base={})
        expect("what was run with the same words is read back", len(calls()) == 1 and again == json.loads(json.dumps(first)), calls())
        extremes_cycle.run("case", {"fluid.spacing_mm": 1}, base={})
        expect("with others it is run again", len(calls()) == 2, calls())
        stopped = extremes_cycle.run("stopped", {"cycle.kernel": "ib3"}, base={})
        expect("a stop keeps its message", stopped["exit"] == 3 and "node 7" in stopped["message"], stopped)
    print(f"{expect.failed} failed")
    return 1 if expect.failed else 0


if __name__ == "__main__":
    sys.exit(main())
