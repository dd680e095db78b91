# The runs behind the committed figures. Included by the Makefile, whose targets and variables are used here.
# They replace what an earlier call left. Durations are those of two cores; those of bench-constants, bench-peers, bench-saved,
# bench-instructions and of all together are estimates.
#
# make bench-reference
#                   every figure of README, RESULTS, METHODOLOGY and FINDINGS that one machine can make: all runs below
#                   (STAGES), then tables, plots, the model of `phr advise` and the pages: 15 to 20 hours. A run that is done
#                   is passed over by the next call, one that was stopped goes on. Needs an idle machine, 16 GiB of memory, 10 GB of
#                   disk, and root for `apt` where embree-ndebug has to be compiled. Left as they are: rows of other
#                   machines and of withheld scenes (results/README.md), sentences written by hand, the tables of
#                   FINDINGS 5.1 and 5.2 over the scenes SCENES, results/turns (which needs a changed program beside this
#                   one), constants/presets.csv and moved.csv, and `make fuzz`.
# make bench-builders
#                   what the targets are judged by (`phr targets`), into results/targets: all builders on the files
#                   SCENES and the built-in scenes with two threads, their builds with one thread beside two, their
#                   growth over scenes of 1 to 32 million triangles, and single extensions: an hour and more, 16 GiB of
#                   memory
# make bench-kernel our kernels and Embree's, single rays and batches, over the same trees, and single rays over trees of
#                   our presets, on the files SCENES and the built-in scenes of 100,000 triangles and more, into
#                   results/kernel: half an hour; 10^8 rays at vertices and edges, into results/leaks; and four scenes at
#                   two sizes of image, into results/kernel-160 and results/kernel-512
# make bench-scaling
#                   the tasks of our builders on the files SCENES and the built-in scenes, timed one by one and scheduled on
#                   up to 64 workers, into results/scaling: ten minutes
# make bench-animation
#                   trees that follow scenes that move, 100 frames each, 4-wide, into results/animation: 25 minutes
# make bench-advice
#                   what `phr advise` names for each of the files SCENES and the built-in scenes after half a minute, helped
#                   by a model that has not seen the scene; judged by a longer run, into results/advice: two hours and
#                   a half
# make bench-tune   what `phr tune` gains over phr-quality for 10^9 rays in the same scenes, two minutes each, into
#                   results/tune: an hour
# make bench-ndebug (and embree-ndebug, which it needs: the distribution's Embree compiled from its source package,
#                   without assertions, into target/embree-ndebug) the built-in scenes built and traced with either
#                   library by turns, the program the same, into results/ndebug: half an hour
# make bench-paper  the paper's protocol: its eight methods over stand-ins for its nine scenes, whole frames of 1024 x 1024
#                   pixels, into results/paper-run; reduced into results/paper-protocol, drawn, and told of beside its claims
#                   of 5.1 and 5.2; then their steps under our kernel, once, into results/paper-steps: three hours
# make bench-experiments
#                   the paper's experiments over the files SCENES, and that of its parameters over stand-ins for its scenes,
#                   into results/experiments-run; reduced into results/experiments, drawn and told; sizes of
#                   cuts, a split, phases of builds and the heat map of Figure 1: two hours
# make bench-constants
#                   what neighbours of the constants chosen on scenes give, to builds too, into results/constants/rows.csv:
#                   ten minutes; with CONSTANTS_ROUNDS=0 nothing is timed
# make bench-peers  the builders of other crates beside ours, into results/peers: half an hour
# make bench-saved  saved trees of ten million triangles, loaded and built, into results/saved: minutes
# make bench-instructions
#                   builds with the machine's best instructions and with none, by turns, into results/instructions: an
#                   hour

