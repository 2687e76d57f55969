"""Which stages a scene has, what each depends on, and whether one is up to date."""

import hashlib
import json
import os
import subprocess
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BIN = ROOT / "build" / "bin"
ORDER = ["segment", "mesher", "stent", "crimp", "deploy", "cycle", "report"]


class CaseError(Exception):
    """The user's case cannot be run; the message says what to change."""


def case_path(name):
    """A path, or the name of a case of the library."""
    for candidate in (Path(name), ROOT / "pipelines" / "cases" / f"{name}.toml"):
        if candidate.is_file():
            return candidate
    known = ", ".join(sorted(p.stem for p in (ROOT / "pipelines" / "cases").glob("*.toml")))
    raise CaseError(f"CASE={name}: neither a file nor a case of the library ({known})")


def parents_of(tables):
    """Stage -> parent stages, for the stages that this scene has."""
    anatomy, device, fluid = ("anatomy" in tables), ("device" in tables), ("fluid" in tables)
    graph = {}
    if anatomy:
        graph["segment"] = []
        graph["mesher"] = ["segment"]
    if device:
        # The size comes from segment where the case leaves it open.
        size_is_open = anatomy and not tables["device"].get("size_mm", 0) and not tables["device"].get("graph_file", "")
        graph["stent"] = ["segment"] if size_is_open else []
        graph["crimp"] = ["stent"]
        if anatomy:
            graph["deploy"] = ["crimp", "mesher"]
    if fluid or "body" in tables:
        last = next((s for s in ("deploy", "mesher") if s in graph), None)
        graph["cycle"] = [last] if last else []
    graph["report"] = [s for s in ORDER if s in graph]
    return graph


class Chain:
    """One case at one fidelity with its overrides, and the folder it runs in."""

    def __init__(self, case, fidelity=None, overrides=(), ranks=None, runs=Path("runs")):
        self.path = case_path(case)
        try:
            self.tables = tomllib.loads(self.path.read_text())
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
            raise CaseError(f"{self.path}: not valid TOML: {error}") from None
        self.overrides = list(overrides)
        for pair in self.overrides:
            key, _, value = pair.partition("=")
            table, _, name = key.partition(".")
            if not isinstance(self.tables.setdefault(table, {}), list):  # entries of [[table]] choose no stages
                self.tables[table][name] = value.strip('"')
        self.name = self.tables.get("case", {}).get("name") or self.path.stem
        self.fidelity = fidelity
        self.ranks = ranks or min(2, os.cpu_count() or 1)
        self.folder = runs / self.name
        self.parents = parents_of(self.tables)

    def stages(self):
        return [stage for stage in ORDER if stage in self.parents]

    def command(self, stage, *extra):
        words = [str(BIN / f"valsalva-{stage}"), str(self.path)]
        if self.fidelity:
            words += ["--fidelity", self.fidelity]
        for pair in self.overrides:
            words += ["--set", pair]
        words += ["--out", str(self.folder / stage)]
        return words + list(extra)

    def environment(self, stage):
        """Threads for the stages on one rank; one thread a rank for the cycle."""
        environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        environment.setdefault("OMP_NUM_THREADS", "1" if stage == "cycle" and "fluid" in self.tables else str(os.cpu_count() or 1))
        environment.setdefault("OMP_WAIT_POLICY", "passive")
        return environment

    def run(self, stage, *extra):
        words = self.command(stage, *extra)
        # A scene without fluid runs on threads: ranks would all compute the same.
        if stage == "cycle" and self.ranks > 1 and "fluid" in self.tables:
            words = ["mpirun", "--oversubscribe", "--bind-to", "none", "-np", str(self.ranks)] + words
        return subprocess.run(words, env=self.environment(stage)).returncode

    def digest(self, stage):
        """Of the parameters the stage depends on; None when the case is refused (its message is on stderr)."""
        done = subprocess.run(self.command(stage, "--digest"), env=self.environment(stage), stdout=subprocess.PIPE, text=True)
        return done.stdout.strip() if done.returncode == 0 else None

    def summary(self, stage):
        try:
            return json.loads((self.folder / stage / "summary.json").read_text())
        except (OSError, json.JSONDecodeError):
            return None

    def fidelity_of_run(self, stage):
        """The level at which the states that the stage starts from were made (without parents: its own); None when
        there are none. A single stage goes on at this level unless another is asked for."""
        for name in self.parents[stage] or [stage]:
            if summary := self.summary(name):
                return summary["fidelity"]
        return None

    def is_up_to_date(self, stage):
        """Finished, with these parameters, from inputs whose content is still the same."""
        summary = self.summary(stage)
        if stage == "report" or not summary or summary["status"] != "ok":
            return False
        if summary["parameters_sha256"] != self.digest(stage):
            return False
        return all(sha256(path) == digest for path, digest in summary["inputs"].items())


def sha256(path):
    """As the stages digest a file, or a folder of files; None when it is gone."""
    path = Path(path)
    digest = hashlib.sha256()
    try:
        files = sorted(p for p in path.rglob("*") if p.is_file()) if path.is_dir() else [path]
        for file in files:
            if path.is_dir():
                digest.update(str(file.relative_to(path)).encode())
            digest.update(file.read_bytes())
    except OSError:
        return None
    return digest.hexdigest()
