# make bench        the table, the plots and the page on the built-in scenes, into results/builtin: seven minutes
#                   from an empty clone on two cores of an AMD EPYC (Zen 4), eleven on older ones, compilation included
# make report       the page of results/builtin again, report.html; RESULTS=DIR for another folder
# make bench-full   the same with more rays and rounds
# make bench-paper  the paper's protocol: its eight methods over stand-ins for its nine scenes, whole frames of 1024 x 1024
#                   pixels, into results/paper-run; reduced into results/paper-protocol, drawn, and told of beside its claims
#                   of 5.1 and 5.2; then their steps under our kernel, once, into results/paper-steps; stopped and resumed
#                   at will: three hours on two cores
# make bench-experiments
#                   the paper's experiments over the files SCENES, and that of its parameters over stand-ins for its scenes,
#                   into results/experiments-run; reduced into results/experiments, drawn and told; sizes of
#                   cuts, a split, phases of builds and the heat map of Figure 1: two hours on two cores
# make bench-builders
#                   what the targets are judged by (`phr targets`), into results/targets: all builders on the files
#                   SCENES and the built-in scenes with two threads, their builds with one thread beside two, their
#                   growth over scenes of 1 to 32 million triangles, and single extensions: an hour on two cores, 16 GiB
#                   of memory
# make bench-kernel our kernels and Embree's, single rays and batches, over the same trees, and single rays over trees of
#                   our presets, on the files SCENES and the built-in scenes of 100,000 triangles and more, into
#                   results/kernel: half an hour on two cores; and 10^8 rays at vertices and edges, into results/leaks
# make bench-scaling
#                   the tasks of our builders on the files SCENES and the built-in scenes, timed one by one and scheduled on
#                   up to 64 workers, into results/scaling: ten minutes
# make bench-animation
#                   trees that follow scenes that move, 100 frames each, 4-wide, into results/animation: a quarter of an hour on two cores
# make bench-advice
#                   what `phr advise` names for each of the files SCENES and the built-in scenes after half a minute, helped
#                   by a model that has not seen the scene; judged by a longer run, into results/advice: two hours and
#                   a half on two cores
# make bench-tune   what `phr tune` gains over phr-quality for 10^9 rays in the same scenes, two minutes each, into
#                   results/tune: an hour
# make bench-reference
#                   the figures of README, RESULTS and METHODOLOGY that come from the reference run, its
#                   ablations, kernels and scaling, again: the runs of bench-builders into results/full, stopped and
#                   resumed at will, reduced into results/reference and results/reference-ablation; tables, plots, pages
#                   and the model of phr advise made from them; refuses to start on a busy machine. Left as they are:
#                   results/ndebug (make embree-ndebug), constants (cargo bench --bench constants), advice (make
#                   bench-advice), tune (make bench-tune), animation (make bench-animation), paper-protocol, saved and the
#                   experiments, whose commands stand beside their figures
# cargo bench --bench steps
#                   the steps of a build one by one (codes, sort, auxiliary tree, sweeps by length of the cut,
#                   refining, leaf blocks, wide nodes), each beside a memcpy of as many bytes: some minutes
# make embree-ndebug
#                   compiles the distribution's Embree from its source package, without assertions, into
#                   target/embree-ndebug; then builds and traces the built-in scenes with either library by turns, the
#                   program the same, into results/ndebug: half an hour on two cores
# make test         everything that is checked before a change is taken: formatting, lints (of the library without any
#                   feature and of the harness without Embree too), documentation, all tests and its examples
#
# make faults       kills a run fifty times at random moments and resumes it, fills its disk, and cuts its results at every
#                   byte: some minutes (the tests have a short version)
# make fuzz         changed and made-up scene files, cameras, saved trees, configurations, rays and results, a minute each, under
#                   AddressSanitizer (nightly toolchain and cargo-fuzz); SECONDS_EACH=600 for ten minutes each
# make sanitize     the library's tests, those beside its code included, under AddressSanitizer and, where the nightly
#                   toolchain has rust-src, under ThreadSanitizer; those of our kernels, of the library's queries and of
#                   the containers with unsafe code under valgrind, and the portable kernel's under Miri where the
#                   nightly toolchain has it: half an hour
# make test-platforms
#                   the library and the benchmark checked for aarch64 Linux and macOS, everything under the oldest compiler,
#                   and the library's tests under qemu on aarch64 and on x86-64 with less than this machine has; the parts
#                   PARTS (checks oldest aarch64 x86-64) of it: half an hour, rustup needed
# make audit        dependencies without use, of licences that do not fit or with known faults, and breaks of the public
#                   interface since the last release (cargo-machete, cargo-deny, cargo-semver-checks)
# make package      both crates as the registry would get them, compiled from there, and the documentation as docs.rs
#                   makes it (nightly toolchain): minutes
# make test-peers   the tests of the builders of other crates, which `make test` leaves out: their crates take minutes to
#                   compile
#
# make test-trixie  embree-sys, the wrapper and short runs with Embree 4 in a root of Debian 13, which debootstrap makes in
#                   target/trixie; as root
#
# make test-slurm   a run spread over a Slurm cluster of this one machine (cluster/submit), a task of it killed and
#                   requeued, merged and compared with the same run in one; as root, some minutes
#
# Debian packages that are missing are installed, as root or by sudo. ARGS go to `phr bench`.

