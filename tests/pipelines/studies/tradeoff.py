"""pipelines/tradeoff_cycle.py: calls the stages in their order, goes on where it was stopped, keeps its rows, extrapolates,
marks the Pareto front, and writes the table of all parts."""

import json
import sys
import tempfile
from pathlib import Path

import pretend

expect = pretend.Expect()


def main():
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        pretend.programs(folder)
        import structure_runs
        import tradeoff
        import tradeoff_cycle

        structure_runs.not_finite = lambda path: False  # the states are empty files

        def study(*words):
            sys.argv = ["tradeoff_cycle.py", "--out", str(folder / "out"), "--runs", str(folder / "runs"), "--ranks", "1", *words]
            tradeoff_cycle.main()
            return tradeoff.read(folder / "out" / "cycle-tradeoff.csv")[0]

        calls = lambda: (folder / "calls.txt").read_text().splitlines()
        rows = study("--scenes", "native-healthy", "demo", "--knobs", "grid", "--values", "1 mm")
        order = [line.split()[0] for line in calls()]
        expect("a scene without device: segment, mesher, cycle", order[:3] == ["segment", "mesher", "cycle"], order)
        expect("a scene with one: its stages in their order", order[3:] == ["segment", "mesher", "stent", "crimp", "deploy", "cycle"], order)
        beat = calls()[-1]
        expect("the beat starts from deploy's state, at draft", "deploy/state_000001.h5" in beat and "--fidelity draft" in beat, beat)
        expect("its meshes are those asked for", "device.leaflet_edge_mm=0.5" in beat and "fluid.spacing_mm=1" in beat, beat)
        expect("two rows", [row["scene"] for row in rows] == ["native-healthy", "demo"], rows)

        done = len(calls())
        study("--scenes", "native-healthy", "--knobs", "grid", "--values", "1 mm")
        expect("a row that is there is not run again", len(calls()) == done, calls()[done:])
        rows = study("--scenes", "native-healthy", "--knobs", "grid", "--values", "1.5 mm", "1.25 mm")
        expect("further rows: the beat alone, for the mesh is there", [line.split()[0] for line in calls()[done:]] == ["cycle", "cycle"],
               calls()[done:])
        expect("rows of before are kept, in the order of the study",
               [(row["scene"], row["value"]) for row in rows] == [("native-healthy", "1.5 mm"), ("native-healthy", "1.25 mm"),
                                                                  ("native-healthy", "1 mm"), ("demo", "1 mm")], rows)
        healthy = rows[2]
        near = lambda text, value: abs(float(text) - value) < 1e-3 * abs(value)
        expect("second order is seen: 12 mmHg is 20 % off 10", near(healthy["mean_gradient_mmHg_error_pct"], 20), healthy)
        expect("first order too: 1.7 cm2 is 15 % off 2", near(healthy["eoa_cm2_error_pct"], 15), healthy)
        expect("the largest of them counts", near(healthy["error_pct"], 20), healthy)
        expect("one grid alone has no error", rows[3]["error_pct"] == "", rows[3])
        orders, _ = tradeoff.read(folder / "out" / "cycle-tradeoff-order.csv")
        seen = {row["figure"]: (float(row["observed_order"]), float(row["extrapolated"])) for row in orders}
        expect("orders and extrapolated values", abs(seen["mean_gradient_mmHg"][0] - 2) < 0.02 and abs(seen["mean_gradient_mmHg"][1] - 10) < 0.02
               and abs(seen["eoa_cm2"][0] - 1) < 0.02, seen)

        rows = study("--scenes", "native-healthy", "--knobs", "kernel", "--values", "ib3", "cbs43")
        failed = next(row for row in rows if row["value"] == "ib3")
        expect("a beat that fails says how, and counts for nothing", "node 7" in failed["status"] and failed["error_pct"] == "", failed)
        front = [row for row in rows if row["pareto"]]
        worse = lambda a, b: float(a["processor_s"]) >= float(b["processor_s"]) and float(a["error_pct"]) > float(b["error_pct"])
        expect("nothing on the front is dearer and worse than another", front and not any(worse(a, b) for a in front for b in rows
                                                                                        if b["error_pct"] and b is not a), front)

        words, _ = tradeoff_cycle.words_of("native-stenotic", {"fluid.spacing_mm": "1"})
        digest = tradeoff_cycle.digest_of(words, "")[:-1]
        (folder / "other").mkdir()
        (folder / "other" / "summary.json").write_text(json.dumps({
            "status": "ok", "version": "other", "ranks": 2, "steps": 7, "wall_s": 3, "simulated_s": 0.88, "peak_rss_MiB": 1,
            "parameters_sha256": digest + "rest", "metrics": {"mean_gradient_mmHg": 40, "eoa_cm2": 1, "stroke_volume_mL": 45}}))
        one = ("--scenes", "native-stenotic", "--knobs", "grid", "--values", "1 mm", "--take", str(folder / "other"))
        rows = study(*one)
        row = next(row for row in rows if row["scene"] == "native-stenotic")
        expect("a beat of the same parameters is taken over", (row["commit"], row["processor_s"], row["steps"]) == ("other", "6", "7"), row)
        try:
            study(*one[:5], "1.5 mm", *one[6:])
            expect("one of others is refused", False)
        except SystemExit as stop:
            expect("one of others is refused", "not a finished beat" in str(stop), stop)

        (folder / "out" / "structure-tradeoff.csv").write_text(
            "# command: none; commit: abc; machine: M; date: D\npart,kind,resolution,exit,wall_s,processor_s,tip_mm,stress_kPa,tip_error,"
            "stress_error\nstatic,hex8,n = 1,0,1.0,0.5,3.9,15,0.01,0.02\nstatic,hex8,n = 2,0,2.0,1.5,3.9,15,0.02,0.02\n")
        study("--tables")
        merged, _ = tradeoff.read(folder / "runs" / "tradeoff" / "tradeoff.csv")
        expect("the table of all parts has both, with commit and machine",
               {row["part"] for row in merged} == {"structure", "cycle"} and all(row["commit"] and row["machine"] for row in merged), merged)
        expect("and its columns", list(merged[0]) == tradeoff.COLUMNS, list(merged[0]))
        expect("with a plot beside it", (folder / "runs" / "tradeoff" / "tradeoff.png").stat().st_size > 1000)
        strip = [row for row in merged if row["part"] == "structure"]
        expect("Pareto: the dearer and worse of two is not on the front", [row["pareto"] for row in strip] == ["yes", ""], strip)
    print(f"{expect.failed} failed")
    return 1 if expect.failed else 0


if __name__ == "__main__":
    sys.exit(main())