# Scene files, rounds, the seconds for which they go on in a scene, and pixels.
SCENES ?= $(wildcard ../shared/scenes/*.ply.zst)
ROUNDS ?= 3
MIN_SECONDS ?= 60
SIZE ?= 160
CONSTANTS_ROUNDS ?= 3
PROGRAM = $(or $(CARGO_TARGET_DIR),./target)/release/phr
JUDGED = results/targets
FULL = results/full
REFERENCE = results/reference
# Builders that have targets, and sizes over which they grow.
TARGETED = lbvh|phr-fast|phr-hq|phr-draft|phr-turbo|phr-speed|phr-quality|phr-best|embree-[a-z-]+
GROWING = lbvh|phr-fast|phr-speed|embree-morton|embree-sah
GROWTH = $(foreach size,1 2 4 8 16 32,scalable-$(size)M)
# PHR-Fast with one extension each, our presets without one each (`phr ablation`), and the costs of a collapse.
COSTS = block=0.175 block=0.7 max_leaf=8 max_leaf=28
ABLATED = phr-fast $(addprefix phr-fast-,bucket coarse clusters subtrees) \
	phr-turbo phr-turbo[presplit=off] phr-turbo[spatial_threshold=off] \
	phr-speed $(patsubst %,phr-speed[%=off],auxiliary_leaf calibration cut_share own_threshold presplit) \
	phr-quality $(patsubst %,phr-quality[%=off],calibration clip_triangles clusters collapse cut_share own_threshold \
	presplit subtree_sweep) $(patsubst %,phr-quality[collapse.%],$(COSTS)) \
	phr-best $(patsubst %,phr-best[%=off],calibration clip_triangles cut_share presplit subtree_sweep) \
	phr-best[rounds=0] $(patsubst %,phr-best[costs.%],$(COSTS))
SCALED = lbvh phr-fast phr-hq phr-draft phr-turbo phr-speed phr-quality phr-best
# The paper's methods, its experiments, and where its protocol is run.
METHODS = embree-morton hunt-50 aac embree-sah hunt-500 embree-fast-spatial phr-fast phr-hq
EXPERIMENTS = spatial-splits cost-counts auxiliary-trees bucket-sort presplitting constant-cut grid
PAPER = results/paper-run
# Scenes whose builds are divided into phases.
PHASED = rooms hair $(filter %/kitchen_bitterli.ply.zst %/karhumaki_bridge.ply.zst,$(SCENES))
# The scene of the heat map: the free part of the one in the paper's Figure 1.
HEATMAP ?= $(or $(firstword $(filter %/sanmiguel_partial.ply.zst,$(SCENES))),sanmiguel-like)
KERNEL_SCENES = rooms statue hair city pipes
# Scenes of larger images, of the constants, and those of other crates' builders, which take minutes in the two largest.
IMAGED = $(filter %/duplex.ply.zst %/bodo_mep.ply.zst %/igea.ply.zst %/campus_vianen.ply.zst,$(SCENES))
VARIED = hair city $(filter %/bunny_144k.ply.zst %/duplex.ply.zst %/dream_apartment.ply.zst %/campus_vianen.ply.zst,$(SCENES))
PEERED = $(KERNEL_SCENES) $(filter-out %/sanmiguel_partial.ply.zst %/karhumaki_bridge.ply.zst,$(SCENES))
PEERS = embree-sah embree-fast-spatial ploc $(addprefix obvhs-,fastest very-fast fast medium slow very-slow) svenstaro-bvh \
	lbvh phr-turbo phr-speed phr-quality phr-best
# All that an advice may name, and Embree's: one that names a tree which the run lacks cannot be judged.
ADVISED = lbvh phr-fast phr-hq phr-draft phr-turbo phr-speed phr-quality phr-best hunt-50 hunt-500 aac ploc embree-morton embree-sah embree-fast-spatial
# Builders whose times with and without assertions in Embree are compared, and ours beside them: what noise looks like.
ASSERTED = embree-morton embree-sah embree-fast-spatial lbvh
NDEBUG = $(CURDIR)/target/embree-ndebug
# Builders that are saved, and those that are built without vector instructions.
SAVED = phr-turbo phr-speed phr-fast phr-quality phr-best
INSTRUCTED = phr-fast phr-hq hunt-50 hunt-500 embree-sah embree-fast-spatial
# The parts of bench-reference: that which compiles a program of its own before results change, by which rows would call it
# dirty; then the short ones, as what is wrong shows early; the reference run itself last.
STAGES = peers constants saved scaling animation kernel ndebug instructions tune experiments advice paper builders
# What is done is noted by the revision of the program. Another begins anew, and `phr bench` refuses to go on with the runs of
# the one before: remove results/full* and results/*-run first.
DONE = results/stages/$(shell git rev-parse --short HEAD)

.PHONY: bench-reference bench-builders bench-kernel bench-scaling bench-animation bench-advice bench-tune bench-ndebug \
	embree-ndebug bench-paper bench-experiments bench-constants bench-peers bench-saved bench-instructions pages

# How the run into the folder $(1) begins: where it was stopped if RESUMED, else in place of an older one.
begun = $(if $(RESUMED),$$(test -f $(1)/samples.json && echo --resume || echo --replace),--replace) --out $(1)

# A run into the folder $(2); of the reference run in a quiet hour, until intervals are narrow.
define measured
	$(PROGRAM) bench $(1) $(call begun,$(2)) $(if $(RESUMED),--when-quiet --until 2%) $(ARGS)

endef

# The runs behind the targets into the folder $(1), and of extensions into $(1)-ablation; the short runs first.
define runs
$(call measured,$(GROWTH) --build-only --filter ' ($(GROWING)) 4 ' --rounds $(ROUNDS) --threads 2,$(1)/growth)
$(call measured,--set builtin $(SCENES) --build-only --filter ' ($(TARGETED)) 4 ' \
	--rounds $(ROUNDS) --seconds $(MIN_SECONDS) --threads 2 --one-thread,$(1)/threads)
$(call measured,--set builtin $(SCENES) --size $(SIZE) --rounds $(ROUNDS) --seconds $(MIN_SECONDS) --threads 2,$(1))
$(call measured,--set builtin $(SCENES) --size 96 $(foreach builder,$(ABLATED),--builder '$(builder)') \
	--rounds $(ROUNDS) --threads 2,$(1)-ablation)
endef

bench-reference: program
	@git diff --quiet HEAD -- src embree-sys benches build.rs Cargo.toml Cargo.lock || { \
		echo "the program is not that of the last commit, by which its runs are noted: commit first"; exit 1; }
	@echo "$(words $(STAGES)) runs over $(words $(SCENES)) scene files and the built-in scenes: $(STAGES)." \
		"The reference run itself (builders) takes four to eight hours on two cores, all of them 15 to 20." \
		"Done at this revision: $(or $(notdir $(wildcard $(DONE)/*)),none). Stop it with Ctrl-C, go on with the same command."
	$(MAKE) RESUMED=yes $(addprefix $(DONE)/,$(STAGES))
	$(MAKE) pages

$(DONE)/builders: | program
	$(call runs,$(FULL))
	$(PROGRAM) reduce $(FULL) $(REFERENCE)
	$(PROGRAM) reduce $(FULL)-ablation $(REFERENCE)-ablation
	mkdir -p $(DONE) && touch $@

$(DONE)/%:
	$(MAKE) bench-$*
	mkdir -p $(DONE) && touch $@

# What is made of the committed rows.
pages: program
	$(PROGRAM) advise --fit $(REFERENCE) --model src/report/advice/model/model.json
	$(PROGRAM) table $(REFERENCE) > $(REFERENCE)/table1.md
	$(PROGRAM) plot $(REFERENCE)
	$(PROGRAM) plot $(REFERENCE)/growth
	$(PROGRAM) plot $(REFERENCE)/threads
	$(PROGRAM) readme README.md RESULTS.md METHODOLOGY.md FINDINGS.md BIAS.md

bench-builders: program
	$(call runs,$(JUDGED))
	$(PROGRAM) plot $(JUDGED)
	$(PROGRAM) plot $(JUDGED)/growth
	$(PROGRAM) targets $(JUDGED)

bench-kernel: program
	$(PROGRAM) kernels $(KERNEL_SCENES) $(SCENES) --least 100000 --size $(SIZE) --seconds 2 --threads 1 --threads 2 \
		--replace --out results/kernel $(ARGS)
	$(PROGRAM) leaks --replace --out results/leaks
	$(if $(IMAGED),for size in 160 512; do $(PROGRAM) kernels $(IMAGED) --builder embree-sah --width 8 --rounds 3 --size $$size \
		--replace --out results/kernel-$$size || exit 1; done)

bench-scaling: program
	$(PROGRAM) scaling $(KERNEL_SCENES) $(SCENES) $(addprefix --builder ,$(SCALED)) --width 8 \
		$(addprefix --workers ,1 2 4 16 64) --replace --out results/scaling $(ARGS)
	$(PROGRAM) plot results/scaling

bench-animation: program
	$(PROGRAM) animate --width 4 --size 128 --replace --out results/animation $(ARGS)

bench-advice: program
	$(PROGRAM) bench $(KERNEL_SCENES) $(SCENES) --size 128 $(addprefix --builder ,$(ADVISED)) --filter grafted \
		--rounds 8 --threads 2 $(call begun,results/advice-run) $(ARGS)
	$(PROGRAM) reduce results/advice-run results/advice
	for scene in $(KERNEL_SCENES) $(SCENES); do \
		name=$$(basename $$scene .ply.zst); \
		$(PROGRAM) advise --fit results/advice --without $$name --model target/without.json && \
			$(PROGRAM) advise $$scene --threads 2 --model target/without.json --out results/advice/$$name \
			|| exit 1; \
	done
	$(PROGRAM) advise --judge results/advice --advice results/advice

bench-tune: program
	for scene in $(KERNEL_SCENES) $(SCENES); do \
		$(PROGRAM) tune $$scene --rays 1G --threads 2 --out results/tune/$$(basename $$scene .ply.zst) $(ARGS) || exit 1; \
	done
	$(PROGRAM) tune --judge results/tune

bench-paper: RESUMED = yes
bench-paper: program
	$(PROGRAM) bench --set paper --frames --width 4 --rounds 3 --threads 2 --filter ' 4 embree-grafted' \
		$(addprefix --builder ,$(METHODS)) $(call begun,$(PAPER)) $(ARGS)
	$(PROGRAM) reduce $(PAPER) results/paper-protocol
	$(PROGRAM) plot results/paper-protocol
	$(PROGRAM) bench --set paper --size 256 --width 4 --rounds 1 --threads 2 --filter ' 4 phr' \
		$(addprefix --builder ,$(METHODS)) $(call begun,$(PAPER)-steps) $(ARGS)
	$(PROGRAM) reduce $(PAPER)-steps results/paper-steps
	for experiment in construction-speed trace-speed; do \
		$(PROGRAM) experiment $$experiment --rows results/paper-protocol --rows results/paper-steps \
			--out results/experiments/$$experiment-paper || exit 1; \
	done

# Those of 5.1 and 5.2 read the rows of older runs, so that they are not here. The grid of 5.4 is made once more over stand-ins
# for the scenes of which the paper speaks there.
bench-experiments: program
	for experiment in $(EXPERIMENTS); do \
		$(PROGRAM) experiment $$experiment $(SCENES) --views 1 --size 128 --rounds 3 \
			$(call begun,results/experiments-run/$$experiment) $(ARGS) && \
			$(PROGRAM) reduce results/experiments-run/$$experiment results/experiments/$$experiment && \
			$(PROGRAM) experiment $$experiment --redraw || exit 1; \
	done
	$(PROGRAM) experiment grid conference-like hairball-like sanmiguel-like powerplant-like --views 1 --rounds 3 \
		$(call begun,results/experiments-run/grid-paper) $(ARGS)
	$(PROGRAM) reduce results/experiments-run/grid-paper results/experiments/grid-paper
	$(PROGRAM) experiment grid --redraw --out results/experiments/grid-paper
	$(PROGRAM) experiment cut-size $(SCENES) --replace
	$(PROGRAM) experiment split --replace
	$(PROGRAM) bench $(PHASED) --build-only --width 8 --rounds 5 --threads 2 $(call begun,results/experiments-run/phases) \
		$(addprefix --builder ,$(SCALED) hunt-50 hunt-500 aac ploc) $(ARGS)
	$(PROGRAM) reduce results/experiments-run/phases results/experiments/phases
	$(PROGRAM) plot results/experiments/phases
	$(PROGRAM) heatmap $(HEATMAP) --width 4 -o results/experiments/heatmap/$(basename $(notdir $(HEATMAP:.zst=))).png

embree-ndebug: packages
	sh .ci/embree-ndebug

# One folder for each library; a round for the one, then one for the other, the other first in every second.
bench-ndebug: embree-ndebug program
	for round in 1 2 3 4; do \
		[ $$round = 1 ] && resume=--replace || resume=--resume; \
		libraries="with: without:$(NDEBUG)/lib"; \
		[ $$((round % 2)) = 0 ] && libraries="without:$(NDEBUG)/lib with:"; \
		for library in $$libraries; do \
			LD_LIBRARY_PATH=$${library#*:} $(PROGRAM) bench --set builtin --size $(SIZE) \
				$(addprefix --builder ,$(ASSERTED)) --rounds $$round --threads 2 $$resume \
				--out results/ndebug-full/$${library%%:*} $(ARGS) || exit 1; \
		done; \
	done
	for library in with without; do $(PROGRAM) reduce results/ndebug-full/$$library results/ndebug/$$library; done

# Likewise: a round with the best instructions, then one with none.
bench-instructions: program
	for round in 1 2 3; do \
		[ $$round = 1 ] && resume=--replace || resume=--resume; \
		[ $$((round % 2)) = 1 ] && order="best scalar" || order="scalar best"; \
		for isa in $$order; do \
			[ $$isa = best ] && unset PHR_ISA || export PHR_ISA=$$isa; \
			$(PROGRAM) bench $(SCENES) --build-only --width 4 $(addprefix --builder ,$(INSTRUCTED)) \
				--rounds $$round --threads 2 $$resume --out results/instructions-full/$$isa $(ARGS) || exit 1; \
		done; \
	done
	for isa in best scalar; do $(PROGRAM) reduce results/instructions-full/$$isa results/instructions/$$isa; done

bench-constants: packages
	$(CARGO) bench --bench constants -- --rounds=$(CONSTANTS_ROUNDS) $(VARIED) > target/constants.csv
	mv target/constants.csv results/constants/rows.csv

bench-peers: packages
	$(CARGO) build --release --bin phr --features peers --target-dir target/peers
	./target/peers/release/phr bench $(PEERED) --filter '( 8 |embree-sah 4 ).*embree-grafted' $(addprefix --builder ,$(PEERS)) \
		--size 96 --views 1 --rounds 3 --threads 2 $(call begun,results/peers-run) $(ARGS)
	./target/peers/release/phr reduce results/peers-run results/peers

bench-saved: program
	for builder in $(SAVED); do \
		$(PROGRAM) build scalable-10M --builder $$builder --width 4 --threads 2 -o target/$$builder.tree || exit 1; \
	done
	$(PROGRAM) bench scalable-10M --width 4 --build-only --rounds 5 --threads 2 --builder lbvh \
		$(foreach builder,$(SAVED),--builder $(builder) --tree target/$(builder).tree) $(call begun,results/saved-run) $(ARGS)
	$(PROGRAM) reduce results/saved-run results/saved
	rm $(foreach builder,$(SAVED),target/$(builder).tree)
