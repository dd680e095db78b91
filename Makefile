# make bench        the table, the plots and the page on the built-in scenes, into results/builtin: from an
#                   empty clone seven minutes on two cores of an AMD EPYC (Zen 4), with the first table after four; eleven
#                   minutes on older processors
# make program      target/release/phr alone
# make report       the page of results/builtin again, report.html; RESULTS=DIR for another folder
# make bench-full   the same with more rays and rounds
# make bench-reference
#                   every figure of the pages that one machine can make, as one command that goes on where it was stopped;
#                   its parts, bench-builders, bench-kernel, bench-paper and others, are in results/runs.mk
# cargo bench --bench steps
#                   the steps of a build one by one (codes, sort, auxiliary tree, sweeps by length of the cut,
#                   refining, leaf blocks, wide nodes), each beside a memcpy of as many bytes: some minutes
# make test         all tests and the documentation's examples: eight minutes from an empty clone on two such cores
# make lint         formatting, lints (of the library without any feature and of the harness without Embree too) and the
#                   documentation
# make check        both, with more trees and scenes compared: everything that is checked before a change is taken
#
# make examples     runs each of the library's examples once: two minutes
#
# make faults       kills a run fifty times at random moments and resumes it, fills its disk, and cuts its results at every
#                   byte: some minutes (the tests have a short version)
# make fuzz         changed and made-up scene files, cameras, saved trees, configurations, rays and results, a minute each, under
#                   AddressSanitizer (nightly toolchain and cargo-fuzz); SECONDS_EACH=600 for ten minutes each
# make sanitize     the library's tests, those beside its code included, under AddressSanitizer and, where the nightly
#                   toolchain has rust-src, under ThreadSanitizer; those of our kernels, of the library's queries and of
#                   the containers with unsafe code under valgrind, and, where the nightly toolchain has Miri, `make miri`:
#                   half an hour and more
# make miri         the tests of the library's queries through the portable kernel under Miri (rustup component add miri
#                   --toolchain nightly): four minutes
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
RESULTS ?= results/builtin
PACKAGES = libembree-dev libclang-dev
HOST = $(shell rustc -vV | sed -n 's/^host: //p')
KERNEL_TESTS = --test library -- trace_agreement trace_batches trace_kernel trace_watertight query:: primitives:: instances::
# The library's tests and those beside its code, but for those that take minutes without a sanitizer.
LIBRARY_TESTS = --lib --test library -- $(addprefix --skip ,tree_hashes configurations_are_refused huge_scenes wide_trees_are_the_naive_ones)
# Those of the containers with unsafe code.
CONTAINER_TESTS = --lib -- parallel:: memory:: builders::lbvh:: builders::wide:: bvh:: geometry::
VALGRIND = CARGO_TARGET_$(shell echo $(HOST) | tr a-z- A-Z_)_RUNNER="valgrind --quiet --error-exitcode=1" \
	$(CARGO) test -p phr --no-default-features --target $(HOST) --target-dir target/valgrind
# Cargo's own tests run by nextest where it is installed.
NEXTEST := $(shell $(CARGO) nextest --version >/dev/null 2>&1 && echo yes)

.PHONY: bench bench-full report program test lint check examples faults fuzz sanitize miri test-platforms audit package test-peers test-trixie test-slurm \
	packages

# The program alone: criterion's benchmarks are not built.
bench: program
	$(PROGRAM) bench --set builtin --rounds 3 --views 1 --size 160 --replace $(ARGS)

# The page of the folder RESULTS again; ARGS="--experiments results/experiments" adds those.
report: program
	$(PROGRAM) report $(RESULTS) $(ARGS)

bench-full: program
	$(PROGRAM) bench --set builtin --replace $(ARGS)

# One test more than there are processors at a time: some wait for a browser, or for a program that they stop.
# The page's tests are left out, and say so, where the browser cannot be had; with PHR_BROWSER=1 they fail.
test: packages
	@sh .ci/packages chromium chromium-driver || echo "no Chromium: the page of a run is not tested"
