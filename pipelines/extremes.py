"""What the studies of extremes (extremes_structure.py, extremes_cycle.py) share: rows of values that are pushed from
harmless to extreme, the limits read from them, and runs/extremes/extremes.csv with its plot, which hold all parts."""

import csv
import os
import re

import structure_runs as runs

ACCURATE = 0.02
FOLDER = runs.ROOT / "runs" / "extremes"
RESULTS = runs.ROOT / "docs" / "results"
PLACE = re.compile(r"\([-\d.e+]+, [-\d.e+]+, [-\d.e+]+\)|node \d|element \d")


class Extremes:
    """The rows of one part of the study."""

    def __init__(self, part):
        self.part, self.rows = part, []

    def note(self, extreme, series, at, result, error=None, remark=""):
        """A value of a series that is pushed from harmless to extreme; series None: a row that is not part of one."""
        code, message = result["exit"], result["message"]
        self.rows.append({"extreme": extreme, "series": series or "", "value": at, "exit": "time out" if code is None else code,
                          "error": "" if error is None or code else f"{error:.2e}", "nan": "yes" if result["nan"] else "no",
                          "state": "yes" if result["state"] else "no",
                          "place": ("yes" if PLACE.search(message) else "no") if code == 3 else "",
                          "processor_s": f"{result['processor_s']:.1f}", "version": result.get("version", ""),
                          "remark": remark or (message if code else "")})
        row = self.rows[-1]
        print(f"  {extreme}, {series or ''}, {at}: exit {row['exit']}, error {row['error'] or '-'}, nan {row['nan']}, "
              f"{row['processor_s']} s{', ' + row['remark'] if row['remark'] else ''}", flush=True)

    def limits(self):
        """Of every series: where it stops being accurate, where it stops, and how."""
        found = []
        for extreme, series in dict.fromkeys((row["extreme"], row["series"]) for row in self.rows if row["series"]):
            rows = [row for row in self.rows if (row["extreme"], row["series"]) == (extreme, series)]
            solved = [row for row in rows if row["exit"] == 0]
            stop = next((row for row in rows if row["exit"] != 0), None)
            accurate, wrong = None, None
            for row in solved:
                if row["error"] and float(row["error"]) > ACCURATE:
                    wrong = row
                    break
                if row["error"]:
                    accurate = row
            found.append({"extreme": extreme, "series": series,
                          "accurate until (error to 2 %)": accurate["value"] if accurate else "",
                          "no longer at": f"{wrong['value']} (error {float(wrong['error']):.2g})" if wrong else "",
                          "goes on until": solved[-1]["value"] if solved else "",
                          "stops at": stop["value"] if stop else "does not stop",
                          "how": f"exit {stop['exit']}, {'last state kept' if stop['state'] == 'yes' else 'nothing written'}: "
                                 f"{stop['remark']}" if stop else "exit 0",
                          "nan": "yes" if any(row["nan"] == "yes" for row in rows) else "no"})
        return found

    def take_others(self, path, single_runs=False):
        """What the table there has of extremes that were not run now, in its place; with single_runs of those, too, of which
        only some runs were."""
        if not path.exists():
            return
        mine = {}
        for row in self.rows:
            mine.setdefault(row["extreme"], []).append(row)
        before = {}
        for row in read(path)[0]:
            exit_code = int(row["exit"]) if row["exit"].isdigit() else row["exit"]
            before.setdefault(row["extreme"], []).append(row | {"exit": exit_code})
        self.rows = [row for extreme in {**before, **mine}
                     for row in (merged(before.get(extreme, []), mine.get(extreme, [])) if single_runs
                                 else mine.get(extreme, before.get(extreme)))]

    def write(self, out, source):
        """Both tables of this part to `out`, and the tables of all parts to runs/extremes."""
        runs.write_csv(out / f"{self.part}-extremes.csv", self.rows, source)
        runs.write_csv(out / f"{self.part}-extremes-limits.csv", self.limits(), source)
        gather({self.part: out})
        for row in self.limits():
            print("| " + " | ".join(str(cell)[:120] for cell in row.values()) + " |")
        print(f"written: {out / self.part}-extremes.csv, {self.part}-extremes-limits.csv, {FOLDER / 'extremes.csv'}")


def merged(before, now):
    """The rows of before with those of now in their places, new ones at the end."""
    def key(row):
        return row["series"], row["value"]
    fresh = {key(row): row for row in now}
    return [fresh.pop(key(row), row) for row in before] + list(fresh.values())


def read(path):
    """The rows of a table, and its first line, which says where they come from."""
    lines = path.read_text().splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#"))), lines[0].lstrip("# ")


def gather(newest):
    """runs/extremes/extremes.csv and .png of all parts; where a part is not among the newest, of what docs/results holds."""
    rows, sources = [], []
    for part in ("structure", "cycle"):
        path = newest.get(part, RESULTS) / f"{part}-extremes.csv"
        if not path.exists():
            continue
        table, source = read(path)
        sources.append(f"{part}: {source}")
        rows += [{"part": part, **{key: row.get(key, "") for key in ("extreme", "series", "value", "exit", "error", "nan", "state",
                                                                    "place", "processor_s", "version", "remark")}} for row in table]
    if rows:
        runs.write_csv(FOLDER / "extremes.csv", rows, dict(enumerate(sources)))
        draw(rows, FOLDER / "extremes.png")


def draw(rows, path):
    """A line a series, a dot a value from harmless to extreme: solved within 2 %, solved, refused, stopped, anything else."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    kinds = {"solved, error to 2 %": "tab:green", "solved, error not measured": "tab:olive", "solved, error above 2 %": "tab:orange",
             "refused as input (2)": "tab:blue", "stopped with the last state (3)": "tab:red", "anything else": "black"}

    def kind(row):
        if row["nan"] == "yes" or row["exit"] not in ("0", "2", "3"):
            return "anything else"
        if row["exit"] != "0":
            return "refused as input (2)" if row["exit"] == "2" else "stopped with the last state (3)"
        if not row["error"]:
            return "solved, error not measured"
        return "solved, error to 2 %" if float(row["error"]) <= ACCURATE else "solved, error above 2 %"

    series = list(dict.fromkeys((row["part"], row["extreme"], row["series"]) for row in rows))
    figure, axis = plt.subplots(figsize=(13, 1 + 0.42 * len(series)))
    for name, colour in kinds.items():
        dots = [(sum(1 for other in rows[:n] if (other["part"], other["extreme"], other["series"]) == key), series.index(key), row["value"])
                for n, row in enumerate(rows) for key in [(row["part"], row["extreme"], row["series"])] if kind(row) == name]
        if dots:
            axis.plot([d[0] for d in dots], [d[1] for d in dots], "o", color=colour, label=name)
        for x, y, value in dots:
            axis.annotate(value[:22], (x, y), fontsize=5, xytext=(0, 5), textcoords="offset points", ha="center")
    axis.set_yticks(range(len(series)), [", ".join(word for word in key if word) for key in series], fontsize=6)
    axis.invert_yaxis()
    axis.set_xlabel("values from harmless to extreme")
    axis.legend(fontsize=7, loc="lower right")
    figure.tight_layout()
    partial = path.with_suffix(".partial.png")
    figure.savefig(partial, dpi=110)
    plt.close(figure)
    os.replace(partial, path)