CARGO ?= cargo
ARGS ?=
# Scene files of `make bench-builders`, its rounds, the seconds for which they go on in a scene, and pixels.
SCENES ?= $(wildcard ../shared/scenes/*.ply.zst)
ROUNDS ?= 3
MIN_SECONDS ?= 60
SIZE ?= 160
RESULTS ?= results/builtin
JUDGED = results/targets
FULL = results/full
REFERENCE = results/reference
# Builders that have targets, and sizes over which they grow.
TARGETED = lbvh|phr-fast|phr-hq|phr-draft|phr-turbo|phr-speed|phr-quality|phr-best|embree-[a-z-]+
GROWING = lbvh|phr-fast|phr-speed|embree-morton|embree-sah
# PHR-Fast with one extension each, and our presets without one each (`phr ablation`).
ABLATED = phr-fast $(addprefix phr-fast-,bucket coarse clusters subtrees) \
	phr-speed $(addprefix phr-speed-no-,auxiliary_leaf calibration cut_share local_threshold presplit)
ABLATED_QUALITY = phr-quality $(addprefix phr-quality-no-,calibration clip_triangles clusters collapse cut_share \
	local_threshold presplit subtree_sweep)
SCALED = lbvh phr-fast phr-hq phr-draft phr-turbo phr-speed phr-quality phr-best
# The paper's methods, and where its protocol is run.
METHODS = embree-morton hunt-50 aac embree-sah hunt-500 embree-fast-spatial phr-fast phr-hq
PAPER = results/paper-run
# Scenes whose builds are divided into phases.
PHASED = rooms hair $(filter %/kitchen_bitterli.ply.zst %/karhumaki_bridge.ply.zst,$(SCENES))
# The scene of the heat map: the free part of the one in the paper's Figure 1.
HEATMAP ?= $(or $(firstword $(filter %/sanmiguel_partial.ply.zst,$(SCENES))),sanmiguel-like)
KERNEL_SCENES = rooms statue hair city pipes
# All that an advice may name, and Embree's: one that names a tree which the run lacks cannot be judged.
ADVISED = lbvh phr-fast phr-hq phr-draft phr-turbo phr-speed phr-quality phr-best hunt-50 hunt-500 aac ploc embree-morton embree-sah embree-fast-spatial
# Builders whose times with and without assertions in Embree are compared, and ours beside them: what noise looks like.
ASSERTED = embree-morton embree-sah embree-fast-spatial lbvh
NDEBUG = $(CURDIR)/target/embree-ndebug
GROWTH = $(foreach size,1 2 4 8 16 32,scalable-$(size)M)
PACKAGES = libembree-dev libclang-dev
HOST = $(shell rustc -vV | sed -n 's/^host: //p')
KERNEL_TESTS = --test library -- trace_agreement trace_batches trace_kernel trace_watertight query:: primitives:: instances::
# The library's tests and those beside its code, but for those that take minutes without a sanitizer.
LIBRARY_TESTS = --lib --test library -- $(addprefix --skip ,tree_hashes configurations_are_refused huge_scenes wide_trees_are_the_naive_ones)
# Those of the containers with unsafe code.
CONTAINER_TESTS = --lib -- parallel:: memory:: builders::lbvh:: builders::wide::
VALGRIND = CARGO_TARGET_$(shell echo $(HOST) | tr a-z- A-Z_)_RUNNER="valgrind --quiet --error-exitcode=1" \
	$(CARGO) test -p phr --no-default-features --target $(HOST) --target-dir target/valgrind
# Cargo's own tests run by nextest where it is installed.
NEXTEST := $(shell $(CARGO) nextest --version >/dev/null 2>&1 && echo yes)

.PHONY: report test-peers test-trixie test-platforms audit package faults fuzz test-slurm sanitize bench bench-scaling bench-animation bench-advice bench-tune bench-full bench-experiments bench-builders bench-reference bench-kernel bench-paper embree-ndebug test packages

# The program alone: criterion's benchmarks are not built.
bench: packages
	$(CARGO) build --release --bin phr
	./target/release/phr bench --set builtin --rounds 3 --views 1 --size 160 --replace $(ARGS)

# The page of the folder RESULTS again; ARGS="--experiments results/experiments" adds those.
report: packages
	$(CARGO) build --release --bin phr
	./target/release/phr report $(RESULTS) $(ARGS)

bench-full: packages
	$(CARGO) build --release --bin phr
	./target/release/phr bench --set builtin --replace $(ARGS)

# A run into the folder $(2); with RESUMED, continued where it was stopped, in a quiet hour, until intervals are narrow.
define measured
	./target/release/phr bench $(1) --out $(2) $(if $(RESUMED),$$(test -f $(2)/samples.json && echo --resume) --when-quiet --until 2%) $(ARGS)

endef

# The runs behind the targets into the folder $(1), and of extensions into $(1)-ablation; the short runs first: what is
# wrong shows early.
define runs
$(call measured,$(GROWTH) --build-only --filter ' ($(GROWING)) 4 ' --rounds $(ROUNDS) --threads 2,$(1)/growth)
$(call measured,--set builtin $(SCENES) --build-only --filter ' ($(TARGETED)) 4 ' \
	--rounds $(ROUNDS) --seconds $(MIN_SECONDS) --threads 2 --one-thread,$(1)/threads)
$(call measured,--set builtin $(SCENES) --size $(SIZE) --rounds $(ROUNDS) --seconds $(MIN_SECONDS) --threads 2,$(1))
$(call measured,--set builtin $(SCENES) --size 64 $(addprefix --builder ,$(ABLATED)) --width 4 \
	--rounds $(ROUNDS) --threads 2,$(1)-ablation)
$(call measured,--set builtin $(SCENES) --size 64 $(addprefix --builder ,$(ABLATED_QUALITY)) --width 4 \
	--rounds $(ROUNDS) --threads 2,$(1)-ablation-quality)
endef

bench-builders: packages
	$(CARGO) build --release --bin phr
	$(call runs,$(JUDGED))
	./target/release/phr plot $(JUDGED)
	./target/release/phr plot $(JUDGED)/growth
	./target/release/phr targets $(JUDGED)

bench-kernel: packages
	$(CARGO) build --release --bin phr
	./target/release/phr kernels $(KERNEL_SCENES) $(SCENES) --least 100000 --size $(SIZE) --threads 1 --threads 2 \
		--out results/kernel $(ARGS)
	./target/release/phr leaks --out results/leaks

bench-scaling: packages
	$(CARGO) build --release --bin phr
	./target/release/phr scaling $(KERNEL_SCENES) $(SCENES) $(addprefix --builder ,$(SCALED)) --width 8 \
		$(addprefix --workers ,1 2 4 16 64) --out results/scaling $(ARGS)
	./target/release/phr plot results/scaling

bench-animation: packages
	$(CARGO) build --release --bin phr
	./target/release/phr animate --width 4 --size 128 --out results/animation $(ARGS)

bench-advice: packages
	$(CARGO) build --release --bin phr
	./target/release/phr bench $(KERNEL_SCENES) $(SCENES) --size 128 $(addprefix --builder ,$(ADVISED)) --filter grafted \
		--rounds 8 --threads 2 --replace --out results/advice-run $(ARGS)
	./target/release/phr reduce results/advice-run results/advice
	for scene in $(KERNEL_SCENES) $(SCENES); do \
		name=$$(basename $$scene .ply.zst); \
		./target/release/phr advise --fit results/advice --without $$name --model target/without.json && \
			./target/release/phr advise $$scene --threads 2 --model target/without.json --out results/advice/$$name \
			|| exit 1; \
	done
	./target/release/phr advise --judge results/advice --advice results/advice

bench-tune: packages
	$(CARGO) build --release --bin phr
	for scene in $(KERNEL_SCENES) $(SCENES); do \
		./target/release/phr tune $$scene --rays 1G --threads 2 --out results/tune/$$(basename $$scene .ply.zst) $(ARGS) || exit 1; \
	done
	./target/release/phr tune --judge results/tune

# A new revision begins anew: it cannot continue the runs of another (remove results/full).
bench-reference: RESUMED = yes
bench-reference: packages
	$(CARGO) build --release --bin phr
	@echo "$(words $(SCENES)) scene files and the built-in scenes: each $(MIN_SECONDS) seconds twice and longer where they" \
		"are large, up to five minutes each; with growth and extensions four to eight hours on two cores. Stop it with Ctrl-C, go on with the same command."
	$(call runs,$(FULL))
	./target/release/phr reduce $(FULL) $(REFERENCE)
	./target/release/phr reduce $(FULL)-ablation $(REFERENCE)-ablation
	./target/release/phr reduce $(FULL)-ablation-quality $(REFERENCE)-ablation-quality
	$(MAKE) bench-kernel bench-scaling
	./target/release/phr advise --fit $(REFERENCE) --model src/report/advice/model/model.json
	./target/release/phr table $(REFERENCE) > $(REFERENCE)/table1.md
	./target/release/phr plot $(REFERENCE)
	./target/release/phr plot $(REFERENCE)/growth
	./target/release/phr plot $(REFERENCE)/threads
	./target/release/phr readme README.md RESULTS.md METHODOLOGY.md

bench-paper: packages
	$(CARGO) build --release --bin phr
	./target/release/phr bench --set paper --frames --width 4 --rounds 3 --threads 2 --filter ' 4 embree-grafted' \
		$(addprefix --builder ,$(METHODS)) $$(test -f $(PAPER)/samples.json && echo --resume) --out $(PAPER) $(ARGS)
	./target/release/phr reduce $(PAPER) results/paper-protocol
	./target/release/phr plot results/paper-protocol
	./target/release/phr bench --set paper --size 256 --width 4 --rounds 1 --threads 2 --filter ' 4 phr' \
		$(addprefix --builder ,$(METHODS)) $$(test -f $(PAPER)-steps/samples.json && echo --resume) --out $(PAPER)-steps $(ARGS)
	./target/release/phr reduce $(PAPER)-steps results/paper-steps
	for experiment in construction-speed trace-speed; do \
		./target/release/phr experiment $$experiment --rows results/paper-protocol --rows results/paper-steps \
			--out results/experiments/$$experiment-paper || exit 1; \
	done

# The grid of 5.4 once more over stand-ins for the scenes of which the paper speaks there.
bench-experiments: packages
	$(CARGO) build --release --bin phr
	for experiment in spatial-splits cost-counts auxiliary-trees bucket-sort presplitting constant-cut grid; do \
		./target/release/phr experiment $$experiment $(SCENES) --views 1 --size 128 --rounds 3 --replace \
			--out results/experiments-run/$$experiment $(ARGS) && \
			./target/release/phr reduce results/experiments-run/$$experiment results/experiments/$$experiment && \
			./target/release/phr experiment $$experiment --redraw || exit 1; \
	done
	./target/release/phr experiment grid conference-like hairball-like sanmiguel-like powerplant-like --views 1 --rounds 3 --replace \
		--out results/experiments-run/grid-paper $(ARGS)
	./target/release/phr reduce results/experiments-run/grid-paper results/experiments/grid-paper
	./target/release/phr experiment grid --redraw --out results/experiments/grid-paper
	./target/release/phr experiment cut-size $(SCENES)
	./target/release/phr experiment split
	./target/release/phr bench $(PHASED) --build-only --width 8 --rounds 5 --threads 2 --replace --out results/experiments-run/phases \
		$(addprefix --builder ,$(SCALED) hunt-50 hunt-500 aac ploc) $(ARGS)
	./target/release/phr reduce results/experiments-run/phases results/experiments/phases
	./target/release/phr plot results/experiments/phases
	./target/release/phr heatmap $(HEATMAP) --width 4 -o results/experiments/heatmap/$(basename $(notdir $(HEATMAP:.zst=))).png

# One folder for each library; a round for the one, then one for the other.
embree-ndebug: packages
	sh .ci/embree-ndebug
	$(CARGO) build --release --bin phr
	for round in 1 2 3 4; do \
		[ $$round = 1 ] && resume=--replace || resume=--resume; \
		for library in with: without:$(NDEBUG)/lib; do \
			LD_LIBRARY_PATH=$${library#*:} ./target/release/phr bench --set builtin --size $(SIZE) \
				$(addprefix --builder ,$(ASSERTED)) --rounds $$round --threads 2 $$resume \
				--out results/ndebug-full/$${library%%:*} $(ARGS) || exit 1; \
		done; \
	done
	for library in with without; do ./target/release/phr reduce results/ndebug-full/$$library results/ndebug/$$library; done

# One test more than there are processors at a time: some wait for a browser, or for a program that they stop.
# The page's tests are left out, and say so, where the browser cannot be had; with PHR_BROWSER=1 they fail.
test: packages
	@sh .ci/packages chromium chromium-driver || echo "no Chromium: the page of a run is not tested"
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets -- -D warnings
	$(CARGO) clippy -p phr --lib --no-default-features -- -D warnings
	$(CARGO) clippy -p phr -p embree-sys --lib --bins --examples --no-default-features --features phr/harness -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc -p phr --lib --no-deps --document-private-items
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc -p phr --lib --no-deps
ifeq ($(NEXTEST),yes)
	$(CARGO) nextest run --workspace --lib --tests --test-threads $$(($$(getconf _NPROCESSORS_ONLN) + 1))
	$(CARGO) test --workspace --doc
else
	$(CARGO) test --workspace
endif
	@echo "checked: format, lints (of the library alone and of the harness without Embree too), documentation; all tests, the documentation's examples"

fuzz:
	sh .ci/fuzz

faults: packages
	PHR_KILLS=50 $(CARGO) test -p phr --test harness -- faults:: cut_files:: --nocapture

# Rust's stable compiler has AddressSanitizer, but not the switch for it. ThreadSanitizer has to see the locks of the
# standard library, which is therefore compiled with it; four threads on fewer processors are interrupted anywhere. A test
# asks for more memory than there is. Under Miri, a thousand times as slow, tests of thousands of rays are left out; by its
# stacked borrows rayon's queues are at fault (crossbeam-epoch), by its tree borrows they are not; rayon's threads outlive the
# tests.
sanitize: SLOW_IN_MIRI = a_loaded_tree a_tree_is_built batches_hit lengths_of_slanted no_ray_panics normals_are
sanitize: PACKAGES = valgrind
sanitize: packages
	ASAN_OPTIONS=allocator_may_return_null=1 RUSTC_BOOTSTRAP=1 RUSTFLAGS=-Zsanitizer=address $(CARGO) test -p phr --no-default-features --target $(HOST) \
		--target-dir target/sanitized $(LIBRARY_TESTS)
	if [ -d "$$(rustc +nightly --print sysroot)/lib/rustlib/src" ]; then \
		TSAN_OPTIONS=allocator_may_return_null=1 RAYON_NUM_THREADS=4 RUSTFLAGS=-Zsanitizer=thread $(CARGO) +nightly test -Zbuild-std -p phr --no-default-features \
			--target $(HOST) --target-dir target/thread-sanitized $(LIBRARY_TESTS); \
	else echo "ThreadSanitizer left out: rustup component add rust-src --toolchain nightly"; fi
	$(VALGRIND) $(KERNEL_TESTS)
	$(VALGRIND) $(CONTAINER_TESTS)
	if $(CARGO) +nightly miri --version; then \
		PHR_ISA=scalar MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-tree-borrows -Zmiri-ignore-leaks" $(CARGO) +nightly miri test -p phr --no-default-features \
			--test library -- query:: $(addprefix --skip ,$(SLOW_IN_MIRI)); \
	else echo "Miri is not installed: rustup component add miri --toolchain nightly"; fi

test-platforms:
	sh .ci/test-platforms

audit:
	sh .ci/audit

package: packages
	$(CARGO) package --workspace
	RUSTDOCFLAGS="--cfg docsrs -D warnings" $(CARGO) +nightly doc -p phr --lib --no-deps --no-default-features \
		--features peers --target-dir target/docs

test-peers: packages
	$(CARGO) clippy --workspace --all-targets --features phr/peers -- -D warnings
	$(CARGO) test -p phr --features peers --lib --test harness peers::

test-trixie:
	sh .ci/test-trixie

test-slurm: packages
	$(CARGO) build --release --bin phr
	sh .ci/test-slurm

packages:
	@command -v $(CARGO) >/dev/null || { echo "no cargo: install Rust 1.89 or later, see https://rustup.rs"; exit 1; }
	@sh .ci/packages $(PACKAGES)
