# The pipeline: scene -> cloud -> images. `make help` lists what there is.
#
# Every recipe is $(SUBMIT) program --threads $(THREADS) ... -o $@: it reads files, writes one, and never asks.

.DELETE_ON_ERROR:
.SECONDARY:
.SUFFIXES:
unexport MAKEFLAGS

OUT     ?= out
THREADS ?= $(shell nproc)
SUBMIT  ?=
CARGO   ?= cargo
SAMPLES ?= 1M
SEED    ?= 0
SPP     ?= 16
MODEL   ?= directional-dipole

BIN := target/release
SAMPLE := $(BIN)/sample-surface
GATHER := $(BIN)/gather
MAKE_SCENES := $(BIN)/make-scenes
COMPARE := $(BIN)/compare
CONTACT_SHEET := $(BIN)/contact-sheet
RUN_NAME := k$(SAMPLES)-s$(SEED)

# The gallery: scene:medium, each from every view of the scene in data/views. A scene of several media has its list,
# MATERIAL=medium each, in MEDIA_ and the name that stands for them. What a scene stands under is the same in both
# programs: ENVIRONMENT_<scene>, a picture or R,G,B.
GALLERY := gummies:fruit chess:stones piglet:skin2 candle:candle_wax milk:wholemilk
MEDIA_fruit  := Cherry=cherry Orange=orange Lime=lime
MEDIA_stones := Marble=marble Jade=jade
ENVIRONMENT_gummies := 0.1,0.11,0.13
ENVIRONMENT_chess   := 0.05,0.06,0.08
ENVIRONMENT_piglet  := 0.08,0.09,0.11
ENVIRONMENT_candle  := 0.006,0.008,0.013
ENVIRONMENT_milk    := data/environments/sky.hdr
EXPOSURE_gummies := 0.25
EXPOSURE_chess   := 0.15
EXPOSURE_piglet  := 0.25
EXPOSURE_candle  := 0.7
EXPOSURE_milk    := 0.4

