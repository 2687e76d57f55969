# The front door. Every target works alone and pulls in what it needs; see README.md.
#   make demo                         the default case end to end, at draft fidelity
#   make test                         build and run the tests
#   make run CASE=name-or-path [FIDELITY=draft|standard|fine|reference] [NP=2] [SET="table.key=value ..."]
#   make segment|mesher|stent|crimp|deploy|cycle|report CASE=...   that stage, when its inputs changed [FORCE=1] [RESUME=1]
#   make cohort COHORT=file.csv [JOBS=n]
#   make verify                       the verification programs, with a table in runs/verify
#   make lint [SINCE=commit]          clang-format, clang-tidy over all files or those changed since a commit
#   make tradeoff | extremes          studies of error against time, and of values pushed until something gives
#   make studies                      benchmark flows against published figures, on grids that take hours
#   make setup | build | bench | reference | clean

CASE     ?= demo
FIDELITY ?=
NP       ?=
JOBS     ?= 1
SET      ?=
FORCE    ?=
RESUME   ?=
SINCE    ?=
COHORT   ?= pipelines/cohorts/anatomies.csv

PIPELINE = python3 pipelines/pipeline.py
STUDY    = /usr/bin/python3
OPTIONS  = $(if $(FIDELITY),--fidelity $(FIDELITY)) $(if $(NP),--ranks $(NP)) $(if $(FORCE),--force) \
           $(if $(RESUME),--resume) $(foreach pair,$(SET),--set $(pair))
STAGES   = segment mesher stent crimp deploy cycle report

.PHONY: demo test setup build run $(STAGES) cohort verify bench tradeoff extremes studies lint format reference clean

demo: build
	$(PIPELINE) run demo --fidelity $(or $(FIDELITY),draft) $(if $(NP),--ranks $(NP)) $(if $(FORCE),--force)

test: build
	cd build && ctest --output-on-failure --parallel 2

setup:
	@sh pipelines/setup.sh

build: setup
	@test -f build/build.ninja || cmake --preset release
	cmake --build build

run: build
	$(PIPELINE) run $(CASE) $(OPTIONS)

$(STAGES): build
	$(PIPELINE) stage $@ $(CASE) $(OPTIONS)

cohort: build
	$(PIPELINE) cohort $(COHORT) --jobs $(JOBS) $(OPTIONS)

verify: build
	mkdir -p runs/verify
	cd build && ctest -L verification --output-on-failure --output-junit $(CURDIR)/runs/verify/verify.xml

bench: build
	python3 pipelines/bench.py

tradeoff: build
	for study in pipelines/tradeoff_*.py; do $(STUDY) $$study || exit; done

extremes: build
	for study in pipelines/extremes_*.py; do $(STUDY) $$study || exit; done

studies: build
	python3 pipelines/study_taylor_green.py --cells 32 64 96 128 --schemes conserving4 upwind3 $(if $(NP),--ranks $(NP))
	python3 pipelines/study_fda.py --reynolds 500 --cells 8 10 12 --wall-convection upwind1 $(if $(NP),--ranks $(NP))
	python3 pipelines/study_fda.py --reynolds 3500 --cells 8 12 --convection weno5 --wall-convection upwind1 \
	  --span 0.15 0.9 $(if $(NP),--ranks $(NP))
	python3 pipelines/study_turek_hron.py --cases fsi1 fsi2 fsi3 --cells 82
	python3 pipelines/study_closed_valve.py --h 1 0.75 0.5 $(if $(NP),--ranks $(NP))

lint: setup
	@SINCE="$(SINCE)" sh pipelines/lint.sh

format: setup
	git ls-files '*.cpp' '*.hpp' | xargs clang-format -i

reference: build
	build/bin/valsalva-cycle --reference > docs/case-file.md

clean:
	rm -rf build runs
