# Tests: of the programs and crates (test, slow), of their pages and farms (browser-test, farm-test), against other
# implementations (peers), with random bytes (fuzz); the checks of the sources (lint); and the benchmarks (bench).

.PHONY: test slow browser-test farm-test peers fuzz lint bench

## test: all fast tests
test:
	$(CARGO) test --workspace --quiet

## browser-test: the pages of `compare --html` in headless Chromium (needs chromium and python3; half a minute)
browser-test:
	@command -v python3 >/dev/null || { echo "browser-test: no python3 found; install it (Debian: apt install python3)" >&2; exit 1; }
	$(CARGO) build --release --package compare --quiet
	python3 -B tests/browser/run.py $(BIN)/compare

## slow: statistical and stability tests at full sample counts
slow: build
	$(CARGO) test --release --package bssrdf --test lanes -- --nocapture
	$(CARGO) test --release --package pipeline-tests --features slow
	$(CARGO) test --release --package sample-surface --features slow --test targets -- --nocapture
	$(CARGO) test --release --package gather --features slow --test programs -- --nocapture mutations faults sixteen

# The fuzz targets are outside the workspace and need a nightly compiler. New inputs go to OUT, not into the corpus.
# TARGET is taken from the command line alone: compilers have an environment variable of that name.
TARGET  := cloud
TARGETS := $(basename $(notdir $(wildcard fuzz/targets/*.rs)))
SECONDS ?= 3600
$(call check_names,TARGET)

## fuzz: look for bytes that break TARGET=cloud, calibration, facts, gltf, image, limits, medium or view, for SECONDS=3600 (fuzz/README.md)
fuzz:
	$(if $(filter $(TARGET),$(TARGETS)),,$(error TARGET=$(TARGET): it is one of $(TARGETS)))
	@mkdir -p $(OUT)/fuzz/$(TARGET)/found
	$(CARGO) +nightly fuzz run --fuzz-dir fuzz $(TARGET) $(OUT)/fuzz/$(TARGET)/found fuzz/corpus/$(TARGET) -- \
	  -artifact_prefix=$(abspath $(OUT))/fuzz/$(TARGET)/ -max_total_time=$(SECONDS) \
	  -rss_limit_mb=2048 -timeout=10 -max_len=65536 -print_final_stats=1

## peers: the metrics of `compare` against scikit-image and flip-evaluator (Python 3.11 or later, and a network once)
peers: build
	python3 tests/peers/metrics.py --compare $(BIN)/compare --environment target/peers-venv

## farm-test: twelve views through a Slurm farm of two nodes on this machine (root; a minute)
farm-test:
	tests/farm/run

## bench: the kernels, the trees and the rays by themselves
bench:
	$(CARGO) bench --package bssrdf --bench kernels
	$(CARGO) bench --package scene --bench rays

## lint: formatting, clippy and the documentation of the crates, without warnings
lint:
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets --quiet -- -D warnings
	RUSTDOCFLAGS='-D warnings' $(CARGO) doc --workspace --no-deps --quiet