comma := ,
space := $(subst ,, )
media_of       = $(or $(MEDIA_$(1)),$(1))
# Of a list as above: the media, their files, and the options that say them.
names_of       = $(foreach m,$(call media_of,$(1)),$(lastword $(subst =, ,$(m))))
files_of       = $(patsubst %,data/media/%.json,$(call names_of,$(1)))
medium_options = $(foreach m,$(call media_of,$(1)),--medium $(if $(findstring =,$(m)),$(firstword $(subst =, ,$(m)))=)data/media/$(lastword $(subst =, ,$(m))).json)
environment_of = $(if $(ENVIRONMENT_$(1)),--environment $(ENVIRONMENT_$(1)))
pictures_of = $(patsubst data/views/$(1)/%.json,$(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL)/%.exr,$(wildcard data/views/$(1)/*.json))
PICTURES := $(foreach g,$(GALLERY),$(call pictures_of,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g)))))

ifdef SCENE
.DEFAULT_GOAL := own
else
.DEFAULT_GOAL := gallery
endif

# Title=picture, for the contact sheet.
titled = $(foreach p,$(call pictures_of,$(1),$(2)),"$(1) $(basename $(notdir $(p)))/$(subst $(space),$(comma)$(space),$(call names_of,$(2)))=$(basename $(p)).png")

.PHONY: .FORCE gallery own contact-sheet build test check check-images check-alarms check-power golden references browser-test slow farm-test peers fuzz accuracy curve curve-full scale bench lint scenes clouds images help clean clean-images

## gallery: build, and render every scene, medium and view of the gallery (what `make` does)
gallery: contact-sheet
	@echo "All pictures on one sheet: $(OUT)/gallery-$(RUN_NAME).png"
	@echo "Each by itself: $(OUT)/*/$(RUN_NAME)/*/*.png; beside it lies its OpenEXR image."

## images: the gallery's images, with programs that are built
images: $(PICTURES)

## contact-sheet: all pictures of the gallery on one sheet, with their scenes, views and media
contact-sheet: $(OUT)/gallery-$(RUN_NAME).png

$(OUT)/gallery-$(RUN_NAME).png: $(PICTURES) | $(CONTACT_SHEET)
	$(CONTACT_SHEET) $(foreach g,$(GALLERY),$(call titled,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))))) -o $@

## clouds: the gallery's clouds
clouds: $(foreach s,$(sort $(foreach g,$(GALLERY),$(word 1,$(subst :, ,$(g))))),$(OUT)/$(s)/$(RUN_NAME).cloud)

## build: the programs, optimised
build:
	$(CARGO) build --release --workspace --quiet

# What changes a result and is no file lies in one that is written only when it changes: $(1) file, $(2) text.
define settings
$(1): .FORCE
	@mkdir -p $$(@D)
	@echo '$(2)' | cmp -s - $$@ || echo '$(2)' > $$@
endef

ifndef SCENE
# A cloud depends on its scene, its environment and the format's version; programs are order-only, so a rebuild keeps
# clouds. What else changes a cloud (samples, seed) is in its name.
define cloud
$(OUT)/$(1)/$(RUN_NAME).cloud: data/scenes/$(1).glb $(wildcard $(ENVIRONMENT_$(1))) $(OUT)/$(1)/$(RUN_NAME).settings \
  crates/formats/cloud-version | $(SAMPLE)
	$$(SUBMIT) $$(SAMPLE) --threads $$(THREADS) --seed $$(SEED) --samples $$(SAMPLES) $(call environment_of,$(1)) --quiet $$< -o $$@
endef
SCENES := $(patsubst data/scenes/%.glb,%,$(wildcard data/scenes/*.glb))
$(foreach s,$(SCENES),$(eval $(call settings,$(OUT)/$(s)/$(RUN_NAME).settings,$(ENVIRONMENT_$(s)))))
$(foreach s,$(SCENES),$(eval $(call cloud,$(s))))

folder_of = $(OUT)/$(word 1,$(subst :, ,$(1)))/$(RUN_NAME)/$(word 2,$(subst :, ,$(1)))-$(MODEL)
$(foreach g,$(GALLERY),$(eval $(call settings,$(call folder_of,$(g))/settings,\
$(SPP) $(MEDIA_$(word 2,$(subst :, ,$(g)))) $(EXPOSURE_$(word 1,$(subst :, ,$(g)))))))

# $(1) scene, $(2) medium, $(3) view
define picture
$(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL)/$(3).exr: $(OUT)/$(1)/$(RUN_NAME).cloud $(call files_of,$(2)) data/views/$(1)/$(3).json \
  $(OUT)/$(1)/$(RUN_NAME)/$(2)-$(MODEL)/settings | $(GATHER)
	$$(SUBMIT) $$(GATHER) --threads $$(THREADS) --seed $$(SEED) --spp $$(SPP) --bssrdf $$(MODEL) $(call medium_options,$(2)) \
	  $(call environment_of,$(1)) --view data/views/$(1)/$(3).json --preview $$(basename $$@).png \
	  --exposure $$(or $$(EXPOSURE_$(1)),0) --quiet $$< data/scenes/$(1).glb -o $$@
endef
$(foreach g,$(GALLERY),$(foreach v,$(notdir $(basename $(wildcard data/views/$(word 1,$(subst :, ,$(g)))/*.json))),\
$(eval $(call picture,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))),$(v)))))

else
# A user's own file: make SCENE=path.glb MEDIUM=marble [SAMPLES=4M], one image for each of its cameras, or for each of
# VIEWS='path/*.json'; with an empty MEDIUM= the file's own media; ENVIRONMENT=sky.exr or R,G,B lights it from all around.
MEDIUM ?= marble
OWN := $(OUT)/$(notdir $(basename $(SCENE)))/$(RUN_NAME)
OWN_IMAGES := $(OWN)/$(or $(notdir $(basename $(MEDIUM))),own)-$(MODEL)
$(eval $(call settings,$(OWN).settings,$(ENVIRONMENT) $(TRANSLUCENT)))
$(eval $(call settings,$(OWN_IMAGES)/settings,$(SPP) $(EXPOSURE)))

ifdef VIEWS
VIEW_FILES := $(foreach v,$(VIEWS),$(or $(wildcard $(v)),$(error no view at $(v))))
VIEW_NAMES := $(basename $(notdir $(VIEW_FILES)))
$(if $(filter-out %.json,$(VIEW_FILES)),$(error VIEWS: not a .json file: $(filter-out %.json,$(VIEW_FILES))))
$(if $(filter-out $(words $(sort $(VIEW_NAMES))),$(words $(VIEW_NAMES))),$(error VIEWS: two files of one name: $(VIEW_FILES)))
# Of a list of views NAME.json the images are NAME.VIEW.exr, and NAME.views is written when all are there.
LISTS := $(shell awk 'FNR == 1 { text = "" } length(text) < 9 { text = text $$0; gsub(/[ \t\r]/, "", text); \
  if (text ~ /^(\[|{"views":)/ && !(FILENAME in seen)) { seen[FILENAME]; print FILENAME } }' $(VIEWS))
picture_of = $(OWN_IMAGES)/$(notdir $(basename $(1))).$(if $(filter $(1),$(LISTS)),views,exr)
OWN_PICTURES := $(foreach v,$(VIEW_FILES),$(call picture_of,$(v)))
else
# Made, and then read again by make itself: the cameras are those of the file.
include $(OWN).cameras
OWN_PICTURES := $(CAMERAS:%=$(OWN_IMAGES)/camera%.exr)
endif

own: $(OWN_PICTURES)
	@echo "The pictures are in $(OWN_IMAGES)/: one .png and one OpenEXR image for each view."

$(OWN).cameras: $(SCENE) | $(GATHER)
	@mkdir -p $(@D)
	@$(GATHER) --list-cameras --quiet '$<' > $@.list
	@sed -e 1d -e 's/ .*//' -e 's/^/CAMERAS += /' $@.list > $@
	@rm $@.list
	@test -s $@ || { echo "$<: it has no camera; give VIEWS='path/*.json'" >&2; exit 2; }

$(OWN).cloud: $(SCENE) $(wildcard $(ENVIRONMENT)) $(OWN).settings crates/formats/cloud-version | $(SAMPLE)
	$(SUBMIT) $(SAMPLE) --threads $(THREADS) --seed $(SEED) --samples $(SAMPLES) $(foreach t,$(TRANSLUCENT),--translucent $(t)) \
	  $(if $(ENVIRONMENT),--environment $(ENVIRONMENT)) '$<' -o $@

# $(1) image, or what says that all images of a list are there; $(2) the file of its view if it has one, $(3) option that says the view
define own_picture
$(1): $(OWN).cloud $(wildcard $(MEDIUM)) $(2) $(OWN_IMAGES)/settings | $(GATHER)
	$$(SUBMIT) $(GATHER) --threads $$(THREADS) --seed $$(SEED) --spp $$(SPP) --bssrdf $$(MODEL) $$(if $$(MEDIUM),--medium $$(MEDIUM)) $(3) \
	  $$(if $$(ENVIRONMENT),--environment $$(ENVIRONMENT)) --preview $$(basename $$@).png --exposure $$(or $$(EXPOSURE),0) $$< '$$(SCENE)' -o $$(basename $$@).exr
	$(if $(filter %.views,$(1)),@touch $$@)
endef
$(foreach c,$(CAMERAS),$(eval $(call own_picture,$(OWN_IMAGES)/camera$(c).exr,,--camera $(c))))
$(foreach v,$(VIEW_FILES),$(eval $(call own_picture,$(call picture_of,$(v)),$(v),--view $(v))))
endif

$(SAMPLE) $(GATHER) $(COMPARE) $(MAKE_SCENES) $(CONTACT_SHEET): | build ;

## scenes: write data/scenes, data/views and data/environments again
scenes: build
	$(MAKE_SCENES) data

## test: all fast tests
test:
	$(CARGO) test --workspace --quiet

## browser-test: the pages of `compare --html` in headless Chromium (needs chromium and python3; half a minute)
browser-test:
	@command -v python3 >/dev/null || { echo "browser-test: no python3 found; install it (Debian: apt install python3)" >&2; exit 1; }
	$(CARGO) build --release --package compare --quiet
	python3 -B tests/browser/run.py $(BIN)/compare

# The noise test (docs/check.md): small images of each scene of the gallery, each from a cloud with a seed of its own.
# Settings and seeds are part of the folder's name. CHECK_SEED is the first of CHECK_COUNT seeds.
CHECK_SEED  ?= 1000
CHECK_COUNT ?= 8
CHECK_SAMPLES := 100k
CHECK_SPP     := 12
CHECK_SIZE    := 48
# Light from a flame inside a hollow takes many samples before its means are near normal.
CHECK_SAMPLES_candle := 500k
# The one medium that absorbs in all colours, and thus tells most about coefficients, is worth more.
CHECK_SAMPLES_piglet := 200k
CHECK_SPP_piglet     := 24
REFERENCE_SEED  := 1
REFERENCE_COUNT := 64
GOLDEN := tests/golden

CHECK_SEEDS  := $(shell seq $(CHECK_SEED) $$(($(CHECK_SEED) + $(CHECK_COUNT) - 1)))
CHECK_SCENES := $(foreach g,$(GALLERY),$(firstword $(subst :, ,$(g))))
# $(1) scene
check_setting = $(or $(CHECK_$(2)_$(1)),$(CHECK_$(2)))
check_view    = $(firstword $(sort $(wildcard data/views/$(1)/*.json)))
check_folder  = $(OUT)/check/s$(CHECK_SEED)-n$(CHECK_COUNT)/$(1)-k$(call check_setting,$(1),SAMPLES)-p$(call check_setting,$(1),SPP)-w$(CHECK_SIZE)
# What is stored with the golden figures: $(1) scene, $(2) medium.
check_sample  = --samples $(call check_setting,$(1),SAMPLES) $(call environment_of,$(1))
check_gather  = --spp $(call check_setting,$(1),SPP) --width $(CHECK_SIZE) --height $(CHECK_SIZE) --bssrdf directional-dipole \
  $(call medium_options,$(2)) $(call environment_of,$(1)) --view $(call check_view,$(1))

# Here the programs are what is tested, so all is made again when they change; sample-surface would keep a cloud that is
# there.
define check_rules
$(call check_folder,$(1))/%.cloud: data/scenes/$(1).glb $(wildcard $(ENVIRONMENT_$(1))) crates/formats/cloud-version $(SAMPLE)
	@mkdir -p $$(@D) && rm -f $$@
	$$(SUBMIT) $$(SAMPLE) --threads $$(THREADS) --seed $$* $(call check_sample,$(1)) --quiet $$< -o $$@
$(call check_folder,$(1))/%.exr: $(call check_folder,$(1))/%.cloud $(call files_of,$(2)) $(call check_view,$(1)) $(GATHER)
	@mkdir -p $$(@D)
	$$(SUBMIT) $$(GATHER) --threads $$(THREADS) --seed $$* $(call check_gather,$(1),$(2)) --quiet $$< data/scenes/$(1).glb -o $$@
CHECK_IMAGES += $(foreach s,$(CHECK_SEEDS),$(call check_folder,$(1))/$(s).exr)
endef
$(foreach g,$(GALLERY),$(eval $(call check_rules,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))))))

## check: small images with new clouds against tests/golden, by statistics (docs/check.md; CHECK_SEED=N for other seeds)
check: build
	@$(MAKE) --no-print-directory --silent check-images
	@code=0; for scene in $(foreach s,$(CHECK_SCENES),$(s)=$(call check_folder,$(s))); do \
	  $(COMPARE) --replicates --family $(words $(CHECK_SCENES)) --quiet --json "$${scene#*=}.json" $(GOLDEN)/"$${scene%%=*}" "$${scene#*=}" || code=1; \
	done; exit $$code

## check-images: the images that `make check` judges
check-images: $(CHECK_IMAGES)

## references: tests/golden again, from other seeds than those of `make check`; see docs/check.md for when
references: build
	@$(MAKE) --no-print-directory --silent check-images CHECK_SEED=$(REFERENCE_SEED) CHECK_COUNT=$(REFERENCE_COUNT)
	@$(MAKE) --no-print-directory golden CHECK_SEED=$(REFERENCE_SEED) CHECK_COUNT=$(REFERENCE_COUNT)

golden: $(foreach s,$(CHECK_SCENES),golden-$(s))

# The figures, the mean image, and the commands that made them.
define golden
golden-$(1):
	$(COMPARE) --summarise $(call check_folder,$(1)) $(GOLDEN)/$(1)
	@printf '%s\n' 'for s in $$$$(seq $(firstword $(CHECK_SEEDS)) $(lastword $(CHECK_SEEDS))); do' \
	  '  sample-surface --seed $$$$s $(call check_sample,$(1)) data/scenes/$(1).glb -o $$$$s.cloud' \
	  '  gather --seed $$$$s $(strip $(call check_gather,$(1),$(2))) $$$$s.cloud data/scenes/$(1).glb -o $(1)/$$$$s.exr' \
	  'done' 'compare --summarise $(1) $(GOLDEN)/$(1)' > $(GOLDEN)/$(1)/command.sh
endef
$(foreach g,$(GALLERY),$(eval $(call golden,$(word 1,$(subst :, ,$(g))),$(word 2,$(subst :, ,$(g))))))

## check-alarms: `make check` under RUNS=200 new seeds, none of which may fail (an hour)
RUNS ?= 200
check-alarms: build
	tests/check/alarms.sh $(RUNS)

## check-power: errors planted one by one into a copy of the tree, each of which `make check` must find (many minutes)
check-power:
	tests/check/planted.sh

## slow: statistical and stability tests at full sample counts
slow: build
	$(CARGO) test --release --package bssrdf --test lanes -- --nocapture
	$(CARGO) test --release --package pipeline-tests --features slow
	$(CARGO) test --release --package gather --features slow --test programs -- --nocapture mutations faults

# Outside the workspace, with a nightly compiler. What is new goes to OUT, not into the corpus.
TARGET  ?= cloud
SECONDS ?= 3600

## fuzz: look for bytes that break TARGET=cloud, gltf, image, limits, medium or view, for SECONDS=3600 (fuzz/README.md)
fuzz:
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

## accuracy: what the models are worth, against random walks: docs/accuracy.md and its pictures (minutes)
accuracy:
	$(CARGO) run --release --quiet --package pipeline-tests --bin accuracy -- docs

# Where `make curve` finds bunny.glb and dragon.glb, and peers/ in the folder above; without them it takes a scene of data/.
MESHES ?= data/scenes
CURVE  := $(CARGO) run --release --quiet --package pipeline-tests --bin curve -- --meshes $(MESHES) --programs $(BIN) --output docs

## curve: time against error: docs/speed.md with its plots and raw data (minutes; MESHES=folder of bunny.glb, dragon.glb)
curve: build
	$(CURVE)

## curve-full: the same with larger clouds and more runs (an hour)
curve-full: build
	$(CURVE) --full

## scale: what sizes cost, and what that says of farms: docs/scale.md (minutes)
scale: build
	$(CURVE) --scale

## bench: the kernels, the trees and the rays by themselves
bench:
	$(CARGO) bench --package bssrdf --bench kernels
	$(CARGO) bench --package scene --bench rays

## lint: formatting, and clippy without warnings
lint:
	$(CARGO) fmt --all --check
	$(CARGO) clippy --workspace --all-targets --quiet -- -D warnings

## clean-images: remove images, keep clouds
clean-images:
	find $(OUT) \( -name '*.exr' -o -name '*.png' \) -delete

## clean: remove all that was rendered
clean:
	rm -rf $(OUT)

## help: this list
help:
	@sed -n 's/^## /  make /p' $(MAKEFILE_LIST)
	@echo "  make SCENE=path.glb MEDIUM=marble [SAMPLES=4M] [TRANSLUCENT=Wax] [EXPOSURE=1]: your own file, one image a camera"
	@echo "  make SCENE=path.glb MEDIUM=marble VIEWS='views/*.json': the same, one image a view file"
	@echo "  variables: OUT=$(OUT) THREADS=$(THREADS) SUBMIT=$(SUBMIT) SAMPLES=$(SAMPLES) SEED=$(SEED) SPP=$(SPP) MODEL=$(MODEL)"