ifeq ($(NEXTEST),yes)
	$(CARGO) nextest run --workspace --lib --tests --test-threads $$(($$(getconf _NPROCESSORS_ONLN) + 1))
	$(CARGO) test --workspace --doc
else
	$(CARGO) test --workspace
endif
	@echo "checked: all tests, the documentation's examples"

# Trees by all instruction sets at any number of threads, and more scenes.
check: lint
	PHR_THOROUGH=1 $(MAKE) test

lint: packages
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets -- -D warnings
	$(CARGO) clippy -p phr --lib --no-default-features -- -D warnings
	$(CARGO) clippy -p phr -p embree-sys --lib --bins --examples --no-default-features --features phr/harness -- -D warnings
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc -p phr --lib --no-deps --document-private-items
	RUSTDOCFLAGS="-D warnings" $(CARGO) doc -p phr --lib --no-deps
	@echo "checked: format, lints (of the library alone and of the harness without Embree too), documentation"

# Compiled as the tests are.
examples: packages
	for example in build_and_trace choose_preset compare_builders follow_animation instances rebuild_per_frame spheres; do \
		echo "$$example:" && $(CARGO) run --quiet --profile test --example $$example || exit 1; \
	done
	printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > target/triangle.obj
	$(CARGO) run --quiet --profile test --example pathtracer -- target/triangle.obj -o target/triangle.png --width 64 --samples 4

fuzz:
	sh .ci/fuzz

faults: packages
	PHR_KILLS=50 $(CARGO) test -p phr --test harness -- faults:: cut_files:: --nocapture

# Rust's stable compiler has AddressSanitizer, but not the switch for it. ThreadSanitizer has to see the locks of the
# standard library, which is therefore compiled with it; four threads on fewer processors are interrupted anywhere. A test
# asks for more memory than there is. Under Miri, a thousand times as slow, tests of thousands of rays are left out; by its
# stacked borrows rayon's queues are at fault (crossbeam-epoch), by its tree borrows they are not; rayon's threads outlive the
# tests.
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
	if $(CARGO) +nightly miri --version; then $(MAKE) miri; \
	else echo "Miri is not installed: rustup component add miri --toolchain nightly"; fi

miri: SLOW_IN_MIRI = a_bvh_is_a_tracer a_loaded_tree a_tree_ batches_hit lengths_of_slanted no_ray_panics normals_are \
	what_is_turned_down a_filter_that
miri:
	PHR_ISA=scalar MIRIFLAGS="-Zmiri-disable-isolation -Zmiri-tree-borrows -Zmiri-ignore-leaks" $(CARGO) +nightly miri test -p phr --no-default-features \
		--test library -- query:: $(addprefix --skip ,$(SLOW_IN_MIRI))

test-platforms:
	sh .ci/test-platforms

audit:
	sh .ci/audit

package: packages
	$(CARGO) package --workspace
	RUSTDOCFLAGS="--cfg docsrs -D warnings" $(CARGO) +nightly doc -p phr --lib --no-deps --no-default-features \
		--features peers --target-dir target/docs
	DOCS_RS=1 RUSTDOCFLAGS="--cfg docsrs -D warnings" $(CARGO) +nightly doc -p embree-sys --no-deps --target-dir target/docs

test-peers: packages
	$(CARGO) clippy --workspace --all-targets --features phr/peers -- -D warnings
	$(CARGO) test -p phr --features peers --lib --test harness peers::

test-trixie:
	sh .ci/test-trixie

test-slurm: program
	sh .ci/test-slurm

program: packages
	$(CARGO) build --release --bin phr

packages:
	@command -v $(CARGO) >/dev/null || { echo "no cargo: install Rust 1.89 or later, see https://rustup.rs"; exit 1; }
	@sh .ci/packages $(PACKAGES)

include results/runs.mk
