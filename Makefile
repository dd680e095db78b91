# make bench        the table on the built-in scenes, into results/builtin: some minutes on two cores
# make bench-paper  the same on the paper's nine scenes or their stand-ins, into results/paper-scenes: hours
# make test         everything that is checked before a change is taken: formatting, lints, the library
#                   without any feature, the harness without Embree, all tests and the documentation's examples
#
# Debian packages that are missing are installed, as root or by sudo. ARGS go to `phr bench`.

CARGO ?= cargo
ARGS ?=
PACKAGES = libembree-dev libclang-dev
# Cargo's own tests run by nextest where it is installed.
NEXTEST := $(shell $(CARGO) nextest --version >/dev/null 2>&1 && echo yes)

.PHONY: bench bench-paper test packages

bench: packages
	$(CARGO) build --release
	./target/release/phr bench --set builtin $(ARGS)

bench-paper: packages
	$(CARGO) build --release
	./target/release/phr bench --set paper --frames $(ARGS)

test: packages
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets -- -D warnings
	$(CARGO) clippy -p phr --lib --no-default-features -- -D warnings
	$(CARGO) clippy -p phr --lib --bins --no-default-features --features harness -- -D warnings
ifeq ($(NEXTEST),yes)
	$(CARGO) nextest run --workspace
	$(CARGO) test --workspace --doc
else
	$(CARGO) test --workspace
endif
	@echo "tested: format, lints, the library alone, the harness without Embree, all tests, the documentation's examples"

packages:
	@command -v $(CARGO) >/dev/null || { echo "no cargo: install Rust 1.89 or later, see https://rustup.rs"; exit 1; }
	@sh .ci/packages $(PACKAGES)
