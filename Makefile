# The pipeline: scene -> cloud -> images. `make help` lists the targets; each file of make/ holds one idea:
#
#   names.mk     which names make accepts             check.mk    the regression test against tests/golden
#   settings.mk  when a file is made again            tests.mk    lint, tests, fuzzing, benchmarks
#   calibrations.mk  whether pictures are calibrated  reports.mk  the documents that programs write
#   gallery.mk   the scenes of data/                  table.mk    the table of the half-space model
#   own.mk       your own scene: make SCENE=...       clean.mk    removal of what was made
#   truth.mk     your own scene beside the truth      install.mk  the programs, their manual pages and completions
#   blender.mk   scenes that Blender exports          cycles.mk  our pictures beside those of Cycles
#
# Every recipe that renders is $(SUBMIT) PROGRAM --threads $(THREADS) ... -o $@: it reads files, writes one and never
# asks, so that SUBMIT may hand it to a queue of machines (docs/farm.md).

.DELETE_ON_ERROR:
.SECONDARY:
.SUFFIXES:
unexport MAKEFLAGS

# All rendered files go to OUT, where `make clean` removes it. OUT is taken from the command line alone, because
# the environment may hold a variable of that name by chance.
ifneq ($(filter environment%,$(origin OUT)),)
$(warning OUT=$(OUT) of the environment is not used; give it to make: make OUT=FOLDER)
override OUT := out
endif
OUT     ?= out
$(if $(OUT),,$(error OUT is empty; give a folder, or leave it away for `out`))
# Threads of each program.
THREADS ?= $(shell nproc)
# What runs a program: empty for this machine, or a command such as srun.
SUBMIT  ?=
CARGO   ?= cargo
# Samples and seed of a cloud; paths for each pixel (of some of the gallery more, unless given) and BSSRDF model of an image.
SAMPLES ?= 1M
SEED    ?= 0
SPP     ?= 16
MODEL   ?= half-space

BIN := target/release
SAMPLE := $(BIN)/sample-surface
CALIBRATOR := $(BIN)/calibrate
GATHER := $(BIN)/gather
MAKE_SCENES := $(BIN)/make-scenes
COMPARE := $(BIN)/compare
CONTACT_SHEET := $(BIN)/contact-sheet
RUN_NAME := k$(SAMPLES)-s$(SEED)

ifdef SCENE
.DEFAULT_GOAL := own
else
.DEFAULT_GOAL := gallery
endif

MAKE_FILES := $(dir $(lastword $(MAKEFILE_LIST)))make
$(if $(wildcard $(MAKE_FILES)/*.mk),,$(error $(MAKE_FILES)/ is missing: where the Makefile is copied to, that folder belongs too))
include $(MAKE_FILES)/names.mk
include $(MAKE_FILES)/settings.mk
include $(MAKE_FILES)/calibrations.mk
include $(MAKE_FILES)/gallery.mk
include $(MAKE_FILES)/own.mk
include $(MAKE_FILES)/truth.mk
include $(MAKE_FILES)/tests.mk
include $(MAKE_FILES)/blender.mk
include $(MAKE_FILES)/cycles.mk
include $(MAKE_FILES)/check.mk
include $(MAKE_FILES)/reports.mk
include $(MAKE_FILES)/table.mk
include $(MAKE_FILES)/install.mk
include $(MAKE_FILES)/clean.mk

.PHONY: .FORCE build scenes help

## build: the programs, optimized
build:
	$(CARGO) build --release --workspace --quiet

$(SAMPLE) $(CALIBRATOR) $(GATHER) $(COMPARE) $(MAKE_SCENES) $(CONTACT_SHEET): | build ;

## scenes: write data/scenes, data/views and data/environments again
scenes: build
	$(MAKE_SCENES) data

## help: this list
help:
	@sed -n 's/^## /  make /p' $(MAKEFILE_LIST)
	@echo "  make SCENE=path.glb MEDIUM=marble [SIZE=0.1] [SAMPLES=4M] [TRANSLUCENT=Wax] [EXPOSURE=1] [TIME=0.5] [ANIMATION=walk]: your own file, one image a camera"
	@echo "  make SCENE=path.glb MEDIUM=marble VIEWS='views/*.json': the same, one image a view file"
	@echo "  variables: OUT=$(OUT) THREADS=$(THREADS) SUBMIT=$(SUBMIT) SAMPLES=$(SAMPLES) SEED=$(SEED) SPP=$(SPP)$(if $(filter file,$(origin SPP)), (peach: $(PATHS_peach), chess: $(PATHS_chess))) MODEL=$(MODEL)"
	@echo "    CALIBRATE=$(CALIBRATE) WALKS=$(WALKS); of truth also WIDTH=$(WIDTH) ERROR=$(ERROR)"
